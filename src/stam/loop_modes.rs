//! The eigenvalues and left eigenvectors of Loop's rules at an extraordinary vertex (docs/LIMIT.md, section 8).
//!
//! The ring decouples into Fourier modes: one of angle a has the eigenvalue 3/8 + cos(a) / 4 and weighs spokes with
//! wave(i) (Loop 1987, Stam 1999). The angle is 2 pi / N round a smooth vertex, pi / k between the two fixed edges of a
//! sector, 0 round a fixed vertex; along a sharp edge the eigenvalue is 1/2. Points outside the ring add 1/8 and 1/16 only.

use super::loop_rows::spoke_weight;
use super::modes::Modes;
use crate::patch::{RingClass, Tip};
use std::f64::consts::{FRAC_PI_3, PI, TAU};

fn eigenvalue(angle: f64) -> f64 {
    0.375 + 0.25 * angle.cos()
}

/// Weights of the vertex and its spokes.
fn ring(class: RingClass, vertex: f64, spoke: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut weights = vec![0.0; class.support()];
    weights[0] = vertex;
    (0..class.spokes()).for_each(|i| weights[1 + i] = spoke(i));
    weights
}

/// Weights of the first and the last spoke of a sector, and its vertex.
fn ends(class: RingClass, vertex: f64, [first, last]: [f64; 2]) -> Vec<f64> {
    let faces = usize::from(class.faces);
    let spoke = |i: usize| match i {
        0 => first,
        i if i == faces => last,
        _ => 0.0,
    };
    ring(class, vertex, spoke)
}

/// What a class of Loop's scheme has at its vertex.
pub(super) fn modes(class: RingClass) -> Modes {
    let faces = f64::from(class.faces);
    match (class.closed, class.tip, class.sharp_spoke) {
        (true, Tip::Smooth, None) => {
            let angle = TAU / faces;
            let wave = |turn: f64| ring(class, 0.0, |i| (i as f64 * angle - turn).cos());
            let tangents = (class.faces > 2).then(|| [wave(0.0), wave(PI / 2.0)]);
            Modes { lambda: eigenvalue(angle), tangents, spare: None }
        }
        (true, Tip::Smooth, Some(sharp)) => dart(class, usize::from(sharp)),
        (true, _, _) => Modes { lambda: eigenvalue(0.0), tangents: None, spare: None },
        (false, Tip::Crease, _) => crease(class),
        // Both bounding edges keep a direction of their own at 1/2. With 3 faces they win over the sine mode, which is at 1/2
        // too, by a Jordan block; with 4 and more it grows faster than they do, and there is no tangent plane.
        (false, _, _) => {
            let tangents = (class.faces <= 3).then(|| [[1.0, 0.0], [0.0, 1.0]].map(|e| ends(class, -1.0, e)));
            Modes { lambda: eigenvalue(PI / faces).max(0.5), tangents, spare: None }
        }
    }
}

/// A crease: the sine modes between its edges, and along it the difference of its two neighbours.
fn crease(class: RingClass) -> Modes {
    let along = ends(class, 0.0, [1.0, -1.0]);
    let tangents = match class.faces {
        // Nothing lies between the edges: the boundary curve's osculating plane, whose second direction has 1/4.
        1 => [along, ends(class, -2.0, [1.0, 1.0])],
        // The second sine mode is not above the direction along the crease (at 6 faces both are 1/2, and a Jordan block lets the
        // latter win).
        2..=6 => [along, sine(class, 1)],
        // Inside the sector it is, on the crease itself it vanishes: no tangent plane, and what is given is the limit inside.
        _ => [sine(class, 2), sine(class, 1)],
    };
    Modes { lambda: eigenvalue(PI / f64::from(class.faces)).max(0.5), tangents: Some(tangents), spare: None }
}

