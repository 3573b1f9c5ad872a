//! `render --compare`: the exact limit, OpenSubdiv's patches, and what differs.

use super::Failure;
use super::account::Account;
use super::render::RenderArgs;
use crate::adaptive::AdaptivePatches;
use crate::compare::{Comparison, Reference, Spread};
use crate::gpu::{Frame, Gpu, Pipeline, Tables, View};
use crate::mesh::SubdivMesh;
use crate::osd::{EndCap, Isolation};
use crate::output::{Panel, Scale, heat_of, sheet, write_png};
use crate::stam::LimitSurface;
use serde::Serialize;
use std::path::Path;

/// Both surfaces on the adapter.
pub(super) struct Pair<'a> {
    gpu: &'a Gpu,
    surface: &'a LimitSurface,
    exact: &'a Tables,
    osd: Tables,
    patches: AdaptivePatches,
    isolation: Isolation,
    end_cap: EndCap,
}

/// What `--json` says of a comparison.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Compared {
    /// Levels to which smooth and sharp features are isolated.
    level_smooth: u32,
    level_sharp: u32,
    end_caps: String,
    patches: usize,
    patches_end_cap: usize,
    bytes: u64,
    bytes_exact: u64,
    normal_deg: Spread,
    lines_px: Spread,
    only_exact_px: usize,
    only_osd_px: usize,
}

impl<'a> Pair<'a> {
    pub fn new(
        args: &RenderArgs,
        mesh: &SubdivMesh,
        surface: &'a LimitSurface,
        gpu: &'a Gpu,
        exact: &'a Tables,
        account: &mut Account,
    ) -> Result<Pair<'a>, Failure> {
        let isolation = args.patches.isolation().unwrap_or(Isolation::DEFAULT);
        let (patches, osd) = args.patches.upload_osd(mesh, isolation, gpu, account)?;
        Ok(Pair { gpu, surface, exact, osd, patches, isolation, end_cap: args.patches.end_cap() })
    }

    /// Draws one view of both, and what differs.
    pub fn take(&self, path: &Path, view: &View, made_by: &str, account: &mut Account) -> Result<(), Failure> {
        let frames = [self.exact, &self.osd].map(|tables| self.gpu.render(tables, view));
        let [exact, osd] = frames;
        let frames = [exact?, osd?];
        for frame in &frames {
            account.add(&frame.timings);
            account.picture(frame.summary);
        }
        let exactly = View { pipeline: Pipeline::Exact, enlarge: 1.0, ..view.clone() };
        let reference = self.gpu.inspect(self.exact, &exactly)?;
        account.add(&reference.timings);
        let reference = account.time("compare", || Reference::new(self.surface, view, &reference));
        let seen = self.gpu.inspect(&self.osd, view)?;
        account.add(&seen.timings);
        let comparison = account.time("compare", || reference.compare(&seen));
        let (size, pixels) = self.sheet(frames, &comparison);
        account.time("write", || write_png(path, size, &pixels, made_by))?;
        account.compared(self.compared(&comparison));
        Ok(())
    }

    fn compared(&self, comparison: &Comparison) -> Compared {
        Compared {
            level_smooth: self.isolation.smooth,
            level_sharp: self.isolation.sharp,
            end_caps: self.end_cap.to_string(),
            patches: self.patches.patches().len(),
            patches_end_cap: self.patches.end_caps(),
            bytes: self.patches.bytes(),
            bytes_exact: self.exact.size(),
            normal_deg: comparison.normal,
            lines_px: comparison.lines,
            only_exact_px: comparison.only_one[0],
            only_osd_px: comparison.only_one[1],
        }
    }

    fn sheet(&self, [exact, osd]: [Frame; 2], comparison: &Comparison) -> ([u32; 2], Vec<u8>) {
        /// A hundredth of a pixel is what our own pipeline is held to; beyond ten pixels a line is another one.
        const LINES: Scale = Scale { least: 1e-3, most: 10.0 };
        /// 1.4e-3 degrees move a line by some 1/100 pixel.
        const NORMALS: Scale = Scale { least: 1e-4, most: 10.0 };
        let panel = |caption: String, rgba8, legend| Panel { caption, rgba8, legend };
        let spread = |what: &str, spread: &Spread| {
            format!("{what}: mean {:.2e}, p99 {:.2e}, max {:.2e}", spread.mean, spread.p99, spread.max)
        };
        let heat = |values: &[f32], scale: Scale, caption: String, what: &str| {
            panel(caption, heat_of(values, &scale), Some((scale, what.to_owned())))
        };
        let Isolation { smooth, sharp } = self.isolation;
        let levels = match smooth == sharp {
            true => format!("level {sharp}"),
            false => format!("level {smooth}, sharp features {sharp}"),
        };
        let osd_caption = format!("OpenSubdiv, {levels}, {} end caps", self.end_cap);
        let panels = [
            panel("Exact limit (Stam tables)".to_owned(), exact.rgba8, None),
            panel(osd_caption, osd.rgba8, None),
            heat(
                &comparison.lines_px,
                LINES,
                spread("Lines", &comparison.lines),
                "Displacement of reflection lines, pixels",
            ),
            heat(
                &comparison.normal_deg,
                NORMALS,
                spread("Normals", &comparison.normal),
                "Angle between normals, degrees",
            ),
        ];
        sheet(comparison.size, &panels)
    }
}

impl Compared {
    /// A line on standard error.
    pub fn say(&self) {
        let Compared { level_smooth, level_sharp, end_caps, patches, patches_end_cap, normal_deg, lines_px, .. } = self;
        eprintln!(
            "compare: OpenSubdiv level {level_smooth}/{level_sharp}, {patches} patches ({patches_end_cap} {end_caps} end caps): \
             normals p99 {:.2e}, max {:.2e} degrees; reflection lines p99 {:.2e}, max {:.2e} pixels; seen in one picture only: \
             {} pixels",
            normal_deg.p99,
            normal_deg.max,
            lines_px.p99,
            lines_px.max,
            self.only_exact_px + self.only_osd_px
        );
    }
}
