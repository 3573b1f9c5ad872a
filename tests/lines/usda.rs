//! USD, by the openusd crate.

use crate::hand_made::{GROUPS, bytes, close_camera, curves, of_group, surface, written};
use catoptric::curves::Curve;
use catoptric::output::LinesFormat;
use glam::DVec3;
use openusd::usd::{Prim, Stage};
use openusd::{gf, sdf, tf};

const FORMAT: LinesFormat = LinesFormat::Usda { meters_per_unit: 0.001 };

fn get<T>(prim: &Prim, name: &str) -> T
where
    T: sdf::FromValue,
    T::Error: Into<openusd::Error>,
{
    let found = prim.attribute(name).get::<T>();
    found.expect("it has its type").unwrap_or_else(|| panic!("{name} is there"))
}

fn integers(prim: &Prim, name: &str) -> Vec<i32> {
    match get::<sdf::Value>(prim, name) {
        sdf::Value::IntVec(integers) => integers,
        other => panic!("{name}: {other:?}"),
    }
}

/// One prim of basis curves against the curves that belong in it.
fn check(prim: &Prim, wrap: &str, curves: &[&Curve], middle: DVec3, diagonal: f64) {
    assert_eq!(prim.type_name().expect("readable").as_deref(), Some("BasisCurves"));
    assert_eq!(get::<tf::Token>(prim, "type").as_str(), "linear");
    assert_eq!(get::<tf::Token>(prim, "wrap").as_str(), wrap);
    let counts = integers(prim, "curveVertexCounts");
    let points: Vec<gf::Vec3f> = get(prim, "points");
    let faces = integers(prim, "primvars:ptex:face");
    let uvs: Vec<gf::Vec2d> = get(prim, "primvars:ptex:uv");
    let extent: Vec<gf::Vec3f> = get(prim, "extent");
    let mut expected = Vec::new();
    for curve in curves {
        let again = (curve.closed && wrap == "nonperiodic").then_some(0);
        expected.extend((0..curve.points.len()).chain(again).map(|i| (curve.points[i], curve.places[i])));
    }
    assert_eq!(counts.len(), curves.len());
    assert_eq!(counts.iter().sum::<i32>() as usize, expected.len());
    assert_eq!([points.len(), faces.len(), uvs.len()], [expected.len(); 3]);
    // Half an ulp in each of three coordinates that are at most half a diagonal.
    let tolerance = 0.5 * diagonal * 2f64.powi(-24) * 3f64.sqrt();
    for (i, (point, place)) in expected.into_iter().enumerate() {
        let local = DVec3::new(points[i].x.into(), points[i].y.into(), points[i].z.into());
        assert!((middle + local).distance(point) <= tolerance, "{local} {point}");
        assert_eq!((faces[i] as u32, uvs[i].x, uvs[i].y), (place.face, place.u, place.v));
    }
    let array = |p: &gf::Vec3f| [p.x, p.y, p.z];
    let [low, high] = [&extent[0], &extent[1]].map(array);
    for axis in 0..3 {
        let along = || points.iter().map(|p| array(p)[axis]);
        assert_eq!(along().reduce(f32::min), Some(low[axis]));
        assert_eq!(along().reduce(f32::max), Some(high[axis]));
    }
}

/// Scopes, curves, their wrapping, primvars and extents come back; also a thousand diagonals from the origin, where
/// points in 32 bits would be a ten-thousandth of a diagonal off.
#[test]
fn scopes_and_curves_come_back() {
    let surface = surface();
    let camera = close_camera(&surface, [64, 64]);
    for far in [0.0, 1000.0] {
        let mut curves = curves(&surface);
        let diagonal = surface.diagonal();
        for curve in &mut curves {
            curve.points.iter_mut().for_each(|point| *point += DVec3::new(far, -far, 0.3 * far) * diagonal);
        }
        let (_folder, path) = written(&curves, &camera, FORMAT, "lines.usda");
        let stage = Stage::open(path.to_str().expect("UTF-8")).expect("openusd reads it");
        assert!(stage.composition_errors().is_empty(), "{:?}", stage.composition_errors());
        assert_eq!(stage.default_prim().as_deref(), Some("lines"));
        let metadata = |name: &str| stage.stage_metadata(name).expect("readable").expect("it is there");
        assert_eq!(metadata("metersPerUnit"), sdf::Value::Double(0.001));
        assert_eq!(metadata("upAxis"), sdf::Value::Token(tf::Token::from("Z")));
        let root = stage.prim("/lines").expect("a path");
        let gf::Vec3d { x, y, z } = get(&root, "xformOp:translate");
        let middle = DVec3::new(x, y, z);
        let names: Vec<String> =
            root.child_names().expect("readable").iter().map(|name| name.as_str().to_owned()).collect();
        assert_eq!(names, GROUPS.map(|(name, ..)| name));
        for (name, light, value) in GROUPS {
            let scope = stage.prim(format!("/lines/{name}").as_str()).expect("a path");
            assert_eq!(get::<i32>(&scope, "catoptric:light"), light);
            assert_eq!(get::<f64>(&scope, "catoptric:value"), value);
            let (closed, open): (Vec<&Curve>, Vec<&Curve>) =
                of_group(&curves, light, value).into_iter().partition(|curve| curve.closed && curve.points.len() > 2);
            let mut children = 0;
            for (child, wrap, curves) in [("open", "nonperiodic", open), ("closed", "periodic", closed)] {
                if !curves.is_empty() {
                    children += 1;
                    let prim = stage.prim(format!("/lines/{name}/{child}").as_str()).expect("a path");
                    check(&prim, wrap, &curves, middle, diagonal);
                }
            }
            assert_eq!(scope.child_names().expect("readable").len(), children);
        }
    }
}

/// How it was made, in the file's own escapes: openusd does not undo those. (usd-core does: the text comes back.)
#[test]
fn it_says_how_it_was_made() {
    let surface = surface();
    let text = String::from_utf8(bytes(&curves(&surface), &close_camera(&surface, [64, 64]), FORMAT)).expect("UTF-8");
    let expected = "string catoptric = \"catoptric lines 'a <b>&amp; \\\"c\\\" */ --> ]]> %s \u{fc}\u{1f697} \\\\n\\n\\t\\x01d.obj' \\\\\"";
    assert!(text.contains(expected), "{}", &text[..400]);
}
