//! Concave faces under the scheme `none`, which covers polygons as they are: they are cut into convex pieces, which cover them exactly.
//!
//! Ears are cut off until a triangle is left (Meisters 1975), and triangles are joined again while they stay convex (Hertel & Mehlhorn 1983).
//! A face that is not in a plane is cut as it looks along its mean normal.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::polygon;
use super::{Scheme, SubdivMesh};

/// Part of the squared size below which an area counts as none: rounding of a product of two differences, with room.
const NO_AREA: f64 = 1e-12;

/// What [`SubdivMesh::cut_concave_faces`] did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CutFaces {
    /// Number of faces that were cut, and the first of them, counted as before.
    pub cut: Option<(usize, usize)>,
    /// Number of faces that cross themselves, and the first of them. They stay as they are, and are covered by the quads between
    /// their corners, the middles of their edges and the mean of their corners, as under [`Scheme::Bilinear`].
    pub crossing: Option<(usize, usize)>,
}

/// How a face is covered.
enum Cover {
    /// By the quads between its corners, the middles of its edges and its mean.
    Convex,
    /// By that of its pieces.
    Pieces(Vec<Vec<u32>>),
    /// Not exactly.
    Crossing,
}

impl SubdivMesh {
    /// Cuts the concave faces of a mesh of the scheme [`None`](Scheme::None) into convex pieces, in the place of the face; indices of holes
    /// and bad faces follow. A mesh of another scheme stays as it is.
    pub fn cut_concave_faces(&mut self) -> CutFaces {
        self.cut_concave_faces_with(|_, _| {})
    }

    /// As [`cut_concave_faces`](Self::cut_concave_faces); `moved` hears of the pieces of each face that is cut: how many faces of the mesh come
    /// before it now, and how many pieces it has.
    pub(super) fn cut_concave_faces_with(&mut self, mut moved: impl FnMut(usize, usize)) -> CutFaces {
        let mut told = CutFaces::default();
        if self.scheme != Scheme::None {
            return told;
        }
        let covers: Vec<(usize, Vec<Vec<u32>>)> = self
            .good_faces()
            .filter_map(|(index, face)| match cover(face, &self.points) {
                Cover::Convex => None,
                Cover::Pieces(pieces) => {
                    told.cut = Some(told.cut.map_or((1, index), |(count, first)| (count + 1, first)));
                    Some((index, pieces))
                }
                Cover::Crossing => {
                    told.crossing = Some(told.crossing.map_or((1, index), |(count, first)| (count + 1, first)));
                    None
                }
            })
            .collect();
        if covers.is_empty() {
            return told;
        }
        let sizes = std::mem::take(&mut self.face_sizes);
        let vertices = std::mem::take(&mut self.face_vertices);
        let mut first_of = Vec::with_capacity(sizes.len() + 1);
        let mut covers = covers.into_iter().peekable();
        let mut rest = vertices.as_slice();
        for (index, &size) in sizes.iter().enumerate() {
            let (face, more) = rest.split_at(size as usize);
            rest = more;
            first_of.push(self.face_sizes.len() as u32);
            match covers.next_if(|(cut, _)| *cut == index) {
                Some((_, pieces)) => {
                    moved(self.face_sizes.len(), pieces.len());
                    self.face_sizes.extend(pieces.iter().map(|piece| piece.len() as u32));
                    self.face_vertices.extend(pieces.concat());
                }
                None => {
                    self.face_sizes.push(size);
                    self.face_vertices.extend(face);
                }
            }
        }
        first_of.push(self.face_sizes.len() as u32);
        let holes = std::mem::take(&mut self.holes);
        for hole in holes {
            let hole = hole as usize;
            match (first_of.get(hole), first_of.get(hole + 1)) {
                (Some(&first), Some(&end)) => self.holes.extend(first..end),
                // One that is out of range stays so.
                _ => self.holes.push(u32::MAX),
            }
        }
        self.bad_faces.iter_mut().for_each(|bad| bad.face = first_of[bad.face as usize]);
        told
    }

