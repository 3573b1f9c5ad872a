//! The eigenvalues and left eigenvectors that a class's limit at the extraordinary vertex needs.
//!
//! Where the ring decouples into Fourier modes they are known: a mode of angle a has the eigenvalue
//! (5 + c + sqrt((9 + c)(1 + c))) / 16, c = cos a (Stam 1998, appendix A), and its left eigenvector weighs spokes with
//! (1 + c + cos(a/2) sqrt(2 (9 + c))) wave(i) and faces with wave(i) + wave(i+1) (Halstead, Kass & DeRose 1993, appendix
//! A). The angle is 2 pi / N round a smooth vertex, pi / k between the two fixed edges of a sector, 0 round a fixed
//! vertex; along a sharp edge the eigenvalue is 1/2.

use crate::patch::{RingClass, Tip};
use std::f64::consts::{PI, TAU};

/// What [`ClassTable`](super::ClassTable) keeps of the spectrum.
pub(super) struct Modes {
    /// Largest eigenvalue below 1.
    pub lambda: f64,
    /// Two left vectors whose values span the tangent plane; their cross product points along the normal.
    pub tangents: Option<[Vec<f64>; 2]>,
    /// What takes the place of the second one where the two are parallel.
    pub spare: Option<Vec<f64>>,
}

fn eigenvalue(angle: f64) -> f64 {
    let c = angle.cos();
    (5.0 + c + ((9.0 + c) * (1.0 + c)).sqrt()) / 16.0
}

/// Weights of the ring of a class: spokes by `spoke(i)`, faces by `face(i)`.
fn ring(class: RingClass, spoke: impl Fn(usize) -> f64, face: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut weights = vec![0.0; class.support()];
    for i in 0..class.spokes() {
        weights[1 + i] = spoke(i);
    }
    for i in 0..usize::from(class.faces) {
        weights[1 + class.spokes() + i] = face(i);
    }
    weights
}

/// The left eigenvector of a Fourier mode.
fn mode(class: RingClass, angle: f64, wave: impl Fn(usize) -> f64) -> Vec<f64> {
    let spoke = 1.0 + angle.cos() + (angle / 2.0).cos() * (2.0 * (9.0 + angle.cos())).sqrt();
    ring(class, |i| spoke * wave(i), |i| wave(i) + wave(i + 1))
}

/// The left eigenvector of sine mode `order` between the edges of a crease sector of 2 faces and more. The mode vanishes on
/// the crease, but crease points weigh in its rows: the columns of the crease points give their weights.
fn sine(class: RingClass, order: usize) -> Vec<f64> {
    let faces = usize::from(class.faces);
    let angle = order as f64 * PI / faces as f64;
    let mut weights = mode(class, angle, |i| if i == faces { 0.0 } else { (i as f64 * angle).sin() });
    let lambda = eigenvalue(angle);
    let (spokes, corners) = weights[1..].split_at(faces + 1);
    // Column of an end's point: the end's midpoint rule, the next spoke's edge point, the first face's point.
    let on_end = spokes[1] / 16.0 + corners[0] / 4.0;
    let (vertex, first, last) = if order.is_multiple_of(2) {
        let end = on_end / (lambda - 0.5);
        (0.0, end, -end)
    } else {
        // Column of the vertex: its crease rule, both midpoints, all edge and face points.
        let on_vertex = 0.375 * spokes.iter().sum::<f64>() + 0.25 * corners.iter().sum::<f64>();
        // (lambda - 3/4) v - e = on_vertex and -v/8 + (lambda - 1/2) e = on_end.
        let determinant = (lambda - 0.75) * (lambda - 0.5) - 0.125;
        let vertex = (on_vertex * (lambda - 0.5) + on_end) / determinant;
        let end = (on_end * (lambda - 0.75) + 0.125 * on_vertex) / determinant;
        (vertex, end, end)
    };
    weights[0] = vertex;
    weights[1] = first;
    weights[1 + faces] = last;
    weights
}

