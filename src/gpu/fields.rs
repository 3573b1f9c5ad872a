//! The shaders of fields, and what they are told.

use crate::field::{CurvatureKind, Field, HighlightKind, Method, Mirrored, PlaneCurve};

/// Kinds of highlight functions.
const HIGHLIGHT_ARRAY: u32 = 0;
const HIGHLIGHT_SIGNED: u32 = 1;
const HIGHLIGHT_NEAREST: u32 = 2;
const HIGHLIGHT_PSEUDO: u32 = 3;
const HIGHLIGHT_ALTERNATIVE: u32 = 4;
/// What looks up a pattern on the sphere.
const SPHERE_NORMAL: u32 = 0;
const SPHERE_REFLECTION: u32 = 1;
/// Kinds of curvature.
const CURVATURE_MEAN: u32 = 0;
const CURVATURE_GAUSSIAN: u32 = 1;
const CURVATURE_LARGEST: u32 = 2;
const CURVATURE_SMALLEST: u32 = 3;

const PLANE: &str = include_str!("../../shaders/field/plane.wgsl");
const GRID: &str = include_str!("../../shaders/field/grid.wgsl");
const NEAREST: &str = include_str!("../../shaders/field/nearest.wgsl");

impl Method {
    /// WGSL that defines `field_value`; it follows shaders/field/light.wgsl. Methods of the same source share pipelines.
    pub fn wgsl(&self) -> String {
        let reads_curvature = self.reads_curvature();
        let mut source = format!("const READS_CURVATURE = {reads_curvature};\n");
        let kinds = [
            ("HIGHLIGHT_SIGNED", HIGHLIGHT_SIGNED),
            ("HIGHLIGHT_NEAREST", HIGHLIGHT_NEAREST),
            ("HIGHLIGHT_PSEUDO", HIGHLIGHT_PSEUDO),
            ("HIGHLIGHT_ALTERNATIVE", HIGHLIGHT_ALTERNATIVE),
            ("SPHERE_REFLECTION", SPHERE_REFLECTION),
            ("CURVATURE_GAUSSIAN", CURVATURE_GAUSSIAN),
            ("CURVATURE_LARGEST", CURVATURE_LARGEST),
            ("CURVATURE_SMALLEST", CURVATURE_SMALLEST),
        ];
        kinds.iter().for_each(|(name, value)| source += &format!("const {name} = {value}u;\n"));
        if let Method::Curve(curve) = self {
            source += &format!("fn curve(x: f32, y: f32) -> f32 {{\n    return {};\n}}\n", curve.wgsl());
        }
        let files: &[&str] = match self {
            Method::Reflection => &[PLANE, include_str!("../../shaders/field/reflection.wgsl")],
            Method::Curve(PlaneCurve::Grid(_)) => &[PLANE, GRID, include_str!("../../shaders/field/curve.wgsl")],
            Method::Curve(_) => &[PLANE, include_str!("../../shaders/field/curve.wgsl")],
            Method::RayDistance => &[NEAREST, include_str!("../../shaders/field/distance.wgsl")],
            Method::Highlight(_) => &[PLANE, NEAREST, include_str!("../../shaders/field/highlight.wgsl")],
            Method::Sphere(_) => &[include_str!("../../shaders/field/sphere.wgsl")],
            Method::Isophote => &[include_str!("../../shaders/field/isophote.wgsl")],
            Method::Curvature(_) => &[include_str!("../../shaders/field/curvature.wgsl")],
            Method::Section => &[include_str!("../../shaders/field/section.wgsl")],
        };
        files.iter().for_each(|file| source += file);
        source
    }

    /// Which kind of its method it is, and a number, in world units, that it takes.
    fn kind(&self) -> (u32, f64) {
        match self {
            Method::Highlight(kind) => match kind {
                HighlightKind::Array => (HIGHLIGHT_ARRAY, 0.0),
                HighlightKind::Signed => (HIGHLIGHT_SIGNED, 0.0),
                HighlightKind::Nearest => (HIGHLIGHT_NEAREST, 0.0),
                HighlightKind::Pseudo => (HIGHLIGHT_PSEUDO, 0.0),
                HighlightKind::Alternative(radius) => (HIGHLIGHT_ALTERNATIVE, *radius),
            },
            Method::Sphere(Mirrored::Normal) => (SPHERE_NORMAL, 0.0),
            Method::Sphere(Mirrored::Reflection) => (SPHERE_REFLECTION, 0.0),
            Method::Curvature(kind) => match kind {
                CurvatureKind::Mean => (CURVATURE_MEAN, 0.0),
                CurvatureKind::Gaussian => (CURVATURE_GAUSSIAN, 0.0),
                CurvatureKind::Largest => (CURVATURE_LARGEST, 0.0),
                CurvatureKind::Smallest => (CURVATURE_SMALLEST, 0.0),
            },
            _ => (0, 0.0),
        }
    }

    /// What 1 in a shader is in units of the field, where 1 is `unit` world units in lengths.
    pub(super) fn scale(&self, unit: f64) -> f64 {
        match self {
            Method::Reflection | Method::RayDistance | Method::Highlight(_) | Method::Section => unit,
            // Curves are computed in world units.
            Method::Curve(_) | Method::Sphere(_) | Method::Isophote => 1.0,
            Method::Curvature(CurvatureKind::Gaussian) => 1.0 / (unit * unit),
            Method::Curvature(_) => 1.0 / unit,
        }
    }
}

/// What the record of the light takes from a field.
#[derive(Debug, Clone, Copy)]
pub(super) struct FieldNumbers {
    pub kind: u32,
    pub parameter: f32,
    /// Period of the pattern in the shader's units of the field.
    pub spacing: f32,
    /// Half the extents of the pattern, in the same units.
    pub half: [f32; 2],
    /// Distance between light lines.
    pub lines: f32,
}

impl FieldNumbers {
    pub fn new(field: &Field, unit: f64) -> FieldNumbers {
        /// Stands for an infinite extent: finite, so that shader arithmetic stays defined.
        const ENDLESS: f64 = 1e30;
        let (kind, parameter) = field.method.kind();
        let scale = field.method.scale(unit);
        let half = field.light.half.map(|half| (half / scale).min(ENDLESS) as f32);
        FieldNumbers {
            kind,
            parameter: (parameter / unit) as f32,
            spacing: (field.light.spacing / scale) as f32,
            half: if field.method.is_bounded() { half } else { [ENDLESS as f32; 2] },
            lines: (field.light.spacing / unit) as f32,
        }
    }
}