    /// The first face that has to be cut under the scheme [`None`](Scheme::None).
    pub(super) fn first_concave_face(&self) -> Option<usize> {
        self.good_faces()
            .find(|(_, face)| matches!(cover(face, &self.points), Cover::Pieces(_)))
            .map(|(index, _)| index)
    }
}

impl CutFaces {
    /// What to tell of faces: `of` says whose face a number is.
    pub(super) fn notes(self, of: impl Fn(usize) -> String) -> Vec<String> {
        let faces = |(count, first): (usize, usize)| match count {
            1 => of(first),
            _ => format!("{count} faces (the first is {})", of(first)),
        };
        let cut = self.cut.map(|found| {
            format!("concave under the scheme none, and cut into convex pieces, which count as faces: {}", faces(found))
        });
        let crossing = self.crossing.map(|found| {
            format!(
                "crossing themselves under the scheme none, and covered as by the scheme bilinear: {}",
                faces(found)
            )
        });
        cut.into_iter().chain(crossing).collect()
    }
}

fn cover(face: &[u32], points: &[DVec3]) -> Cover {
    // What is no face is refused by others.
    let corners: Option<Vec<DVec3>> = face.iter().map(|&vertex| points.get(vertex as usize).copied()).collect();
    let Some(corners) = corners.filter(|corners| corners.len() > 3 && corners.iter().all(|p| p.is_finite())) else {
        return Cover::Convex;
    };
    let Some(outline) = projected(&corners) else {
        // The parts of a bow tie may cancel each other out; what is a line has nothing to cover.
        return if is_line(&corners) { Cover::Convex } else { Cover::Crossing };
    };
    if polygon::is_convex(face, points) {
        return Cover::Convex;
    }
    if crosses(&outline) {
        return Cover::Crossing;
    }
    let Some(triangles) = ears(&outline) else { return Cover::Crossing };
    let is_convex = |piece: &[usize]| {
        let piece: Vec<u32> = piece.iter().map(|&corner| face[corner]).collect();
        polygon::is_convex(&piece, points)
    };
    let pieces = joined(triangles, face.len(), is_convex);
    Cover::Pieces(pieces.into_iter().map(|piece| piece.into_iter().map(|corner| face[corner]).collect()).collect())
}

/// Whether all corners lie on one line, or at one point.
fn is_line(corners: &[DVec3]) -> bool {
    let away = |corner: &DVec3| *corner - corners[0];
    let longest = corners.iter().map(away).fold(DVec3::ZERO, |a, b| if b.length() > a.length() { b } else { a });
    corners.iter().map(away).all(|side| longest.cross(side).length() <= NO_AREA * longest.length_squared())
}

/// The outline as seen along its mean normal, counter-clockwise and of size 1; `None` where it has no area.
fn projected(corners: &[DVec3]) -> Option<Vec<DVec2>> {
    let mean = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let size = corners.iter().map(|corner| corner.distance(mean)).fold(0.0, f64::max);
    let around: Vec<DVec3> = corners.iter().map(|corner| (corner - mean) / size).collect();
    let area = |k: usize| around[k].cross(around[(k + 1) % around.len()]);
    let normal = (0..around.len()).map(area).sum::<DVec3>();
    let normal = (normal.length() > NO_AREA).then(|| normal.normalize())?;
    let (x, y) = normal.any_orthonormal_pair();
    // The pair and the normal are right-handed, or the outline would be turned over.
    let y = if x.cross(y).dot(normal) < 0.0 { -y } else { y };
    Some(around.into_iter().map(|corner| DVec2::new(corner.dot(x), corner.dot(y))).collect())
}

