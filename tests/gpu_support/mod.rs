//! What the GPU tests share. They fail where there is no adapter: a test that cannot look has seen nothing.
use catoptric::gpu::Gpu;
use catoptric::mesh::{self, SubdivMesh};
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

/// All meshes of tests/meshes that have a surface, by name.
pub fn meshes() -> Vec<SubdivMesh> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let entries = std::fs::read_dir(folder).expect("tests/meshes is there");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("it is readable").file_name().to_string_lossy().into_owned()).collect();
    names.retain(|name| name.ends_with(".obj"));
    names.sort();
    assert!(names.len() >= 20, "only {} test meshes", names.len());
    names.iter().map(|name| mesh(name)).collect()
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
