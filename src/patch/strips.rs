//! Strips along a semi-sharp crease.
//!
//! # Theory
//! Niessner, Loop & Greiner 2012 (semi-smooth creases): where the only feature of a regular face is one crease edge of
//! constant sharpness, the subdivision rules are a tensor product. Along the crease they are those of the uniform cubic
//! B-spline at every level, so nothing need be split; across it they act on rows of control points, and only the row
//! on the crease knows of the sharpness. So the face is a stack of B-spline patches of full width: after each level, the
//! half that does not touch the crease any more, and what is left when the sharpness is used up.
//!
//! # Practice
//! [`stack`] gives, for a sharpness, the rows of each strip's net over the four rows of the face's own net.

use super::RowWeights;

/// Weights of the rows -1, 0, 1, 2 of the face; row 0 lies on the crease, row 1 on the opposite edge.
type Row = [f64; 4];

fn mix(terms: &[(f64, Row)]) -> Row {
    std::array::from_fn(|k| terms.iter().map(|(factor, row)| factor * row[k]).sum())
}

/// Nets of the strips of a face whose crease has `sharpness` > 0: strip i spans v in [2^-(i+1), 2^-i], the last one
/// [0, 2^-i]. There are ceil(sharpness) + 1.
pub(super) fn stack(sharpness: f32) -> Vec<RowWeights> {
    let mut rows: [Row; 4] = std::array::from_fn(|i| std::array::from_fn(|k| f64::from(u8::from(i == k))));
    let mut strips = Vec::new();
    let mut left = f64::from(sharpness);
    while left > 0.0 {
        let [below, crease, first, second] = rows;
        let middle = |a: Row, b: Row| mix(&[(0.5, a), (0.5, b)]);
        let vertex = |a: Row, b: Row, c: Row| mix(&[(0.125, a), (0.75, b), (0.125, c)]);
        // In the last level, of sharpness below 1, OpenSubdiv blends the crease rule with the smooth one.
        let sharp = left.min(1.0);
        let on_crease = mix(&[(sharp, crease), (1.0 - sharp, vertex(below, crease, first))]);
        rows = [middle(below, crease), on_crease, middle(crease, first), vertex(crease, first, second)];
        strips.push([rows[1], rows[2], rows[3], middle(first, second)]);
        left -= 1.0;
    }
    strips.push(rows);
    strips
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sharpness 0 in the limit: the strips are the smooth patch itself, cut.
    #[test]
    fn vanishing_sharpness_is_knot_insertion() {
        let strips = stack(1e-30);
        assert_eq!(strips.len(), 2);
        // Rows of the lower half by the subdivision of a uniform cubic B-spline.
        assert_eq!(
            strips[1],
            [[0.5, 0.5, 0.0, 0.0], [0.125, 0.75, 0.125, 0.0], [0.0, 0.5, 0.5, 0.0], [0.0, 0.125, 0.75, 0.125]]
        );
    }

    #[test]
    fn rows_are_affine_combinations() {
        for sharpness in [0.3, 1.0, 2.5, 9.9] {
            let strips = stack(sharpness);
            assert_eq!(strips.len(), sharpness.ceil() as usize + 1);
            for row in strips.iter().flatten() {
                assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            }
        }
    }
}
