//! How a file was made, in one line that goes into it.

use super::render::RenderArgs;
use crate::digest::{START, fnv1a};
use crate::field::{Camera, Grid, Method, Palette, Pattern, Projection};
use crate::gpu::View;
use crate::mesh::{Boundary, Creasing, Scheme, SubdivMesh, TriangleRule};
use crate::rig::{Attachment, Colours, FittedRig, PatternName};
use clap::ValueEnum;
use glam::DVec3;
use std::fmt::{Display, Write};
use std::path::Path;

/// A command in one line, as a shell takes it, that makes a file again.
#[derive(Default)]
pub(super) struct CommandLine(String);

impl CommandLine {
    /// The command, and the file name of its mesh: the folder is nobody's business.
    pub(super) fn new(command: &str, mesh: Option<&Path>) -> CommandLine {
        let mut line = CommandLine(format!("catoptric {command}"));
        if let Some(path) = mesh {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            // It would be taken for a flag.
            let folder = if name.starts_with('-') { "./" } else { "" };
            line.word(&format!("{folder}{name}"));
        }
        line
    }

    fn word(&mut self, word: &str) {
        let plain = |c: char| c.is_alphanumeric() || "_@%+=:,./-".contains(c);
        self.0.push(' ');
        match word.chars().all(plain) && !word.is_empty() {
            true => self.0 += word,
            false => self.0 += &format!("'{}'", word.replace('\'', "'\\''")),
        }
    }

    /// A flag and its value.
    pub(super) fn flag(&mut self, name: &str, value: impl Display) {
        self.word(&format!("--{name}={value}"));
    }

    /// The words so far.
    pub(super) fn into_words(self) -> String {
        self.0
    }

    /// A flag without a value.
    pub(super) fn switch(&mut self, name: &str) {
        self.word(&format!("--{name}"));
    }

    fn vector(&mut self, name: &str, v: DVec3) {
        self.flag(name, format_args!("{},{},{}", v.x, v.y, v.z));
    }

    /// The picture's size, and all that is to be said of the camera.
    pub(super) fn camera(&mut self, camera: &Camera) {
        let Camera { eye, target, up, projection, size } = *camera;
        self.flag("size", format_args!("{}x{}", size[0], size[1]));
        match projection {
            Projection::Perspective { fov } => self.flag("fov", fov),
            Projection::Orthographic { height } => {
                self.flag("projection", "orthographic");
                self.flag("height", height);
            }
        }
        [("eye", eye), ("target", target), ("up", up)].into_iter().for_each(|(name, v)| self.vector(name, v));
    }

    /// The method and its light.
    pub(super) fn field(&mut self, rig: &FittedRig) {
        let light = &rig.light;
        self.flag("field", method_name(&rig.method));
        if light.attached != Attachment::default() {
            self.flag("light-attached", light.attached.name());
        }
        let vectors = [("center", light.center), ("normal", light.normal), ("lines", light.lines)];
        vectors.into_iter().for_each(|(name, v)| self.vector(&format!("light-{name}"), v));
        self.flag("light-spacing", light.spacing);
        if light.half.iter().all(|half| half.is_finite()) {
            self.flag("light-size", format_args!("{},{}", 2.0 * light.half[0], 2.0 * light.half[1]));
        }
    }

    /// A pattern and its name.
    pub(super) fn pattern(&mut self, pattern: &Pattern, name: &PatternName) {
        match (pattern, name) {
            (Pattern::Heat { range }, _) => self.flag("pattern", format_args!("heat:{},{}", range[0], range[1])),
            // The folder is nobody's business.
            (_, PatternName::File(path)) => self.flag("pattern", path.file_name().unwrap_or_default().display()),
            (_, name) => self.flag("pattern", name),
        }
        match pattern {
            Pattern::Stripes { width } | Pattern::Lattice { width } => self.flag("light-width", width),
            Pattern::Circles { radius } => self.flag("light-width", 2.0 * radius),
            Pattern::Band { radius } => self.flag("light-width", 2.0 * radius),
            Pattern::Heat { .. } | Pattern::Picture(_) => {}
        }
    }

    /// The colours that are not the usual ones.
    pub(super) fn colours(&mut self, palette: Palette) {
        let [colours, usual] = [palette, Palette::default()].map(Colours::of);
        for (name, colour, usual) in [
            ("paint", colours.paint, usual.paint),
            ("light-colour", colours.light, usual.light),
            ("background-top", colours.top, usual.top),
            ("background-bottom", colours.bottom, usual.bottom),
        ] {
            colour.filter(|_| colour != usual).iter().for_each(|colour| self.flag(name, colour));
        }
    }

