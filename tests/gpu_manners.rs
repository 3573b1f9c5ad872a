//! What an adapter tells, and whom: nothing on the standard streams, its name to who asks, how far a picture is to who draws it.

#[allow(dead_code, reason = "each test program uses its part")]
mod gpu_support;

use catoptric::field::Scout;
use catoptric::gpu::{AdapterChoice, Gpu, GpuError, Pipeline, View, adapters};
use catoptric::stam::LimitSurface;
use gpu_support::{gpu, mesh};
use std::process::{Command, Output};
use std::sync::Mutex;

/// What another process does that starts this program again.
#[test]
#[ignore = "for nothing_is_printed"]
fn open_an_adapter() {
    Gpu::new().expect("an adapter");
    assert!(adapters(&AdapterChoice::Auto).iter().any(|adapter| adapter.is_chosen));
    eprintln!("afterwards");
}

/// Opens an adapter in a process of its own, without a desktop session and without the variables that hush Mesa's layers.
fn opened(variables: &[(&str, &str)]) -> Output {
    let mut program = Command::new(std::env::current_exe().expect("this program"));
    program.args(["--exact", "open_an_adapter", "--include-ignored", "--nocapture"]);
    for name in [
        "NODEVICE_SELECT",
        "VK_LOADER_DEBUG",
        "XDG_RUNTIME_DIR",
        "XDG_CACHE_HOME",
        "HOME",
        "DISPLAY",
        "WAYLAND_DISPLAY",
    ] {
        program.env_remove(name);
    }
    program.envs(variables.iter().copied()).output().expect("it starts")
}

#[cfg(unix)]
#[test]
fn nothing_is_printed() {
    for variables in [
        // Mesa's layer device_select looks for a desktop session: a line a device.
        &[][..],
        // Mesa cannot make a folder for compiled shaders there.
        &[("XDG_CACHE_HOME", "/proc/no-such-folder")],
        &[("HOME", "/proc/no-such-folder"), ("XDG_RUNTIME_DIR", "/proc/no-such-folder")],
        &[("MESA_GLSL_CACHE_MAX_SIZE", "1M")],
    ] {
        let output = opened(variables);
        let [out, error] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
        assert!(output.status.success(), "{variables:?}: {out}{error}");
        assert_eq!(error, "afterwards\n", "{variables:?}");
        let of_the_harness =
            |line: &str| line.is_empty() || line.starts_with("running 1 test") || line.starts_with("test ");
        assert!(out.lines().all(of_the_harness), "{variables:?}: {out}");
    }
    // Who asks the loader what it does hears it.
    let heard = opened(&[("VK_LOADER_DEBUG", "all")]).stderr;
    assert!(String::from_utf8_lossy(&heard).lines().count() > 1);
}

#[test]
fn adapters_are_listed_and_found_by_a_part_of_their_name() {
    let all = adapters(&AdapterChoice::Auto);
    let chosen: Vec<_> = all.iter().filter(|adapter| adapter.is_chosen).collect();
    assert!(chosen.len() == 1 && !chosen[0].kind.is_empty(), "{all:?}");
    // Any case, any part.
    let name = &all.last().expect("an adapter").name;
    let part = name.split(' ').next().expect("a word").to_uppercase();
    let found = Gpu::with(&AdapterChoice::Named(part.clone())).expect("it is there");
    assert!(found.adapter().to_uppercase().contains(&part));
    let none = AdapterChoice::Named("no such adapter".to_owned());
    assert!(adapters(&none).iter().all(|adapter| !adapter.is_chosen));
    let error = Gpu::with(&none).map(drop).expect_err("there is none");
    assert!(!error.is_no_adapter() && matches!(error, GpuError::UnknownAdapter { .. }));
    let message = error.to_string();
    assert!(message.contains("no GPU adapter matches \"no such adapter\"") && message.contains(name), "{message}");
}

/// From 0 to 1, in every pipeline, whatever the number of tiles.
#[test]
fn pictures_tell_how_far_they_are() {
    let surface = LimitSurface::new(&mesh("three_creases.obj")).expect("it has a surface");
    let tables = gpu().upload(&surface).expect("it fits");
    let scout = Scout::new(&surface).expect("it has faces");
    for (pipeline, size) in [
        (Pipeline::Exact, [64, 48]),
        (Pipeline::Exact, [1100, 8]),
        (Pipeline::Polygon, [64, 48]),
        (Pipeline::Points, [64, 48]),
    ] {
        let camera = scout.camera(size, glam::DVec3::Z);
        let view = View { pipeline, ..View::new(camera, scout.light(&camera)) };
        let told = Mutex::new(Vec::new());
        let watch = |done: f64| told.lock().expect("nobody panics").push(done);
        let watched = gpu().watched(&watch);
        let picture = watched.render(&tables, &view).expect("it is drawn");
        assert!(picture.rgba8 == gpu().render(&tables, &view).expect("it is drawn").rgba8, "the same picture");
        let of_picture = std::mem::take(&mut *told.lock().expect("nobody panics"));
        watched.inspect(&tables, &view).expect("it is drawn");
        watched.render_linear(&tables, &view).expect("it is drawn");
        for told in [of_picture, told.lock().expect("nobody panics").clone()] {
            assert!(told.iter().all(|done| (0.0..=1.0).contains(done)), "{pipeline:?}: {told:?}");
            assert_eq!(told.last(), Some(&1.0), "{pipeline:?}");
            let parts = told.iter().filter(|done| **done > 0.0 && **done < 1.0).count();
            assert!(parts > 1 || pipeline == Pipeline::Points, "{pipeline:?}: {told:?}");
        }
    }
}
