//! The program as a user or a script meets it: formats, exit codes, bad input.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn mesh(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name).with_extension("obj")
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn file(&self, name: &str, content: &str) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, content).expect("a writable folder");
        path
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run<I: AsRef<std::ffi::OsStr>>(&self, args: impl IntoIterator<Item = I>) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
        command.args(args).current_dir(self.0.path()).output().expect("the program starts")
    }

    /// Runs arguments that must be refused with exit code 2, one line, and no file left behind.
    fn refused(&self, args: &[&str]) -> String {
        let before = self.names();
        let output = self.run(args);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{args:?}: {message}");
        assert!(!message.contains("panicked"), "{args:?}: {message}");
        assert_eq!(self.names(), before, "{args:?} left a file");
        message
    }

    fn names(&self) -> Vec<std::ffi::OsString> {
        let entries = std::fs::read_dir(self.0.path()).expect("a readable folder");
        let mut names: Vec<_> = entries.map(|entry| entry.expect("an entry").file_name()).collect();
        names.sort();
        names
    }
}

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn bad_meshes_are_refused_by_every_command_with_the_line() {
    let folder = Folder::new();
    let cases = [
        ("empty", String::new(), "empty"),
        ("index_too_large", format!("{QUAD}f 1 2 3 9\n"), ":5: "),
        ("index_zero", format!("{QUAD}f 0 1 2\n"), ":5: "),
        ("two_gon", format!("{QUAD}f 1 2\n"), ":5: "),
        ("repeated_vertex", format!("{QUAD}f 1 2 2 3\n"), ":5: "),
        ("nan", format!("v nan 0 0\n{QUAD}f 2 3 4 5\n"), ":1: "),
        ("crease_out_of_range", format!("{QUAD}f 1 2 3 4\nt crease 2/1/0 0 99 3\n"), ":6: "),
        ("crease_no_edge", format!("{QUAD}f 1 2 3 4\nt crease 2/1/0 0 2 3\n"), ":6: "),
        ("crease_nan", format!("{QUAD}f 1 2 3 4\nt crease 2/1/0 0 1 nan\n"), ":6: "),
        ("crease_negative", format!("{QUAD}f 1 2 3 4\nt crease 2/1/0 0 1 -1\n"), ":6: "),
        ("corner_out_of_range", format!("{QUAD}f 1 2 3 4\nt corner 1/1/0 7 3\n"), ":6: "),
        ("hole_out_of_range", format!("{QUAD}f 1 2 3 4\nt hole 1/0/0 7\n"), ":6: "),
        ("tag_truncated", format!("{QUAD}f 1 2 3 4\nt crease 2/1/0 0\n"), ":6: "),
        ("tag_unknown", format!("{QUAD}f 1 2 3 4\nt wrinkle 0/0/0\n"), ":6: "),
        ("not_text", "\0\u{1}\u{2}".repeat(500), "NUL"),
    ];
    for (name, text, expected) in &cases {
        let path = folder.file(&format!("{name}.obj"), text);
        let path = path.to_str().expect("a UTF-8 path");
        folder.file("samples.csv", "face,u,v\n0,0.5,0.5\n");
        for command in [
            &["render", path, "-o", "out.png"][..],
            &["verify", path, "--json", "out.json"],
            &["info", path],
            &["eval", path, "--samples", "samples.csv", "-o", "out.csv"],
        ] {
            let message = folder.refused(command);
            assert!(message.contains(expected) && message.contains(name), "{name}: {message}");
        }
    }
}

