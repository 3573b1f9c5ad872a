//! EXR files as other programs read them: channels, attributes, and what pixels say about the surface.

use catoptric::field::{Camera, Light, Projection};
use catoptric::gpu::{Gpu, LinearFrame, NO_PATCH, SurfaceImage, View};
use catoptric::mesh;
use catoptric::output::{Layers, MADE_BY, NO_FACE, read_exr_made_by, write_exr};
use catoptric::stam::LimitSurface;
use exr::prelude::*;
use glam::{DMat4, DVec2, DVec3, dvec3};
use std::path::Path;
use std::sync::OnceLock;

const SIZE: [u32; 2] = [160, 120];

/// The adapter, opened once.
fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::new().expect("these tests need a Vulkan adapter"))
}

/// What was drawn, and the file read back.
struct Written {
    view: View,
    surface: LimitSurface,
    colour: LinearFrame,
    seen: SurfaceImage,
    file: FlatImage,
}

impl Written {
    fn new(name: &str, projection: Projection) -> Written {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name);
        let surface = LimitSurface::new(&mesh::read(&path).expect("a test mesh")).expect("it has a surface");
        let [low, high] = surface.bounds().expect("it has patches");
        let (middle, diagonal) = ((low + high) * 0.5, (high - low).length());
        let eye = middle + dvec3(1.0, 2.0, 1.5).normalize() * diagonal * 1.6;
        let camera = Camera { eye, target: middle, up: DVec3::Z, projection, size: SIZE };
        let light = Light::new(middle + diagonal * 1.5 * DVec3::Z, DVec3::NEG_Z, DVec3::Y, 0.8 * diagonal);
        let view = View::new(camera, light);
        let tables = gpu().upload(&surface).expect("it fits");
        let colour = gpu().render_linear(&tables, &view).expect("the adapter works");
        let seen = gpu().inspect(&tables, &view).expect("the adapter works");
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("view.exr");
        let layers = Layers {
            camera: &view.camera,
            colour: &colour,
            seen: &seen,
            source: &surface,
            made_by: "by hand: \u{fc}\u{2192}",
        };
        write_exr(&path, &layers).expect("a writable folder");
        let text = std::fs::read(&path).map(|bytes| read_exr_made_by(std::io::Cursor::new(bytes)).expect("an EXR"));
        assert_eq!(text.expect("it is readable").as_deref(), Some(layers.made_by));
        let file = read_all_flat_layers_from_file(&path).expect("an EXR");
        Written { view, surface, colour, seen, file }
    }

    fn floats(&self, name: &str) -> &[f32] {
        let channels = &self.file.layer_data[0].channel_data.list;
        match &channels.iter().find(|channel| channel.name.eq(name)).expect(name).sample_data {
            FlatSamples::F32(samples) => samples,
            other => panic!("{name} is {other:?}"),
        }
    }

    fn faces(&self) -> &[u32] {
        let channels = &self.file.layer_data[0].channel_data.list;
        match &channels.iter().find(|channel| channel.name.eq("ptex.face")).expect("ptex.face").sample_data {
            FlatSamples::U32(samples) => samples,
            other => panic!("ptex.face is {other:?}"),
        }
    }

    /// A matrix attribute: for row vectors in the file, for column vectors here.
    fn matrix(&self, name: &str) -> DMat4 {
        let attributes = &self.file.layer_data[0].attributes;
        let stored = match name {
            "worldToCamera" => attributes.world_to_camera,
            _ => attributes.world_to_normalized_device,
        };
        DMat4::from_cols_array(&stored.expect(name).map(f64::from))
    }

    fn covered(&self) -> impl Iterator<Item = usize> {
        (0..self.seen.patch.len()).filter(|&i| self.seen.patch[i] != NO_PATCH)
    }
}

fn both() -> [Written; 2] {
    let perspective = Projection::Perspective { fov: 40.0 };
    [Written::new("cube.obj", perspective), Written::new("pole_5.obj", Projection::Orthographic { height: 16.0 })]
}

#[test]
fn channels_have_their_names_and_types() {
    let [written, _] = both();
    let layer = &written.file.layer_data[0];
    assert_eq!(written.file.layer_data.len(), 1);
    assert_eq!((layer.size.0, layer.size.1), (SIZE[0] as usize, SIZE[1] as usize));
    let mut names: Vec<String> = layer.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
    names.sort();
    let mut expected =
        "R G B A P.X P.Y P.Z N.X N.Y N.Z ptex.face ptex.u ptex.v field residual".split(' ').collect::<Vec<_>>();
    expected.sort_unstable();
    assert_eq!(names, expected);
    let integers = layer.channel_data.list.iter().filter(|c| matches!(c.sample_data, FlatSamples::U32(_)));
    assert_eq!(integers.map(|channel| channel.name.to_string()).collect::<Vec<_>>(), ["ptex.face"]);
    assert!(layer.channel_data.list.iter().all(|c| !matches!(c.sample_data, FlatSamples::F16(_))));
    assert!(layer.attributes.other.contains_key(MADE_BY.as_bytes()));
}

