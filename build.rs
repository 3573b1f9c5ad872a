//! Compiles the shim over OpenSubdiv and generates its Rust declarations.

use std::{env, path::PathBuf};

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
    let with_embree = env::var_os("CARGO_FEATURE_PEERS").is_some();
    if with_embree {
        shim.file("ffi/embree.cpp");
    }
    // The address sanitizer of `cargo fuzz` looks into the shim too (docs/FUZZING.md).
    if env::var("CARGO_CFG_SANITIZE").is_ok_and(|kinds| kinds.split(',').any(|kind| kind == "address")) {
        shim.flag("-fsanitize=address").flag("-fno-omit-frame-pointer");
    }
    shim.compile("catoptric_osd");
    // Debian's libosdCPU; the GPU half of OpenSubdiv is not used.
    println!("cargo:rustc-link-lib=osdCPU");
    if with_embree {
        println!("cargo:rustc-link-lib=embree3");
    }

    let bindings = bindgen::Builder::default()
        .header(if with_embree { "ffi/embree.h" } else { "ffi/osd.h" })
        .allowlist_item("(osd|OSD|emb|EMB)_.*")
        .prepend_enum_name(false)
        .derive_default(true)
        .generate()
        .expect("bindgen reads ffi/osd.h (libclang-dev is needed: script/setup installs it)");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    bindings.write_to_file(out.join("osd.rs")).expect("OUT_DIR is writable");
}
