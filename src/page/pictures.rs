//! Pictures of a mesh: the shader's error on the surface, and the reflection lines with and without end caps.

use super::chart::Legend;
use crate::adaptive::AdaptivePatches;
use crate::compare::Exact;
use crate::field::Scout;
use crate::gpu::{Gpu, NO_PATCH, SurfaceImage, View};
use crate::mesh::SubdivMesh;
use crate::osd::{Answer, EndCap, Far, Isolation, Location, MAX_ISOLATION, ReferenceJet};
use crate::output::{LINES_PX, NORMALS_DEG, Panel, Scale, comparison_panels, heat_of, png_bytes};
use crate::stam::LimitSurface;
use crate::statistics::{Spread, angle_deg, short};
use crate::verify::VerifyError;
use base64::Engine;
use glam::DVec3;
use rayon::prelude::*;

/// Side of a picture in pixels: 6 pictures a mesh, so that a page of 37 meshes stays below 20 MB.
const SIDE: u32 = 480;

/// Of positions of the shader, in parts of the diagonal; 2e-6 is allowed.
const POSITION: Scale = Scale::logarithmic(1e-11, 1e-5);
/// Of its normals, in degrees; 1e-3 is allowed.
const NORMAL: Scale = Scale::logarithmic(1e-8, 1e-2);

/// The pictures of a mesh, ready to be put into a page.
#[derive(Debug, Clone, Default)]
pub struct Pictures {
    /// The shader against OpenSubdiv: position and normal.
    pub(super) errors: Vec<Figure>,
    /// The exact limit, OpenSubdiv's end caps, and what differs.
    pub(super) end_caps: Vec<Figure>,
}

#[derive(Debug, Clone)]
pub(super) struct Figure {
    pub caption: String,
    /// For those who do not see it.
    pub alt: String,
    /// The PNG file in base64.
    pub png: String,
    pub size: [u32; 2],
    pub legend: Option<Legend>,
}

impl Pictures {
    /// Draws a mesh from where tier `fragment` sees it. No pictures where no pixel sees a surface.
    ///
    /// # Errors
    /// The mesh is refused, OpenSubdiv fails, or the adapter does.
    pub fn take(mesh: &SubdivMesh, gpu: &Gpu) -> Result<Self, VerifyError> {
        let surface = LimitSurface::new(mesh)?;
        let Some(scout) = Scout::new(&surface) else { return Ok(Self::default()) };
        let camera = scout.camera([SIDE; 2], DVec3::Z);
        let view = View::new(camera, scout.light(&camera));
        let tables = gpu.upload(&surface)?;
        let image = gpu.inspect(&tables, &view)?;
        if image.patch.iter().all(|&patch| patch == NO_PATCH) {
            return Ok(Self::default());
        }
        let figure = |panel| Figure::new(panel, &mesh.name);
        let errors = errors(mesh, &surface, &image)?.into_iter().map(figure).collect();
        if surface.has_triangles() {
            // OpenSubdiv's patches of triangles are not read.
            return Ok(Self { errors, end_caps: Vec::new() });
        }
        let patches = AdaptivePatches::new(mesh, Isolation::DEFAULT, EndCap::Gregory)?;
        let osd = gpu.upload_patches(&patches)?;
        let seen = gpu.inspect(&osd, &view)?;
        let mut comparison = Exact { surface: &surface, view: &view, image: &image }.compare(&patches, &seen);
        snap(&mut comparison.lines_px, &LINES_PX);
        snap(&mut comparison.normal_deg, &NORMALS_DEG);
        let frames = [gpu.render(&tables, &view)?, gpu.render(&osd, &view)?];
        let name = "OpenSubdiv's end caps, default level".to_owned();
        let end_caps = comparison_panels(frames, &seen, &comparison, name);
        Ok(Self { errors, end_caps: end_caps.into_iter().map(figure).collect() })
    }
}

/// The shader's position and normal at every pixel against OpenSubdiv's regular patches at isolation 10.
fn errors(mesh: &SubdivMesh, surface: &LimitSurface, image: &SurfaceImage) -> Result<[Panel; 2], VerifyError> {
    let seen: Vec<usize> = (0..image.patch.len()).filter(|&i| image.patch[i] != NO_PATCH).collect();
    let location = |&i: &usize| -> Location {
        let patch = &surface.patches()[image.patch[i] as usize];
        let [u, v] = patch.to_ptex(image.uv[i].map(f64::from));
        (patch.ptex, u, v)
    };
    let answers = Far::new(mesh, MAX_ISOLATION)?.evaluate(&seen.par_iter().map(location).collect::<Vec<_>>())?;
    let [mut position, mut normal] = [(); 2].map(|()| vec![f32::NAN; image.patch.len()]);
    for (&i, ReferenceJet { answer, position: theirs, du, dv, .. }) in seen.iter().zip(&answers) {
        if *answer == Answer::Regular {
            position[i] = (image.position[i].distance(*theirs) / mesh.diagonal()) as f32;
            let ours = DVec3::from_array(image.normal[i].map(f64::from));
            normal[i] = angle_deg(ours, du.cross(*dv)) as f32;
        }
    }
    let panel = |mut values: Vec<f32>, scale: Scale, name: &str, unit: &str| {
        let Spread { p99, max, .. } = Spread::of(values.iter().copied().map(f64::from));
        snap(&mut values, &scale);
        Panel {
            caption: format!("{name}: 99 % below {}, at most {} {unit}", short(p99), short(max)),
            rgba8: heat_of(&values, &scale, |i| image.patch[i] != NO_PATCH),
            legend: Some((scale, format!("{name} off by, {unit} (grey: OpenSubdiv has an end cap)"))),
        }
    };
    Ok([panel(position, POSITION, "Position", "of the diagonal"), panel(normal, NORMAL, "Normal", "degrees")])
}

/// Rounds values to 64 steps of a scale: pictures of so few colours are a third as large.
fn snap(values: &mut [f32], scale: &Scale) {
    const STEPS: f32 = 63.0;
    for value in values.iter_mut().filter(|value| !value.is_nan()) {
        let step = (scale.place(*value) * STEPS).round() / STEPS;
        *value = scale.least * (scale.most / scale.least).powf(step);
    }
}

impl Figure {
    fn new(panel: Panel, mesh: &str) -> Self {
        let size = [SIDE; 2];
        let png = base64::engine::general_purpose::STANDARD.encode(png_bytes(size, &panel.rgba8));
        let legend = panel.legend.as_ref().map(|(scale, what)| Legend::new(scale, what));
        let kind = if legend.is_some() { "Heat map of" } else { "Reflection lines of" };
        Self { alt: format!("{kind} {mesh}. {}", panel.caption), caption: panel.caption, png, size, legend }
    }
}
