//! Boundaries that lie beside each other: joints that topology does not know.

use crate::surfaces::grid;
use catoptric::mesh::{self, SubdivMesh};
use catoptric::quality::{Feature, FeatureKind, Limits, Quality, WELD};
use catoptric::stam::LimitSurface;
use glam::{DVec3, dvec3};
use std::f64::consts::TAU;
use std::path::Path;

fn measure(mesh: &SubdivMesh, weld: Option<f64>) -> Quality {
    let surface = LimitSurface::new(mesh).expect("it has a surface");
    Quality::measure(mesh, &surface, None, &Limits { weld, ..Limits::default() })
}

fn seams(quality: &Quality) -> Vec<&Feature> {
    quality.features.iter().filter(|feature| feature.kind == FeatureKind::Seam).collect()
}

/// Two meshes as one, without a vertex in common.
pub fn both(first: &SubdivMesh, second: &SubdivMesh) -> SubdivMesh {
    let count = first.points.len() as u32;
    let mut mesh = first.clone();
    mesh.points.extend(&second.points);
    mesh.face_sizes.extend(&second.face_sizes);
    mesh.face_vertices.extend(second.face_vertices.iter().map(|vertex| vertex + count));
    mesh
}

/// All faces the other way round.
fn flipped(mut mesh: SubdivMesh) -> SubdivMesh {
    for face in mesh.face_vertices.chunks_mut(4) {
        face.reverse();
    }
    mesh
}

/// A flat sheet of 4 x 4 faces over the unit square.
fn sheet() -> SubdivMesh {
    grid([5, 5], |i, j| dvec3(i / 4.0, j / 4.0, 0.0))
}

/// A flat sheet of `width` x `height` faces that goes on from the line x = 1 at an angle, `aside` along the line and `gap` away from it.
fn wing([width, height]: [u32; 2], angle_deg: f64, aside: f64, gap: f64) -> SubdivMesh {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let steps = [width, height].map(f64::from);
    grid([width + 1, height + 1], move |i, j| {
        let (u, v) = (gap + i / steps[0], j / steps[1]);
        dvec3(1.0 + u * cos, v + aside, u * sin)
    })
}

/// Whatever the subdivision, the direction and the overlap, the angle and the gap are those that the sheets were given.
#[test]
fn sheets_side_by_side_have_their_angle_and_their_gap() {
    let diagonal = 2.3;
    let mut judged = 0;
    for size in [[4, 4], [1, 1], [3, 7], [2, 8], [5, 3]] {
        for angle in [0.0, 0.3, 30.0, 90.0, 150.0] {
            for (aside, gap) in [(0.0, 0.0), (0.6, 0.0), (-0.93, 0.0), (0.0, 0.5 * WELD * diagonal), (0.3, 1e-6)] {
                for is_flipped in [false, true] {
                    let wing = wing(size, angle, aside, gap);
                    let mesh = both(&sheet(), &if is_flipped { flipped(wing) } else { wing });
                    let quality = measure(&mesh, Some(WELD * diagonal));
                    let what = format!("{size:?} {angle} {aside} {gap} {is_flipped}");
                    let found = seams(&quality);
                    let [seam] = found[..] else { panic!("{what}: {found:?}") };
                    // Unit vectors from coordinates below 10, and their product: some 20 roundings.
                    let rounding = 20.0 * f64::EPSILON * 10.0;
                    let measured = seam.extremes.angle_deg.expect("normals");
                    assert!((measured - angle).abs() < rounding.to_degrees(), "{what}: {measured}");
                    assert!((seam.extremes.gap - gap).abs() < rounding, "{what}: {}", seam.extremes.gap);
                    assert_eq!((seam.extremes.difference, seam.reversed), (Some(0.0), is_flipped), "{what}");
                    let (own, other) = (seam.chain.as_ref().expect("a side"), &seam.beside);
                    assert!(own.vertices.iter().all(|&vertex| vertex < 25) && !own.closed, "{what}: {own:?}");
                    assert!(
                        other.len() == 1 && other[0].vertices.iter().all(|&vertex| vertex >= 25),
                        "{what}: {other:?}"
                    );
                    assert_eq!(quality.nearby, None, "{what}");
                    judged += 1;
                }
            }
        }
    }
    assert_eq!(judged, 5 * 5 * 5 * 2);
}

