//! `catoptric glints` as a user meets it.

use std::path::Path;
use std::process::{Command, Output};

fn glints(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_catoptric"));
    command.arg("glints").args(args).current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes"));
    command.output().expect("the program starts")
}

fn text(output: &Output) -> &str {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    std::str::from_utf8(&output.stdout).expect("text")
}

const EYE: &str = "--eye=3.5,-2.5,4";
const LIGHTS: [&str; 2] = ["--light-point=1,4,5", "--light-point=-3,0.5,4"];

/// The same points as CSV and as JSON, and each of them mirrors.
#[test]
fn csv_and_json_say_the_same() {
    let csv = glints(&["cube.obj", EYE, LIGHTS[0], LIGHTS[1]]);
    let mut reader = csv::Reader::from_reader(text(&csv).as_bytes());
    assert_eq!(reader.headers().expect("a header").as_slice(), "lightfaceuvxyznxnynzresidualnature");
    let rows: Vec<Vec<String>> =
        reader.records().map(|row| row.expect("a row").iter().map(str::to_owned).collect()).collect();
    let json = glints(&["cube.obj", EYE, LIGHTS[0], LIGHTS[1], "--json"]);
    let json: serde_json::Value = serde_json::from_str(text(&json)).expect("JSON");
    assert_eq!(json["eye"], serde_json::json!([3.5, -2.5, 4.0]));
    let mut count = 0;
    for (light, entry) in json["lights"].as_array().expect("a list").iter().enumerate() {
        let points = entry["points"].as_array().expect("a list");
        assert!(!points.is_empty());
        for point in points {
            let row = &rows[count];
            assert_eq!((row[0].parse::<usize>(), row[1].as_str()), (Ok(light), point["face"].to_string().as_str()));
            for (k, x) in
                ["position", "normal"].iter().flat_map(|key| point[key].as_array().expect("a vector")).enumerate()
            {
                assert_eq!(row[4 + k].parse::<f64>().ok(), x.as_f64());
            }
            assert_eq!(row[11], point["nature"].as_str().expect("text"));
            assert!(point["residual"].as_f64().expect("a number") < 1e-12);
            count += 1;
        }
    }
    assert_eq!(count, rows.len());
}

#[test]
fn files_defaults_and_faults() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("glints.csv");
    let path = format!("--output={}", file.display());
    let with_file = glints(&["cube.obj", "--eye-direction=1,-2,3", LIGHTS[0], &path]);
    assert!(text(&with_file).is_empty());
    let written = std::fs::read_to_string(&file).expect("the file");
    assert!(written.starts_with("light,face,u,v,") && written.lines().count() > 1, "{written}");
    // The sample, and an eye that is fitted.
    assert!(text(&glints(&["--light-point=2,3,4"])).lines().count() > 1);
    for (args, fault) in [
        (vec!["cube.obj"], "--light-point"),
        (vec!["cube.obj", "--light-point=1,2"], "three finite numbers"),
        (vec!["cube.obj", LIGHTS[0], "--eye-direction=0,0,0"], "--eye-direction"),
        (vec!["cube.obj", LIGHTS[0], EYE, "--eye-direction=0,0,1"], "does not go with"),
        (vec!["nothing.obj", LIGHTS[0]], "nothing.obj"),
    ] {
        let output = glints(&args);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
        assert!(said.contains(fault) && said.lines().count() == 1, "{args:?}: {said}");
    }
}