/// Twice the area of a triangle, positive where it turns left.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Whether two edges cross, each strictly inside of the other. Edges are sorted by their left ends, so that few pairs are looked at.
fn crosses(outline: &[DVec2]) -> bool {
    let count = outline.len();
    let ends = |k: usize| (outline[k], outline[(k + 1) % count]);
    let left = |k: usize| ends(k).0.x.min(ends(k).1.x);
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&i, &j| left(i).total_cmp(&left(j)));
    let mut open: Vec<usize> = Vec::new();
    for k in order {
        let (a, b) = ends(k);
        open.retain(|&other| ends(other).0.x.max(ends(other).1.x) >= left(k));
        let apart = |s: f64, t: f64| (s > NO_AREA && t < -NO_AREA) || (s < -NO_AREA && t > NO_AREA);
        let does_cross = |&other: &usize| {
            let (c, d) = ends(other);
            apart(turn(a, b, c), turn(a, b, d)) && apart(turn(c, d, a), turn(c, d, b))
        };
        if open.iter().any(does_cross) {
            return true;
        }
        open.push(k);
    }
    false
}

/// Triangles that cover an outline, by their corners; `None` where no ear can be cut off.
fn ears(outline: &[DVec2]) -> Option<Vec<[usize; 3]>> {
    let count = outline.len();
    let mut before: Vec<usize> = (0..count).map(|k| (k + count - 1) % count).collect();
    let mut after: Vec<usize> = (0..count).map(|k| (k + 1) % count).collect();
    let mut triangles = Vec::with_capacity(count - 2);
    let mut left = count;
    let mut tip = 0;
    let mut tried = 0;
    while left > 3 {
        let (a, c) = (before[tip], after[tip]);
        if is_ear(outline, [a, tip, c], &after) {
            triangles.push([a, tip, c]);
            (after[a], before[c]) = (c, a);
            left -= 1;
            tried = 0;
            // The next ear somewhere else: fans have thin triangles.
            tip = after[c];
        } else {
            tried += 1;
            if tried > left {
                return None;
            }
            tip = c;
        }
    }
    let last = [before[tip], tip, after[tip]];
    let [a, b, c] = last.map(|corner| outline[corner]);
    (turn(a, b, c) > NO_AREA).then(|| {
        triangles.push(last);
        triangles
    })
}

/// Whether a triangle has area and no other corner of what is left of the outline lies in it.
fn is_ear(outline: &[DVec2], [a, tip, c]: [usize; 3], after: &[usize]) -> bool {
    let [p, q, r] = [a, tip, c].map(|corner| outline[corner]);
    if turn(p, q, r) <= NO_AREA {
        return false;
    }
    let mut other = after[c];
    while other != a {
        let s = outline[other];
        let is_inside = turn(p, q, s) >= -NO_AREA && turn(q, r, s) >= -NO_AREA && turn(r, p, s) >= -NO_AREA;
        if is_inside && s != p && s != q && s != r {
            return false;
        }
        other = after[other];
    }
    true
}

