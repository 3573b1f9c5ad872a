//! What the GPU tests share. They fail where there is no adapter: a test that cannot look has seen nothing.

use catoptric::gpu::Gpu;
use catoptric::mesh::{self, SubdivMesh};
use glam::{DVec3, dvec3};
use std::path::Path;
use std::sync::OnceLock;

/// The adapter, opened once.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::new().expect("these tests need a Vulkan adapter"))
}

/// A mesh of tests/meshes.
pub fn mesh(name: &str) -> SubdivMesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name);
    mesh::read(&path).expect("a test mesh is valid")
}

/// Numbers in [0,1) from a multiplicative congruential generator: the same in every run.
#[derive(Debug)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A disc of quads round one vertex of this valence, two rings wide, with uneven heights.
pub fn pole(valence: usize, seed: u64) -> SubdivMesh {
    let mut random = Random::new(seed);
    let mut mesh = SubdivMesh { name: format!("pole {valence}"), points: vec![DVec3::ZERO], ..SubdivMesh::default() };
    // Sector k holds the grid points (i, j), i from 1 to 2 along its first spoke, j from 0 to 2 towards the next one.
    let index = |sector: usize, i: usize, j: usize| match (i, j) {
        (0, 0) => 0,
        (0, j) => (1 + 6 * ((sector + 1) % valence) + 3 * (j - 1)) as u32,
        (i, j) => (1 + 6 * sector + 3 * (i - 1) + j) as u32,
    };
    for sector in 0..valence {
        let spoke = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / valence as f64;
            dvec3(angle.cos(), angle.sin(), 0.0)
        };
        for (i, j) in (1..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let mut noise = || 0.4 * (random.next() - 0.5);
            let p = spoke(sector) * i as f64 + spoke(sector + 1) * j as f64 + dvec3(noise(), noise(), 2.0 * noise());
            mesh.points.push(p);
        }
        for (i, j) in (0..2).flat_map(|i| (0..2).map(move |j| (i, j))) {
            mesh.face_sizes.push(4);
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            mesh.face_vertices.extend(corners.map(|(i, j)| index(sector, i, j)));
        }
    }
    mesh
}