impl Modes {
    pub fn of(class: RingClass) -> Self {
        let faces = f64::from(class.faces);
        match (class.closed, class.tip, class.sharp_spoke) {
            // Two faces: the eigenvalues 1/4, 1/4 and -1/4 make normals alternate from level to level for ever.
            (true, Tip::Smooth, None) if class.faces == 2 => Self { lambda: 0.25, tangents: None, spare: None },
            (true, Tip::Smooth, None) => {
                let angle = TAU / faces;
                let tangents = [0.0, 0.25 * TAU].map(|phase| mode(class, angle, |i| (i as f64 * angle - phase).cos()));
                Self { lambda: eigenvalue(angle), tangents: Some(tangents), spare: None }
            }
            (true, Tip::Smooth, Some(sharp)) => Self::dart(class, usize::from(sharp)),
            (true, _, _) => Self { lambda: eigenvalue(0.0), tangents: None, spare: None },
            (false, Tip::Crease, _) => Self::crease(class),
            // Both bounding edges keep a direction of their own at 1/2. With 2 faces they win over the sine mode by a Jordan
            // block; with 3 and more it grows faster than they do, and there is no tangent plane.
            (false, Tip::Corner, _) if class.faces == 2 => {
                let end = |place: usize| {
                    let mut weights = ring(class, |i| f64::from(u8::from(i == place)), |_| 0.0);
                    weights[0] = -1.0;
                    weights
                };
                Self { lambda: 0.5, tangents: Some([end(0), end(2)]), spare: None }
            }
            (false, _, _) => Self { lambda: eigenvalue(PI / faces).max(0.5), tangents: None, spare: None },
        }
    }

    /// A crease: the sine modes between its edges, and along it the difference of its two neighbours.
    fn crease(class: RingClass) -> Self {
        let faces = usize::from(class.faces);
        let ends = |first: f64, second: f64| {
            let spoke = |i: usize| {
                if i == 0 {
                    first
                } else if i == faces {
                    second
                } else {
                    0.0
                }
            };
            ring(class, spoke, |_| 0.0)
        };
        let along = ends(1.0, -1.0);
        let angle = PI / f64::from(class.faces);
        // Where the boundary of a single face runs straight through the vertex, the face's far corner gives the plane.
        let spare = (faces == 1).then(|| {
            let mut weights = ring(class, |_| 0.0, |_| 1.0);
            weights[0] = -1.0;
            weights
        });
        let tangents = match faces {
            // Directions across decay like n / 4^n along the second difference of the boundary curve (a Jordan block):
            // the tangent plane is the curve's osculating plane.
            1 => {
                let mut bend = ends(1.0, 1.0);
                bend[0] = -2.0;
                [along, bend]
            }
            // The direction along the crease has the eigenvalue 1/2, and the second sine mode is not above it (at 4
            // faces both are equal, and a Jordan block lets the one along the crease win).
            2..=4 => [along, sine(class, 1)],
            // Inside the sector the second sine mode wins. On the crease itself it vanishes, so the normals there have
            // another limit: such a sector has no tangent plane, and what is given is the limit inside.
            _ => [sine(class, 2), sine(class, 1)],
        };
        Self { lambda: eigenvalue(angle).max(0.5), tangents: Some(tangents), spare }
    }

    /// A dart: the mode that is odd about its sharp edge is the smooth one, the even one has an angle of its own.
    fn dart(class: RingClass, sharp: usize) -> Self {
        let angle = TAU / f64::from(class.faces);
        let odd = mode(class, angle, |i| ((i as f64 - sharp as f64) * angle).sin());
        let (lambda, even) = even_dart(class, sharp);
        Self { lambda: eigenvalue(angle).max(lambda), tangents: Some([even, odd]), spare: None }
    }
}