#[test]
fn vertices_that_coincide_without_being_one_are_named() {
    // Five on each side; the lower one comes first.
    let quality = measure(&both(&sheet(), &wing([4, 4], 30.0, 0.0, 0.0)), None);
    let unwelded = quality.unwelded.expect("they coincide");
    assert_eq!((unwelded.count, unwelded.first), (5, [4, 25]));
    assert!(unwelded.distance < 1e-15);
    // A long edge against two short ones: only the ends.
    let quality = measure(&both(&sheet(), &wing([1, 1], 0.0, 0.0, 0.0)), None);
    assert_eq!(quality.unwelded.map(|unwelded| unwelded.count), Some(2));
    // Faces that are holes have no boundary, wherever their vertices lie.
    let mut mesh = both(&sheet(), &wing([4, 4], 30.0, 0.0, 0.0));
    mesh.holes = (16..32).collect();
    let quality = measure(&mesh, None);
    assert!(quality.unwelded.is_none() && seams(&quality).is_empty());
    // Sheets with all their vertices in common have none.
    let quality = measure(&grid([9, 5], |i, j| dvec3(i, j, 0.0)), None);
    assert!(quality.unwelded.is_none() && seams(&quality).is_empty());
}

/// A tube whose seam is open, with its boundary beside itself; and a slit that ends inside a sheet.
#[test]
fn a_boundary_may_lie_beside_itself() {
    let tube = |part: f64| {
        grid([13, 4], move |i, j| {
            let angle = TAU * part * i / 12.0;
            dvec3(angle.cos(), angle.sin(), j)
        })
    };
    let quality = measure(&tube(1.0), None);
    let found = seams(&quality);
    let [seam] = found[..] else { panic!("{found:?}") };
    // Chords of a twelfth of the circle on both sides, which corners of the boundary keep straight there.
    assert!((seam.extremes.angle_deg.expect("normals") - 30.0).abs() < 1e-9, "{:?}", seam.extremes);
    assert!(seam.extremes.gap < 1e-14 && !seam.reversed && seam.pieces.len() == 6);
    assert_eq!(quality.unwelded.map(|unwelded| (unwelded.count, unwelded.first)), Some((4, [0, 12])));
    // Open by 2 pi / 1000: beyond the default, and spoken of.
    let quality = measure(&tube(0.999), None);
    assert!(seams(&quality).is_empty());
    let nearby = quality.nearby.expect("it is near");
    assert!((nearby.distance - TAU / 1000.0).abs() < 1e-6, "{nearby:?}");
    assert_eq!(seams(&measure(&tube(0.999), Some(0.007))).len(), 1);

    let mut slit = sheet();
    for (double, vertex) in [(25, 10), (26, 11)] {
        slit.points.push(slit.points[vertex]);
        for face in [8, 9] {
            let corners = &mut slit.face_vertices[4 * face..4 * face + 4];
            corners.iter_mut().filter(|corner| **corner == vertex as u32).for_each(|corner| *corner = double);
        }
    }
    let quality = measure(&slit, None);
    let found = seams(&quality);
    let [seam] = found[..] else { panic!("{found:?}") };
    assert!(seam.pieces.len() == 4 && seam.extremes.gap < 1e-14 && seam.extremes.angle_deg < Some(1e-9));
    assert_eq!(quality.unwelded.map(|unwelded| (unwelded.count, unwelded.first)), Some((2, [10, 25])));
}

