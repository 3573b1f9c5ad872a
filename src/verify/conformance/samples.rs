//! The standard sample set: the same points for every evaluator of a mesh.

use crate::patch::{Patch, PatchKind};
use crate::stam::LimitSurface;
use crate::statistics::scatter;
use crate::verify::Sample;

/// Samples of each ptex face unless asked otherwise: the fixed points of the face, and some twenty each that are scattered over it and
/// over its patches.
pub const DEFAULT_PER_FACE: usize = 64;

/// Quarters of a face: corners, middles of its edges and of the face, then the other quarters along the edges, then those inside.
/// Dyadic, so that whoever refines reaches them too.
const QUARTERS: [[u8; 2]; 25] = [
    [0, 0],
    [4, 0],
    [4, 4],
    [0, 4],
    [2, 0],
    [4, 2],
    [2, 4],
    [0, 2],
    [2, 2],
    [1, 0],
    [3, 0],
    [4, 1],
    [4, 3],
    [3, 4],
    [1, 4],
    [0, 3],
    [0, 1],
    [1, 1],
    [3, 1],
    [3, 3],
    [1, 3],
    [2, 1],
    [3, 2],
    [2, 3],
    [1, 2],
];

/// Towards an extraordinary vertex, the larger parameter of the patch is about 2^-k: from the patch itself to where a 32-bit parameter
/// that was interpolated ends (24 bits).
const NEARER: [i32; 7] = [0, 1, 3, 6, 10, 15, 20];

/// The sample set of a surface: `per_face` points of every ptex face, holes included, where the right answer is none.
///
/// Each face has its quarters first, then in turn points scattered over the face and over its patches, those with an
/// extraordinary vertex and the deepest first. It depends on the surface alone, and a smaller set is the beginning of each
/// face of a larger one.
pub fn sample_set(surface: &LimitSurface, per_face: usize) -> impl Iterator<Item = Sample> {
    let mut rest = surface.patches();
    (0..surface.ptex_count() as u32).flat_map(move |face| {
        let (own, others) = rest.split_at(rest.partition_point(|patch| patch.ptex <= face));
        rest = others;
        let mut patches: Vec<&Patch> = own.iter().collect();
        patches.sort_by_key(|patch| (patch.kind == PatchKind::Regular, 255 - patch.depth[0].max(patch.depth[1])));
        on_face(face, patches).take(per_face)
    })
}

fn on_face(face: u32, patches: Vec<&Patch>) -> impl Iterator<Item = Sample> {
    let quarters = QUARTERS.iter().map(|quarters| quarters.map(|k| f64::from(k) / 4.0));
    // Other points on every face: Knuth's multiplicative hash, 20 bits of it.
    let first = face.wrapping_mul(2_654_435_761) >> 12;
    let scattered = (0..).flat_map(move |i: u32| {
        let over_face = scatter(first + 2 * i);
        let over_patch = patches.get(i as usize % patches.len().max(1)).map(|patch| {
            let nearer = match patch.kind {
                PatchKind::Regular => 0,
                _ => NEARER[i as usize / patches.len() % NEARER.len()],
            };
            patch.to_ptex(towards_corner(scatter(first + 2 * i + 1), nearer))
        });
        [Some(over_face), over_patch].into_iter().flatten()
    });
    quarters.chain(scattered).map(move |[u, v]| Sample { face, u, v })
}

/// A point of the unit square, moved towards (0,0) until its larger coordinate is 2^-nearer to half of that.
fn towards_corner(point: [f64; 2], nearer: i32) -> [f64; 2] {
    if nearer == 0 {
        return point;
    }
    let [least, most] = [point[0].min(point[1]), point[0].max(point[1])];
    let larger = 0.5f64.powi(nearer) * (1.0 - 0.5 * least / most);
    point.map(|x| x / most * larger)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh;

    #[test]
    fn every_kind_and_depth_is_sampled_and_small_sets_begin_large_ones() {
        let surface = LimitSurface::new(&mesh::sample()).expect("the sample has a surface");
        let set: Vec<Sample> = sample_set(&surface, DEFAULT_PER_FACE).collect();
        assert_eq!(set.len(), surface.ptex_count() * DEFAULT_PER_FACE);
        assert!(set.iter().all(|s| (0.0..=1.0).contains(&s.u) && (0.0..=1.0).contains(&s.v)));
        let hit: Vec<&Patch> = set
            .iter()
            .filter_map(|s| surface.locate(s.face, [s.u, s.v]))
            .map(|(patch, _)| &surface.patches()[patch])
            .collect();
        let deepest = |patches: &mut dyn Iterator<Item = &Patch>| patches.map(|p| p.depth[0].max(p.depth[1])).max();
        for kind in PatchKind::ALL {
            let there = deepest(&mut surface.patches().iter().filter(|p| p.kind == kind));
            assert_eq!(deepest(&mut hit.iter().copied().filter(|p| p.kind == kind)), there, "{kind:?}");
        }
        // Near the vertex: in the innermost level that f32 parameters tell apart.
        let near = set.iter().filter_map(|s| surface.locate(s.face, [s.u, s.v])).any(|(patch, [u, v])| {
            surface.kind(patch) != PatchKind::Regular && u.max(v) > 0.0 && u.max(v) < 2f64.powi(-19)
        });
        assert!(near);
        let small: Vec<Sample> = sample_set(&surface, 30).collect();
        assert!(small.chunks(30).zip(set.chunks(DEFAULT_PER_FACE)).all(|(small, large)| small == &large[..30]));
    }
}