/// Eigenvalue and left eigenvector of a dart's largest mode that is even about its sharp edge.
///
/// Away from the sharp edge it is a wave of angle phi, lambda = mode(phi), over a constant that the vertex rule asks for;
/// the sharp edge's own weight follows from its column. phi is where the vector is orthogonal to the constants, as
/// every left vector of an eigenvalue other than 1 is: docs/LIMIT.md, section 5.
fn even_dart(class: RingClass, sharp: usize) -> (f64, Vec<f64>) {
    let n = usize::from(class.faces);
    if n == 4 {
        // Here lambda is 1/2, the sharp edge's own eigenvalue, and the wave's formula has a pole.
        let wheel = |table: [f64; 4], i: usize| table[(i + 4 - sharp) % 4];
        let mut weights = ring(class, |i| wheel([28.0, -8.0, -16.0, -8.0], i), |i| wheel([-1.0, -5.0, -5.0, -1.0], i));
        weights[0] = 16.0;
        return (0.5, weights);
    }
    let valence = n as f64;
    let vector = |phi: f64| {
        let lambda = eigenvalue(phi);
        let constant = (6.0 * lambda - 1.0) / (4.0 * valence * valence * (lambda * lambda - 0.75 * lambda + 0.0625));
        let height = -constant / (phi * valence / 2.0).cos();
        let place = |i: usize| (i + n - sharp) % n;
        let spoke = |i: usize| match place(i) {
            0 => 0.0,
            i => constant + height * (phi * (i as f64 - valence / 2.0)).cos(),
        };
        let corner = |i: usize| ((spoke(i) + spoke(i + 1)) / 16.0 + 0.25 / (valence * valence)) / (lambda - 0.25);
        let mut weights = ring(class, spoke, corner);
        weights[0] = 1.0;
        let before = sharp + n - 1;
        let sides = (spoke(before) + spoke(sharp + 1)) / 16.0 + (corner(before) + corner(sharp)) / 4.0;
        weights[1 + sharp] = (sides + 1.5 / (valence * valence)) / (lambda - 0.5);
        // Pointing along the sharp edge, so that the odd mode lies to its left.
        let sign = weights[1 + sharp].signum();
        (lambda, weights.into_iter().map(|w| sign * w).collect::<Vec<f64>>())
    };
    let excess = |phi: f64| {
        let weights: Vec<f64> = vector(phi).1;
        weights.iter().sum::<f64>() * weights[0].signum()
    };
    // Between two poles of the sum (one where lambda is 1/2), so that its sign changes.
    let [mut low, mut high] =
        if n == 3 { [PI / 2.0, TAU / 3.0] } else { [TAU / valence, (1.5 * TAU / valence).min(PI / 2.0)] };
    let margin = 1e-9 * (high - low);
    let rising = excess(high - margin) > 0.0;
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
    use crate::stam::rows::Rows;

    fn class(faces: u16, closed: bool, tip: Tip, sharp_spoke: Option<u16>) -> RingClass {
        RingClass { triangles: false, faces, closed, index: 0, tip, sharp_spoke }
    }

    #[test]
    fn closed_forms_are_the_iterated_eigenvalues() {
        let smooth = (2..=20).map(|n| class(n, true, Tip::Smooth, None));
        let cones = (3..=8).map(|n| class(n, true, Tip::Corner, None));
        // Sectors of 1, 2 and 4 faces have equal or defective eigenvalues at 1/2 or below the largest: iteration is slow
        // there, not the formula wrong; the others converge.
        let sectors =
            [3, 5, 6, 7].into_iter().flat_map(|k| [Tip::Crease, Tip::Corner].map(|tip| class(k, false, tip, None)));
        let darts = (3..=12).map(|n| class(n, true, Tip::Smooth, Some(0)));
        for class in smooth.chain(cones).chain(sectors).chain(darts) {
            let table = ClassTable::new(class);
            let iterated = iterated_eigenvalue(&Rows::new(class).step(), &table.limit);
            assert!((iterated - table.lambda).abs() < 1e-12, "{class:?}: {iterated} against {}", table.lambda);
        }
    }

    /// A left vector is an eigenvector of `eigenvalue`.
    fn assert_left(class: RingClass, vector: &[f64], eigenvalue: f64) {
        let table = ClassTable::new(class);
        let next = deflated_step(vector, &Rows::new(class).step(), &table.limit, eigenvalue);
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
        for k in 3..=20 {
            let crease = class(k, false, Tip::Crease, None);
            let [second, first] = tangents(crease);
            assert_left(crease, &first, eigenvalue(PI / f64::from(k)));
            assert_left(crease, &second, if k <= 4 { 0.5 } else { eigenvalue(2.0 * PI / f64::from(k)) });
        }
        for n in (3..=20).chain([33, 64]) {
            let dart = class(n, true, Tip::Smooth, Some(n / 2));
            let [even, odd] = tangents(dart);
            assert_left(dart, &odd, eigenvalue(TAU / f64::from(n)));
            assert_left(dart, &even, even_dart(dart, usize::from(n / 2)).0);
        }
    }
}
