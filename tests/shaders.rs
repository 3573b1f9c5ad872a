//! Every WGSL entry point is valid, and every struct that Rust shares with WGSL has the same layout on both sides.

use catoptric::field::{CurvatureKind, Grid, HighlightKind, Method, Mirrored, PlaneCurve};
use catoptric::gpu::records::*;
use catoptric::gpu::shader::{MODULES, Module};
use naga::{TypeInner, front::wgsl, valid};
use std::mem::offset_of;

/// One of each method.
fn methods() -> Vec<Method> {
    let curve = |text: &str| Method::Curve(PlaneCurve::Expression(text.parse().expect("an expression")));
    vec![
        Method::Reflection,
        Method::Curve(PlaneCurve::Circle),
        Method::Curve(PlaneCurve::Ellipse { aspect: 2.0 }),
        curve(
            "-x^2 + 3 * y ^ 0.5 / (1 + abs(x)) - max(x, min(y, pi)) * sin(x) + atan2(y, x) + pow(x, 2) - log(exp(tanh(floor(sign(cos(tan(sqrt(x))))))))",
        ),
        Method::Curve(PlaneCurve::Grid(Grid::new([4, 5], vec![0.5; 20], 2.0).expect("a grid"))),
        Method::RayDistance,
        Method::Highlight(HighlightKind::Array),
        Method::Sphere(Mirrored::Normal),
        Method::Isophote,
        Method::Curvature(CurvatureKind::Mean),
        Method::Section,
    ]
}

fn parse(module: &Module, method: &Method) -> naga::Module {
    let source = module.source(method);
    wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{}: {}", module.name, e.emit_to_string(&source)))
}

#[test]
fn entry_points_are_valid() {
    for (module, method) in MODULES.iter().flat_map(|module| methods().into_iter().map(move |method| (module, method)))
    {
        let parsed = parse(module, &method);
        assert!(!parsed.entry_points.is_empty(), "{} has no entry point", module.name);
        let mut validator = valid::Validator::new(valid::ValidationFlags::all(), valid::Capabilities::empty());
        if let Err(error) = validator.validate(&parsed) {
            panic!("{}: {}", module.name, error.emit_to_string(&module.source(&method)));
        }
    }
}

/// The same for tables of triangles.
#[test]
fn entry_points_are_valid_for_triangles() {
    for (module, method) in MODULES.iter().flat_map(|module| methods().into_iter().map(move |method| (module, method)))
    {
        let source = module.source_for_triangles(&method);
        let parsed =
            wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{}: {}", module.name, e.emit_to_string(&source)));
        let mut validator = valid::Validator::new(valid::ValidationFlags::all(), valid::Capabilities::empty());
        if let Err(error) = validator.validate(&parsed) {
            panic!("{}: {}", module.name, error.emit_to_string(&source));
        }
    }
}

/// Offsets of the fields of a WGSL struct, and its size.
fn layout(name: &str) -> (Vec<(String, usize)>, usize) {
    for module in MODULES {
        for (_, ty) in parse(&module, &Method::Reflection).types.iter() {
            if let (Some(found), TypeInner::Struct { members, span }) = (&ty.name, &ty.inner)
                && found == name
            {
                let fields = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize));
                return (fields.collect(), *span as usize);
            }
        }
    }
    panic!("no shader has a struct {name}");
}

/// Compares a WGSL struct with its host twin: every WGSL field at the same offset, and the same size.
macro_rules! same_layout {
    ($wgsl:literal, $host:ty { $($field:ident),+ $(,)? }) => {
        let (fields, size) = layout($wgsl);
        let fields: Vec<_> = fields.iter().map(|(name, offset)| (name.as_str(), *offset)).collect();
        assert_eq!(fields, [$((stringify!($field), offset_of!($host, $field))),+], "fields of {}", $wgsl);
        assert_eq!(size, size_of::<$host>(), "size of {}", $wgsl);
    };
}

#[test]
fn structs_have_the_same_layout_on_both_sides() {
    same_layout!("Draw", DrawRecord { first, group_size, padding });
    same_layout!("Span", SpanRecord { first, count, groups, rows });
    same_layout!(
        "Frame",
        FrameRecord { clip_x, near, clip_y, focal, clip_depth, proxy_level, scale, shift, size, orthographic, padding }
    );
    same_layout!("SampleRecord", SampleRecord { uv, patch_id, padding });
    same_layout!("JetRecord", JetRecord { position, du, dv, normal });
    same_layout!(
        "Light",
        LightRecord { center, spacing, axis_x, half_x, axis_y, half_y, sight, from_eye, kind, parameter, lines, unit }
    );
    same_layout!(
        "Shade",
        ShadeRecord {
            paint,
            width,
            tube,
            padding0,
            top,
            samples,
            bottom,
            padding1,
            up,
            padding2,
            key,
            padding3,
            picture_scale,
            range
        }
    );
    same_layout!("Lens", LensRecord { size, perspective, scale });
    same_layout!("Own", OwnRecord { origin, size });
    same_layout!("Resolve", ResolveRecord { top, padding0, bottom, row, rows });
}
