//! The rules by which a control mesh is subdivided.

use super::SubdivMesh;

/// Whose rules make the limit surface of a control mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
pub enum Scheme {
    /// Catmull & Clark 1978: bicubic splines where the mesh is regular.
    #[default]
    CatmullClark,
    /// Loop 1987, for triangles: quartic box splines where the mesh is regular.
    Loop,
    /// Every face stays where it is: a quad is the bilinear patch of its corners, any other face is cut into quads at the
    /// middles of its edges and the mean of its corners. Sharpness changes nothing.
    Bilinear,
    /// Polygons as they are, no subdivision. A convex face in a plane is covered exactly as it is; one that is not in a plane,
    /// or crosses itself, is the surface that [`Bilinear`](Self::Bilinear) makes of it. A concave one is refused; readers cut it into
    /// convex pieces first ([`SubdivMesh::cut_concave_faces`]).
    None,
}

impl Scheme {
    /// All schemes.
    pub const ALL: [Self; 4] = [Self::CatmullClark, Self::Loop, Self::Bilinear, Self::None];

    /// The token of `UsdGeomMesh` and of the `scheme` tag.
    pub fn name(self) -> &'static str {
        match self {
            Self::CatmullClark => "catmullClark",
            Self::Loop => "loop",
            Self::Bilinear => "bilinear",
            Self::None => "none",
        }
    }

    /// The scheme of a name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scheme| scheme.name() == name)
    }

    /// Faces stay as flat as they are, with a crease at every edge.
    pub fn is_linear(self) -> bool {
        matches!(self, Self::Bilinear | Self::None)
    }

    /// A face of so many corners is one ptex face; any other face is one for each corner.
    pub fn regular_face_size(self) -> usize {
        match self {
            Self::Loop => 3,
            _ => 4,
        }
    }
}

impl SubdivMesh {
    /// Number of ptex faces that a face of `size` corners takes.
    pub(crate) fn ptex_faces_of(&self, size: usize) -> usize {
        if size == self.scheme.regular_face_size() { 1 } else { size }
    }
}
