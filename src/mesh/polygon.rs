//! Shape of a single polygon.

use glam::DVec3;

/// Part of the squared perimeter that a turn may be off: beyond it a corner is a reflex one. Not derived: coordinates in f32
/// move a straight corner by 1e-7.
const TURN: f64 = 1e-6;

/// Whether a face is convex and goes round once, as seen along its mean normal. Then it is covered exactly by the quads
/// between its corners, the middles of its edges and the mean of its corners.
pub(super) fn is_convex(face: &[u32], points: &[DVec3]) -> bool {
    let size = face.len();
    let corner = |k: usize| points[face[k % size] as usize];
    let mean = (0..size).map(corner).sum::<DVec3>() / size as f64;
    let area = |k: usize| (corner(k) - mean).cross(corner(k + 1) - mean);
    // Newell's normal.
    let Some(normal) = (0..size).map(area).sum::<DVec3>().try_normalize() else { return true };
    let perimeter: f64 = (0..size).map(|k| corner(k).distance(corner(k + 1))).sum();
    let slack = -TURN * perimeter * perimeter;
    let turn = |k: usize| (corner(k + 1) - corner(k)).cross(corner(k + 2) - corner(k + 1)).dot(normal);
    let angle = |k: usize| {
        let (a, b) = (corner(k) - mean, corner(k + 1) - mean);
        a.cross(b).dot(normal).atan2(a.dot(b))
    };
    (0..size).all(|k| turn(k) >= slack) && (0..size).map(angle).sum::<f64>() < 1.5 * std::f64::consts::TAU
}

#[cfg(test)]
mod tests {
    use super::*;

    fn convex(outline: &[[f64; 2]]) -> bool {
        let points: Vec<DVec3> = outline.iter().map(|&[x, y]| DVec3::new(x, y, 1.0 + x - 2.0 * y)).collect();
        let face: Vec<u32> = (0..points.len() as u32).collect();
        let turned: Vec<u32> = face.iter().rev().copied().collect();
        assert_eq!(is_convex(&face, &points), is_convex(&turned, &points));
        is_convex(&face, &points)
    }

    #[test]
    fn reflex_corners_and_stars_are_not_convex() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!(convex(&square));
        let mut more = square.to_vec();
        more.insert(1, [0.5, 0.0]);
        assert!(convex(&more), "a straight corner");
        more[1] = [0.5, 0.1];
        assert!(!convex(&more), "a reflex corner");
        more[1] = [0.5, 1e-3];
        assert!(!convex(&more), "a slightly reflex corner");
        let star: Vec<[f64; 2]> =
            (0..5).map(|k| (f64::from(k) * 0.8 * std::f64::consts::PI).sin_cos().into()).collect();
        assert!(!convex(&star), "a pentagram turns left at every corner, twice round");
        assert!(!convex(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.2]]), "a bow tie");
        assert!(convex(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]), "no area");
    }
}