#[test]
fn pixels_without_surface_are_nan() {
    for written in both() {
        let background: Vec<usize> =
            (0..written.seen.patch.len()).filter(|&i| written.seen.patch[i] == NO_PATCH).collect();
        assert!(background.len() > 1000);
        for name in ["P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "ptex.u", "ptex.v", "field", "residual"] {
            let samples = written.floats(name);
            assert!(background.iter().all(|&i| samples[i].is_nan()), "{name} of the background");
            if name != "field" {
                assert!(written.covered().all(|i| samples[i].is_finite()), "{name} of the surface");
            }
        }
        assert!(background.iter().all(|&i| written.faces()[i] == NO_FACE));
        assert_eq!(NO_FACE, 4_294_967_295);
    }
}

/// What the file says agrees with the f64 surface at the (face, u, v) that it says, which f32 parameters move by 1e-7 of
/// a face; and with what was read back from the adapter.
#[test]
fn pixels_agree_with_the_surface() {
    for written in both() {
        let [low, high] = written.surface.bounds().expect("it has patches");
        let tolerance = 4e-6 * (high - low).length();
        let [x, y, z] = ["P.X", "P.Y", "P.Z"].map(|name| written.floats(name));
        let [nx, ny, nz] = ["N.X", "N.Y", "N.Z"].map(|name| written.floats(name));
        let [u, v, field] = ["ptex.u", "ptex.v", "field"].map(|name| written.floats(name));
        for i in written.covered() {
            let position = DVec3::new(x[i].into(), y[i].into(), z[i].into());
            let uv = [u[i], v[i]].map(f64::from);
            let (_, jet) = written.surface.evaluate_ptex(written.faces()[i], uv).expect("not a hole");
            assert!(position.distance(jet.position) < tolerance, "{position} {}", jet.position);
            assert_eq!([nx[i], ny[i], nz[i]], written.seen.normal[i]);
            match written.seen.field[i] {
                Some(value) => assert_eq!(field[i], value.x as f32),
                None => assert!(field[i].is_nan()),
            }
        }
    }
}

/// The matrices as OpenEXR defines them: P times worldToNDC is the pixel's centre, but for the residual that the file
/// admits and the rounding of f32 matrices and positions; P times worldToCamera lies before the eye, and its distance
/// from the axis is what the projection makes of it.
#[test]
fn matrices_bring_positions_to_their_pixels() {
    for written in both() {
        let [x, y, z] = ["P.X", "P.Y", "P.Z"].map(|name| written.floats(name));
        let residual = written.floats("residual");
        let [to_ndc, to_camera] = ["worldToNDC", "worldToCamera"].map(|name| written.matrix(name));
        let size = DVec2::new(SIZE[0].into(), SIZE[1].into());
        let mut worst = 0.0f64;
        for i in written.covered() {
            let position = DVec3::new(x[i].into(), y[i].into(), z[i].into());
            let centre = DVec2::new((i % SIZE[0] as usize) as f64, (i / SIZE[0] as usize) as f64) + 0.5;
            let off = (to_ndc.project_point3(position).truncate() * size).distance(centre);
            worst = worst.max((off - f64::from(residual[i])).abs());
            let inside = to_camera.transform_point3(position);
            assert!(inside.z > 0.0, "{inside} is not before the eye");
            let w = match written.view.camera.projection {
                Projection::Perspective { fov } => inside.z * (fov.to_radians() / 2.0).tan(),
                Projection::Orthographic { height } => height / 2.0,
            };
            let at = DVec2::new(inside.x, -inside.y) / w * (size.y / 2.0) + size / 2.0;
            assert!((at.distance(centre) - f64::from(residual[i])).abs() < 1e-4, "{at} {centre}");
        }
        println!("{:?}: {worst:e} pixels beside the residual", written.view.camera.projection);
        assert!(worst < 1e-4, "{worst}");
        assert!(written.covered().all(|i| residual[i] < 0.5), "points are in their pixels");
    }
}

/// Colour is linear and premultiplied: with the background put behind it, it is the PNG's.
#[test]
fn colour_is_the_picture_without_its_background() {
    let [written, _] = both();
    let tables = gpu().upload(&written.surface).expect("it fits");
    let frame = gpu().render(&tables, &written.view).expect("the adapter works");
    let [r, g, b, a] = ["R", "G", "B", "A"].map(|name| written.floats(name));
    let palette = written.view.palette;
    let srgb = |x: f32| if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    for i in 0..a.len() {
        assert_eq!([r[i], g[i], b[i], a[i]], written.colour.rgba[i]);
        assert!((0.0..=1.0).contains(&a[i]) && (a[i] > 0.0 || r[i] == 0.0));
        let height = (i / SIZE[0] as usize) as f32 / SIZE[1] as f32 + 0.5 / SIZE[1] as f32;
        let smooth = height * height * (3.0 - 2.0 * height);
        for (k, channel) in [r[i], g[i], b[i]].into_iter().enumerate() {
            let background = palette.top[k] + (palette.bottom[k] - palette.top[k]) * smooth;
            let shown = srgb((channel + background * (1.0 - a[i])).clamp(0.0, 1.0)) * 255.0;
            assert!((shown - f32::from(frame.rgba8[4 * i + k])).abs() < 0.75, "pixel {i}");
        }
    }
    let covered = a.iter().filter(|&&a| a == 1.0).count();
    assert!(covered > 1000 && a.iter().any(|&a| a > 0.0 && a < 1.0), "{covered} pixels covered");
}
