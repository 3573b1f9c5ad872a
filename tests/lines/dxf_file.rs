//! DXF, by the dxf crate.

use crate::hand_made::{GROUPS, HOSTILE_LINE, bytes, close_camera, curves, of_group, surface, written};
use catoptric::output::LinesFormat;
use dxf::entities::{Entity, EntityType, Polyline};
use dxf::enums::AcadVersion;
use dxf::{Drawing, XDataItem};

/// Layers, polylines, their flags and data come back, points to the last bit.
#[test]
fn layers_and_polylines_come_back() {
    let surface = surface();
    let curves = curves(&surface);
    let (_folder, path) = written(&curves, &close_camera(&surface, [64, 64]), LinesFormat::Dxf, "lines.dxf");
    let drawing = Drawing::load_file(&path).expect("the dxf crate reads it");
    assert_eq!(drawing.header.version, AcadVersion::R12);
    let layers: Vec<&str> = drawing.layers().map(|layer| layer.name.as_str()).collect();
    let names = GROUPS.map(|(name, ..)| name.to_uppercase());
    assert!(names.iter().all(|name| layers.contains(&name.as_str())), "{layers:?}");
    assert!(drawing.app_ids().any(|app| app.name == "CATOPTRIC"));
    let polyline = |entity: &'_ Entity| -> Polyline {
        match &entity.specific {
            EntityType::Polyline(polyline) => polyline.clone(),
            other => panic!("{other:?}"),
        }
    };
    for (name, (_, light, value)) in names.iter().zip(GROUPS) {
        let found: Vec<&Entity> = drawing.entities().filter(|entity| entity.common.layer == *name).collect();
        let expected = of_group(&curves, light, value);
        assert_eq!(found.len(), expected.len());
        for (entity, curve) in found.into_iter().zip(expected) {
            let line = polyline(entity);
            assert!(line.is_3d_polyline() && line.is_closed() == curve.closed);
            let points = line.vertices().map(|vertex| [vertex.location.x, vertex.location.y, vertex.location.z]);
            assert_eq!(points.collect::<Vec<_>>(), curve.points.iter().map(|p| p.to_array()).collect::<Vec<_>>());
            let [data] = &entity.common.x_data[..] else { panic!("{:?}", entity.common.x_data) };
            assert_eq!(data.application_name, "CATOPTRIC");
            assert_eq!(data.items, [XDataItem::Real(value), XDataItem::Long(light)]);
        }
    }
    let total: usize = GROUPS.iter().map(|&(_, light, value)| of_group(&curves, light, value).len()).sum();
    assert_eq!(drawing.entities().count(), total);
}

/// ASCII alone, in pairs, no line longer than the format allows; and the comments say how it was made.
#[test]
fn the_text_is_what_release_12_takes() {
    let surface = surface();
    let file = bytes(&curves(&surface), &close_camera(&surface, [64, 64]), LinesFormat::Dxf);
    let text = String::from_utf8(file).expect("ASCII");
    let lines: Vec<&str> = text.lines().collect();
    assert!(text.is_ascii() && lines.len().is_multiple_of(2) && lines.iter().all(|line| line.len() <= 255));
    let comments: Vec<&str> =
        lines.chunks(2).filter(|pair| pair[0].trim() == "999").map(|pair| pair[1].trim()).collect();
    let escaped = HOSTILE_LINE
        .replace('\u{fc}', "\\U+00FC")
        .replace('\u{1f697}', "\\U+D83D\\U+DE97")
        .replace('\u{fffd}', "\\U+FFFD");
    assert_eq!(comments.concat(), escaped);
}
