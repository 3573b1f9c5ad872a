//! The Gregory patch of OpenSubdiv's end caps.

use crate::stam::Jet;
use glam::DVec3;

/// Where the 12 points of the border stand among a patch's 20, and in its Bezier net (u fastest).
const BORDER: [(usize, usize); 12] =
    [(0, 0), (1, 1), (7, 2), (5, 3), (2, 4), (6, 7), (16, 8), (12, 11), (15, 12), (17, 13), (11, 14), (10, 15)];

/// The Bezier points inside, a corner each, counter-clockwise from (0,0).
const INNER: [usize; 4] = [5, 6, 10, 9];

/// A bicubic Bezier patch whose four inner points depend on (u,v) (Loop, Schaefer, Ni & Castano 2009, "Approximating
/// subdivision surfaces with Gregory patches for hardware tessellation", sec. 3): each is a mean of two, f+ and f-, weighted by the
/// distances from the two edges of its corner.
#[derive(Debug, Clone, PartialEq)]
pub struct Gregory {
    /// Bezier net, u fastest, with f- inside.
    pub bezier: [DVec3; 16],
    /// f+ - f- at each corner.
    pub spread: [DVec3; 4],
}

/// The weights of f+ at the four corners: with a the parameter along the corner's first edge and b along its second, a / (a + b).
/// At the corner itself, where the point has no influence, 0.
pub fn weights([u, v]: [f64; 2]) -> [f64; 4] {
    let (s, t) = (1.0 - u, 1.0 - v);
    [(u, v), (v, s), (s, t), (t, u)].map(|(a, b)| if a + b > 0.0 { a / (a + b) } else { 0.0 })
}

/// The four cubic Bernstein polynomials, and their derivatives.
fn bernstein(t: f64) -> ([f64; 4], [f64; 4]) {
    let s = 1.0 - t;
    (
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t],
    )
}

impl Gregory {
    /// From the 20 points in OpenSubdiv's order: for each corner counter-clockwise P, e+, e-, f+, f-.
    pub fn new(points: &[DVec3; 20]) -> Gregory {
        let mut bezier = [DVec3::ZERO; 16];
        for (from, to) in BORDER {
            bezier[to] = points[from];
        }
        for (corner, to) in INNER.into_iter().enumerate() {
            bezier[to] = points[5 * corner + 4];
        }
        Gregory { bezier, spread: std::array::from_fn(|corner| points[5 * corner + 3] - points[5 * corner + 4]) }
    }

    /// The patch as an affine map sees it; `linear` is the map's linear part.
    pub fn mapped(&self, map: impl Fn(DVec3) -> DVec3, linear: impl Fn(DVec3) -> DVec3) -> Gregory {
        Gregory { bezier: self.bezier.map(map), spread: self.spread.map(linear) }
    }

    /// Points whose hull holds the surface.
    pub fn hull(&self) -> impl Iterator<Item = DVec3> + Clone {
        let others = INNER.iter().zip(&self.spread).map(|(&k, &spread)| self.bezier[k] + spread);
        self.bezier.iter().copied().chain(others)
    }

    /// The Bezier net at (u,v).
    fn net(&self, uv: [f64; 2]) -> [DVec3; 16] {
        let mut net = self.bezier;
        for ((k, w), spread) in INNER.into_iter().zip(weights(uv)).zip(self.spread) {
            net[k] += w * spread;
        }
        net
    }

    /// Position at (u,v), each 0 to 1.
    pub fn position(&self, uv: [f64; 2]) -> DVec3 {
        let [(u, _), (v, _)] = uv.map(bernstein);
        let net = self.net(uv);
        (0..4).map(|j| v[j] * (0..4).map(|i| u[i] * net[4 * j + i]).sum::<DVec3>()).sum()
    }

    /// Position, derivatives and normal as OpenSubdiv evaluates them, on CPU and GPU: the derivatives are those of the Bezier net
    /// at (u,v), which is held still.
    pub fn evaluate(&self, uv: [f64; 2]) -> Jet {
        let [(u, du), (v, dv)] = uv.map(bernstein);
        let net = self.net(uv);
        let sum = |u: &[f64; 4], v: &[f64; 4]| -> DVec3 {
            (0..4).map(|j| v[j] * (0..4).map(|i| u[i] * net[4 * j + i]).sum::<DVec3>()).sum()
        };
        Jet::new(sum(&u, &v), sum(&du, &v), sum(&u, &dv))
    }
}
