//! Time: stages at a time code, and sequences of files.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use catoptric::mesh::{self, Choice, MeshFile, SubdivMesh};
use glam::DVec3;

use crate::fixtures::{assert_attributes, expected, folder};
use crate::{HEADER, SQUARE, prim};

fn at(path: &Path, time: Option<f64>) -> SubdivMesh {
    let file = MeshFile::open(path).expect("a stage");
    file.read(&Choice { time, ..Choice::default() }).unwrap_or_else(|error| panic!("{error}"))
}

/// Where samples are, to rounding; between them usd-core interpolates angles, points and weights in 32 bits, and so do we.
#[test]
fn stages_move_as_in_usd_core() {
    let (mut compared, mut exact, mut between) = (0, 0.0_f64, 0.0_f64);
    for extension in ["usda", "usdc", "usdz"] {
        let path = folder().join("moving").with_extension(extension);
        for moment in &expected("moving").times {
            let mesh = at(&path, moment.time);
            let names: Vec<&str> = mesh.parts.iter().map(|part| part.name.as_str()).collect();
            let shown: Vec<&str> = moment.meshes.iter().map(|prim| prim.prim.as_str()).collect();
            assert_eq!(names, shown, "{} at {:?}", path.display(), moment.time);
            for (part, prim) in mesh.parts.iter().zip(&moment.meshes) {
                let choice = Choice { prims: vec![prim.prim.clone()], time: moment.time, ..Choice::default() };
                let alone = mesh::read_choice(&path, &choice).expect("a mesh");
                assert_attributes(&alone, prim, &prim.prim);
                let points = &mesh.points[part.points.start as usize..part.points.end as usize];
                assert_eq!(points, alone.points);
                let world = prim.world();
                let size = world.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
                let off = points.iter().zip(&world).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max) / size;
                // Before the first and behind the last sample of everything.
                let is_held = moment.time.is_some_and(|time| time <= 1.0 || time >= 10.0);
                if is_held {
                    exact = exact.max(off)
                } else {
                    between = between.max(off)
                }
                compared += 1;
            }
        }
    }
    println!("{compared} meshes; at most {exact:.1e} of their size off at samples, {between:.1e} between");
    assert!(compared >= 60, "only {compared} meshes");
    assert!(exact <= 1e-14, "{exact:e}");
    // A unit in the last place of 32 bits is 1.2e-7, and angle and points may both be one off.
    assert!(between <= 5e-7, "{between:e}");
}

/// At the default time, what has samples alone is as at its first.
#[test]
fn the_default_time_is_before_all_samples() {
    let path = folder().join("moving.usda");
    assert_eq!(mesh::read(&path).expect("a mesh"), at(&path, Some(-100.0)));
}