/// Triangles as larger convex pieces: the cuts between them are taken away one by one while what is joined stays convex.
fn joined(triangles: Vec<[usize; 3]>, corners: usize, is_convex: impl Fn(&[usize]) -> bool) -> Vec<Vec<usize>> {
    let mut pieces: Vec<Vec<usize>> = triangles.into_iter().map(Vec::from).collect();
    // The piece to the left of each cut.
    let mut left: HashMap<[usize; 2], usize> = HashMap::new();
    let mut cuts = Vec::new();
    for (index, piece) in pieces.iter().enumerate() {
        for k in 0..3 {
            let edge = [piece[k], piece[(k + 1) % 3]];
            if (edge[0] + 1) % corners != edge[1] {
                left.insert(edge, index);
                if edge[0] < edge[1] {
                    cuts.push(edge);
                }
            }
        }
    }
    for [a, b] in cuts {
        let (Some(&one), Some(&other)) = (left.get(&[a, b]), left.get(&[b, a])) else { continue };
        let from = |piece: &[usize], start: usize| {
            let turned = piece.iter().position(|&corner| corner == start).unwrap_or(0);
            [&piece[turned..], &piece[..turned]].concat()
        };
        // b ... a of the one, then what lies between a and b of the other.
        let (first, second) = (from(&pieces[one], b), from(&pieces[other], a));
        let whole = [&first[..], &second[1..second.len() - 1]].concat();
        if is_convex(&whole) {
            for k in 0..whole.len() {
                let edge = [whole[k], whole[(k + 1) % whole.len()]];
                if let Some(piece) = left.get_mut(&edge) {
                    *piece = one;
                }
            }
            pieces[one] = whole;
            pieces[other].clear();
        }
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mesh of one face in a tilted plane.
    fn face(outline: &[[f64; 2]]) -> SubdivMesh {
        SubdivMesh {
            points: outline.iter().map(|&[x, y]| DVec3::new(x, y, 1.0 + x - 2.0 * y)).collect(),
            face_sizes: vec![outline.len() as u32],
            face_vertices: (0..outline.len() as u32).collect(),
            holes: vec![0],
            scheme: Scheme::None,
            ..SubdivMesh::default()
        }
    }

    fn area(face: &[u32], points: &[DVec3]) -> DVec3 {
        let corner = |k: usize| points[face[k % face.len()] as usize];
        (0..face.len()).map(|k| corner(k).cross(corner(k + 1))).sum::<DVec3>() / 2.0
    }

    /// Asserts that all pieces are convex, that their areas are that of the whole, and how many there are.
    fn assert_cut(outline: &[[f64; 2]], pieces: usize) {
        for turned in [false, true] {
            let mut whole = face(outline);
            if turned {
                whole.face_vertices.reverse();
            }
            let mut cut = whole.clone();
            assert_eq!(cut.cut_concave_faces(), CutFaces { cut: Some((1, 0)), crossing: None });
            let parts: Vec<DVec3> = cut.faces().map(|(_, face)| area(face, &cut.points)).collect();
            let total = area(&whole.face_vertices, &whole.points);
            let sum = parts.iter().sum::<DVec3>();
            assert!(sum.distance(total) <= 1e-12 * total.length(), "{sum} {total}");
            assert!(parts.iter().all(|part| part.dot(total) > 0.0));
            assert!(cut.faces().all(|(_, face)| polygon::is_convex(face, &cut.points)));
            assert!(cut.face_count() <= pieces, "{} pieces", cut.face_count());
            assert_eq!(cut.holes, (0..cut.face_count() as u32).collect::<Vec<_>>());
            assert_eq!(cut.first_concave_face(), None);
        }
    }

    #[test]
    fn concave_faces_are_covered_by_convex_pieces() {
        assert_cut(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]], 3);
        assert_cut(&[[0.0, 0.0], [1.0, 0.0], [0.3, 0.3], [0.0, 1.0]], 2);
        // Corners on a line, also with a cut.
        assert_cut(
            &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [1.0, 1.0], [0.5, 1.0], [0.0, 1.0]],
            4,
        );
        let star: Vec<[f64; 2]> = (0..200)
            .map(|k| {
                let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 200.0).sin_cos();
                let radius = if k % 2 == 0 { 2.0 } else { 1.0 };
                [radius * cos, radius * sin]
            })
            .collect();
        assert_cut(&star, 101);
        let comb: Vec<[f64; 2]> = (0..40).map(|k| [f64::from(k), if k % 2 == 0 { 0.0 } else { 5.0 }]).collect();
        assert_cut(&[&comb[..], &[[39.0, -1.0], [0.0, -1.0]]].concat().into_iter().rev().collect::<Vec<_>>(), 40);
    }

    #[test]
    fn faces_that_cross_themselves_stay() {
        let star: Vec<[f64; 2]> =
            (0..5).map(|k| (f64::from(k) * 0.8 * std::f64::consts::PI).sin_cos().into()).collect();
        let ties = [1.0, 1.2].map(|height| [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, height]]);
        for outline in [&star[..], &ties[0], &ties[1]] {
            let mut mesh = face(outline);
            assert_eq!(mesh.cut_concave_faces(), CutFaces { cut: None, crossing: Some((1, 0)) });
            assert_eq!(mesh, face(outline));
        }
        assert_eq!(face(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]).cut_concave_faces(), CutFaces::default());
    }
}
