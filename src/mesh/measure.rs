//! Counts, faces and extent of a mesh.

use glam::DVec3;

use super::SubdivMesh;

impl SubdivMesh {
    /// Number of faces, holes included.
    pub fn face_count(&self) -> usize {
        self.face_sizes.len()
    }

    /// Number of ptex faces, holes included: a quad is one, an n-gon n; under Loop's scheme a triangle is one.
    pub fn ptex_count(&self) -> usize {
        self.face_sizes.iter().map(|&size| self.ptex_faces_of(size as usize)).sum()
    }

    /// Number of control points, those that no face uses included.
    pub fn vertex_count(&self) -> usize {
        self.points.len()
    }

    /// Faces in order: index and vertices.
    ///
    /// Ends early if `face_sizes` asks for more vertices than there are, which [`validate`](Self::validate) refuses.
    pub fn faces(&self) -> impl Iterator<Item = (usize, &[u32])> {
        let mut rest = self.face_vertices.as_slice();
        self.face_sizes.iter().enumerate().map_while(move |(face, &size)| {
            let (vertices, tail) = rest.split_at_checked(size as usize)?;
            rest = tail;
            Some((face, vertices))
        })
    }

    /// Bytes of the mesh's lists.
    pub(crate) fn bytes(&self) -> u64 {
        let lists = [
            size_of_val(&self.points[..]),
            size_of_val(&self.face_sizes[..]),
            size_of_val(&self.face_vertices[..]),
            size_of_val(&self.creases[..]),
            size_of_val(&self.corners[..]),
            size_of_val(&self.face_lines[..]),
        ];
        lists.iter().sum::<usize>() as u64
    }

    /// Smallest and largest coordinates of the control points that faces use; `None` if there are no faces. Those of
    /// [`bad_faces`](Self::bad_faces) do not count.
    ///
    /// # Panics
    /// If a face names a vertex that is not there, which [`validate`](Self::validate) refuses.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        match self.bad_faces[..] {
            [] => self.bounds_of(self.face_vertices.iter()),
            _ => self.bounds_of(self.good_faces().flat_map(|(_, face)| face)),
        }
    }

    fn bounds_of<'a>(&self, used: impl Iterator<Item = &'a u32>) -> Option<(DVec3, DVec3)> {
        let mut used = used.map(|&v| self.points[v as usize]);
        let first = used.next()?;
        Some(used.fold((first, first), |(low, high), p| (low.min(p), high.max(p))))
    }

    /// Length of the diagonal of [`bounds`](Self::bounds), the unit of all position errors; 0 if there are no faces.
    ///
    /// # Panics
    /// As [`bounds`](Self::bounds).
    pub fn diagonal(&self) -> f64 {
        self.bounds().map_or(0.0, |(low, high)| low.distance(high))
    }

    /// The same mesh moved by `offset`.
    #[must_use]
    pub fn translated(&self, offset: DVec3) -> Self {
        Self { points: self.points.iter().map(|&p| p + offset).collect(), ..self.clone() }
    }
}
