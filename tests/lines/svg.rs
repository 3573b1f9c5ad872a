//! SVG, by roxmltree (its structure), usvg (its paths and size) and resvg (its picture).

use crate::hand_made::{GROUPS, HOSTILE, bytes, close_camera, curves, of_group, surface};
use catoptric::curves::Curve;
use catoptric::output::{LinesFormat, MM_PER_PIXEL, in_picture};
use glam::DVec2;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Group, Node, Options, Tree};

const SIZE: [u32; 2] = [320, 240];
const PIXELS: LinesFormat = LinesFormat::Svg { mm_per_pixel: None };

fn svg(format: LinesFormat) -> String {
    let surface = surface();
    String::from_utf8(bytes(&curves(&surface), &close_camera(&surface, SIZE), format)).expect("UTF-8")
}

/// The points of a path, and whether it is closed.
fn path(d: &str) -> (Vec<DVec2>, bool) {
    let inner = d.strip_prefix('M').expect("it starts somewhere");
    let (inner, closed) = inner.strip_suffix('Z').map_or((inner, false), |inner| (inner, true));
    let number = |x: &str| x.parse::<f64>().expect("a number");
    let point = |pair: &str| pair.split_once(',').map(|(x, y)| DVec2::new(number(x), number(y))).expect("a pair");
    (inner.split(' ').map(point).collect(), closed)
}

#[test]
fn groups_titles_and_paths_are_the_curves() {
    let surface = surface();
    let (curves, camera) = (curves(&surface), close_camera(&surface, SIZE));
    for (mm, scale) in [(None, 1.0), (Some(2.0 / 3.0), 2.0 / 3.0)] {
        let text = svg(LinesFormat::Svg { mm_per_pixel: mm });
        let document = roxmltree::Document::parse(&text).expect("it is XML");
        let root = document.root_element();
        let child = |name: &str| root.children().find(|node| node.has_tag_name(("http://www.w3.org/2000/svg", name)));
        assert_eq!(child("title").and_then(|node| node.text()), Some("curve:x < y & \"z\""));
        // XML has no U+0001.
        assert_eq!(child("desc").and_then(|node| node.text()), Some(HOSTILE.replace('\u{1}', "\u{fffd}").as_str()));
        let groups: Vec<_> = document.descendants().filter(|node| node.has_attribute("data-light")).collect();
        assert_eq!(groups.iter().map(|g| g.attribute("id")).collect::<Vec<_>>(), GROUPS.map(|(name, ..)| Some(name)));
        let mut cut = 0;
        for (group, (_, light, value)) in groups.iter().zip(GROUPS) {
            let number = |name: &str| group.attribute(name).and_then(|x| x.parse::<f64>().ok());
            assert_eq!([number("data-light"), number("data-value")], [Some(f64::from(light)), Some(value)]);
            let title = group.children().find(|node| node.has_tag_name("title")).and_then(|node| node.text());
            assert_eq!(title, Some(format!("light {light}: {value:?}").as_str()));
            let expected = of_group(&curves, light, value);
            let drawn: Vec<_> = expected.iter().flat_map(|curve| in_picture(&camera, curve)).collect();
            let paths: Vec<_> = group.children().filter_map(|node| node.attribute("d")).map(path).collect();
            assert_eq!(paths.len(), drawn.len());
            for ((points, closed), part) in paths.iter().zip(&drawn) {
                assert_eq!((*closed, points.len()), (part.closed, part.points.len()));
                // Six decimals in both coordinates.
                assert!(points.iter().zip(&part.points).all(|(a, b)| a.distance(*b * scale) < 0.71e-6));
            }
            let whole = |curve: &&&Curve| {
                let inside = |p: [f64; 2]| p.iter().zip(SIZE).all(|(x, n)| (0.0..=f64::from(n)).contains(x));
                curve.points.iter().all(|&point| camera.project(point).is_some_and(inside))
            };
            let seen = expected.iter().filter(|curve| !in_picture(&camera, curve).is_empty());
            cut += seen.filter(|curve| !whole(curve)).count();
        }
        println!("{cut} curves are cut");
        assert!(cut > 2, "the border cuts curves");
    }
}