    /// The line, with the version and digests of the mesh ([`mesh_digest`]) and of the grid of a field in a comment.
    pub(super) fn finish(self, mesh: u64, method: &Method) -> String {
        let mut line = format!("{} # catoptric {}, mesh {mesh:016x}", self.0, env!("CARGO_PKG_VERSION"));
        if let Some((size, values)) = method.grid().and_then(Grid::net) {
            let mut digest = Digest::new();
            digest.bytes(bytemuck::bytes_of(&size));
            digest.bytes(bytemuck::cast_slice(values));
            let _ = write!(line, ", field {:016x}", digest.0);
        }
        line
    }
}

/// A method as it is written, without the folder of a picture: that is nobody's business.
pub(super) fn method_name(method: &Method) -> String {
    let mut method = method.clone();
    if let Some(grid) = method.grid_mut() {
        grid.set_path(grid.path().file_name().unwrap_or_default().into());
    }
    method.to_string()
}

/// The command that makes the picture again, with everything in it that was fitted, and digests of the files that it
/// reads. On one adapter, pictures of the same line are the same.
///
/// `rig`: that of `view`; `pattern`: the name of its pattern.
pub(super) fn made_by(args: &RenderArgs, mesh: MeshAt, rig: &FittedRig, pattern: &PatternName, view: &View) -> String {
    let mut line = CommandLine::new("render", args.mesh.as_deref());
    args.scene.record(mesh.time, &mut line);
    line.camera(&rig.camera);
    line.field(rig);
    line.pattern(&view.pattern, pattern);
    line.colours(rig.palette);
    line.flag("pipeline", value_name(&args.pipeline));
    if view.enlarge != 1.0 {
        line.flag("enlarge", view.enlarge);
    }
    line.flag("patches", args.patches.patches);
    if let Some(end_caps) = &args.patches.end_caps {
        line.flag("end-caps", value_name(end_caps));
    }
    line.flag("tables", args.layout);
    if let Some(level) = view.proxy_level {
        line.flag("proxy-level", level);
    }
    line.flag("samples", view.samples);
    if let Some(show) = &args.show {
        line.flag("show", value_name(show));
    }
    if args.patches.compare {
        line.switch("compare");
    }
    let mut text = line.finish(mesh.digest, &rig.method);
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

/// A digest of lists of bytes.
struct Digest(u64);

impl Digest {
    fn new() -> Digest {
        Digest(START)
    }

    fn bytes(&mut self, bytes: &[u8]) {
        // The length keeps two lists from running into each other.
        self.0 = fnv1a(fnv1a(self.0, &(bytes.len() as u64).to_le_bytes()), bytes);
    }
}

/// Which mesh a picture shows.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeshAt {
    /// As [`mesh_digest`].
    pub(super) digest: u64,
    /// The time that was asked for.
    pub(super) time: Option<f64>,
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
    let scheme = match mesh.scheme {
        Scheme::CatmullClark => 0,
        Scheme::Loop => 2,
        Scheme::Bilinear => 4,
        Scheme::None => 6,
    };
    let triangles = u8::from(mesh.triangles == TriangleRule::Smooth) << 3;
    digest.bytes(&[boundary, scheme | triangles | u8::from(mesh.creasing == Creasing::Chaikin)]);
    digest.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh;

    #[test]
    fn words_are_quoted_as_shells_want_it() {
        let mut line = CommandLine::new("lines", Some(Path::new("/home/a/it's a car.obj")));
        line.flag("field", "curve:x^2 - y^2");
        line.flag("light-center", "-1,2.5,1e-7");
        line.switch("hidden");
        let words =
            r"catoptric lines 'it'\''s a car.obj' '--field=curve:x^2 - y^2' --light-center=-1,2.5,1e-7 --hidden";
        let version = env!("CARGO_PKG_VERSION");
        let expected = format!("{words} # catoptric {version}, mesh 000000000000002a");
        assert_eq!(line.finish(42, &Method::Reflection), expected);
        let line = CommandLine::new("render", Some(Path::new("cars/-x.obj")));
        assert_eq!(line.0, "catoptric render ./-x.obj");
    }

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