#[test]
fn bad_usage_is_refused() {
    let folder = Folder::new();
    for (args, expected) in [
        (&["no-such-command"][..], "no-such-command"),
        (&["render", "/no/such/file.obj"], "no such file"),
        (&["render", "--size", "0x0"], "WIDTHxHEIGHT"),
        (&["render", "--size", "99999x10"], "WIDTHxHEIGHT"),
        (&["render", "--fov", "180"], "field of view"),
        (&["render", "--fov", "0"], "field of view"),
        (&["render", "--projection", "orthographic", "--height", "1e-30"], "a pixel would span"),
        (&["render", "--projection", "orthographic", "--height", "-1"], "above 0"),
        (&["render", "--show", "magic"], "magic"),
        (&["render", "--show", "steps", "-o", "a.exr"], "--show colours a .png"),
        (&["render", "--stage", "vertex"], "vertex"),
        (&["render", "-o", "a.png", "--json", "a.png"], "--json would overwrite the picture"),
        (&["render", "--json", "no-such-folder/a.json"], "no-such-folder"),
        (&["render", "--frames", "2", "--orbit", "1e300"], "at most 1e6"),
        (&["render", "--fov", "nan"], "field of view"),
        (&["render", "--projection", "isometric"], "isometric"),
        (&["render", "--projection", "orthographic", "--fov", "30"], "--fov does not apply"),
        (&["render", "--projection", "orthographic", "--height", "0"], "above 0"),
        (&["render", "--projection", "orthographic", "--height", "inf"], "above 0"),
        (&["render", "--height", "2"], "--projection orthographic"),
        (&["render", "--light-normal", "0,0,0"], "--light-normal"),
        (&["render", "--light-lines", "0,0,0"], "--light-lines"),
        (&["render", "--light-normal", "0,0,2", "--light-lines", "0,0,-3"], "parallel"),
        (&["eval", "--samples", "."], "folder"),
        // Where to write is checked before there is work: these meshes do not even exist.
        (&["verify", "no-such.obj", "--json", "no-such-folder/v.json"], "no-such-folder"),
        (&["verify", "no-such.obj", "--json", "."], "it is a folder"),
        (&["eval", "no-such.obj", "--samples", "no-such.csv", "-o", "no-such-folder/o.csv"], "no-such-folder"),
        (&["render", "--eye", "1,2"], "X,Y,Z"),
        (&["render", "--eye", "1,2,nan"], "X,Y,Z"),
        (&["render", "--pipeline", "magic"], "magic"),
        (&["render", "--pipeline", "points", "--enlarge", "0.5"], "from 1 to 8"),
        (&["render", "--pipeline", "points", "--enlarge", "nan"], "from 1 to 8"),
        (&["render", "--pipeline", "polygon", "--enlarge", "1"], "--pipeline points"),
        (&["render", "--enlarge", "1.7"], "--pipeline points"),
        (&["render", "--pipeline", "points", "--size", "4097x8"], "samples a side"),
        (&["render", "--pattern", "no-such.png"], "no-such.png"),
        (&["render", "-o", "no-such-folder/out.png"], "no-such-folder"),
        (
            &["render", "-o", "out.tiff"],
            "out.tiff: not a picture that we write; choose a name that ends in .png or .exr",
        ),
        (&["eval", "--samples", "no-such.csv"], "no-such.csv"),
        (&["render", "--up", "0,0,0"], "--up has no direction"),
        (&["render", "--light-spacing", "0"], "above 0"),
        (&["eval"], "--samples"),
        (&[], "no command"),
    ] {
        let message = folder.refused(args);
        assert!(message.contains(expected), "{args:?}: {message}");
    }
}

