//! OBJ, by tobj.

use crate::hand_made::{GROUPS, HOSTILE_LINE, bytes, close_camera, curves, of_group, surface, written};
use catoptric::output::LinesFormat;

/// Objects, polylines and points come back, the latter to the last bit.
#[test]
fn objects_and_polylines_come_back() {
    let surface = surface();
    let curves = curves(&surface);
    let (_folder, path) = written(&curves, &close_camera(&surface, [64, 64]), LinesFormat::Obj, "lines.obj");
    let options = tobj::LoadOptions { ignore_lines: false, ..tobj::LoadOptions::default() };
    let (models, _) = tobj::load_obj(&path, &options).expect("tobj reads it");
    assert_eq!(models.iter().map(|model| model.name.as_str()).collect::<Vec<_>>(), GROUPS.map(|(name, ..)| name));
    for (model, (_, light, value)) in models.iter().zip(GROUPS) {
        let mesh = &model.mesh;
        let mut rest = mesh.indices.as_slice();
        let expected = of_group(&curves, light, value);
        assert_eq!(mesh.face_arities.len(), expected.len());
        for (curve, &arity) in expected.into_iter().zip(&mesh.face_arities) {
            let (indices, tail) = rest.split_at(arity as usize);
            rest = tail;
            let point = |&i: &u32| [0, 1, 2].map(|axis| mesh.positions[3 * i as usize + axis]);
            let mut points: Vec<[f64; 3]> = curve.points.iter().map(|point| point.to_array()).collect();
            points.extend(curve.closed.then(|| points[0]));
            assert_eq!(indices.iter().map(point).collect::<Vec<_>>(), points);
            assert_eq!(curve.closed, indices.first() == indices.last(), "the same index, not the same point again");
        }
        assert!(rest.is_empty());
    }
    let text = String::from_utf8(bytes(&curves, &close_camera(&surface, [64, 64]), LinesFormat::Obj)).expect("UTF-8");
    assert_eq!(text.lines().next(), Some(format!("# {HOSTILE_LINE}").as_str()));
    assert!(text.lines().all(|line| ["# ", "o ", "v ", "l "].iter().any(|start| line.starts_with(start))));
}
