//! Pictures on the sphere: once round it.

use super::Folder;
use catoptric::field::{Field, Light, Method, Mirrored, Palette, Pattern, Picture, Scout};
use catoptric::gpu::{Gpu, NO_PATCH, View};
use catoptric::mesh;
use catoptric::stam::LimitSurface;
use glam::DVec3;

/// A picture that says longitude in red (0 to 255 for -180 to 180) and latitude in green (255 to 0 for 90 to -90), linear light
/// aside.
fn map() -> Picture {
    let size = [256, 128];
    let texel = |k: u32| [(k % size[0]) as u8, (255 - 2 * (k / size[0])) as u8, 0, 255];
    Picture { size, rgba8: (0..size[0] * size[1]).flat_map(texel).collect() }
}

/// Every pixel shows the texel of its direction: f64 from the normal that was drawn, without the fields' code.
#[test]
fn every_direction_has_its_texel() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/pole_5.obj");
    let surface = LimitSurface::new(&mesh::read(&path).expect("a test mesh")).expect("it is valid");
    let scout = Scout::new(&surface).expect("it has faces");
    let camera = scout.camera([200, 150], DVec3::Z);
    // The plane faces down: north is up, longitude 0 is along x and grows to the right, as seen from inside.
    let light = Light::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::NEG_Y, 10.0);
    assert!(light.axes[0].distance(DVec3::X) < 1e-15);
    let gpu = Gpu::new().expect("an adapter");
    let tables = gpu.upload(&surface).expect("they fit");
    let palette = Palette { paint: [0.0; 3], tube: [1.0; 3], top: [0.0; 3], bottom: [0.0; 3] };
    for mirrored in [Mirrored::Normal, Mirrored::Reflection] {
        let field = Field { light, method: Method::Sphere(mirrored) };
        let view = View { field, pattern: Pattern::Picture(map()), samples: 1, palette, ..View::new(camera, light) };
        let frame = gpu.render(&tables, &view).expect("the adapter works");
        let seen = gpu.inspect(&tables, &view).expect("the adapter works");
        let (mut count, mut reds, mut greens) = (0, [255, 0], [255, 0]);
        for i in (0..seen.patch.len()).filter(|&i| seen.patch[i] != NO_PATCH) {
            let normal = DVec3::from_array(seen.normal[i].map(f64::from));
            let sight = (seen.position[i] - camera.eye).normalize();
            let d = match mirrored {
                Mirrored::Normal => normal,
                Mirrored::Reflection => sight - 2.0 * sight.dot(normal) * normal,
            };
            let longitude = (-d.y).atan2(d.x).to_degrees();
            let latitude = d.z.clamp(-1.0, 1.0).asin().to_degrees();
            // Near the seam and the poles, and where a pixel sees many texels, it shows their mean.
            if longitude.abs() > 170.0 || latitude.abs() > 75.0 {
                continue;
            }
            let [red, green] =
                [(longitude / 360.0 + 0.5) * 256.0 - 0.5, 255.0 - 2.0 * ((0.5 - latitude / 180.0) * 128.0 - 0.5)];
            let found = [frame.rgba8[4 * i], frame.rgba8[4 * i + 1]];
            let off = (f64::from(found[0]) - red).abs().max((f64::from(found[1]) - green).abs());
            reds = [reds[0].min(found[0]), reds[1].max(found[0])];
            greens = [greens[0].min(found[1]), greens[1].max(found[1])];
            count += 1;
            // A texel, rounding to 8 bits, and what filtering of a curved piece of the sphere adds at silhouettes.
            assert!(off < 8.0, "{mirrored:?}: {longitude} {latitude}: {found:?} {red} {green}");
        }
        println!("{mirrored:?}: {count} pixels, red {reds:?}, green {greens:?}");
        assert!(count > 3000 && reds[1] - reds[0] > 40 && greens[1] - greens[0] > 40, "{mirrored:?}");
    }
}

/// The seam at 180 degrees is none: an environment of one colour has no line there.
#[test]
fn the_seam_does_not_show() {
    let folder = Folder::new();
    image::RgbaImage::from_pixel(64, 32, image::Rgba([255; 4])).save(folder.path("white.png")).expect("it");
    let flags = [
        "--field=sphere",
        "--pattern=white.png",
        "--light-colour=#ffffff",
        "--background-top=#ffffff",
        "--background-bottom=#ffffff",
    ];
    let pixels = folder.drawn(&flags);
    let dark = pixels.chunks(4).filter(|pixel| pixel[0] < 250).count();
    assert_eq!(dark, 0);
}
