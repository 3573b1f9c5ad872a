//! Time to evaluate the highlight functions of Beier & Chen 1994 on their largest grid: 100 x 100 points of one bicubic B-spline surface.
//! They took 0.193 s on a Silicon Graphics Personal Iris (fig. 15), contouring and display included; with the pseudo signed
//! distance 15 % less. `cargo run --release --example highlight_grid`

use catoptric::field::{Field, HighlightKind, Light, Method, Point};
use catoptric::mesh::{Boundary, SubdivMesh};
use catoptric::stam::{LimitSurface, weights};
use glam::DVec3;
use std::time::Instant;

/// Points along a side, all in one ptex face after the other.
const SIDE: usize = 100;

/// Spans of the B-spline surface along a side.
const SPANS: usize = 5;

/// A sheet of 5 x 5 bicubic spans, bent both ways.
fn sheet() -> SubdivMesh {
    let side = SPANS + 3;
    let point = |k: usize| {
        let [x, y] = [k % side, k / side].map(|i| (i as f64 - 3.5) / 2.5);
        DVec3::new(x, y, 0.3 * (1.5 * x).sin() - 0.2 * y * y + 0.05 * (3.0 * x * y).cos())
    };
    let corners = |k: usize| {
        let first = k / (side - 1) * side + k % (side - 1);
        [first, first + 1, first + side + 1, first + side].map(|v| v as u32)
    };
    let faces = (side - 1) * (side - 1);
    SubdivMesh {
        name: "sheet".into(),
        points: (0..side * side).map(point).collect(),
        face_sizes: vec![4; faces],
        face_vertices: (0..faces).flat_map(corners).collect(),
        boundary: Boundary::None,
        ..SubdivMesh::default()
    }
}

/// Shortest of many runs, in milliseconds, and the number of values that are not negative.
fn fastest(mut run: impl FnMut() -> usize) -> (f64, usize) {
    let mut best = (f64::INFINITY, 0);
    for _ in 0..200 {
        let start = Instant::now();
        let count = run();
        best = (best.0.min(start.elapsed().as_secs_f64() * 1e3), count);
    }
    best
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let surface = LimitSurface::new(&sheet())?;
    let light = Light::new(DVec3::new(0.2, 0.1, 3.0), DVec3::NEG_Z, DVec3::new(0.2, 1.0, 0.0), 0.5);
    let patches = surface.patches().len();
    let per_span = SIDE / SPANS;
    let grid: Vec<(usize, [f64; 2])> = (0..patches)
        .flat_map(|patch| {
            let at = move |k: usize| [k % per_span, k / per_span].map(|i| (i as f64 + 0.5) / per_span as f64);
            (0..per_span * per_span).map(move |k| (patch, at(k)))
        })
        .collect();
    println!("{} grid points on {patches} bicubic spans, one thread; shortest of 200 runs", grid.len());
    let value = |field: &Field, position: DVec3, normal: DVec3| {
        let point = Point { position, normal, sight: DVec3::NEG_Z, curvature: None };
        field.value(&point).is_some_and(|value| value.x >= 0.0)
    };
    for kind in [HighlightKind::Signed, HighlightKind::Pseudo, HighlightKind::Alternative(0.1)] {
        let field = Field { light, method: Method::Highlight(kind) };
        let (time, count) = fastest(|| {
            let jets = grid.iter().map(|&(patch, uv)| surface.evaluate(patch, uv));
            jets.filter(|jet| value(&field, jet.position, jet.normal)).count()
        });
        println!("{}: {time:.2} ms; {count} values are not negative", field.method);
    }
    // As anyone would who evaluates a grid: the net of a span once, the weights of the grid once.
    let weights: Vec<_> = grid[..per_span * per_span].iter().map(|&(_, uv)| weights(uv)).collect();
    let field = Field { light, method: Method::Highlight(HighlightKind::Signed) };
    let (time, count) = fastest(|| {
        let mut count = 0;
        for patch in 0..patches {
            let catoptric::stam::Net::Regular(net) = surface.net(patch, 1) else { continue };
            for weights in &weights {
                let mut sums = [DVec3::ZERO; 3];
                for (point, w) in net.iter().zip(weights) {
                    sums.iter_mut().zip(w).for_each(|(sum, w)| *sum += *w * *point);
                }
                let [position, du, dv] = sums;
                count += usize::from(value(&field, position, du.cross(dv).normalize()));
            }
        }
        count
    });
    println!("{}, span by span with the weights of the grid: {time:.2} ms; {count}", field.method);
    Ok(())
}
