//! Histograms and legends as SVG: what stands where.

use crate::output::Scale;
use crate::verify::{Histogram, MeshReport};

/// A logarithmic axis of errors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    title: &'static str,
    unit: &'static str,
    /// Exponents of ten at the ends; errors beyond count at the ends.
    range: [i32; 2],
    /// Histogram and tolerance of a row.
    of: fn(&crate::verify::Tier) -> (&Histogram, Option<f64>),
}

impl Axis {
    pub const POSITION: Axis = Axis {
        title: "Position",
        unit: "parts of the diagonal",
        range: [-18, 0],
        of: |row| (&row.histogram.position, row.tolerance_position),
    };
    pub const NORMAL: Axis = Axis {
        title: "Normal",
        unit: "degrees",
        range: [-16, 2],
        of: |row| (&row.histogram.normal_deg, row.tolerance_normal_deg),
    };
}

/// Width of a chart, in its own units, as all lengths here.
const WIDTH: f64 = 520.0;
/// Where the axis begins: left of it are names and the bar of errors that are 0.
const LEFT: f64 = 104.0;
const RIGHT: f64 = 10.0;
/// Height of a tier's bars, and from one tier to the next.
const BARS: f64 = 34.0;
const STEP: f64 = 44.0;
/// Width and place of the bar of zeros.
const ZERO: [f64; 2] = [86.0, 10.0];

/// Bars of every tier, one above the other, on one axis.
#[derive(Debug)]
pub(super) struct Chart {
    pub title: &'static str,
    pub unit: &'static str,
    pub size: [f64; 2],
    pub tiers: Vec<Bars>,
    pub ticks: Vec<Tick>,
    /// Baseline of the ticks' labels.
    pub labels: f64,
}

/// The errors of a tier.
#[derive(Debug)]
pub(super) struct Bars {
    pub name: &'static str,
    pub samples: usize,
    /// Errors that are no number: they are in the last bar.
    pub base: f64,
    pub bars: Vec<Bar>,
    /// Where the largest tolerance stands.
    pub tolerance: Option<f64>,
}

/// A rectangle, and what it is.
#[derive(Debug)]
pub(super) struct Bar {
    pub x: f64,
    pub width: f64,
    pub height: f64,
    pub count: u64,
    pub from: String,
}

#[derive(Debug)]
pub(super) struct Tick {
    pub x: f64,
    pub label: Option<String>,
}

impl Chart {
    /// `None` where there is nothing to show.
    pub fn new(report: &MeshReport, axis: Axis) -> Option<Self> {
        let mut names: Vec<&'static str> = report.tiers.iter().map(|row| row.tier).collect();
        names.dedup();
        let mut tiers = Vec::new();
        for name in names {
            let (mut histogram, mut tolerance) = (Histogram::default(), None);
            for row in report.tiers.iter().filter(|row| row.tier == name) {
                let (errors, allowed) = (axis.of)(row);
                histogram.merge(errors);
                tolerance = [tolerance, allowed].into_iter().flatten().reduce(f64::max);
            }
            if histogram.total() > 0 {
                let base = 14.0 + STEP * tiers.len() as f64 + BARS;
                tiers.push(axis.bars(name, &histogram, tolerance, base));
            }
        }
        let bottom = 14.0 + STEP * tiers.len() as f64 - (STEP - BARS);
        let [first, last] = axis.range;
        let tick = |exponent: i32| Tick {
            x: axis.x(f64::from(exponent)),
            // The first would run into that of the zeros.
            label: (exponent > first && (exponent - first) % 3 == 0).then(|| format!("1e{exponent}")),
        };
        (!tiers.is_empty()).then(|| Chart {
            title: axis.title,
            unit: axis.unit,
            size: [WIDTH, bottom + 24.0],
            ticks: (first..=last).map(tick).collect(),
            labels: bottom + 18.0,
            tiers,
        })
    }
}

impl Axis {
    /// Place of an exponent of ten.
    fn x(&self, exponent: f64) -> f64 {
        let [first, last] = self.range.map(f64::from);
        LEFT + (WIDTH - LEFT - RIGHT) * ((exponent - first) / (last - first)).clamp(0.0, 1.0)
    }

    fn bars(&self, name: &'static str, histogram: &Histogram, tolerance: Option<f64>, base: f64) -> Bars {
        // Heights by the logarithm: a single sample that is far off must be seen beside a million that are not.
        let most = histogram.bins().map(|(_, count)| count).chain([histogram.zero, histogram.not_finite]).max();
        let height = |count: u64| {
            let most = (1.0 + most.unwrap_or(1) as f64).ln();
            (BARS * (1.0 + count as f64).ln() / most).max(2.0)
        };
        let mut bars = Vec::new();
        if histogram.zero > 0 {
            let [x, width] = ZERO;
            let count = histogram.zero;
            bars.push(Bar { x, width, height: height(count), count, from: "exactly 0".to_owned() });
        }
        for ([low, high], count) in histogram.bins().filter(|(_, count)| *count > 0) {
            let [left, right] = [low, high].map(|border| self.x(border.log10()));
            let least = (WIDTH - LEFT - RIGHT) / f64::from(self.range[1] - self.range[0]) / 4.0;
            let x = left.min(WIDTH - RIGHT - least);
            let width = (right - x).max(least) - 0.6;
            bars.push(Bar { x, width, height: height(count), count, from: format!("{low:.1e} to {high:.1e}") });
        }
        if histogram.not_finite > 0 {
            let count = histogram.not_finite;
            let x = WIDTH - RIGHT + 1.0;
            bars.push(Bar { x, width: 8.0, height: height(count), count, from: "no finite number".to_owned() });
        }
        let tolerance = tolerance.map(|allowed| self.x(allowed.log10()));
        Bars { name, samples: histogram.total() as usize, base, bars, tolerance }
    }
}

/// A scale of colours below a picture.
#[derive(Debug, Clone)]
pub(super) struct Legend {
    /// Of the gradient, which is the same in the same scale.
    pub id: String,
    pub what: String,
    /// Colours at equal distances.
    pub stops: Vec<(f64, String)>,
    pub ticks: Vec<(f64, String)>,
}

impl Legend {
    /// Width, in its own units.
    pub const WIDTH: f64 = 260.0;
    /// Room for the outer labels.
    pub const INSET: f64 = 16.0;

    pub fn new(scale: &Scale, what: &str) -> Self {
        const STOPS: usize = 8;
        let stop = |i: usize| {
            let part = i as f64 / STOPS as f64;
            let [r, g, b] = scale.colour_at(part as f32);
            (100.0 * part, format!("#{r:02x}{g:02x}{b:02x}"))
        };
        let tick = |(value, label): (f32, String)| {
            (Self::INSET + (Self::WIDTH - 2.0 * Self::INSET) * f64::from(scale.place(value)), label)
        };
        let id = format!("scale{}{}", scale.least.log10(), scale.most.log10()).replace('.', "-");
        Self {
            id,
            what: what.to_owned(),
            stops: (0..=STOPS).map(stop).collect(),
            ticks: scale.ticks().into_iter().map(tick).collect(),
        }
    }
}
