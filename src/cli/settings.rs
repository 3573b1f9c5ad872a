//! How a picture was made, in one line that goes into its file.

use super::render::RenderArgs;
use crate::field::{Camera, Pattern, Projection};
use crate::gpu::View;
use crate::mesh::{Boundary, Creasing, SubdivMesh};
use clap::ValueEnum;
use glam::DVec3;
use std::fmt::Write;
use std::path::Path;

/// The command that makes the picture again, with everything in it that was fitted, and digests of the files that it
/// reads. On one adapter, pictures of the same line are the same.
///
/// `mesh`: the digest of the mesh ([`mesh_digest`]).
pub(super) fn made_by(args: &RenderArgs, mesh: u64, view: &View) -> String {
    let Camera { eye, target, up, projection, size } = view.camera;
    let light = view.light();
    let mut text = format!("catoptric {} render", env!("CARGO_PKG_VERSION"));
    let mut add = |flag: &str, value: String| {
        text += &match flag {
            "" => format!(" {value}"),
            flag => format!(" --{flag}={value}"),
        }
    };
    let vector = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
    // Its folder is nobody's business.
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if let Some(path) = &args.mesh {
        add("", name(path));
    }
    add("size", format!("{}x{}", size[0], size[1]));
    match projection {
        Projection::Perspective { fov } => add("fov", fov.to_string()),
        Projection::Orthographic { height } => {
            add("projection", "orthographic".to_owned());
            add("height", height.to_string());
        }
    }
    [("eye", eye), ("target", target), ("up", up)].into_iter().for_each(|(flag, v)| add(flag, vector(v)));
    add("field", view.field.method.to_string());
    let directions = [("light-center", light.center), ("light-normal", light.normal()), ("light-lines", light.axes[1])];
    directions.into_iter().for_each(|(flag, v)| add(flag, vector(v)));
    add("light-spacing", light.spacing.to_string());
    if light.half.iter().all(|half| half.is_finite()) {
        add("light-size", format!("{},{}", 2.0 * light.half[0], 2.0 * light.half[1]));
    }
    add("pattern", args.pattern.name(&view.pattern));
    match &view.pattern {
        Pattern::Stripes { width } | Pattern::Lattice { width } => add("light-width", width.to_string()),
        Pattern::Circles { radius } => add("light-width", (2.0 * radius).to_string()),
        Pattern::Band { radius } => add("light-width", (2.0 * radius).to_string()),
        Pattern::Heat { .. } | Pattern::Picture(_) => {}
    }
    add("pipeline", value_name(&args.pipeline));
    if view.enlarge != 1.0 {
        add("enlarge", view.enlarge.to_string());
    }
    add("patches", args.patches.patches.to_string());
    if let Some(end_caps) = &args.patches.end_caps {
        add("end-caps", value_name(end_caps));
    }
    add("tables", args.layout.to_string());
    if let Some(level) = view.proxy_level {
        add("proxy-level", level.to_string());
    }
    add("samples", view.samples.to_string());
    if let Some(show) = &args.show {
        add("show", value_name(show));
    }
    if args.patches.compare {
        text += " --compare";
    }
    let _ = write!(text, " # mesh {mesh:016x}");
    if let Pattern::Picture(picture) = &view.pattern {
        let mut digest = Digest::new();
        digest.bytes(bytemuck::bytes_of(&picture.size));
        digest.bytes(&picture.rgba8);
        let _ = write!(text, ", pattern {:016x}", digest.0);
    }
    text
}

fn value_name(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// FNV-1a, 64 bits (Fowler, Noll & Vo): the same on every machine and in every version, unlike the standard library's.
struct Digest(u64);

impl Digest {
    fn new() -> Digest {
        Digest(0xcbf2_9ce4_8422_2325)
    }

    fn bytes(&mut self, bytes: &[u8]) {
        // The length keeps two lists from running into each other.
        for byte in (bytes.len() as u64).to_le_bytes().iter().chain(bytes) {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// Digest of all that the limit surface depends on.
pub(super) fn mesh_digest(mesh: &SubdivMesh) -> u64 {
    let mut digest = Digest::new();
    digest.bytes(bytemuck::cast_slice(&mesh.points));
    for list in [&mesh.face_sizes, &mesh.face_vertices, &mesh.holes] {
        digest.bytes(bytemuck::cast_slice(list));
    }
    let edges = mesh.creases.iter().map(|c| [c.vertices[0], c.vertices[1], c.sharpness.to_bits()]);
    digest.bytes(bytemuck::cast_slice(&edges.collect::<Vec<_>>()));
    let corners = mesh.corners.iter().map(|c| [c.vertex, c.sharpness.to_bits()]);
    digest.bytes(bytemuck::cast_slice(&corners.collect::<Vec<_>>()));
    let boundary = match mesh.boundary {
        Boundary::None => 0,
        Boundary::EdgeOnly => 1,
        Boundary::EdgeAndCorner => 2,
    };
    digest.bytes(&[boundary, u8::from(mesh.creasing == Creasing::Chaikin)]);
    digest.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh;

    #[test]
    fn digests_are_those_of_fnv_and_tell_meshes_apart() {
        // The empty input, after the eight bytes of its length, which are 0: only the multiplications are left.
        let mut digest = Digest::new();
        digest.bytes(&[]);
        assert_eq!(digest.0, (0..8).fold(0xcbf2_9ce4_8422_2325, |x: u64, _| x.wrapping_mul(0x0100_0000_01b3)));
        let mesh = mesh::sample();
        let mut other = mesh.clone();
        assert_eq!(mesh_digest(&mesh), mesh_digest(&other));
        other.points[3].y += 1e-12;
        assert_ne!(mesh_digest(&mesh), mesh_digest(&other));
        let mut other = mesh.clone();
        other.creases[0].sharpness += 0.5;
        assert_ne!(mesh_digest(&mesh), mesh_digest(&other));
    }
}