#[test]
fn defaults_count_where_there_is_no_sample() {
    let samples =
        "double3 xformOp:translate = (0, 0, 5)\ndouble3 xformOp:translate.timeSamples = { 1: (0, 0, 1), 3: (0, 0, 2) }
        uniform token[] xformOpOrder = [\"xformOp:translate\"]";
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh.usda");
    fs::write(&path, HEADER.to_owned() + &prim("m", &format!("{SQUARE}{samples}"))).expect("a file");
    let height = |time| at(&path, time).points[0].z;
    assert_eq!([None, Some(0.0), Some(1.5), Some(9.0)].map(height), [5.0, 1.0, 1.25, 2.0]);
}

fn run(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
    command.args(args).current_dir(folder).output().expect("the program starts")
}

fn answers(folder: &Path, args: &[&str]) -> String {
    let told = run(folder, &[&["eval", "--samples", "samples.csv"], args].concat());
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    String::from_utf8(told.stdout).expect("text")
}

fn refusal(folder: &Path, args: &[&str]) -> String {
    let told = run(folder, args);
    assert_eq!(told.status.code(), Some(2));
    String::from_utf8(told.stderr).expect("text").trim_start_matches("catoptric: ").trim_end().to_owned()
}

/// A bumpy square at frames 1 to 3, as a stage with samples and as an OBJ each.
fn sequence(folder: &Path) {
    let points = |frame: f64| {
        let point =
            |k: u32| DVec3::new(f64::from(k % 4), f64::from(k / 4), if k == 5 { frame } else { f64::from(k % 3) });
        (0..16).map(point).collect::<Vec<_>>()
    };
    let faces: Vec<[u32; 4]> = (0..9).map(|k| k % 3 + k / 3 * 4).map(|k| [k, k + 1, k + 5, k + 4]).collect();
    let mut samples = String::new();
    for frame in 1..=3 {
        let text: Vec<String> = points(frame.into()).iter().map(|p| format!("({}, {}, {})", p.x, p.y, p.z)).collect();
        samples += &format!("{frame}: [{}],\n", text.join(", "));
        let mut obj = "t interpolateboundary 1/0/0 1\n".to_owned();
        points(frame.into()).iter().for_each(|p| obj += &format!("v {} {} {}\n", p.x, p.y, p.z));
        faces.iter().for_each(|f| obj += &format!("f {} {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1, f[3] + 1));
        fs::write(folder.join(format!("mesh.{frame:04}.obj")), obj).expect("a file");
    }
    let list = |values: &[u32]| values.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
    let mesh = format!(
        "point3f[] points.timeSamples = {{\n{samples}}}\nint[] faceVertexCounts = [{}]\nint[] faceVertexIndices = [{}]",
        list(&[4; 9]),
        list(&faces.concat())
    );
    fs::write(folder.join("mesh.usda"), HEADER.to_owned() + &prim("m", &mesh)).expect("a file");
    fs::write(folder.join("samples.csv"), "face,u,v\n0,0.5,0.5\n4,0.25,1\n8,1,0\n").expect("a file");
}

/// A stage at a time and the OBJ of that frame give the same answers.
#[test]
fn the_program_takes_times_of_stages_and_of_sequences() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    sequence(folder);
    for frame in ["1", "2", "3"] {
        let own = answers(folder, &[&format!("mesh.000{frame}.obj")]);
        assert_eq!(answers(folder, &["mesh.####.obj", "--time", frame]), own);
        assert_eq!(answers(folder, &["mesh.%04d.obj", "--time", frame]), own);
        assert_eq!(answers(folder, &["mesh.usda", "--time", frame]), own);
    }
    assert_eq!(answers(folder, &["mesh.usda"]), answers(folder, &["mesh.usda", "--time", "1"]));
    assert_ne!(answers(folder, &["mesh.usda", "--time", "1"]), answers(folder, &["mesh.usda", "--time", "1.5"]));

    let eval = |args: &[&str]| refusal(folder, &[&["eval", "--samples", "samples.csv"], args].concat());
    let number = "the name has a place for the number of a frame";
    assert_eq!(eval(&["mesh.####.obj"]), format!("mesh.####.obj: no such file, and {number}; give --time"));
    assert_eq!(
        eval(&["mesh.####.obj", "--time", "1.5"]),
        format!("mesh.####.obj: {number}, and --time 1.5 is none; give 0, 1, 2 ...")
    );
    assert_eq!(eval(&["mesh.####.obj", "--time", "4"]), "mesh.0004.obj: no such file; check the path");
    let no_time =
        "an OBJ has no time; leave --time out, give a USD file, or have #### in the name for the number of the frame";
    assert_eq!(eval(&["mesh.0001.obj", "--time", "1"]), format!("mesh.0001.obj: {no_time}"));
    assert!(eval(&["mesh.usda", "--time", "x"]).contains("give a time code, a number"));
    assert!(eval(&["--time", "1"]).contains("--time is for USD files and sequences"));
}

/// Each frame of a series is the picture that its recorded command makes alone, and that of the mesh in a file of its own.
#[test]
fn animations_are_their_pictures_one_by_one() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    sequence(folder);
    let fixed =
        ["--size", "64x64", "--eye", "1.5,-6,8", "--target", "1.5,1.5,1", "--up", "0,0,1", "--light-center", "0,0,20"];
    let light = ["--light-normal", "0,0,-1", "--light-lines", "1,0,0", "--light-spacing", "4"];
    let render = |args: &[&str]| {
        let told = run(folder, &[&["render"], args, &fixed, &light].concat());
        assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    };
    let pixels =
        |name: &str| image::open(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}")).to_rgba8();
    render(&["mesh.usda", "-o", "usd.png", "--time", "1:3"]);
    render(&["mesh.####.obj", "-o", "obj.####.png", "--time", "1:3"]);
    for frame in 1..=3 {
        render(&[&format!("mesh.000{frame}.obj"), "-o", "alone.png"]);
        let alone = pixels("alone.png");
        assert_eq!(pixels(&format!("usd_000{frame}.png")), alone);
        assert_eq!(pixels(&format!("obj.000{frame}.png")), alone);
    }
    assert_ne!(pixels("usd_0001.png"), pixels("usd_0003.png"));
    // Times that are no numbers of frames are counted.
    render(&["mesh.usda", "-o", "half.png", "--time", "1:2:0.5"]);
    assert_eq!([pixels("half_0001.png"), pixels("half_0003.png")], [pixels("usd_0001.png"), pixels("usd_0002.png")]);
    // What is there stays, what is not is drawn.
    let whole = fs::read(folder.join("usd_0002.png")).expect("a frame");
    let command = String::from_utf8_lossy(&whole).into_owned();
    assert!(command.contains("render mesh.usda --time=2 "), "the command is recorded with its time");
    fs::remove_file(folder.join("usd_0002.png")).expect("removed");
    render(&["mesh.usda", "-o", "usd.png", "--time", "1:3", "--resume"]);
    assert_eq!(fs::read(folder.join("usd_0002.png")).expect("a frame"), whole);
    // A turntable of something that moves.
    render(&["mesh.usda", "-o", "turn.png", "--time", "1:3", "--orbit", "360"]);
    assert_eq!(pixels("turn_0001.png"), pixels("usd_0001.png"));
    assert_ne!(pixels("turn_0002.png"), pixels("usd_0002.png"));

    let message = refusal(folder, &["render", "mesh.usda", "--time", "1:3", "--frames", "3", "--orbit", "9"]);
    assert_eq!(message, "--time FIRST:LAST says how many pictures there are; leave --frames out");
    let other = fs::read_to_string(folder.join("mesh.0003.obj")).expect("a file") + "t corner 1/1/0 5 2\n";
    fs::write(folder.join("mesh.0003.obj"), other).expect("a file");
    let message = refusal(folder, &["render", "mesh.####.obj", "-o", "x.png", "--time", "1:3", "--size", "16x16"]);
    // What was drawn until then is there, and is named.
    assert_eq!(
        message,
        "wrote x_0001.png to x_0002.png, 2 pictures of 16x16 pixels\n\
         catoptric: mesh.0003: at time 3 sharp vertices differ, so it is another surface; give frames of one topology"
    );
}

/// A prim that turns into its mirror image turns its faces over: each frame is the picture of its own stage.
#[test]
fn prims_may_turn_into_their_mirror_images() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let mirror = "float3 xformOp:scale.timeSamples = { 1: (1, 1, 1), 2: (-1, 1, 1) }\nuniform token[] xformOpOrder = [\"xformOp:scale\"]\n";
    let bent = SQUARE.replace("(1, 1, 0)", "(1, 1, 0.5)");
    fs::write(folder.join("mesh.usda"), HEADER.to_owned() + &prim("m", &format!("{bent}{mirror}"))).expect("a file");
    let fixed =
        ["--size", "48x48", "--eye", "0,-6,8", "--target", "0,0,0", "--up", "0,0,1", "--light-center", "0,0,20"];
    let light = ["--light-normal", "0,0,-1", "--light-lines", "1,0,0", "--light-spacing", "4"];
    let render = |args: &[&str]| {
        let told = run(folder, &[&["render", "mesh.usda"], args, &fixed, &light].concat());
        assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    };
    render(&["-o", "series.png", "--time", "1:2"]);
    let pixels = |name: &str| image::open(folder.join(name)).expect("a picture").to_rgba8();
    for frame in ["1", "2"] {
        render(&["-o", "alone.png", "--time", frame]);
        assert_eq!(pixels(&format!("series_000{frame}.png")), pixels("alone.png"), "frame {frame}");
    }
    assert_ne!(pixels("series_0001.png"), pixels("series_0002.png"));
    let faces = |time| at(&folder.join("mesh.usda"), Some(time)).face_vertices;
    assert_eq!([faces(1.0), faces(2.0)], [vec![0, 1, 2, 3], vec![0, 3, 2, 1]]);
}
