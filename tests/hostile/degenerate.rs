//! Meshes of which little is left: points on one place or line, sizes at the ends of the range, parts that vanish, faces edge-on.

use super::Folder;

const CUBE: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];
const FACES: &str = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// The cube with its points elsewhere.
fn cube(change: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> String {
    let point = |(k, p): (usize, &[f64; 3])| {
        let [x, y, z] = change(k, *p);
        format!("v {x:e} {y:e} {z:e}\n")
    };
    CUBE.iter().enumerate().map(point).collect::<String>() + FACES
}

/// Meshes by name, and whether they have an area.
fn meshes() -> Vec<(&'static str, String, bool)> {
    let along = |k: usize| k as f64 - 3.5;
    vec![
        ("point", cube(|_, _| [1.0, 2.0, 3.0]), false),
        ("origin", cube(|_, _| [0.0; 3]), false),
        ("line", cube(|k, _| [0.1, 0.2, 0.3].map(|x| x * along(k))), false),
        ("far", cube(|_, [x, y, z]| [x + 1e18, y, z]), false),
        ("subnormal", cube(|_, p| p.map(|x| x * 5e-324)), false),
        ("small", cube(|_, p| p.map(|x| x * 1e-30)), true),
        ("large", cube(|_, p| p.map(|x| x * 1e18)), true),
        ("flat", cube(|_, [x, y, _]| [x, y, 0.0]), true),
        ("collapsed", cube(|k, p| if k < 4 { [0.0; 3] } else { p }), true),
        ("triangle", "v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\nf 1 2 3\n".to_owned(), true),
    ]
}

fn is_number(text: &str) -> bool {
    let lower = text.to_lowercase();
    let words = lower.split(|c: char| !c.is_alphanumeric());
    !words.into_iter().any(|word| matches!(word, "nan" | "inf" | "infinity"))
}

/// Every command does what it can: no panic, no NaN in any answer, and no picture of nothing without a word.
#[test]
fn every_command_takes_what_little_there_is() {
    let folder = Folder::new();
    folder.write("s.csv", "face,u,v\n0,0.5,0.5\n0,0,0\n");
    let commands = [
        "render M --size=32x32 -o out.png --json=out.json",
        "render M --size=32x32 -o out.png --pipeline=limit --field=curvature:mean --pattern=heat",
        "render M --size=32x32 -o out.png --patches=osd:3 --compare",
        "lines M -o out.svg",
        "lines M --field=highlight",
        "quality M --json=out.json",
        "quality M --weld=1e18 -o out.png --size=32x32",
        "glints M --light-point=3,3,5",
        "eval M --samples=s.csv",
        "info M --json --levels=1",
        "verify M --json=out.json --size=16x16",
    ];
    for (name, text, has_area) in meshes() {
        let path = folder.write(&format!("{name}.obj"), text).display().to_string();
        for command in commands {
            let args: Vec<&str> =
                command.split(' ').map(|word| if word == "M" { path.as_str() } else { word }).collect();
            let output = folder.run(&args);
            let [out, error] =
                [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
            let what = format!("{name}: {command}: {error}");
            assert!(matches!(output.status.code(), Some(0..=2)) && !error.contains("panicked"), "{what}");
            assert!(is_number(&out) && is_number(&error), "{what}\n{out}");
            for file in ["out.json", "out.svg"].map(|file| folder.path(file)) {
                if let Ok(written) = std::fs::read_to_string(&file) {
                    assert!(is_number(&written), "{what}\n{written}");
                    std::fs::remove_file(file).expect("it is ours");
                }
            }
            let said = error.lines().filter(|line| line.contains("the surface has no area; ")).count();
            if command.starts_with("render") || command.starts_with("lines") || command.starts_with("glints") {
                assert_eq!(said, usize::from(!has_area), "{what}");
            }
        }
    }
}

/// A plane seen from its edge, from behind the eye, or from beside: the picture is empty, and it is said why, once.
#[test]
fn empty_pictures_say_so() {
    let folder = Folder::new();
    folder.write("plane.obj", "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 1 2 3 4\nt interpolateboundary 1/0/0 1\n");
    for pipeline in ["exact", "limit", "points"] {
        let render = |view: &str, is_empty: bool| {
            let line = format!("render plane.obj --size=32x32 -o v.png --pipeline={pipeline} {view}");
            let output = folder.run(&line.split(' ').collect::<Vec<_>>());
            let error = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(0), "{line}: {error}");
            let said =
                error.lines().filter(|line| line.contains("no sample of the picture sees the surface: ")).count();
            assert_eq!(said, usize::from(is_empty), "{line}: {error}");
        };
        render("--eye=-5,2,0 --target=2,2,0", true);
        render("--eye=2,2,5 --target=2,2,9 --up=0,1,0", true);
        render("--eye=2,-20,5 --target=20,-20,5", true);
        render("--eye=2,-20,5 --target=2,2,0", false);
    }
    // All faces are holes: there is no surface at all.
    folder.write("holes.obj", cube(|_, p| p) + &(0..6).map(|k| format!("t hole 1/0/0 {k}\n")).collect::<String>());
    let message = folder.refused(&["render", "holes.obj", "-o", "v2.png"]);
    assert!(message.contains("no face has a limit surface"), "{message}");
}

/// `info` and `render` name the first face that runs against its neighbours, by its line; in a stage by its prim.
#[test]
fn reversed_faces_are_named() {
    let folder = Folder::new();
    folder.write("flipped.obj", cube(|_, p| p).replace("f 5 6 7 8", "f 8 7 6 5"));
    let expected = "flipped.obj: 1 face runs against its neighbours, face 1 (line 10): ";
    let output = folder.run(&["render", "flipped.obj", "--size=32x32", "-o", "v.png"]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(error.contains(expected) && output.status.success(), "{error}");
    let info = |args: &[&str]| String::from_utf8_lossy(&folder.run(args).stdout).into_owned();
    let text = info(&["info", "flipped.obj", "--levels=0"]);
    assert!(text.contains("\nagainst their neighbours  1 (the first: face 1 (line 10); flip it)\n"), "{text}");
    let json: serde_json::Value =
        serde_json::from_str(&info(&["info", "flipped.obj", "--json", "--levels=0"])).expect("JSON");
    let first = serde_json::json!({ "count": 1, "first": { "face": 1, "line": 10, "prim": null } });
    assert_eq!((&json["reversed_faces"], &json["one_sided_components"]["count"]), (&first, &0.into()));
    let prim = |name: &str, indices: &str| {
        format!(
            "def Mesh \"{name}\" {{ int[] faceVertexCounts = [4, 4]\n int[] faceVertexIndices = [{indices}]\n \
             point3f[] points = [(0,0,0), (1,0,0), (2,0,0), (0,1,0), (1,1,0), (2,1,0)] }}\n"
        )
    };
    let stage = prim("Right", "0,1,4,3,1,2,5,4") + &prim("Wrong", "0,1,4,3,4,5,2,1");
    folder.write("stage.usda", "#usda 1.0\n".to_owned() + &stage);
    let text = info(&["info", "stage.usda", "--levels=0"]);
    assert!(text.contains("\nagainst their neighbours  1 (the first: face 1 of /Wrong; flip it)\n"), "{text}");
}
