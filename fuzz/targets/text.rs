//! OBJ, its tags, and CSV.

use super::check_message;
use super::draft::{Draft, Input};
use arbitrary::Unstructured;
use catoptric::cli::{parse_answers, parse_samples};
use catoptric::mesh::{SubdivMesh, parse_obj};
use std::fmt::Write;
use std::path::Path;

/// The bytes of an OBJ.
pub fn obj(data: &[u8]) {
    read(data);
}

fn read(text: &[u8]) -> Option<SubdivMesh> {
    match parse_obj(text, "mesh.obj") {
        Ok(mesh) => {
            mesh.validate().expect("what is read is valid");
            Some(mesh)
        }
        Err(error) => {
            check_message(&error.to_string(), "mesh.obj");
            None
        }
    }
}

/// A small mesh with tags that are nearly right.
pub fn tags(data: &[u8]) {
    let mut input = Unstructured::new(data);
    let _ = tagged(&mut input).map(|text| read(text.as_bytes()));
}

fn tagged(input: &mut Input<'_>) -> arbitrary::Result<String> {
    let draft = Draft::base(input)?;
    let mut text = draft.obj();
    for _ in 0..input.int_in_range(0..=8)? {
        let known = [
            "crease",
            "corner",
            "hole",
            "interpolateboundary",
            "creasemethod",
            "smoothtriangles",
            "scheme",
            "facevaryinginterpolateboundary",
            "facevaryingpropagatecorners",
        ];
        let name = if input.ratio(9, 10)? { *input.choose(&known)? } else { input.arbitrary()? };
        let mut ints = Vec::new();
        for _ in 0..input.int_in_range(0..=6)? {
            ints.push(match input.int_in_range(0..=9)? {
                0 => input.arbitrary::<i64>()?.to_string(),
                1 => input.arbitrary::<&str>()?.to_owned(),
                _ => input.int_in_range(0..=draft.points.len() as i64)?.to_string(),
            });
        }
        // A chain of edges, so that creases are accepted as well.
        if name == "crease" && input.ratio(2, 3)? {
            ints = draft.chain(input)?.iter().map(u32::to_string).collect();
        }
        let mut floats = Vec::new();
        for _ in 0..input.int_in_range(0..=6)? {
            floats.push(match input.int_in_range(0..=9)? {
                0 => input.arbitrary::<f64>()?.to_string(),
                1 => input.arbitrary::<&str>()?.to_owned(),
                _ => input.int_in_range(0..=11)?.to_string(),
            });
        }
        let mut strings = Vec::new();
        for _ in 0..input.int_in_range(0..=2)? {
            let words =
                ["normal", "uniform", "chaikin", "catmark", "smooth", "loop", "bilinear", "none", "catmullClark"];
            strings.push(if input.ratio(3, 4)? { *input.choose(&words)? } else { input.arbitrary()? });
        }
        let right = format!("{}/{}/{}", ints.len(), floats.len(), strings.len());
        let counts = if input.ratio(9, 10)? { right } else { input.arbitrary::<String>()? };
        let values: Vec<_> = ints.iter().chain(&floats).map(String::as_str).chain(strings).collect();
        let _ = writeln!(text, "t {name} {counts} {}", values.join(" "));
    }
    Ok(text)
}

/// The bytes of a CSV file, as samples and as another program's answers.
pub fn samples(data: &[u8]) {
    const FACES: usize = 6;
    let name = Path::new("samples.csv");
    let check = |(face, u, v): (u32, f64, f64)| {
        assert!((face as usize) < FACES && (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v), "{face} {u} {v}");
    };
    for triangles in [false, true] {
        match parse_samples(data, name, FACES, triangles) {
            Ok(samples) => samples.into_iter().for_each(check),
            Err(message) => check_message(&message, "samples.csv"),
        }
    }
    match parse_answers(data, name, FACES) {
        Ok(answers) => {
            assert!(answers.iter().any(|answer| answer.position.is_some()));
            for answer in answers {
                check((answer.at.face, answer.at.u, answer.at.v));
                assert!(answer.position.is_none_or(|p| p.is_finite()));
            }
        }
        Err(message) => check_message(&message, "samples.csv"),
    }
}
