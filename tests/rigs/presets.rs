//! Presets suit themselves to an object, wherever it is and however large.

use super::Folder;
use catoptric::field::{Pattern, Scout};
use catoptric::mesh::{self, SubdivMesh};
use catoptric::rig::{FittedRig, Preset, Rig};
use catoptric::stam::LimitSurface;
use glam::DVec3;

fn fitted(preset: Preset, mesh: &SubdivMesh) -> (FittedRig, LimitSurface) {
    let surface = LimitSurface::new(mesh).expect("the mesh is valid");
    let scout = Scout::new(&surface).expect("it has faces");
    let rig = Rig { preset: Some(preset), ..Rig::default() };
    (rig.fit(&scout, None).expect("it fits"), surface)
}

fn read(name: &str) -> SubdivMesh {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name);
    mesh::read(&path).expect("a test mesh is valid")
}

/// Part of the surface that faces the eye and shows light, and the number of changes between light and dark along rows of
/// samples: what a preset is for.
fn shown(preset: Preset, mesh: &SubdivMesh) -> (f64, usize) {
    let (rig, surface) = fitted(preset, mesh);
    let field = rig.field();
    let rig_pattern = Rig { preset: Some(preset), ..Rig::default() }.with_preset().pattern;
    let pattern: Pattern = rig_pattern.read(&rig.method).expect("no picture").expect("no fit");
    let (mut lit, mut seen, mut changes) = (0, 0, 0);
    for ptex in 0..surface.ptex_count() as u32 {
        for row in 0..8 {
            let mut before = None;
            for k in 0..32 {
                let uv = [(f64::from(k) + 0.5) / 32.0, (f64::from(row) + 0.5) / 8.0];
                let Some((patch, local)) = surface.locate(ptex, uv) else { continue };
                let jet = surface.evaluate(patch, local);
                if jet.normal.dot(rig.camera.sight(jet.position)) >= 0.0 {
                    before = None;
                    continue;
                }
                let value = field.at(&surface, &rig.camera, patch, local);
                let is_lit = value.is_some_and(|value| pattern.radiance(&field, value) != DVec3::ZERO);
                seen += 1;
                lit += usize::from(is_lit);
                changes += usize::from(before.is_some_and(|before| before != is_lit));
                before = Some(is_lit);
            }
        }
    }
    (f64::from(lit as u32) / f64::from(seen), changes)
}

#[test]
fn every_preset_shows_lights_on_every_shape() {
    for mesh in [read("corner.obj"), read("pole_5.obj"), read("semi_sharp_crease.obj"), mesh::sample()] {
        for preset in Preset::ALL {
            let (lit, changes) = shown(preset, &mesh);
            println!("{} {preset}: {:.0} % lit, {changes} changes", mesh.name, 100.0 * lit);
            assert!((0.03..0.9).contains(&lit), "{} {preset}: {lit}", mesh.name);
            assert!(changes >= 10, "{} {preset}: {changes}", mesh.name);
        }
    }
}

/// A mesh twice as large and elsewhere gets the same picture: the rig moves and grows with it.
#[test]
fn presets_move_and_grow_with_the_object() {
    let small = read("corner.obj");
    let (scale, shift) = (8.0, DVec3::new(64.0, -32.0, 16.0));
    let mut large = small.clone();
    large.points.iter_mut().for_each(|point| *point = *point * scale + shift);
    for preset in Preset::ALL {
        let [(a, _), (b, _)] = [&small, &large].map(|mesh| fitted(preset, mesh));
        let diagonal = small.diagonal();
        let near = |a: DVec3, b: DVec3, size: f64, what: &str| {
            assert!(a.distance(b) < 1e-9 * size, "{preset}: {what} {a} {b}");
        };
        near(a.camera.eye * scale + shift, b.camera.eye, scale * diagonal, "eye");
        near(a.light.center * scale + shift, b.light.center, 10.0 * scale * diagonal, "centre");
        near(a.light.normal, b.light.normal, 1.0, "normal");
        near(a.light.lines, b.light.lines, 1.0, "lines");
        // Angles stay as they are.
        let factor = if matches!(a.method, catoptric::field::Method::Sphere(_)) { 1.0 } else { scale };
        assert!((a.light.spacing * factor / b.light.spacing - 1.0).abs() < 1e-9, "{preset}");
        for (a, b) in a.light.half.iter().zip(b.light.half) {
            assert!(a.is_infinite() && b.is_infinite() || (a * factor / b - 1.0).abs() < 1e-9, "{preset}");
        }
    }
}

/// No two presets draw the same, nor what is drawn without one.
#[test]
fn presets_are_distinct() {
    let folder = Folder::new();
    let mut pictures = vec![("none", folder.drawn(&[]))];
    for preset in Preset::ALL {
        let pixels = folder.drawn(&["--rig", preset.name()]);
        for (name, other) in &pictures {
            let different = pixels.iter().zip(other).filter(|(a, b)| a.abs_diff(**b) > 24).count();
            assert!(different > pixels.len() / 50, "{preset} looks like {name}: {different}");
        }
        pictures.push((preset.name(), pixels));
    }
}
