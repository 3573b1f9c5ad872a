//! Ulmet's theorem: lines are the contours f(u,v) = c, so f is c at every point of every curve, whatever the field and the mesh.

use crate::common::meshes;
use catoptric::curves::trace;
use catoptric::field::{Field, HighlightKind, Method, Scout};
use catoptric::stam::LimitSurface;
use glam::DVec3;

const METHODS: [&str; 17] = [
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
fn family(scout: &Scout, field: &Field, camera: &catoptric::field::Camera) -> Vec<(i32, f64)> {
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

/// Relative to the value or, round 0, to the distance between lines, which is what a line is seen against.
#[test]
fn fields_have_their_value_on_every_curve() {
    let found: Vec<(String, f64, usize, usize)> = meshes()
        .into_iter()
        .flat_map(|mesh| {
            let surface = LimitSurface::new(&mesh).expect("it has a surface");
            let scout = Scout::new(&surface).expect("it has patches");
            let camera = scout.camera([256; 2], DVec3::Z);
            METHODS.iter().map(move |name| {
                let method: Method = name.parse().expect("a method");
                let field = scout.field(&method, &camera);
                let curves =
                    trace(&surface, &field, &camera, &family(&scout, &field, &camera), 1e-3 * surface.diagonal());
                let (mut worst, mut points) = (0.0f64, 0);
                for curve in &curves {
                    for place in &curve.places {
                        let (patch, uv) = surface.locate(place.face, [place.u, place.v]).expect("no hole");
                        let error = match field.at(&surface, &camera, patch, uv) {
                            Some(value) => (value.x - curve.value).abs() / curve.value.abs().max(field.light.spacing),
                            None => f64::INFINITY,
                        };
                        worst = worst.max(error);
                        points += 1;
                    }
                }
                (format!("{} {name}", mesh.name), worst, points, curves.len())
            })
        })
        .collect();
    let (points, curves) = found.iter().fold((0, 0), |sum, entry| (sum.0 + entry.2, sum.1 + entry.3));
    let worst = found.iter().max_by(|a, b| a.1.total_cmp(&b.1)).expect("there are meshes");
    println!("{points} points on {curves} curves; the worst is {:.1e} off: {}", worst.1, worst.0);
    for (what, error, ..) in &found {
        assert!(*error <= 1e-10, "{what}: {error:e}");
    }
    for name in METHODS {
        let curves: usize = found.iter().filter(|entry| entry.0.ends_with(name)).map(|entry| entry.3).sum();
        assert!(curves > 50, "{name}: {curves} curves");
    }
}
