//! The proxy tessellation: small parameter grids, instanced over the patches that use them.
//!
//! For level L a patch of refinement level l is cut into 2^max(0, L-l) parts each way, so neighbours of any level up to L
//! meet in the same vertices. A patch that is not cut but has a deeper neighbour (a transition edge) becomes a fan with a vertex
//! in the middle of that edge.
//!
//! An instance is a group of patches, so that it has about a thousand vertices however coarse the pattern is: software
//! adapters take microseconds an instance (measured: 5 us on lavapipe), and deep patches are many and have 4 vertices.

use super::NO_PATCH;
use super::records::ProxyVertex;
use std::collections::BTreeMap;
use std::ops::Range;

/// Vertices that an instance should have at least.
const INSTANCE_VERTICES: usize = 1024;

/// All patterns of one level, and the patches that use each.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Proxy {
    /// Vertices of the groups of all patterns.
    pub vertices: Vec<ProxyVertex>,
    /// Triangles of all patterns, relative to the pattern's first vertex.
    pub indices: Vec<u32>,
    /// Patches, pattern after pattern, filled up with [`NO_PATCH`] to whole groups.
    pub order: Vec<u32>,
    /// One draw a pattern.
    pub draws: Vec<Draw>,
}

/// One instanced draw.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Draw {
    pub indices: Range<u32>,
    pub base_vertex: i32,
    /// Groups to draw.
    pub groups: u32,
    /// Patches in a group.
    pub group_size: u32,
    /// First patch in `order`.
    pub first: u32,
}

impl Proxy {
    /// Tessellation of level `level` of patches with these refinement levels and transition bits.
    pub fn new(cells: &[([u8; 2], u8)], level: u32) -> Proxy {
        // Patterns by parts along u and v (powers of two) and, for a single part, by the edges with a middle vertex.
        let mut users: BTreeMap<([u32; 2], u8), Vec<u32>> = BTreeMap::new();
        for (patch, &(own, transition)) in cells.iter().enumerate() {
            let finer = own.map(|own| level.saturating_sub(u32::from(own)));
            let transition = if finer == [0, 0] { transition & 15 } else { 0 };
            users.entry((finer, transition)).or_default().push(patch as u32);
        }
        let mut proxy = Proxy::default();
        for ((finer, transition), patches) in users {
            let (vertices, indices) = match transition {
                0 => grid(finer.map(|n| 1 << n)),
                _ => fan(transition),
            };
            proxy.add(&vertices, &indices, &patches);
        }
        proxy
    }

    fn add(&mut self, vertices: &[[f32; 2]], indices: &[u32], patches: &[u32]) {
        let group_size = INSTANCE_VERTICES.div_ceil(vertices.len()).min(patches.len());
        let groups = patches.len().div_ceil(group_size);
        let (first_index, first) = (self.indices.len() as u32, self.order.len() as u32);
        let base_vertex = self.vertices.len() as i32;
        for member in 0..group_size as u32 {
            self.vertices.extend(vertices.iter().map(|&uv| ProxyVertex { uv, member }));
            self.indices.extend(indices.iter().map(|k| k + member * vertices.len() as u32));
        }
        self.order.extend(patches);
        self.order.resize(first as usize + groups * group_size, NO_PATCH);
        self.draws.push(Draw {
            indices: first_index..self.indices.len() as u32,
            base_vertex,
            groups: groups as u32,
            group_size: group_size as u32,
            first,
        });
    }
}

/// The unit square in quads, `parts` along u and v.
fn grid(parts: [u32; 2]) -> (Vec<[f32; 2]>, Vec<u32>) {
    let [columns, rows] = parts;
    let row = columns + 1;
    let vertex = |k: u32| [(k % row) as f32 / columns as f32, (k / row) as f32 / rows as f32];
    let quads = (0..columns * rows).map(|k| k / columns * row + k % columns);
    let indices = quads.flat_map(|a| [a, a + 1, a + row + 1, a, a + row + 1, a + row]).collect();
    ((0..row * (rows + 1)).map(vertex).collect(), indices)
}

/// The unit square as a fan round its middle, with an extra vertex on every edge whose bit is set (bit 0: v = 0, 1: u = 1,
/// 2: v = 1, 3: u = 0).
fn fan(transition: u8) -> (Vec<[f32; 2]>, Vec<u32>) {
    const CORNERS: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut vertices = vec![[0.5, 0.5]];
    for edge in 0..4 {
        let (a, b) = (CORNERS[edge], CORNERS[(edge + 1) % 4]);
        vertices.push(a);
        if transition >> edge & 1 == 1 {
            vertices.push([(a[0] + b[0]) * 0.5, (a[1] + b[1]) * 0.5]);
        }
    }
    let rim = vertices.len() as u32 - 1;
    (vertices, (0..rim).flat_map(|k| [0, k + 1, (k + 1) % rim + 1]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the area of a triangle, positive if it turns from u to v.
    fn area(vertices: &[[f32; 2]], triangle: &[u32]) -> f32 {
        let [a, b, c] = [0, 1, 2].map(|k| vertices[triangle[k] as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    #[test]
    fn patterns_cover_the_square_once() {
        for (vertices, indices) in (1..16).map(fan).chain([[1, 1], [2, 2], [8, 2], [16, 16]].map(grid)) {
            let areas: Vec<f32> = indices.chunks_exact(3).map(|t| area(&vertices, t)).collect();
            assert!(areas.iter().all(|&a| a > 0.0));
            assert!((areas.iter().sum::<f32>() - 2.0).abs() < 1e-5);
        }
    }

    #[test]
    fn every_patch_is_drawn_once() {
        let cells: Vec<_> = (0..5000u32).map(|k| ([(k % 6) as u8, (k % 5) as u8], (k % 16) as u8)).collect();
        let proxy = Proxy::new(&cells, 3);
        let mut order = proxy.order.clone();
        order.retain(|&patch| patch != NO_PATCH);
        order.sort_unstable();
        assert_eq!(order, (0..5000).collect::<Vec<u32>>());
        assert_eq!(proxy.draws.iter().map(|d| d.groups * d.group_size).sum::<u32>(), proxy.order.len() as u32);
        assert!(proxy.order.len() < 5000 + proxy.draws.len() * INSTANCE_VERTICES);
        assert_eq!(Proxy::new(&[], 3).draws, []);
    }
}