#[test]
fn bad_samples_are_refused_with_their_line() {
    let folder = Folder::new();
    for (text, expected) in [
        ("", "header"),
        ("u,v,face\n0.5,0.5,0\n", "header"),
        ("face,u,v\n0,0.5,1.5\n", ":2: v = 1.5"),
        ("face,u,v\n0,0.5,0.5\n0,-0.1,0\n", ":3: u = -0.1"),
        ("face,u,v\n0,nan,0\n", ":2: u = NaN"),
        ("face,u,v\n0,0.5,0.5\n99999,0.5,0.5\n", ":3: ptex face 99999"),
        ("face,u,v\n0,0.5\n", ":2: "),
        ("face,u,v\n-1,0.5,0.5\n", ":2: "),
        ("face,u,v\nzero,0.5,0.5\n", ":2: "),
        ("face,u,v\n\n0,.5,.5\n\n\n0,2,0", ":6: u = 2"),
        ("face,u,v\r\n\r\n0,.5,.5\r\n\r\n0,2,0\r\n", ":5: u = 2"),
        ("\n\nface,u,v\n\n99999,0,0\n", ":5: ptex face"),
        ("face,u,v\n\"0\",\"0.5\n\",0.5\n\n0,2\n", ":5: "),
    ] {
        let path = folder.file("samples.csv", text);
        let message = folder.refused(&["eval", "--samples", path.to_str().expect("UTF-8"), "-o", "out.csv"]);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
}

#[test]
fn a_header_that_is_not_text_is_named() {
    let folder = Folder::new();
    std::fs::write(folder.path("samples.csv"), b"face,u,\xff\n0,0,0\n").expect("a writable folder");
    let message = folder.refused(&["eval", "--samples", "samples.csv", "-o", "out.csv"]);
    assert!(message.contains("samples.csv:1: the header is not face,u,v"), "{message}");
}

/// Rows of a CSV file that `eval` wrote: numbers, and the kind.
fn rows(path: &Path) -> Vec<(Vec<f64>, String)> {
    let mut reader = csv::Reader::from_path(path).expect("a CSV file");
    let header = reader.headers().expect("a header").iter().collect::<Vec<_>>().join(",");
    assert_eq!(header, "face,u,v,x,y,z,xu,yu,zu,xv,yv,zv,nx,ny,nz,kind");
    let row = |row: Result<csv::StringRecord, csv::Error>| {
        let row = row.expect("a row");
        let numbers = row.iter().take(15).filter(|x| !x.is_empty()).map(|x| x.parse().expect("a number")).collect();
        (numbers, row[15].to_owned())
    };
    reader.into_records().map(row).collect()
}

#[test]
fn evaluators_answer_in_order_and_agree() {
    let folder = Folder::new();
    let samples = folder.file("samples.csv", "face,u,v\n0,0.5,0.25\n3,0.125,0.5\n5,1,0.125\n2,0.3,0.9\n");
    let mut tables = Vec::new();
    for backend in ["cpu", "gpu", "osd"] {
        let out = folder.path("out.csv");
        let args = ["eval", "--samples", samples.to_str().expect("UTF-8"), "-o", "out.csv", "--backend", backend];
        let output = folder.run(args.iter().copied().chain([mesh("cube").to_str().expect("UTF-8")]));
        assert!(output.status.success(), "{backend}: {}", String::from_utf8_lossy(&output.stderr));
        tables.push(rows(&out));
    }
    for table in &tables {
        assert_eq!(table.iter().map(|(numbers, _)| numbers[0]).collect::<Vec<_>>(), [0.0, 3.0, 5.0, 2.0]);
        for ((numbers, kind), (reference, _)) in table.iter().zip(&tables[0]) {
            assert_eq!(kind, "smooth");
            for (a, b) in numbers.iter().zip(reference) {
                // f32 on the GPU: 2e-6 of the cube's diagonal, a few times that in derivatives.
                assert!((a - b).abs() < 2e-5, "{numbers:?} {reference:?}");
            }
        }
    }
}

#[test]
fn the_smallest_parameters_come_back_and_have_answers() {
    let folder = Folder::new();
    folder.file("samples.csv", "face,u,v\n0,5e-324,5e-324\n0,1e-305,1e-305\n0,1e-300,0.1\n0,0.30000000000000004,1\n");
    for backend in ["cpu", "gpu", "osd"] {
        let mesh = mesh("cube");
        let flags = ["eval", "--samples", "samples.csv", "-o", "out.csv", "--backend", backend];
        let output = folder.run(flags.iter().copied().chain([mesh.to_str().expect("UTF-8")]));
        assert!(output.status.success(), "{backend}: {}", String::from_utf8_lossy(&output.stderr));
        let text = std::fs::read_to_string(folder.path("out.csv")).expect("it is written");
        let places: Vec<_> =
            text.lines().skip(1).map(|line| line.split(',').take(3).collect::<Vec<_>>().join(",")).collect();
        assert_eq!(places, ["0,5e-324,5e-324", "0,1e-305,1e-305", "0,1e-300,0.1", "0,0.30000000000000004,1"]);
        let rows = rows(&folder.path("out.csv"));
        assert!(rows.iter().all(|(numbers, _)| numbers.iter().all(|x| x.is_finite())), "{backend}: {text}");
    }
}

/// The process file system takes no files from anybody, root included.
#[cfg(target_os = "linux")]
#[test]
fn a_locked_folder_is_told_without_the_temporary_name() {
    let folder = Folder::new();
    let message = folder.refused(&["verify", "--json", "/proc/v.json"]);
    assert!(message.contains("/proc/v.json") && !message.contains(".part"), "{message}");
}

#[test]
fn meshes_without_a_surface_are_no_pass() {
    let folder = Folder::new();
    folder.file("holes.obj", &format!("{QUAD}f 1 2 3 4\nt hole 1/0/0 0\n"));
    folder.file("no_interior.obj", &format!("{QUAD}f 1 2 3 4\nt interpolateboundary 1/0/0 0\n"));
    for mesh in ["holes.obj", "no_interior.obj"] {
        let message = folder.refused(&["verify", mesh, "--json", "v.json"]);
        assert!(message.contains("no face has a limit surface"), "{message}");
    }
    folder.file("tiny.obj", &format!("{}f 1 2 3 4\n", QUAD.replace('1', "1e-300")));
    assert!(folder.refused(&["verify", "tiny.obj"]).contains("underflow"));
}

#[test]
fn valence_is_told_as_what_the_mesh_has() {
    let folder = Folder::new();
    let points: String = (0..5000).map(|i| format!("v {i} {} 0\n", i * i)).collect();
    let face: String = (1..=5000).map(|i| format!(" {i}")).collect();
    folder.file("n_gon.obj", &format!("{points}f{face}\n"));
    assert!(folder.refused(&["info", "n_gon.obj"]).contains("a face of 5000 corners or a vertex of valence 5000"));
}

#[test]
fn holes_have_a_kind_and_no_numbers() {
    let folder = Folder::new();
    let samples = folder.file("samples.csv", "face,u,v\n5,0.5,0.5\n0,0.5,0.5\n");
    for backend in ["cpu", "gpu", "osd"] {
        let (mesh, samples) = (mesh("hole"), samples.as_path());
        let args = ["eval", mesh.to_str().expect("UTF-8"), "--samples", samples.to_str().expect("UTF-8")];
        let output = folder.run(args.iter().chain(&["-o", "out.csv", "--backend", backend]));
        assert!(output.status.success());
        let rows = rows(&folder.path("out.csv"));
        assert_eq!((rows[0].0.len(), rows[0].1.as_str()), (3, "hole"));
        assert_eq!((rows[1].0.len(), rows[1].1.as_str()), (15, "regular"));
    }
}

#[test]
fn info_counts_features_and_patches() {
    let folder = Folder::new();
    let output = folder.run(["info".as_ref(), mesh("pole_5").as_os_str(), "--json".as_ref()]);
    let info: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(info["patches"]["smooth"], 5);
    assert_eq!(info["interior_valences"]["5"], 1);
    let text = folder.run(["info".as_ref(), mesh("pole_5").as_os_str()]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("smooth: 5"));
    let levels = info["opensubdiv"].as_array().expect("a list of levels");
    assert_eq!(levels.len(), 10);
    for pair in levels.windows(2) {
        assert!(pair[1]["patches"].as_u64() > pair[0]["patches"].as_u64());
        assert!(pair[1]["bytes"].as_u64() > pair[0]["bytes"].as_u64());
        let position = |level: &serde_json::Value| level["gregory"]["position"]["max"].as_f64().expect("a number");
        assert!(position(&pair[1]) < position(&pair[0]) && position(&pair[1]) > 0.0);
    }
    // A pole of valence 5 inside: five end caps at every level, on an area that shrinks by four.
    assert!(levels.iter().all(|level| level["end_caps"] == 5));
    let area = |i: usize| levels[i]["gregory"]["area"].as_f64().expect("a number");
    assert!((area(3) * 4.0 - area(2)).abs() < 1e-12);
    let by_level = levels[9]["patches_by_level"].as_object().expect("a map").values();
    assert_eq!(
        by_level.map(|count| count.as_u64().expect("a count")).sum::<u64>(),
        levels[9]["patches"].as_u64().unwrap()
    );
    assert!(String::from_utf8_lossy(&text.stdout).contains("OpenSubdiv's feature-adaptive patches"));
    let text = folder.run(["info".as_ref(), mesh("pole_5").as_os_str(), "--levels".as_ref(), "0".as_ref()]);
    assert!(!String::from_utf8_lossy(&text.stdout).contains("OpenSubdiv"));
}

#[test]
fn verify_passes_and_says_so_everywhere() {
    let folder = Folder::new();
    let meshes = [mesh("cube"), mesh("dart")];
    let flags = ["verify", "--json", "v.json", "--size", "64x64"].map(PathBuf::from);
    let output = folder.run(flags.iter().chain(&meshes));
    let text = std::fs::read(folder.path("v.json")).expect("the report is written");
    let report: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
    assert_eq!(report["pass"], true, "{}", String::from_utf8_lossy(&output.stdout));
    assert!(output.status.success());
    assert!(String::from_utf8_lossy(&output.stdout).contains("pass: 2 meshes against"));
    let row = &report["meshes"][0]["tiers"][0];
    assert_eq!((&row["failed"], &row["normals_skipped"]), (&0.into(), &0.into()));
    let one = folder.run(["verify".as_ref(), mesh("cube").as_os_str(), "--size".as_ref(), "32x32".as_ref()]);
    assert!(String::from_utf8_lossy(&one.stdout).contains("pass: 1 mesh against"));
    let tiers = |mesh: usize| -> std::collections::BTreeSet<String> {
        let rows = report["meshes"][mesh]["tiers"].as_array().expect("rows");
        rows.iter().map(|row| row["tier"].as_str().expect("a name").to_owned()).collect()
    };
    let expected = ["dyadic", "endcap", "fragment", "regular", "vertex"].map(String::from);
    assert_eq!(tiers(0), expected.iter().cloned().collect());
    // Where OpenSubdiv is wrong, the report names it.
    assert!(!report["meshes"][1]["reference_known_wrong"].as_array().expect("a list").is_empty());
}

#[test]
fn pictures_have_their_size_and_repeat_bit_by_bit() {
    let folder = Folder::new();
    let render = |name: &str, pipeline: &str| {
        let mesh = mesh("corner");
        let args = ["render", mesh.to_str().expect("UTF-8"), "-o", name, "--size", "96x64", "--pipeline", pipeline];
        let output = folder.run(args);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(folder.path(name)).expect("the picture is written")
    };
    for pipeline in ["limit", "polygon", "points"] {
        let first = render("a.png", pipeline);
        assert_eq!(first, render("b.png", pipeline));
        let picture = image::load_from_memory(&first).expect("a PNG");
        assert_eq!((picture.width(), picture.height()), (96, 64));
    }
}

/// What takes more memory than it may is refused before it is taken: files, refinement, tables.
#[test]
fn memory_is_forecast() {
    let folder = Folder::new();
    // Random sharpness along all edges: refined to level 10 everywhere along them.
    let side = 60;
    let mut text = String::new();
    for k in 0..=side {
        (0..=side).for_each(|i| text += &format!("v {i} {k} {}\n", (i * k) % 7));
    }
    let vertex = |i: usize, j: usize| j * (side + 1) + i;
    for (i, j) in (0..side * side).map(|k| (k % side, k / side)) {
        let corners = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)].map(|v| v + 1);
        text += &format!("f {} {} {} {}\n", corners[0], corners[1], corners[2], corners[3]);
        for (k, end) in [vertex(i + 1, j), vertex(i, j + 1)].into_iter().enumerate() {
            let sharpness = 9.0 + ((i * 31 + j * 17 + k * 7) % 90) as f64 / 100.0;
            text += &format!("t crease 2/1/0 {} {end} {sharpness}\n", vertex(i, j));
        }
    }
    folder.file("sharp.obj", &text);
    for (limit, what) in [("100KiB", "to be read"), ("200MiB", "to be refined"), ("0", "nothing fits")] {
        let message = folder.refused(&["info", "sharp.obj", "--memory-limit", limit]);
        assert!(message.contains(what), "{limit}: {message}");
    }
    let message = folder.refused(&["render", "--memory-limit", "300MiB"]);
    assert!(message.contains("sample: to be drawn"), "{message}");
    folder.refused(&["info", "--memory-limit", "much"]);
    assert!(folder.run(["info", "--memory-limit", "1GiB"]).status.success());
}

/// The certificates on standard error and in JSON, and as colours.
#[test]
fn certificates_are_told() {
    let folder = Folder::new();
    let output = folder.run(["render", "-o", "a.png", "--size", "64x48", "--json", "a.json", "--show", "residual"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{message}");
    assert!(message.starts_with("exact: ") && message.ends_with("0 not converged\n"), "{message}");
    let json = std::fs::read(folder.path("a.json")).expect("it was written");
    let json: serde_json::Value = serde_json::from_slice(&json).expect("it is JSON");
    let certificate = &json["certificate"];
    assert_eq!(certificate["samples"], 64 * 48);
    assert_eq!(certificate["unconverged"], 0);
    let residual = certificate["residual_max_pixels"].as_f64().expect("a number");
    assert!(residual > 0.0 && residual < 1e-3, "{residual}");
    assert_eq!(image::open(folder.path("a.png")).expect("a picture").to_rgb8().dimensions(), (64, 48));
}