/// What lies near itself without a gap between is no seam: neighbours along a boundary, corners and tips, the two sides of a narrow strip,
/// and faces that are small beside the weld distance.
#[test]
fn neighbours_along_a_boundary_are_no_seam() {
    let line = |count: u32, width: f64| grid([count, 2], move |i, j| dvec3(i / f64::from(count), width * j, 0.0));
    let tip = |height: f64| SubdivMesh {
        name: "tip".into(),
        points: vec![DVec3::ZERO, DVec3::X, dvec3(1.0, height, 0.0)],
        face_sizes: vec![3],
        face_vertices: vec![0, 1, 2],
        ..SubdivMesh::default()
    };
    let waves = |i: f64, j: f64| dvec3(i / 60.0, j / 60.0, 0.1 * (i / 10.0).sin() * (j / 12.0).cos());
    let meshes = [
        line(41, 5e-4),
        line(11, 1e-9),
        line(3, 1.0),
        tip(1.0),
        tip(0.1),
        tip(0.02),
        grid([61, 61], waves),
        grid([2, 2], |i, j| dvec3(i, j, 0.0)),
    ];
    for (k, mesh) in meshes.iter().enumerate() {
        for weld in [None, Some(0.02)] {
            let quality = measure(mesh, weld);
            assert!(seams(&quality).is_empty(), "{k} {weld:?}: {:?}", seams(&quality));
            assert_eq!((quality.unwelded, quality.nearby), (None, None), "{k} {weld:?}");
        }
    }
    // No test mesh is torn; in one a face is the wrong way round, and its four edges are cut open.
    for mesh in crate::common::meshes() {
        let quality = measure(&mesh, None);
        let reversed: Vec<bool> = seams(&quality).iter().map(|seam| seam.reversed).collect();
        assert_eq!(reversed, if mesh.name == "mixed_orientation" { vec![true] } else { vec![] }, "{}", mesh.name);
        assert!(quality.unwelded.is_none(), "{}: {:?}", mesh.name, quality.unwelded);
    }
}

/// The strip of the trials: 0.07 apart on a diagonal of 2.3.
#[test]
fn a_gap_beyond_the_weld_distance_is_spoken_of() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/torn/gap_strip.obj");
    let mesh = mesh::read(&path).expect("it is valid");
    let gap = 0.05 * 2f64.sqrt();
    let quality = measure(&mesh, None);
    assert!(seams(&quality).is_empty() && quality.unwelded.is_none());
    assert_eq!(quality.weld, WELD * mesh.diagonal());
    let nearby = quality.nearby.expect("it is near");
    assert!((nearby.distance - gap).abs() < 1e-15 && (nearby.position.x - 1.0).abs() < 1e-15, "{nearby:?}");
    let quality = measure(&mesh, Some(0.1));
    let found = seams(&quality);
    let [seam] = found[..] else { panic!("{found:?}") };
    assert!((seam.extremes.gap - gap).abs() < 1e-15);
    // The second strip rises by 0.45 over 0.95.
    let angle = (0.45f64 / 0.95).atan().to_degrees();
    assert!((seam.extremes.angle_deg.expect("normals") - angle).abs() < 1e-12);
    assert_eq!(quality.nearby, None);
    // No distance at all: no seam, and nothing is near.
    let quality = measure(&mesh, Some(0.0));
    assert!(seams(&quality).is_empty() && quality.nearby.is_none());
}

/// A face that runs against its neighbours is judged as if it were flipped.
#[test]
fn a_reversed_face_is_no_break_of_180_degrees() {
    let mut mesh = sheet();
    mesh.face_vertices[20..24].reverse();
    assert_eq!(mesh.orientation().reversed, [5]);
    let quality = measure(&mesh, None);
    let found = seams(&quality);
    let [seam] = found[..] else { panic!("{found:?}") };
    // Its edges are not manifold for the rules, but the sheet is flat.
    assert!(seam.reversed && seam.extremes.angle_deg < Some(1e-9) && seam.extremes.gap < 1e-14, "{:?}", seam.extremes);
    assert!(quality.unjudged.nonmanifold_edges.is_empty());
    assert_eq!(quality.unwelded, None);
}