/// The left eigenvector of sine mode `order` between the edges of a crease sector. The mode vanishes on the crease, but
/// crease points weigh in its rows: the columns of the crease points give their weights.
fn sine(class: RingClass, order: usize) -> Vec<f64> {
    let faces = usize::from(class.faces);
    let angle = order as f64 * PI / faces as f64;
    let wave = |i: usize| (i as f64 * angle).sin();
    let lambda = eigenvalue(angle);
    // Column of an end's point: its midpoint rule, the next spoke's edge point, and the vertex's crease rule.
    let on_end = wave(1) / 8.0;
    let (vertex, first, last) = if order.is_multiple_of(2) {
        let end = on_end / (lambda - 0.5);
        (0.0, end, -end)
    } else {
        // Column of the vertex: its crease rule, both midpoints, all edge points.
        let on_vertex = 0.375 * (1..faces).map(wave).sum::<f64>();
        // (lambda - 3/4) v - e = on_vertex and -v/8 + (lambda - 1/2) e = on_end.
        let determinant = (lambda - 0.75) * (lambda - 0.5) - 0.125;
        let vertex = (on_vertex * (lambda - 0.5) + on_end) / determinant;
        let end = (on_end * (lambda - 0.75) + 0.125 * on_vertex) / determinant;
        (vertex, end, end)
    };
    let spoke = |i: usize| match i {
        0 => first,
        i if i == faces => last,
        i => wave(i),
    };
    ring(class, vertex, spoke)
}

/// A dart: the mode that is odd about its sharp edge is the smooth one, the even one has an angle of its own.
fn dart(class: RingClass, sharp: usize) -> Modes {
    let angle = TAU / f64::from(class.faces);
    let odd = ring(class, 0.0, |i| ((i as f64 - sharp as f64) * angle).sin());
    let (lambda, even) = even_dart(class, sharp);
    let tangents = (class.faces > 2).then_some([even, odd]);
    Modes { lambda: eigenvalue(angle).max(lambda), tangents, spare: None }
}

