//! `render --compare`: the exact limit, OpenSubdiv's patches, and what differs.

use super::account::Account;
use super::render::RenderArgs;
use super::{Failure, outgoing};
use crate::adaptive::AdaptivePatches;
use crate::compare::{Comparison, Exact};
use crate::gpu::{Gpu, Pipeline, Tables, View};
use crate::line::count;
use crate::mesh::SubdivMesh;
use crate::osd::{EndCap, Isolation};
use crate::output::{comparison_panels, encode_png, sheet};
use crate::stam::LimitSurface;
use crate::statistics::{Spread, short};
use serde::Serialize;
use std::path::Path;

/// Both surfaces on the adapter.
pub(super) struct Pair<'a> {
    gpu: &'a Gpu,
    surface: LimitSurface,
    exact: Tables,
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
        surface: &LimitSurface,
        gpu: &'a Gpu,
        exact: Tables,
        account: &mut Account,
    ) -> Result<Pair<'a>, Failure> {
        let isolation = args.patches.isolation().unwrap_or(Isolation::DEFAULT);
        let (patches, osd) = args.patches.upload_osd(mesh, isolation, gpu, account)?;
        let (surface, end_cap) = (surface.clone(), args.patches.end_cap());
        Ok(Pair { gpu, surface, exact, osd, patches, isolation, end_cap })
    }

    /// The tables of the exact limit.
    pub fn exact(&self) -> &Tables {
        &self.exact
    }

    /// Draws one view of both, and what differs; returns the size of the picture, and tells `watch` how much of it is done.
    pub fn take(
        &self,
        path: &Path,
        view: &View,
        made_by: &str,
        account: &mut Account,
        watch: &(dyn Fn(f64) + Sync),
    ) -> Result<[u32; 2], Failure> {
        // Four pictures, as long as one another.
        let quarter = |k: u32| move |done: f64| watch((f64::from(k) + done) / 4.0);
        let frames = [
            self.gpu.watched(&quarter(0)).render(&self.exact, view)?,
            self.gpu.watched(&quarter(1)).render(&self.osd, view)?,
        ];
        for frame in &frames {
            account.add(&frame.timings);
            account.picture(frame.summary);
        }
        let exactly = View { pipeline: Pipeline::Exact, enlarge: 1.0, ..view.clone() };
        let image = self.gpu.watched(&quarter(2)).inspect(&self.exact, &exactly)?;
        let seen = self.gpu.watched(&quarter(3)).inspect(&self.osd, view)?;
        account.add(&image.timings);
        account.add(&seen.timings);
        let exact = Exact { surface: &self.surface, view, image: &image };
        let comparison = account.time("compare", || exact.compare(&self.patches, &seen));
        let (size, pixels) = sheet(comparison.size, &comparison_panels(frames, &seen, &comparison, self.name()));
        account.time("write", || outgoing::write(path, |out| encode_png(out, size, &pixels, made_by)))?;
        account.compared(self.compared(&comparison));
        Ok(size)
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

    /// What the picture of OpenSubdiv's patches is called.
    fn name(&self) -> String {
        let Isolation { smooth, sharp } = self.isolation;
        match smooth == sharp {
            true => format!("OpenSubdiv, level {sharp}, {} end caps", self.end_cap),
            false => format!("OpenSubdiv, level {smooth}, sharp features {sharp}, {} end caps", self.end_cap),
        }
    }
}

impl Compared {
    /// A line on standard error.
    pub fn say(&self) {
        let Compared { level_smooth, level_sharp, end_caps, patches, patches_end_cap, normal_deg, lines_px, .. } = self;
        tell!(
            "compare: OpenSubdiv level {level_smooth}/{level_sharp}, {} ({}): \
             normals p99 {}, max {} degrees; reflection lines p99 {}, max {} pixels; seen in one picture only: {}",
            count(*patches, "patch"),
            count(*patches_end_cap, &format!("{end_caps} end cap")),
            short(normal_deg.p99),
            short(normal_deg.max),
            short(lines_px.p99),
            short(lines_px.max),
            count(self.only_exact_px + self.only_osd_px, "pixel")
        );
    }
}
