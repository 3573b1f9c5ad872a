//! Tier `fragment`: every pixel of a rendered view, against the f64 limit at the same (patch, u, v) and against
//! OpenSubdiv at the same (face, u, v).

use super::bin::{Bins, Difference, Key, Sample, Tolerance, angle_deg};
use super::{Subject, VerifyError};
use crate::field::Scout;
use crate::gpu::{Gpu, NO_PATCH, View};
use crate::osd::{Answer, Far, Reference};
use glam::DVec3;
use rayon::prelude::*;

/// Positions relative to the patch in f32: some 20 roundings of 6e-8 of the patch's size. The normal budget is that of
/// design.md 3.2, held at the 99.99th percentile: 1/100 pixel of reflection line is 1.4e-3 degrees.
const TOLERANCE: Tolerance = Tolerance { position: Some(2e-6), normal_deg: Some(1e-3), derivative: None };

pub(super) fn run(
    subject: &Subject<'_>,
    far: &mut Far,
    gpu: &Gpu,
    size: [u32; 2],
    bins: &mut Bins,
) -> Result<(), VerifyError> {
    let surface = subject.surface;
    let Some(scout) = Scout::new(surface) else { return Ok(()) };
    let camera = scout.camera(size, DVec3::Z);
    let light = scout.light(camera.eye, camera.up);
    let image = gpu.inspect(&gpu.upload(surface)?, &View::new(camera, light))?;

    let pixels: Vec<usize> = (0..image.patch.len()).filter(|&i| image.patch[i] != NO_PATCH).collect();
    let local = |i: usize| (image.patch[i] as usize, image.uv[i].map(f64::from));
    let exact: Vec<_> = pixels
        .par_iter()
        .map(|&i| {
            let (patch, uv) = local(i);
            surface.evaluate(patch, uv)
        })
        .collect();
    let samples: Vec<(u32, f64, f64)> = pixels
        .iter()
        .map(|&i| {
            let (patch, uv) = local(i);
            let [u, v] = surface.patches()[patch].to_ptex(uv);
            (surface.patches()[patch].ptex, u, v)
        })
        .collect();
    let answers = far.evaluate(&samples)?;

    for (((&i, jet), &(face, u, v)), answer) in pixels.iter().zip(&exact).zip(&samples).zip(&answers) {
        let kind = surface.kind(image.patch[i] as usize);
        let normal = DVec3::from_array(image.normal[i].map(f64::from));
        let mut add = |reference, position: DVec3, reference_normal: DVec3| {
            let difference = Difference {
                position: image.position[i].distance(position),
                normal_deg: angle_deg(normal, reference_normal),
                derivative: None,
            };
            let key = Key { tier: "fragment", reference, kind, known_wrong: None };
            bins.add(key, TOLERANCE, Sample { face, u, v }, difference);
        };
        add("f64", jet.position, jet.normal);
        if answer.answer == Answer::Regular {
            add("Far level 10", answer.position, answer.du.cross(answer.dv));
        }
    }
    Ok(())
}
