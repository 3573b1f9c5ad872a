//! Compiles the shim over OpenSubdiv and generates its Rust declarations.

use std::env;
use std::path::{Path, PathBuf};

const SHIM: [&str; 5] =
    ["ffi/refiner.cpp", "ffi/reference.cpp", "ffi/stencils.cpp", "ffi/peers.cpp", "ffi/process.cpp"];

fn main() {
    for file in SHIM.iter().chain(&[
        "ffi/osd.h",
        "ffi/embree.h",
        "ffi/embree.cpp",
        "ffi/bfr.hpp",
        "ffi/guard.hpp",
        "ffi/table.hpp",
        "build.rs",
    ]) {
        println!("cargo:rerun-if-changed={file}");
    }
    let mut shim = cc::Build::new();
    shim.cpp(true).std("c++14").opt_level(2).warnings(true).files(SHIM);
    // A peer of benchmarks: the program itself does not know of it.
    let embree = env::var_os("CARGO_FEATURE_PEERS").map(|_| embree());
    if let Some(version) = embree {
        shim.file("ffi/embree.cpp").define("CATOPTRIC_EMBREE", version);
    }
    // The address sanitizer of `cargo fuzz` looks into the shim too (docs/FUZZING.md).
    if env::var("CARGO_CFG_SANITIZE").is_ok_and(|kinds| kinds.split(',').any(|kind| kind == "address")) {
        shim.flag("-fsanitize=address").flag("-fno-omit-frame-pointer");
    }
    shim.compile("catoptric_osd");
    // Debian's libosdCPU; the GPU half of OpenSubdiv is not used.
    println!("cargo:rustc-link-lib=osdCPU");
    if let Some(version) = embree {
        println!("cargo:rustc-link-lib=embree{version}");
    }

    let bindings = bindgen::Builder::default()
        .header(if embree.is_some() { "ffi/embree.h" } else { "ffi/osd.h" })
        .allowlist_item("(osd|OSD|emb|EMB)_.*")
        .prepend_enum_name(false)
        .derive_default(true)
        .generate()
        .expect("bindgen reads ffi/osd.h (libclang-dev is needed: script/setup installs it)");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    bindings.write_to_file(out.join("osd.rs")).expect("OUT_DIR is writable");
}

/// Major version of the Embree that is installed: Debian 12 has the third, Debian 13 the fourth.
fn embree() -> &'static str {
    let folders = ["/usr/include", "/usr/local/include"].map(Path::new);
    let is_there =
        |version: &str| folders.iter().any(|folder| folder.join(format!("embree{version}/rtcore.h")).exists());
    ["4", "3"].into_iter().find(|version| is_there(version)).expect(
        "the feature `peers` needs Embree 3 or 4, and neither <embree4/rtcore.h> nor <embree3/rtcore.h> is installed \
         (script/bench installs libembree-dev)",
    )
}
