//! Lights that go with the object or with the camera.

use super::Folder;
use catoptric::field::{Camera, Light, Projection};
use catoptric::rig::{Attachment, PlacedLight};
use glam::{DVec3, dvec3};

fn camera() -> Camera {
    let projection = Projection::Perspective { fov: 30.0 };
    Camera { eye: dvec3(4.0, -3.0, 2.0), target: dvec3(0.5, 0.2, 0.1), up: DVec3::Z, projection, size: [64, 48] }
}

/// The camera's coordinates: the eye is the origin, x to the right, y up, z towards the viewer.
#[test]
fn coordinates_are_the_cameras() {
    let camera = camera();
    let axes = camera.axes();
    let light = PlacedLight {
        attached: Attachment::Camera,
        center: dvec3(1.0, 2.0, -5.0),
        normal: DVec3::Z,
        lines: DVec3::Y,
        spacing: 1.0,
        half: [f64::INFINITY; 2],
    };
    let world = light.in_world(&camera);
    let expected = camera.eye + axes.right + axes.up * 2.0 + axes.forward * 5.0;
    assert!(world.center.distance(expected) < 1e-14, "{} {expected}", world.center);
    assert!(world.normal().distance(-axes.forward) < 1e-15 && world.axes[1].distance(axes.up) < 1e-15);
    // In front of the lens, above its middle and to its right.
    let [x, y] = camera.project(world.center).expect("it is in front");
    assert!(x > 32.0 && y < 24.0, "{x} {y}");
}

/// Going over to the camera's coordinates and back changes nothing but the last digits.
#[test]
fn fitted_lights_keep_their_place() {
    let camera = camera();
    let light = Light::new(dvec3(-7.0, 3.0, 9.0), dvec3(0.3, -0.5, -1.0), dvec3(1.0, 1.0, 0.2), 0.7);
    for attached in [Attachment::Object, Attachment::Camera] {
        let back = PlacedLight::new(&light, attached, &camera).in_world(&camera);
        assert!(back.center.distance(light.center) < 1e-14 * 30.0, "{attached:?}");
        assert!((0..2).all(|k| back.axes[k].distance(light.axes[k]) < 1e-15), "{attached:?}");
    }
}

fn different(a: &[u8], b: &[u8]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 8).count()
}

/// A turntable of a body that comes to coincide with itself after a quarter turn: a light that goes with the camera draws the same
/// picture again; one that stays with the object does not.
#[test]
fn lights_go_round_with_the_camera() {
    let folder = Folder::new();
    let mut cube = String::new();
    for k in 0..8 {
        let side = |bit: u32| if k >> bit & 1 == 0 { -1 } else { 1 };
        cube += &format!("v {} {} {}\n", side(0), side(1), side(2));
    }
    cube += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    folder.write("cube.obj", &cube);
    let draw = |attached: &str| {
        let flag = format!("--light-attached={attached}");
        let size = "--size=96x96";
        let target = "--target=0,0,0";
        folder.done(&["render", "cube.obj", "--frames=4", "--orbit=360", size, target, &flag, "-o", "f.png"]);
        ["f_0001.png", "f_0002.png"].map(|name| folder.pixels(name))
    };
    let [first, second] = draw("camera");
    assert!(different(&first, &second) < first.len() / 200, "{}", different(&first, &second));
    let [first, second] = draw("object");
    assert!(different(&first, &second) > first.len() / 50, "{}", different(&first, &second));
}

/// Where it is fitted, a light is at the same place whatever it is attached to.
#[test]
fn first_frames_are_the_same() {
    let folder = Folder::new();
    let [object, camera] = ["object", "camera"].map(|attached| folder.drawn(&["--light-attached", attached]));
    assert!(different(&object, &camera) < object.len() / 200, "{}", different(&object, &camera));
}

/// Vectors of a file are not read in other coordinates than it gives them in.
#[test]
fn another_attachment_sets_vectors_aside() {
    let folder = Folder::new();
    folder.write("world.toml", "[light]\ncenter = [0, 0, 9]\nnormal = [0, 0, -1]\nlines = [1, 0, 0]\nspacing = 0.5");
    let mut fitted = folder.drawn(&["--light-attached=camera", "--light-spacing=0.5"]);
    assert!(folder.drawn(&["--light-attached=camera", "--rig=world.toml"]) == fitted);
    // The same one again sets nothing aside.
    fitted = folder.drawn(&["--rig=world.toml"]);
    assert!(folder.drawn(&["--light-attached=object", "--rig=world.toml"]) == fitted);
    assert!(folder.drawn(&["--light-attached=object", "--light-spacing=0.5"]) != fitted);
}