/// Eigenvalue and left eigenvector of a dart's largest mode that is even about its sharp edge.
///
/// Away from the sharp edge it is a wave of angle phi, lambda = 3/8 + cos(phi) / 4, over a constant that the vertex rule asks
/// for; the sharp edge's own weight follows from its column. phi is where the vector is orthogonal to the constants, as
/// every left vector of an eigenvalue other than 1 is.
fn even_dart(class: RingClass, sharp: usize) -> (f64, Vec<f64>) {
    let n = usize::from(class.faces);
    let place = |i: usize| (i + n - sharp) % n;
    if n == 6 {
        // Here lambda is 1/2, the sharp edge's own eigenvalue, and the wave's formula has a pole.
        return (0.5, ring(class, 4.0, |i| [8.0, -1.0, -3.0, -4.0, -3.0, -1.0][place(i)]));
    }
    let valence = n as f64;
    let weight = spoke_weight(valence);
    let vector = |phi: f64| {
        let lambda = eigenvalue(phi);
        let constant = weight / (lambda - 0.625);
        let height = -constant / (phi * valence / 2.0).cos();
        let wave = |i: usize| constant + height * (phi * (i as f64 - valence / 2.0)).cos();
        let on_sharp = (0.125 * (wave(1) + wave(n - 1)) + weight) / (lambda - 0.5);
        // Pointing along the sharp edge, so that the odd mode lies to its left.
        let sign = on_sharp.signum();
        let spoke = |i: usize| sign * if place(i) == 0 { on_sharp } else { wave(place(i)) };
        (lambda, ring(class, sign, spoke))
    };
    let excess = |phi: f64| {
        let weights: Vec<f64> = vector(phi).1;
        weights.iter().sum::<f64>() * weights[0].signum()
    };
    // Between the smooth mode and the nearest pole of the sum: where lambda is 1/2, or where the wave's height has one.
    let [smooth, pole] = [TAU / valence, if n < 6 { PI / valence } else { 3.0 * PI / valence }];
    let [mut low, mut high] = if n < 6 { [pole.max(FRAC_PI_3), smooth] } else { [smooth, pole.min(FRAC_PI_3)] };
    let margin = 1e-9 * (high - low);
    let rising = excess(high - margin) > 0.0;
    (low, high) = (low + margin, high - margin);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if (excess(middle) > 0.0) == rising { high = middle } else { low = middle }
    }
    vector(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stam::ClassTable;
    use crate::stam::class::{deflated_step, tests::iterated_eigenvalue};
    use crate::stam::loop_rows::LoopRows;

    fn class(faces: u16, closed: bool, tip: Tip, sharp_spoke: Option<u16>) -> RingClass {
        RingClass { triangles: true, faces, closed, index: 0, tip, sharp_spoke }
    }

    #[test]
    fn closed_forms_are_the_iterated_eigenvalues() {
        let smooth = (3..=20).map(|n| class(n, true, Tip::Smooth, None));
        let cones = (3..=8).map(|n| class(n, true, Tip::Corner, None));
        // Corner sectors of 3 faces have a Jordan block at 1/2: iteration is slow there, not the formula wrong.
        let creases = [1, 2, 4, 5, 7].map(|k| class(k, false, Tip::Crease, None));
        let corners = [2, 4, 5, 6].map(|k| class(k, false, Tip::Corner, None));
        let darts = (2..=12).filter(|n| *n != 6).map(|n| class(n, true, Tip::Smooth, Some(0)));
        for class in smooth.chain(cones).chain(creases).chain(corners).chain(darts) {
            let table = ClassTable::new(class);
            let iterated = iterated_eigenvalue(&LoopRows::new(class).step(), &table.limit);
            assert!((iterated - table.lambda).abs() < 1e-12, "{class:?}: {iterated} against {}", table.lambda);
        }
    }

    fn assert_left(class: RingClass, vector: &[f64], eigenvalue: f64) {
        let table = ClassTable::new(class);
        let next = deflated_step(vector, &LoopRows::new(class).step(), &table.limit, eigenvalue);
        let size = vector.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let change = next.iter().zip(vector).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(change < 1e-13 * size, "{class:?}: {change:e}");
    }

    #[test]
    fn tangents_are_left_eigenvectors() {
        let tangents = |class| ClassTable::new(class).tangents.expect("there is a tangent plane");
        for n in 3..=20 {
            let smooth = class(n, true, Tip::Smooth, None);
            tangents(smooth).iter().for_each(|t| assert_left(smooth, t, eigenvalue(TAU / f64::from(n))));
        }
        for k in 2..=20 {
            let crease = class(k, false, Tip::Crease, None);
            let [second, first] = tangents(crease);
            assert_left(crease, &first, eigenvalue(PI / f64::from(k)));
            assert_left(crease, &second, if k <= 6 { 0.5 } else { eigenvalue(2.0 * PI / f64::from(k)) });
        }
        let [along, bend] = tangents(class(1, false, Tip::Crease, None));
        assert_left(class(1, false, Tip::Crease, None), &along, 0.5);
        assert_left(class(1, false, Tip::Crease, None), &bend, 0.25);
        for n in (3..=20).chain([33, 64]) {
            let dart = class(n, true, Tip::Smooth, Some(n / 2));
            let [even, odd] = tangents(dart);
            assert_left(dart, &odd, eigenvalue(TAU / f64::from(n)));
            assert_left(dart, &even, even_dart(dart, usize::from(n / 2)).0);
        }
    }

    /// Limit positions at smooth vertices: Loop 1987, as OpenSubdiv's masks have them.
    #[test]
    fn limit_weights_of_smooth_vertices_are_the_known_ones() {
        for n in 3..=12u16 {
            let valence = f64::from(n);
            let beta = eigenvalue(TAU / valence);
            let gamma = (0.625 - beta * beta) / valence;
            let spoke = 1.0 / (valence + 3.0 / (8.0 * gamma));
            let limit = ClassTable::new(class(n, true, Tip::Smooth, None)).limit;
            for (k, &weight) in limit.iter().enumerate() {
                let expected = match k {
                    0 => 1.0 - valence * spoke,
                    k if k <= usize::from(n) => spoke,
                    _ => 0.0,
                };
                assert!((weight - expected).abs() < 1e-15, "N = {n}, point {k}: {weight} {expected}");
            }
        }
    }
}
