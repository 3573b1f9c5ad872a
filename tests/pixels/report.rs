//! The figures of one view.

use super::{BAND, Pixels, Verdict};
use std::fmt;

/// What is asked of a pixel-exact pipeline.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Distance of hits in the picture, in pixels.
    pub image: f64,
    /// Angle of normals in degrees, 99.9th percentile.
    pub normal: f64,
    /// Part of the covered pixels that may be marked as not converged.
    pub unconverged: f64,
}

impl Limits {
    /// A hundredth of a pixel cannot be seen, 1/100 of a pixel of reflection line on a face 200 pixels wide that turns by
    /// half a radian is 1.4e-3 degrees, and one pixel in 100,000 is 10 in a megapixel.
    pub const EXACT: Limits = Limits { image: BAND, normal: 1e-3, unconverged: 1e-5 };
}

/// Figures of one view; distances in pixels, angles in degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    pub name: String,
    /// Pixels that see the surface, on either side.
    pub covered: usize,
    /// Pixels of which one side sees the surface: not excused, excused.
    pub coverage: [usize; 2],
    /// Pixels that see different layers: not excused, excused.
    pub layer: [usize; 2],
    /// Distance in the picture: 99.9th percentile, maximum.
    pub image: [f64; 2],
    /// Distance in space over the size of a pixel there: 99.9th percentile, maximum.
    pub space: [f64; 2],
    /// Angle of normals: 99.9th percentile, maximum.
    pub normal: [f64; 2],
    /// Pixels at creases, whose normals are not compared.
    pub creases: usize,
    /// Pixels that the pipeline itself marks, where it does: its residual is above the band, or is no number.
    pub unconverged: Option<usize>,
}

impl Report {
    pub fn new(name: &str, verdicts: &[Verdict], pixels: &Pixels) -> Report {
        let count = |wanted: fn(&Verdict) -> bool| verdicts.iter().filter(|v| wanted(v)).count();
        let same = |value: fn(f64, f64, Option<f64>) -> Option<f64>| {
            let one = |v: &Verdict| match *v {
                Verdict::Same { image, space, angle } => value(image, space, angle),
                _ => None,
            };
            high_end(verdicts.iter().filter_map(one).collect())
        };
        let marked = |residual: &Vec<f32>| {
            let bad = |(point, &r): (&Option<_>, &f32)| point.is_some() && (r.is_nan() || f64::from(r) > BAND);
            pixels.points.iter().zip(residual).filter(|&pair| bad(pair)).count()
        };
        Report {
            name: name.into(),
            covered: count(|v| !matches!(v, Verdict::Background)),
            coverage: [
                count(|v| matches!(v, Verdict::Coverage { excused: false })),
                count(|v| matches!(v, Verdict::Coverage { excused: true })),
            ],
            layer: [
                count(|v| matches!(v, Verdict::Layer { excused: false })),
                count(|v| matches!(v, Verdict::Layer { excused: true })),
            ],
            image: same(|image, _, _| Some(image)),
            space: same(|_, space, _| Some(space)),
            normal: same(|_, _, angle| angle),
            creases: count(|v| matches!(v, Verdict::Same { angle: None, .. })),
            unconverged: pixels.residual.as_ref().map(marked),
        }
    }

    /// What is not within the limits.
    pub fn failures(&self, limits: &Limits) -> Vec<String> {
        let mut failures = Vec::new();
        let mut require = |holds: bool, what: String| {
            if !holds {
                failures.push(format!("{}: {what}", self.name));
            }
        };
        require(self.covered > 0, "nothing in sight".into());
        require(self.coverage[0] == 0, format!("{} pixels wrongly covered or not", self.coverage[0]));
        require(self.layer[0] == 0, format!("{} pixels see another layer", self.layer[0]));
        require(self.image[1] <= limits.image, format!("hits {:.1e} pixels off", self.image[1]));
        require(self.normal[0] <= limits.normal, format!("normals {:.1e} degrees off", self.normal[0]));
        let allowed = limits.unconverged * self.covered as f64;
        let unconverged = self.unconverged.unwrap_or(0);
        require(unconverged as f64 <= allowed, format!("{unconverged} pixels did not converge"));
        failures
    }

    /// Names of the columns.
    pub fn header() -> String {
        format!(
            "{:<44} {:>7} {:>9} {:>9} {:>17} {:>17} {:>17} {:>7} {:>11}",
            "view", "covered", "coverage", "layer", "image px", "space px", "normal deg", "creases", "unconverged"
        )
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pair = |[a, b]: [f64; 2]| format!("{a:.1e} {b:.1e}");
        let counts = |[bad, excused]: [usize; 2]| format!("{bad}+{excused}");
        write!(
            f,
            "{:<44} {:>7} {:>9} {:>9} {:>17} {:>17} {:>17} {:>7} {:>11}",
            self.name,
            self.covered,
            counts(self.coverage),
            counts(self.layer),
            pair(self.image),
            pair(self.space),
            pair(self.normal),
            self.creases,
            self.unconverged.map_or("-".into(), |n| n.to_string())
        )
    }
}

/// The 99.9th percentile and the maximum; a value that is no number counts as infinite.
fn high_end(mut values: Vec<f64>) -> [f64; 2] {
    values.iter_mut().filter(|x| x.is_nan()).for_each(|x| *x = f64::INFINITY);
    values.sort_by(f64::total_cmp);
    let Some(last) = values.len().checked_sub(1) else { return [0.0; 2] };
    [values[(last as f64 * 0.999).round() as usize], values[last]]
}
