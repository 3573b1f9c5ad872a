//! USD: whole files, and the attributes of Mesh prims.

use super::check_message;
use super::draft::{Draft, Input};
use arbitrary::Unstructured;
use catoptric::mesh;
use std::fmt::Write;

/// The bytes of a file, named by what they begin with, or `.usd`, for which the reader looks itself.
pub fn usd_file(data: &[u8]) {
    let extension = match data {
        _ if data.len() % 2 == 1 => "usd",
        [b'P', b'X', b'R', ..] => "usdc",
        [b'P', b'K', ..] => "usdz",
        _ => "usda",
    };
    read(data, extension);
}

/// The text of a stage with meshes whose attributes are nearly right.
pub fn usd_attributes(data: &[u8]) {
    let mut input = Unstructured::new(data);
    if let Ok(text) = stage(&mut input) {
        read(text.as_bytes(), "usda");
    }
}

fn read(data: &[u8], extension: &str) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh").with_extension(extension);
    std::fs::write(&path, data).expect("a temporary file");
    match mesh::read(&path) {
        Ok(mesh) => mesh.validate().expect("what is read is valid"),
        Err(error) => check_message(&error.to_string(), path.to_str().expect("UTF-8")),
    }
}

fn stage(input: &mut Input<'_>) -> arbitrary::Result<String> {
    let mut text = "#usda 1.0\n".to_owned();
    if input.ratio(1, 4)? {
        let _ = writeln!(text, "(\n    upAxis = \"{}\"\n    defaultPrim = \"m0\"\n)", input.choose(&["Y", "Z", "X"])?);
    }
    for i in 0..input.int_in_range(1..=3)? {
        let kind = *input.choose(&["Xform", "Scope", "PointInstancer", "", "Mesh", "Mesh", "Mesh"])?;
        let _ = writeln!(text, "def {kind} \"m{i}\"{}\n{{", arcs(input)?);
        text += &transforms(input)?;
        if kind == "Mesh" {
            text += &attributes(input)?;
        } else {
            let _ = writeln!(
                text,
                "def Mesh \"child\"{}\n{{\n{}{}}}",
                arcs(input)?,
                transforms(input)?,
                attributes(input)?
            );
        }
        text += "}\n";
    }
    Ok(text)
}

/// References and the like, circles among them.
fn arcs(input: &mut Input<'_>) -> arbitrary::Result<String> {
    let mut text = String::new();
    for _ in 0..input.int_in_range(0..=2)? {
        let kind = *input.choose(&["references", "payload", "inherits", "specializes", "instanceable", "active"])?;
        let target =
            *input.choose(&["</m0>", "</m1>", "</m0/child>", "</m2/child>", "@./mesh.usda@</m1>", "@gone.usda@"])?;
        let value = match kind {
            "instanceable" | "active" => *input.choose(&["true", "false"])?,
            "inherits" | "specializes" if target.starts_with('@') => "</m1>",
            _ => target,
        };
        let _ = write!(text, "\n    {kind} = {value}");
    }
    Ok(if text.is_empty() { text } else { format!(" ({text}\n)") })
}

fn transforms(input: &mut Input<'_>) -> arbitrary::Result<String> {
    let mut text = String::new();
    let mut order = Vec::new();
    for _ in 0..input.int_in_range(0..=2)? {
        let (kind, name) = *input.choose(&[
            ("double3", "translate"),
            ("float3", "scale"),
            ("float", "rotateX"),
            ("float3", "rotateXYZ"),
            ("quatf", "orient"),
            ("matrix4d", "transform"),
            ("half3", "scale"),
            ("double", "scaleY"),
            ("string", "translate"),
            ("float3", "rotateZZZ"),
        ])?;
        let n = |input: &mut Input<'_>| number(input);
        let value = match kind {
            "float" | "double" => n(input)?,
            "quatf" => format!("({}, {}, {}, {})", n(input)?, n(input)?, n(input)?, n(input)?),
            "string" => "\"far\"".to_owned(),
            "matrix4d" => {
                let mut row = || Ok::<_, arbitrary::Error>(format!("({}, {}, 0, {})", n(input)?, n(input)?, n(input)?));
                format!("({}, {}, {}, {})", row()?, row()?, row()?, row()?)
            }
            _ => format!("({}, {}, {})", n(input)?, n(input)?, n(input)?),
        };
        let _ = writeln!(text, "{kind} xformOp:{name} = {value}");
        let inverted = if input.ratio(1, 8)? { "!invert!" } else { "" };
        order.push(format!("\"{inverted}xformOp:{name}\""));
    }
    if input.ratio(1, 8)? {
        order.push("\"!resetXformStack!\"".to_owned());
    }
    if !order.is_empty() {
        let _ = writeln!(text, "uniform token[] xformOpOrder = [{}]", order.join(", "));
    }
    for (name, values) in [("visibility", ["inherited", "invisible"]), ("purpose", ["render", "proxy"])] {
        if input.ratio(1, 8)? {
            let _ = writeln!(text, "token {name} = \"{}\"", input.choose(&values)?);
        }
    }
    Ok(text)
}

