//! `glints`: the points that mirror given light points into the eye.

use super::args::GlintsArgs;
use super::rows::shortest;
use super::scene::say_without_area;
use super::{Failure, outgoing, progress, refined, write_out};
use crate::field::{DEFAULT_FOV, Scout, sample_rig};
use crate::physical::{Nature, PathEnd, PathPoint, physical_reflections};
use glam::DVec3;
use serde_json::json;

const HEADER: &str = "light,face,u,v,x,y,z,nx,ny,nz,residual,nature";

pub(super) fn run(args: &GlintsArgs) -> Result<(), Failure> {
    args.output.iter().try_for_each(|path| outgoing::check(path, "-o"))?;
    if args.eye_direction == Some(DVec3::ZERO) {
        return Err(Failure::Bad("--eye-direction has no direction; give one that is not 0,0,0".to_owned()));
    }
    let mesh = args.scene.load_quads(args.mesh.as_deref(), "glints")?;
    let surface = refined(&mesh, &progress("searching".to_owned()))?;
    let scout = Scout::new(&surface);
    if let Some(scout) = &scout {
        say_without_area(&mesh, scout, "nothing can be mirrored");
    }
    let eye = match (args.eye, args.eye_direction) {
        (_, Some(direction)) => PathEnd::Direction(direction),
        (Some(eye), None) => PathEnd::Point(eye),
        (None, None) => {
            let scout = scout.as_ref().ok_or_else(|| {
                Failure::of(&mesh, "no face has a limit surface, so no eye can be fitted; give --eye X,Y,Z")
            })?;
            PathEnd::Point(fitted_eye(scout, mesh.up, args.mesh.is_none()))
        }
    };
    let points = args.light_point.iter().map(|&light| physical_reflections(&surface, PathEnd::Point(light), eye));
    let points: Vec<Vec<PathPoint>> = points.collect();
    let text = if args.json { as_json(args, eye, &points)? } else { as_csv(&points) };
    write_out(args.output.as_ref(), text.as_bytes())
}

/// The eye of `render`'s default camera, whose picture is square.
fn fitted_eye(scout: &Scout, up: Option<DVec3>, is_sample: bool) -> DVec3 {
    const SIZE: [u32; 2] = [1024; 2];
    let up = up.unwrap_or(DVec3::Z);
    let default = scout.camera(SIZE, up);
    let direction = if is_sample { sample_rig().0 } else { default.eye - default.target };
    scout.camera_from(SIZE, up, direction, DEFAULT_FOV).eye
}

fn nature(point: &PathPoint) -> &'static str {
    match point.nature {
        Nature::Extremum => "extremum",
        Nature::Saddle => "saddle",
        Nature::Vertex => "vertex",
        Nature::Degenerate { .. } => "degenerate",
    }
}

/// A row a point, numbers with 17 digits; lights are counted from 0.
fn as_csv(points: &[Vec<PathPoint>]) -> String {
    let mut out = HEADER.to_owned() + "\n";
    for (light, point) in points.iter().enumerate().flat_map(|(light, points)| points.iter().map(move |p| (light, p))) {
        let place = point.place;
        out += &format!("{light},{},{},{}", place.face, shortest(place.u), shortest(place.v));
        for x in [point.position, point.normal].iter().flat_map(|p| p.to_array()) {
            out += &format!(",{x:.16e}");
        }
        out += &format!(",{:.1e},{}\n", point.residual, nature(point));
    }
    out
}

fn as_json(args: &GlintsArgs, eye: PathEnd, points: &[Vec<PathPoint>]) -> Result<String, Failure> {
    let point = |point: &PathPoint| {
        let mut value = json!({
            "face": point.place.face, "uv": [point.place.u, point.place.v], "position": point.position.to_array(),
            "normal": point.normal.to_array(), "residual": point.residual, "nature": nature(point),
        });
        if let Nature::Degenerate { extent } = point.nature {
            value["extent"] = json!(extent);
        }
        value
    };
    let lights: Vec<_> = args
        .light_point
        .iter()
        .zip(points)
        .map(|(light, points)| json!({ "light": light.to_array(), "points": points.iter().map(point).collect::<Vec<_>>() }))
        .collect();
    let (name, eye) = match eye {
        PathEnd::Point(eye) => ("eye", eye),
        PathEnd::Direction(direction) => ("eye_direction", direction),
    };
    let text = serde_json::to_string_pretty(&json!({ name: eye.to_array(), "lights": lights }));
    text.map(|text| text + "\n").map_err(|error| Failure::Bad(error.to_string()))
}
