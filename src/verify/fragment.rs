//! Tier `fragment`: every pixel of a rendered view, against the f64 limit at the same (patch, u, v) and against
//! OpenSubdiv at the same (face, u, v); and the shader's evaluation on every patch, seen or not, against f64.

use super::bin::{Bins, CAP};
use super::clock::Clock;
use super::difference::{Check, Difference, Normal, Sample};
use super::key::{Against, Key, TierName};
use super::references::References;
use super::{Subject, VerifyError, rounding};
use crate::field::{Camera, DEFAULT_FOV, Scout};
use crate::gpu::{self, Gpu, NO_PATCH, SurfaceImage, Tables, View};
use crate::osd::{Answer, Location, ReferenceJet};
use crate::stam::Jet;
use crate::statistics::scatter;
use glam::DVec3;
use rayon::prelude::*;

/// Positions relative to the patch in f32: some 20 roundings of 6e-8 of the patch's size. The normal budget is that of
/// reflection lines, held at the 99.99th percentile: 1/100 pixel of reflection line is 1.4e-3 degrees.
pub(super) const POSITION: f64 = 2e-6;
pub(super) const NORMAL_DEG: f64 = 1e-3;

/// Length by which f32 moves a derivative, in units of the larger of the two: 20 roundings of 2^-24 of the control net,
/// which is three cells wide.
pub(super) const DERIVATIVE: f64 = 20.0 * 3.0 / 16_777_216.0;

/// Samples of the shader's evaluation, and on one patch.
const BUDGET: usize = 200_000;
const PER_PATCH: usize = 8;

/// Pixels that are compared with OpenSubdiv at a time.
const PORTION: usize = 1 << 20;

pub(super) fn run(
    subject: &Subject<'_>,
    references: &References<'_>,
    gpu: &Gpu,
    size: [u32; 2],
    clock: &mut Clock,
    bins: &mut Bins,
) -> Result<(), VerifyError> {
    let tables = clock.time("fragment: tables", || gpu.upload(subject.surface))?;
    let largest = clock.time("fragment: all patches", || all_patches(subject, gpu, &tables, bins))?;
    let Some(scout) = Scout::new(subject.surface) else { return Ok(()) };
    let look = |camera: Camera, clock: &mut Clock| {
        let light = scout.light(&camera);
        clock.time("fragment: picture", || gpu.inspect(&tables, &View::new(camera, light)))
    };
    let covered = |image: &SurfaceImage| image.patch.iter().any(|&patch| patch != NO_PATCH);
    let image = look(scout.camera(size, DVec3::Z), clock)?;
    if covered(&image) {
        return pixels(subject, references, &image, clock, bins);
    }
    // A surface too thin for the pixels' centres is seen from near; one without area not at all.
    let Some(jet) = largest else { return Ok(()) };
    let image = look(close_up(&jet, size), clock)?;
    if !covered(&image) {
        bins.nothing(Key::new(TierName::Fragment, Against::F64, None));
    }
    pixels(subject, references, &image, clock, bins)
}

/// A camera that looks at a square round a point, as wide as a quarter of its cell is in the direction in which it is thin.
fn close_up(jet: &Jet, size: [u32; 2]) -> Camera {
    let half = jet.du.length().min(jet.dv.length()) / 8.0;
    let [across, along] = [jet.du, jet.dv].map(|d| d.normalize() * half);
    let corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    let corners = corners.map(|[a, b]| jet.position + a * across + b * along);
    Camera::fit(&corners, size, along, jet.normal, DEFAULT_FOV)
}

/// Local parameters of sample `i` of a patch: scattered ones, and deep ones where the levels of irregular patches are
/// chosen and the digits of f32 run out.
fn place(patch: usize, i: usize) -> [f32; 2] {
    const DEEP: [[f32; 2]; 4] = [[6.0, 6.0], [6.0, 1.0], [12.0, 12.0], [0.0, 12.0]];
    match i {
        1 | 3 | 5 | 7 => DEEP[i / 2].map(|k| (-k).exp2()),
        _ => scatter((PER_PATCH * patch + i) as u32 % (1 << 20)).map(|x| x as f32),
    }
}

