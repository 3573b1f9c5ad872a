//! Parameters of triangles: a triangle has the corners (0,0), (1,0), (0,1); its quarters are the three at its corners and the
//! one in the middle, turned by half a turn, which lies at the far corner of its cell (as in `Far::PatchParam`).

use super::{Patch, Shape};

/// Parameters in the frame whose (0,0) is the triangle's corner `rotation`.
fn turn_in(rotation: u8, [u, v]: [f64; 2]) -> [f64; 2] {
    match rotation {
        0 => [u, v],
        1 => [v, 1.0 - u - v],
        _ => [1.0 - u - v, u],
    }
}

/// Into the triangle, whatever rounding did.
fn inside([u, v]: [f64; 2]) -> [f64; 2] {
    let u = u.clamp(0.0, 1.0);
    [u, v.clamp(0.0, 1.0 - u)]
}

/// The quarter that holds a point of a triangle, by its number among the children, and the parameters there.
pub(super) fn quarter([u, v]: [f64; 2]) -> (usize, [f64; 2]) {
    if u >= 0.5 {
        (1, [2.0 * u - 1.0, 2.0 * v])
    } else if v >= 0.5 {
        (2, [2.0 * u, 2.0 * v - 1.0])
    } else if u + v <= 0.5 {
        (0, [2.0 * u, 2.0 * v])
    } else {
        (3, [1.0 - 2.0 * u, 1.0 - 2.0 * v])
    }
}

impl Patch {
    pub(super) fn in_triangle(&self, uv: [f64; 2]) -> [f64; 2] {
        let place: [f64; 2] = std::array::from_fn(|k| uv[k] * self.scale()[k] - f64::from(self.origin[k]));
        let place = if self.shape == Shape::TurnedTriangle { place.map(|x| 1.0 - x) } else { place };
        inside(turn_in(self.rotation, place))
    }

    pub(super) fn of_triangle(&self, uv: [f64; 2]) -> [f64; 2] {
        // Turning in by the rest of a whole turn turns out.
        let place = turn_in((3 - self.rotation) % 3, uv);
        let place = if self.shape == Shape::TurnedTriangle { place.map(|x| 1.0 - x) } else { place };
        std::array::from_fn(|k| (place[k] + f64::from(self.origin[k])) / self.scale()[k])
    }

    /// Derivatives of the local parameters (s,t) by those of the ptex face: [[ds/du, dt/du], [ds/dv, dt/dv]].
    pub fn local_by_ptex(&self) -> [[f64; 2]; 2] {
        let turned = if self.shape == Shape::TurnedTriangle { -1.0 } else { 1.0 };
        let by_place = match (self.shape, self.rotation) {
            (Shape::Square, 0) | (Shape::Triangle | Shape::TurnedTriangle, 0) => [[1.0, 0.0], [0.0, 1.0]],
            (Shape::Square, 1) => [[0.0, -1.0], [1.0, 0.0]],
            (Shape::Square, 2) => [[-1.0, 0.0], [0.0, -1.0]],
            (Shape::Square, _) => [[0.0, 1.0], [-1.0, 0.0]],
            (_, 1) => [[0.0, -1.0], [1.0, -1.0]],
            (_, _) => [[-1.0, 1.0], [-1.0, 0.0]],
        };
        std::array::from_fn(|k| by_place[k].map(|x| turned * x * self.scale()[k]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::PatchKind;

    #[test]
    fn parameters_go_there_and_back() {
        for shape in [Shape::Triangle, Shape::TurnedTriangle] {
            for rotation in 0..3 {
                let patch = Patch {
                    ptex: 0,
                    shape,
                    depth: [3; 2],
                    quadrant: false,
                    origin: [2, 3],
                    rotation,
                    kind: PatchKind::Regular,
                    transition: 0,
                };
                let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|local| patch.to_ptex(local));
                for (k, corner) in corners.into_iter().enumerate() {
                    assert_eq!(patch.to_local(corner), [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]][k]);
                }
                // Counter-clockwise, an eighth of a side.
                let [a, b, c] = corners;
                assert_eq!((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]), 1.0 / 64.0);
                for local in [[0.25, 0.5], [0.125, 0.0], [0.5, 0.5]] {
                    assert_eq!(patch.to_local(patch.to_ptex(local)), local);
                }
                let by = patch.local_by_ptex();
                let step = [1.0 / 1024.0, 1.0 / 2048.0];
                let at = patch.to_ptex([0.25, 0.25]);
                let moved = patch.to_local([at[0] + step[0], at[1] + step[1]]);
                for k in 0..2 {
                    assert_eq!(moved[k] - 0.25, step[0] * by[0][k] + step[1] * by[1][k]);
                }
            }
        }
    }

    #[test]
    fn quarters_cover_the_triangle() {
        for [i, j] in (0..=16).flat_map(|i| (0..=16 - i).map(move |j| [i, j])) {
            let uv = [i, j].map(|k| f64::from(k) / 16.0);
            let (child, [s, t]) = quarter(uv);
            assert!(s >= 0.0 && t >= 0.0 && s + t <= 1.0, "{uv:?} {child}");
        }
    }
}
