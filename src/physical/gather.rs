//! What patches found, put together: points on shared edges once, undecided pieces as one degenerate point each cluster.

use super::ends::Ends;
use super::piece::eigenvectors;
use super::search::{Findings, Unclear};
use super::{Nature, PathPoint};
use crate::curves::Place;
use crate::stam::LimitSurface;
use glam::{DMat2, DVec2, DVec3};
use std::collections::HashMap;

/// Part of the surface's diagonal within which two findings are the same point, rounding of their positions aside.
const SAME: f64 = 1e-9;

/// The same for an extraordinary vertex beside a point: near the vertex the pull may turn slowly, so that at both it is normal to
/// [`NORMAL`].
const SAME_AS_VERTEX: f64 = 1e-6;

/// Tangential part of the pull up to which a vertex counts as stationary.
const NORMAL: f64 = 1e-9;

/// The same for what pieces found or, as small as pieces get, have left.
const NORMAL_IN_PIECE: f64 = 1e-6;

/// A point on its way into the answer.
struct Candidate {
    point: PathPoint,
    error: f64,
}

/// All points of a surface, in the order of their patches.
pub(super) fn gather(surface: &LimitSurface, ends: &Ends, findings: &[Findings]) -> Vec<PathPoint> {
    let at = |patch: usize, uv: [f64; 2], nature: Nature| point(surface, ends, patch, uv, nature);
    let mut kept: Vec<Candidate> = Vec::new();
    for (patch, found) in findings.iter().enumerate() {
        for zero in &found.zeros {
            let nature = if zero.is_saddle { Nature::Saddle } else { Nature::Extremum };
            let point = at(patch, zero.uv, nature);
            // Where a patch folds, its derivatives are parallel and the gradient may vanish though the pull is not normal.
            if point.residual <= NORMAL_IN_PIECE {
                kept.push(Candidate { point, error: zero.error });
            }
        }
    }
    let same = SAME * surface.diagonal();
    once(&mut kept, same);

    let beside = |kept: &[Candidate], point: &PathPoint, reach: f64| {
        kept.iter().any(|other| other.point.position.distance(point.position) <= reach + other.error)
    };
    for (patch, _) in findings.iter().enumerate().filter(|(_, found)| found.has_tip) {
        let vertex = at(patch, [0.0; 2], Nature::Vertex);
        if vertex.residual <= NORMAL && !beside(&kept, &vertex, SAME_AS_VERTEX * surface.diagonal()) {
            kept.push(Candidate { point: vertex, error: 0.0 });
        }
    }

    let unclear: Vec<Unclear> = findings.iter().flat_map(|found| found.unclear.iter().copied()).collect();
    for cluster in clusters(&unclear) {
        let bounds = cluster.iter().map(|&i| unclear[i].bounds);
        let [low, high] = bounds.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or_default();
        let extent = low.distance(high);
        let middle = |i: usize| at(unclear[i].patch, unclear[i].uv, Nature::Degenerate { extent });
        let points = cluster.iter().map(|&i| (i, middle(i)));
        let Some((best, _)) = points.min_by(|a, b| a.1.residual.total_cmp(&b.1.residual)) else { continue };
        let uv = improved(surface, ends, &unclear[best]);
        let point = at(unclear[best].patch, uv, Nature::Degenerate { extent });
        let is_resolved = cluster.iter().all(|&i| unclear[i].is_smallest);
        // Written so that NaN, at an end of the path, is none.
        // What a neighbour made out, though this side could not.
        let known = extent <= SAME_AS_VERTEX * surface.diagonal() && beside(&kept, &point, same + extent);
        let is_one = point.residual <= NORMAL_IN_PIECE || (!is_resolved && point.residual.is_finite());
        if is_one && !known {
            kept.push(Candidate { point, error: extent });
        }
    }
    let mut points: Vec<PathPoint> = kept.into_iter().map(|candidate| candidate.point).collect();
    let key = |point: &PathPoint| (point.place.face, point.place.u, point.place.v);
    points.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
    points
}

/// The point at a patch's (u,v).
fn point(surface: &LimitSurface, ends: &Ends, patch: usize, uv: [f64; 2], nature: Nature) -> PathPoint {
    let jet = surface.evaluate(patch, uv);
    let [to_light, to_eye] = ends.0.map(|end| end.from(jet.position));
    let cosines = [to_light, to_eye].map(|d| d.dot(jet.normal));
    let pull = to_light + to_eye;
    let mirrors = cosines[0] * cosines[1] > 0.0;
    // h of eq. 3.1; where the path goes through the surface, its tangential part, which is what vanishes.
    let residual = match mirrors {
        true => (pull - 2.0 * cosines[1] * jet.normal).length(),
        false => (pull - pull.dot(jet.normal) * jet.normal).length(),
    };
    let at_end = to_light == DVec3::ZERO || to_eye == DVec3::ZERO;
    let cell = &surface.patches()[patch];
    let [u, v] = cell.to_ptex(uv);
    PathPoint {
        place: Place { face: cell.ptex, u, v },
        patch,
        uv,
        position: jet.position,
        normal: jet.normal,
        mirrors,
        residual: if at_end { f64::NAN } else { residual },
        nature,
    }
}

