//! Ulmet's theorem: lines are the contours f(u,v) = c, so f is c at every point of every curve, whatever the field and the mesh.

use crate::common::meshes;
use catoptric::curves::trace;
use catoptric::field::{Field, HighlightKind, Method, Scout};
use catoptric::stam::LimitSurface;
use glam::DVec3;

pub const METHODS: [&str; 17] = [
    "reflection",
    "curve:circle",
    "curve:ellipse=0.5",
    "curve:x^2 - y^2",
    "distance",
    "highlight:array",
    "highlight:signed",
    "highlight:nearest",
    "highlight:pseudo",
    "highlight:alternative=0.1",
    "sphere:reflection",
    "sphere:normal",
    "isophote",
    "curvature:mean",
    "curvature:gaussian",
    "curvature:largest",
    "section",
];

/// Values of the family that the camera sees, at most nine.
pub fn family(scout: &Scout, field: &Field, camera: &catoptric::field::Camera) -> Vec<(i32, f64)> {
    let [low, high] = scout.range(field, camera);
    let spacing = field.light.spacing;
    let first = (low / spacing).ceil() as i32;
    let last = ((high / spacing).floor() as i32).min(first.saturating_add(8));
    // Distances from the nearest light are 0 on its line.
    let is_nearest = matches!(field.method, Method::RayDistance | Method::Highlight(HighlightKind::Nearest));
    if is_nearest {
        return (-4..=4).map(|k| (k, 0.0)).collect();
    }
    (first..=last).map(|k| (k, f64::from(k) * spacing)).collect()
}

/// Largest |f - c|, relative.
const ASKED: f64 = 1e-10;

/// What was found of one mesh and method.
struct Found {
    what: String,
    /// Largest |f - c| over |c| or the distance between lines; without what rounding of (u,v) alone makes of it.
    worst: f64,
    beyond_rounding: f64,
    points: usize,
    /// Points where rounding of (u,v) alone moves f by more than asked.
    steep: usize,
    curves: usize,
}

/// Relative to the value or, round 0, to the distance between lines, which is what a line is seen against.
///
/// A place is two numbers of 53 bits. Beside sharp features the field is so steep in them that the last bit moves it by more than
/// 1e-10: there f - c is held to what f differs by at the places that two last bits reach, once for the tracer's evaluation and once for the
/// reference's, and such points are counted.
#[test]
fn fields_have_their_value_on_every_curve() {
    let mut found = Vec::new();
    for mesh in meshes() {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let scout = Scout::new(&surface).expect("it has patches");
        let camera = scout.camera([256; 2], DVec3::Z);
        for name in METHODS {
            let method: Method = name.parse().expect("a method");
            let field = scout.field(&method, &camera);
            let curves = trace(&surface, &field, &camera, &family(&scout, &field, &camera), 1e-3 * surface.diagonal());
            let value = |[u, v]: [f64; 2], face: u32| {
                let (patch, uv) = surface.locate(face, [u.clamp(0.0, 1.0), v.clamp(0.0, 1.0)])?;
                Some(field.at(&surface, &camera, patch, uv)?.x)
            };
            let what = format!("{} {name}", mesh.name);
            let mut all = Found { what, worst: 0.0, beyond_rounding: 0.0, points: 0, steep: 0, curves: curves.len() };
            for curve in &curves {
                let scale = curve.value.abs().max(field.light.spacing);
                // Longitudes of -180 and 180 are one.
                let turn = if name.starts_with("sphere") { 360.0 } else { f64::INFINITY };
                for place in &curve.places {
                    all.points += 1;
                    let off = |at: [f64; 2]| value(at, place.face).map_or(f64::INFINITY, |f| f - curve.value);
                    let error = |at: [f64; 2]| off(at).abs().min((turn - off(at).abs()).abs()) / scale;
                    let [u, v] = [place.u, place.v];
                    let here = error([u, v]);
                    all.worst = all.worst.max(here);
                    if here > ASKED {
                        all.steep += 1;
                        // All 25 places: evaluation may well give the nearest ones the same value.
                        let step = |k: usize| (k as f64 - 2.0) * f64::EPSILON;
                        let around =
                            (0..25).map(|k| off([u + step(k % 5), v + step(k / 5)])).filter(|off| off.is_finite());
                        let here_off = off([u, v]);
                        let rounding = around.map(|off| (off - here_off).abs()).fold(0.0, f64::max) / scale;
                        all.beyond_rounding = all.beyond_rounding.max(here - 2.0 * rounding);
                    }
                }
            }
            found.push(all);
        }
    }
    let points: usize = found.iter().map(|found| found.points).sum();
    let steep: usize = found.iter().map(|found| found.steep).sum();
    let curves: usize = found.iter().map(|found| found.curves).sum();
    let worst = found.iter().max_by(|a, b| a.worst.total_cmp(&b.worst)).expect("there are meshes");
    println!(
        "{points} points on {curves} curves; f - c is more than 1e-10 at {steep}, where rounding of (u,v) is, at most {:.1e}: {}",
        worst.worst, worst.what
    );
    for found in &found {
        assert!(found.beyond_rounding <= ASKED, "{}: {:e}", found.what, found.beyond_rounding);
    }
    assert!(steep * 200 < points, "{steep} of {points}");
    for name in METHODS {
        let curves: usize = found.iter().filter(|found| found.what.ends_with(name)).map(|found| found.curves).sum();
        assert!(curves > 50, "{name}: {curves} curves");
    }
}
