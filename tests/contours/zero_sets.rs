//! Beier & Chen 1994, eq. 13 to 17: signed, pseudo and alternative functions have the same highlight lines and band boundaries.

use crate::common::meshes;
use crate::distance;
use catoptric::curves::{Curve, trace};
use catoptric::field::{Field, HighlightKind, Method, Scout};
use catoptric::stam::LimitSurface;
use glam::DVec3;

#[test]
fn functions_have_the_same_lines() {
    // Numbers of points, and the lengths of line that they stand for: points lie closer together where lines end.
    let (mut compared, mut parallel) = ((0, 0.0), (0, 0.0));
    for mesh in meshes().into_iter().filter(|mesh| ["pole_5", "crease_2_7", "dart", "sample"].contains(&&*mesh.name)) {
        let surface = LimitSurface::new(&mesh).expect("it has a surface");
        let scout = Scout::new(&surface).expect("it has patches");
        let camera = scout.camera([256; 2], DVec3::Z);
        let tolerance = 1e-4 * surface.diagonal();
        let Field { light, .. } = scout.field(&Method::Highlight(HighlightKind::Signed), &camera);
        let radius = 0.5 * light.spacing;
        let lines = |kind: HighlightKind, value: f64| {
            let field = Field { light, method: Method::Highlight(kind) };
            trace(&surface, &field, &camera, &[(0, value)], tolerance)
        };
        // The line itself, and the boundaries of a band (eq. 16 and 17).
        let families: [Vec<Vec<Curve>>; 3] = [
            vec![
                lines(HighlightKind::Signed, 0.0),
                lines(HighlightKind::Pseudo, 0.0),
                lines(HighlightKind::Alternative(0.0), 0.0),
                lines(HighlightKind::Array, 0.0),
            ],
            vec![lines(HighlightKind::Signed, radius), lines(HighlightKind::Alternative(radius), 0.0)],
            vec![lines(HighlightKind::Signed, -radius), lines(HighlightKind::Alternative(-radius), 0.0)],
        ];
        for family in &families {
            for (first, second) in [(0, 1), (1, 0), (0, family.len() - 1), (family.len() - 1, 0)] {
                let points =
                    family[first].iter().flat_map(|curve| curve.points.iter().zip(&curve.places).zip(shares(curve)));
                for ((point, place), share) in points {
                    // Where the normal is parallel to the light, some of the functions are undefined, and their lines end.
                    let jet = surface.evaluate_ptex(place.face, [place.u, place.v]).expect("no hole").1;
                    if jet.normal.cross(light.axes[1]).length() < 2e-3 {
                        parallel = (parallel.0 + 1, parallel.1 + share);
                        continue;
                    }
                    // The points are on the line; the other polyline is within the tolerance of it.
                    let off = distance(&family[second], *point);
                    assert!(
                        off <= 1.01 * tolerance,
                        "{}: {point} is {off:e} from the other function's line",
                        mesh.name
                    );
                    compared = (compared.0 + 1, compared.1 + share);
                }
            }
        }
    }
    println!(
        "{} points compared, {} not: the normal is parallel to the light; lengths {} and {}",
        compared.0, parallel.0, compared.1, parallel.1
    );
    assert!(20.0 * parallel.1 < compared.1);
    assert!(compared.0 > 500);
}

/// Length of line that each point of a curve stands for: half of the chords on its two sides.
fn shares(curve: &Curve) -> Vec<f64> {
    let mut shares = vec![0.0; curve.points.len()];
    for (k, ends) in curve.points.windows(2).enumerate() {
        let half = ends[0].distance(ends[1]) / 2.0;
        shares[k] += half;
        shares[k + 1] += half;
    }
    shares
}
