//! Curves in the light plane, given as contours of a function g of its coordinates.

mod expression;
mod grid;

pub use expression::{Expression, ExpressionError};
pub use grid::Grid;

use glam::{DVec2, dvec2};

/// A function g(x, y) of light plane coordinates, whose contours are the light curves (Ulmet 2003, Theorem RC).
#[derive(Debug, Clone, PartialEq)]
pub enum PlaneCurve {
    /// Distance from the centre, world units: circles (Ulmet's example 5.2).
    Circle,
    /// Half the extent along x of the ellipse through the point, world units; that along y is `aspect` times as long.
    Ellipse {
        /// Greater than 0.
        aspect: f64,
    },
    /// Any expression in x and y, world units.
    Expression(Expression),
    /// A gray picture.
    Grid(Grid),
}

impl PlaneCurve {
    /// g and zero; `None` where g is not finite.
    pub fn value(&self, at: DVec2) -> Option<DVec2> {
        let value = match self {
            PlaneCurve::Circle => at.length(),
            PlaneCurve::Ellipse { aspect } => at.x.hypot(at.y / aspect),
            PlaneCurve::Expression(expression) => expression.value(at),
            PlaneCurve::Grid(grid) => grid.value(at),
        };
        value.is_finite().then(|| dvec2(value, 0.0))
    }

    /// g as a WGSL expression of `x` and `y`, world units.
    pub(crate) fn wgsl(&self) -> String {
        match self {
            PlaneCurve::Circle => "length(vec2f(x, y))".to_owned(),
            PlaneCurve::Ellipse { aspect } => format!("length(vec2f(x, y / {:?}))", *aspect as f32),
            PlaneCurve::Expression(expression) => expression.wgsl(),
            PlaneCurve::Grid(grid) => grid.wgsl(),
        }
    }
}
