//! What OpenSubdiv's feature-adaptive refinement makes of a mesh.

use crate::adaptive::{Accuracy, AdaptivePatches};
use crate::gpu;
use crate::mesh::SubdivMesh;
use crate::osd::{EndCap, Error, Isolation};
use crate::stam::LimitSurface;
use crate::statistics::short;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::time::Instant;

/// Points on the end caps of a level at which they are held against the limit.
const SAMPLES: usize = 100_000;

/// The patches where all features are isolated to one level.
#[derive(Debug, Serialize)]
pub(super) struct AdaptiveLevel {
    level: u32,
    /// Regular ones and end caps.
    patches: usize,
    end_caps: usize,
    /// Patches by the refinement level of their faces.
    patches_by_level: BTreeMap<u8, usize>,
    /// Bytes of OpenSubdiv's table and its points in f64, and of our tables of the same patches on the GPU.
    bytes: u64,
    gpu_bytes: u64,
    /// To refine, and to make patches and points.
    build_ms: f64,
    /// Of Gregory and of B-spline end caps.
    gregory: Accuracy,
    bspline: Accuracy,
}

impl AdaptiveLevel {
    pub fn new(mesh: &SubdivMesh, surface: &LimitSurface, level: u32) -> Result<AdaptiveLevel, Error> {
        let isolation = Isolation::uniform(level);
        let start = Instant::now();
        let patches = AdaptivePatches::new(mesh, isolation, EndCap::Gregory)?;
        let build_ms = start.elapsed().as_secs_f64() * 1e3;
        let splines = AdaptivePatches::new(mesh, isolation, EndCap::BSpline)?;
        let mut patches_by_level = BTreeMap::new();
        for patch in patches.patches() {
            *patches_by_level.entry(patch.level).or_default() += 1;
        }
        Ok(AdaptiveLevel {
            level,
            patches: patches.patches().len(),
            end_caps: patches.end_caps(),
            patches_by_level,
            bytes: patches.bytes(),
            gpu_bytes: gpu::tables::bytes(&patches, gpu::TableLayout::Auto),
            build_ms,
            gregory: patches.accuracy(surface, SAMPLES),
            bspline: splines.accuracy(surface, SAMPLES),
        })
    }
}

/// A table for people.
pub(super) fn describe(levels: &[AdaptiveLevel]) -> String {
    let mut text = String::new();
    let Some(last) = levels.last() else { return text };
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "\nOpenSubdiv's feature-adaptive patches, all features isolated to a level. Normals and positions (parts of the\n\
         diagonal): how far patches that approximate are from the limit, at up to {SAMPLES} points on them. These are end caps, and\n\
         regular patches where semi-sharp features are not resolved."
    );
    let _ = writeln!(
        text,
        "{:>5} {:>8} {:>8} {:>8} {:>10} {:>9} {:>20} {:>9} {:>20}",
        "level",
        "patches",
        "end caps",
        "of area",
        "MiB (f64)",
        "build",
        "normal p99/max",
        "position",
        "B-spline p99/max"
    );
    for level in levels {
        let normal =
            |accuracy: &Accuracy| format!("{:.1e}/{:.1e} deg", accuracy.normal_deg.p99, accuracy.normal_deg.max);
        let _ = writeln!(
            text,
            "{:>5} {:>8} {:>8} {:>8} {:>6.2} % {:>10.2} {:>6.0} ms {:>20} {:>9} {:>20}",
            level.level,
            level.patches,
            level.end_caps,
            level.gregory.patches,
            100.0 * level.gregory.area,
            level.bytes as f64 / f64::from(1 << 20),
            level.build_ms,
            normal(&level.gregory),
            short(level.gregory.position.max),
            normal(&level.bspline),
        );
    }
    let by_level: Vec<_> = last.patches_by_level.iter().map(|(level, count)| format!("{level}: {count}")).collect();
    let _ = writeln!(text, "patches at level {} by refinement level: {}", last.level, by_level.join(", "));
    text
}