/// All paths below a group, by usvg.
fn count_paths(group: &Group) -> usize {
    let count = |node: &Node| match node {
        Node::Group(group) => count_paths(group),
        Node::Path(path) => {
            assert!(path.fill().is_none() && path.stroke().is_some());
            1
        }
        other => panic!("{other:?}"),
    };
    group.children().iter().map(count).sum()
}

#[test]
fn sizes_are_pixels_or_millimetres() {
    let pixels = Tree::from_str(&svg(PIXELS), &Options::default()).expect("usvg reads it");
    assert_eq!([pixels.size().width(), pixels.size().height()], [320.0, 240.0]);
    let paths = count_paths(pixels.root());
    println!("{paths} paths");
    assert!(paths > 10);
    // 1 mm a pixel: usvg counts in CSS pixels.
    let mm =
        Tree::from_str(&svg(LinesFormat::Svg { mm_per_pixel: Some(1.0) }), &Options::default()).expect("it reads it");
    assert!((f64::from(mm.size().width()) - 320.0 / MM_PER_PIXEL).abs() < 1e-2, "{:?}", mm.size());
    assert_eq!(count_paths(mm.root()), paths);
}

/// The picture that resvg makes of it: ink where curves are, and nowhere else.
#[test]
fn ink_is_where_the_curves_are() {
    let surface = surface();
    let camera = close_camera(&surface, SIZE);
    let tree = Tree::from_str(&svg(PIXELS), &Options::default()).expect("usvg reads it");
    let mut pixmap = Pixmap::new(SIZE[0], SIZE[1]).expect("memory");
    resvg::render(&tree, Transform::default(), &mut pixmap.as_mut());
    let ink = |x: u32, y: u32| f64::from(pixmap.pixel(x, y).expect("it is inside").alpha()) / 255.0;
    let parts: Vec<_> = curves(&surface)
        .iter()
        .filter(|curve| curve.points.len() > 1)
        .flat_map(|curve| in_picture(&camera, curve))
        .collect();
    let mut near = vec![false; (SIZE[0] * SIZE[1]) as usize];
    let mut samples = 0;
    for part in &parts {
        let count = part.points.len();
        for i in 0..if part.closed { count } else { count - 1 } {
            let (a, b) = (part.points[i], part.points[(i + 1) % count]);
            let steps = (a.distance(b) * 4.0).ceil().max(1.0);
            for k in 0..=steps as u32 {
                let at = a.lerp(b, f64::from(k) / steps);
                let cell = |x: f64, n: u32| (x.floor() as u32).min(n - 1);
                let (x, y) = (cell(at.x, SIZE[0]), cell(at.y, SIZE[1]));
                // A pen 1 pixel wide covers a third of some pixel within half a pixel of its middle, whatever its
                // direction.
                let around = |dx: i64, dy: i64| {
                    let inside = |v: i64, n: u32| u32::try_from(v).ok().filter(|&v| v < n);
                    let (x, y) = (inside(i64::from(x) + dx, SIZE[0])?, inside(i64::from(y) + dy, SIZE[1])?);
                    Some((x, y))
                };
                let cells: Vec<(u32, u32)> =
                    (-1..=1).flat_map(|dy| (-1..=1).filter_map(move |dx| around(dx, dy))).collect();
                assert!(cells.iter().any(|&(x, y)| ink(x, y) > 0.3), "no ink at {at}");
                cells.iter().for_each(|&(x, y)| near[(y * SIZE[0] + x) as usize] = true);
                samples += 1;
            }
        }
    }
    let mut inked = 0;
    for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
        if ink(x, y) > 0.0 {
            inked += 1;
            assert!(near[(y * SIZE[0] + x) as usize], "ink at {x}, {y}, where no curve is");
        }
    }
    assert!(samples > 2000 && inked > 1000, "{samples} {inked}");
}