/// Leaves the first of the candidates that are the same point.
fn once(candidates: &mut Vec<Candidate>, same: f64) {
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    let x = |i: usize| candidates[i].point.position.x;
    order.sort_by(|&a, &b| x(a).total_cmp(&x(b)));
    let reach = same + 2.0 * candidates.iter().map(|candidate| candidate.error).fold(0.0, f64::max);
    let mut is_kept = vec![true; candidates.len()];
    for (k, &i) in order.iter().enumerate() {
        for &j in order[k + 1..].iter().take_while(|&&j| x(j) - x(i) <= reach) {
            let [a, b] = [i, j].map(|i| &candidates[i]);
            if a.point.position.distance(b.point.position) <= same + a.error + b.error {
                is_kept[i.max(j)] = false;
            }
        }
    }
    let mut kept = is_kept.into_iter();
    candidates.retain(|_| kept.next() == Some(true));
}

/// Undecided pieces that touch, by index. Pieces are sorted into cells of the size of the largest one, so those that touch lie in
/// neighbouring cells; some that nearly touch do so too.
fn clusters(pieces: &[Unclear]) -> Vec<Vec<usize>> {
    let sides = pieces.iter().map(|piece| (piece.bounds[1] - piece.bounds[0]).max_element());
    let size = sides.fold(f64::MIN_POSITIVE, f64::max);
    let cell =
        |piece: &Unclear| ((piece.bounds[0] + piece.bounds[1]) * (0.5 / size)).floor().to_array().map(|x| x as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (i, piece) in pieces.iter().enumerate() {
        cells.entry(cell(piece)).or_default().push(i);
    }
    let mut clusters = Vec::new();
    for piece in pieces {
        let mut cluster = Vec::new();
        let mut waiting = vec![cell(piece)];
        while let Some([x, y, z]) = waiting.pop() {
            let Some(inside) = cells.remove(&[x, y, z]) else { continue };
            cluster.extend(inside);
            let steps = (0..27).map(|k| [k % 3, k / 3 % 3, k / 9].map(|step: i64| step - 1));
            waiting.extend(steps.map(|[a, b, c]| [x.wrapping_add(a), y.wrapping_add(b), z.wrapping_add(c)]));
        }
        if !cluster.is_empty() {
            cluster.sort_unstable();
            clusters.push(cluster);
        }
    }
    clusters
}

/// Parameters nearer to a stationary point than the middle of an undecided piece: Newton's method along the directions in which the
/// path's length is curved.
fn improved(surface: &LimitSurface, ends: &Ends, piece: &Unclear) -> [f64; 2] {
    /// Part of the larger curvature below which the smaller one is taken for none.
    const FLAT: f64 = 1e-6;
    const STEPS: usize = 10;
    let mut best = (f64::INFINITY, piece.uv);
    let mut uv = piece.uv;
    for _ in 0..STEPS {
        let jet = surface.evaluate_second(piece.patch, uv);
        let (position, [du, dv]) = (jet.first.position, [jet.first.du, jet.first.dv]);
        let (pull, bend) = (ends.pull(position), ends.bend(position));
        let residual = (pull - pull.dot(jet.first.normal) * jet.first.normal).length();
        if residual >= best.0 || residual.is_nan() {
            break;
        }
        best = (residual, uv);
        let gradient = DVec2::new(pull.dot(du), pull.dot(dv));
        let mixed = pull.dot(jet.duv) - du.dot(bend * dv);
        let diagonal = [pull.dot(jet.duu) - du.dot(bend * du), pull.dot(jet.dvv) - dv.dot(bend * dv)];
        let pairs = eigenvectors(&DMat2::from_cols_array(&[diagonal[0], mixed, mixed, diagonal[1]]));
        let largest = pairs[0].0.abs().max(pairs[1].0.abs());
        let curved = pairs.iter().filter(|(value, _)| value.abs() > FLAT * largest);
        let step: DVec2 = curved.map(|(value, e)| *e * (gradient.dot(*e) / value)).sum();
        uv = (DVec2::from_array(uv) - step).clamp(DVec2::ZERO, DVec2::ONE).to_array();
    }
    best.1
}