/// The attributes of a small mesh, each of them right, wrong, or not there.
fn attributes(input: &mut Input<'_>) -> arbitrary::Result<String> {
    let draft = Draft::base(input)?;
    let points: Vec<_> = draft.points.iter().map(|p| format!("({}, {}, {})", p.x, p.y, p.z)).collect();
    let sizes: Vec<_> = draft.faces.iter().map(|face| face.len().to_string()).collect();
    let vertices: Vec<_> = draft.faces.concat().iter().map(u32::to_string).collect();
    let chain: Vec<_> = draft.chain(input)?.iter().map(u32::to_string).collect();
    let length = chain.len().to_string();
    let mut text = String::new();
    for (kind, name, right) in [
        ("point3f[]", "points", format!("[{}]", points.join(", "))),
        ("int[]", "faceVertexCounts", format!("[{}]", sizes.join(", "))),
        ("int[]", "faceVertexIndices", format!("[{}]", vertices.join(", "))),
        ("int[]", "creaseIndices", format!("[{}]", chain.join(", "))),
        ("int[]", "creaseLengths", format!("[{length}]")),
        ("float[]", "creaseSharpnesses", format!("[{}]", number(input)?)),
        ("int[]", "cornerIndices", "[0, 1]".to_owned()),
        ("float[]", "cornerSharpnesses", format!("[{}, 2]", number(input)?)),
        ("int[]", "holeIndices", "[0]".to_owned()),
        ("token", "interpolateBoundary", "\"edgeOnly\"".to_owned()),
        ("token", "subdivisionScheme", "\"catmullClark\"".to_owned()),
        ("token", "orientation", "\"leftHanded\"".to_owned()),
        ("token", "triangleSubdivisionRule", "\"catmullClark\"".to_owned()),
    ] {
        let kinds = ["int[]", "float[]", "token", "point3f[]", "double3[]", "half", "int64[]", "string", "asset"];
        match input.int_in_range(0..=15)? {
            0 => {}
            1 => drop(writeln!(text, "{kind} {name} = {}", wrong(input)?)),
            2 => drop(writeln!(text, "{} {name} = {}", input.choose(&kinds)?, wrong(input)?)),
            3 => drop(writeln!(text, "{kind} {name}.timeSamples = {{ {}: {right}, 2: None }}", number(input)?)),
            4 => drop(writeln!(text, "{kind} {name} = None")),
            _ => drop(writeln!(text, "{kind} {name} = {right}")),
        }
    }
    Ok(text)
}

/// A value of some type.
fn wrong(input: &mut Input<'_>) -> arbitrary::Result<String> {
    let mut list = Vec::new();
    for _ in 0..input.int_in_range(0..=6)? {
        list.push(number(input)?);
    }
    Ok(match input.int_in_range(0..=5)? {
        0 => number(input)?,
        1 => format!(
            "\"{}\"",
            input.choose(&["none", "loop", "bilinear", "edgeAndCorner", "", "smooth", "rightHanded", "\\n"])?
        ),
        2 => format!("[({})]", list.join(", ")),
        3 => input.arbitrary::<&str>()?.to_owned(),
        _ => format!("[{}]", list.join(", ")),
    })
}

fn number(input: &mut Input<'_>) -> arbitrary::Result<String> {
    Ok(match input.int_in_range(0..=7)? {
        0 => input.arbitrary::<f64>()?.to_string(),
        1 => input.arbitrary::<i64>()?.to_string(),
        2 => (*input.choose(&["inf", "-inf", "nan", "1e400", "-0", "2147483648", "1e-320", "1e38"])?).to_owned(),
        3 => input.arbitrary::<i8>()?.to_string(),
        _ => input.int_in_range(0..=11)?.to_string(),
    })
}
