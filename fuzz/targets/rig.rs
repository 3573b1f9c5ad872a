//! Light rigs.

use super::check_message;
use catoptric::field::Scout;
use catoptric::mesh::parse_obj;
use catoptric::rig::{FittedRig, PatternName, PatternRig, Rig, RigFormat};
use catoptric::stam::LimitSurface;
use std::path::Path;
use std::sync::LazyLock;

/// What rigs are fitted to.
static SCOUT: LazyLock<Scout> = LazyLock::new(|| {
    let cube = parse_obj(include_bytes!("../../tests/meshes/cube.obj"), "cube").expect("a mesh");
    Scout::new(&LimitSurface::new(&cube).expect("a surface")).expect("patches")
});

/// The text of a rig: JSON where it begins with a brace, else TOML.
pub fn rig(data: &[u8]) {
    // What is not UTF-8 is refused when the file is read.
    let Ok(text) = std::str::from_utf8(data) else { return };
    let is_json = text.trim_start().starts_with('{');
    let (format, name) = if is_json { (RigFormat::Json, "rig.json") } else { (RigFormat::Toml, "rig.toml") };
    let rig = match Rig::parse(text, format, Path::new(name)) {
        Ok(rig) => rig,
        Err(error) => return check_message(&error.to_string(), name),
    };
    write_and_read(&rig);
    match rig.fit(&SCOUT, None) {
        Ok(fitted) => check_fitted(&fitted),
        Err(error) => check_message(&format!("{name}: {error}"), name),
    }
}

/// What is written is read as the same.
fn write_and_read(rig: &Rig) {
    // Files are written as seen from the folder, and have to be there.
    let has_files = matches!(rig.pattern.name, Some(PatternName::File(_))) || rig.method().grid().is_some();
    if has_files {
        return;
    }
    for format in [RigFormat::Toml, RigFormat::Json] {
        let text = rig.write(format, Path::new(".")).expect("a rig can be written");
        let again = Rig::parse(&text, format, Path::new("again"));
        assert_eq!(again.as_ref().ok(), Some(rig), "{text}\n{:?}", again.as_ref().err());
    }
}

/// A camera that is not refused sees along finite axes, and its light has finite ones; written down, they are a rig.
fn check_fitted(fitted: &FittedRig) {
    let camera = &fitted.camera;
    if let Err(message) = camera.check(2) {
        return check_message(&format!("rig: {message}"), "rig");
    }
    let axes = camera.axes();
    assert!([axes.right, axes.up, axes.forward].iter().all(|axis| axis.is_finite()), "{camera:?}");
    let light = fitted.light.in_world(camera);
    assert!(light.axes.iter().all(|axis| axis.is_finite() && axis.length() > 0.9), "{fitted:?}");
    let rig = fitted.to_rig(PatternRig::default());
    rig.check().expect("a fitted rig does not contradict itself");
}