/// Checks the shader's evaluation on every patch. Returns the jet, in f64, of the largest area whose normal f32 can tell.
fn all_patches(subject: &Subject<'_>, gpu: &Gpu, tables: &Tables, bins: &mut Bins) -> Result<Option<Jet>, VerifyError> {
    let surface = subject.surface;
    let count = surface.patches().len();
    let each = (BUDGET / count.max(1)).clamp(1, PER_PATCH);
    let samples: Vec<gpu::Sample> = (0..count)
        .step_by((count * each).div_ceil(BUDGET).max(1))
        // With fewer a patch, other ones on every patch.
        .flat_map(|patch| (0..each).map(move |i| (patch, (patch + i) % PER_PATCH)))
        .map(|(patch, i)| {
            let uv = surface.folded(place(patch, i).map(f64::from)).map(|x| x as f32);
            gpu::Sample { patch: patch as u32, uv }
        })
        .collect();
    let exact: Vec<Jet> = samples.par_iter().map(|s| subject.evaluate_patch(s.patch as usize, s.uv)).collect();
    let mut largest: Option<(f64, Jet)> = None;
    for ((sample, jet), reference) in samples.iter().zip(gpu.evaluate(tables, &samples)?).zip(&exact) {
        let ours = (subject.ours)(jet);
        let difference = difference(subject, &ours, reference, 1.0, true);
        let area = reference.du.cross(reference.dv).length();
        let judged = matches!(difference.normal, Normal::Judged(_));
        if judged && area.is_finite() && largest.as_ref().is_none_or(|(most, _)| area > *most) {
            largest = Some((area, *reference));
        }
        let patch = sample.patch as usize;
        let key = Key::new(TierName::Fragment, Against::F64AllPatches, subject.kind(patch));
        bins.add(key, subject.place(to_ptex(subject, patch, sample.uv), Some(patch)), difference);
    }
    Ok(largest.map(|(_, jet)| jet))
}

fn to_ptex(subject: &Subject<'_>, patch: usize, uv: [f32; 2]) -> Sample {
    let patch = &subject.surface.patches()[patch];
    let [u, v] = patch.to_ptex(uv.map(f64::from));
    Sample { face: patch.ptex, u, v }
}

/// Compares a jet in f32 with a reference in f64, differentiated in cells of the side `cell`.
///
/// The budget of the normal is the same for every pixel; the reference's own rounding comes on top. `conditioned` samples
/// are allowed what f32 may turn their normal: a handful in a bin, deep in the corner of a patch, are no percentile.
/// Where that is more than the cap (folds, vanishing derivatives), the normal is not judged, but counted.
fn difference(subject: &Subject<'_>, ours: &Jet, reference: &Jet, cell: f64, conditioned: bool) -> Difference {
    let rounding = &subject.rounding;
    let longest = reference.du.length().max(reference.dv.length());
    let turn = |error| rounding::turn_deg(reference.du, reference.dv, error);
    let theirs = rounding.derivative(cell);
    let both = turn(DERIVATIVE * longest + theirs);
    let allowed = if conditioned { NORMAL_DEG.max(both) } else { NORMAL_DEG + turn(theirs) };
    Difference {
        position: Check {
            error: ours.position.distance(reference.position) / rounding.unit,
            allowed: POSITION + rounding.position(),
        },
        normal: Normal::judge(ours.normal, reference.normal, both, CAP * NORMAL_DEG, allowed),
        derivative: None,
    }
}

fn pixels(
    subject: &Subject<'_>,
    references: &References<'_>,
    image: &SurfaceImage,
    clock: &mut Clock,
    bins: &mut Bins,
) -> Result<(), VerifyError> {
    let pixels: Vec<usize> = (0..image.patch.len()).filter(|&i| image.patch[i] != NO_PATCH).collect();
    let patch = |i: usize| image.patch[i] as usize;
    let place = |i: usize| subject.place(to_ptex(subject, patch(i), image.uv[i]), Some(patch(i)));
    let key = |i: usize, against| Key::new(TierName::Fragment, against, subject.kind(patch(i)));
    let ours = |i: usize| {
        let normal = DVec3::from_array(image.normal[i].map(f64::from));
        (subject.ours)(Jet { position: image.position[i], normal, du: DVec3::ZERO, dv: DVec3::ZERO })
    };
    clock.time("fragment: pixels with f64", || {
        bins.fill(pixels.len(), |bins, i| {
            let i = pixels[i];
            let exact = subject.evaluate_patch(patch(i), image.uv[i]);
            bins.add(key(i, Against::F64), place(i), difference(subject, &ours(i), &exact, 1.0, false));
        });
    });
    clock.time("fragment: pixels with OpenSubdiv", || {
        let location = |&i: &usize| {
            let Sample { face, u, v } = place(i).sample;
            (face, u, v)
        };
        // Portions bound the memory: a picture may have 64 million pixels.
        for pixels in pixels.chunks(PORTION) {
            let samples: Vec<Location> = pixels.par_iter().map(location).collect();
            let answers = references.far(&samples);
            let Some(answers) = bins.answered(TierName::Fragment, Against::Far, answers) else { break };
            bins.fill(pixels.len(), |bins, k| {
                let (i, answer) = (pixels[k], &answers[k]);
                if answer.answer == Answer::Regular {
                    let ReferenceJet { position, du, dv, cell, .. } = *answer;
                    let jet = Jet { position, du, dv, normal: du.cross(dv) };
                    bins.add(key(i, Against::Far), place(i), difference(subject, &ours(i), &jet, cell, false));
                }
            });
        }
    });
    Ok(())
}
