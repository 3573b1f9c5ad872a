//! Normals at extraordinary vertices against brute-force refinement.

#[path = "oracle/brute/mod.rs"]
mod brute;
#[path = "common/mod.rs"]
mod common;

use brute::{CORNERS, Cage, Descent};
use catoptric::patch::{PatchKind, RingClass, Tip};
use catoptric::stam::LimitSurface;
use common::{angle_deg, meshes};
use glam::DVec3;
use std::collections::BTreeMap;

/// Control points of the ring of the sector that `face` lies in, relative to the vertex, counter-clockwise.
fn spokes(cage: &Cage, face: usize, vertex: usize) -> (Vec<DVec3>, bool) {
    let (spokes, _, _, closed) = cage.sector(face, vertex);
    (spokes.into_iter().map(|v| cage.points[v] - cage.points[vertex]).collect(), closed)
}

/// The normal of the tangent plane, from control points that are followed down to the vertex; `None` where there is no
/// tangent plane.
///
/// Along an infinitely sharp edge the control points tend to the tangent of its curve, which halves with each level; any
/// other pair of spokes spans the tangent plane, however their lengths part.
fn tangent_plane(descent: &Descent, class: RingClass) -> Option<DVec3> {
    let vertex = descent.cage.at(descent.cell.face, descent.corner);
    let (ring, closed) = spokes(&descent.cage, descent.cell.face, vertex);
    let count = ring.len();
    let faces = usize::from(class.faces);
    match (class.tip, closed) {
        // A dart: along its edge, and between the spokes on either side of it. Smooth: the sine and the cosine mode.
        (Tip::Smooth, _) if faces > 2 => {
            let angle = |i: usize| std::f64::consts::TAU * i as f64 / count as f64;
            let mode = |wave: fn(f64) -> f64| ring.iter().enumerate().map(|(i, &p)| wave(angle(i)) * p).sum::<DVec3>();
            Some(mode(f64::cos).cross(mode(f64::sin)))
        }
        // Defective: see `defective_sectors_drift_to_their_limit`. One face: the osculating plane of the edge's curve.
        (Tip::Crease, false) if faces == 1 => Some((ring[0] - ring[1]).cross(ring[0] + ring[1])),
        // From 5 faces on the second mode across (0.551) outlives the tangent of the curve (0.5): the normal depends on
        // the direction.
        (Tip::Crease, false) if faces <= 4 => {
            let across: DVec3 = ring[1..count - 1].iter().sum();
            Some((ring[0] - ring[count - 1]).cross(across))
        }
        (Tip::Corner, false) if faces <= 2 => Some(ring[0].cross(ring[count - 1])),
        _ => None,
    }
}

/// Levels to follow. The next eigenvalue is at most 0.92 of the smaller one of the plane for smooth vertices of valence 12,
/// 0.82 along a crease of 3 or 4 faces, and control points on a crease follow from each other alone, without loss. Darts
/// lose 1e-16 times (first eigenvalue of the plane / second)^n, so they stop earlier.
fn levels(class: RingClass) -> usize {
    match class.tip {
        // Exact at every level, and beyond some 20 nothing but rounding sets the two directions apart.
        Tip::Crease if class.faces == 1 => 4,
        Tip::Corner => 4,
        _ if class.sharp_spoke.is_some() => 120,
        _ if class.faces > 12 => 400,
        _ => 200,
    }
}

/// Degrees. Along creases and at smooth vertices 1e-7 is the bound for normals across patches; the plane of a dart is
/// known to 0.9^120 of a radian.
fn tolerance(class: RingClass) -> f64 {
    if class.sharp_spoke.is_some() { 1e-3 } else { 1e-7 }
}

#[test]
fn normals_at_extraordinary_vertices() {
    let mut worst: BTreeMap<String, (f64, usize, f64, String)> = BTreeMap::new();
    for mesh in meshes().iter().filter(|mesh| mesh.face_vertices.len() <= 500) {
        let surface = LimitSurface::new(mesh).expect("it has a surface");
        let (cage, cells) = brute::refined(mesh, 1);
        for cell in &cells {
            for (corner, &uv) in CORNERS.iter().enumerate().filter(|&(corner, uv)| cell.parameters(corner) == *uv) {
                let Some((patch, jet)) = surface.evaluate_ptex(cell.ptex, uv) else { continue };
                if surface.kind(patch) == PatchKind::Regular || surface.locate(cell.ptex, uv) != Some((patch, [0.0; 2]))
                {
                    continue;
                }
                let class = surface.classes()[surface.class(patch).expect("an irregular patch has a class")];
                let mut descent = Descent::new(&cage, *cell, corner);
                (0..levels(class)).for_each(|_| descent.step());
                let Some(normal) = tangent_plane(&descent, class) else { continue };
                let spoke = if class.sharp_spoke.is_some() { "dart " } else { "" };
                let name = format!("{spoke}{:?} tip, {} faces", class.tip, class.faces);
                let turned = angle_deg(jet.normal, normal.normalize_or_zero());
                let entry = worst.entry(name).or_insert((0.0, 0, tolerance(class), String::new()));
                entry.1 += 1;
                if turned > entry.0 || turned.is_nan() {
                    (entry.0, entry.3) = (turned, format!("{} ptex {} {uv:?}", mesh.name, cell.ptex));
                }
            }
        }
    }
    for (name, (turned, count, tolerance, place)) in &worst {
        println!("{name}: {turned:.1e} degrees ({tolerance:e}) of {count} vertices, at {place}");
    }
    for (name, (turned, _, tolerance, place)) in &worst {
        assert!(turned <= tolerance, "{name}: {turned:e} degrees at {place}");
    }
}

/// Crease sectors of one face and corner sectors of two have a defective eigenvalue (1/4 and 1/2): the normal turns towards
/// its limit like 1/n, and no depth shows it. But the product of the derivatives, scaled, grows by a constant vector a
/// level, and that is the direction of the limit: 22 levels leave 2^-22 of the next term.
#[test]
fn defective_sectors_drift_to_their_limit() {
    let mut checked = 0;
    for mesh in meshes().iter().filter(|mesh| mesh.face_vertices.len() <= 500) {
        let surface = LimitSurface::new(mesh).expect("it has a surface");
        let (cage, cells) = brute::refined(mesh, 1);
        for cell in &cells {
            for (corner, &uv) in CORNERS.iter().enumerate().filter(|&(corner, uv)| cell.parameters(corner) == *uv) {
                let Some((patch, _)) = surface.evaluate_ptex(cell.ptex, uv) else { continue };
                if surface.kind(patch) == PatchKind::Regular || surface.locate(cell.ptex, uv) != Some((patch, [0.0; 2]))
                {
                    continue;
                }
                let class = surface.classes()[surface.class(patch).expect("an irregular patch has a class")];
                let growth = match (class.tip, class.closed, class.faces) {
                    (Tip::Crease, false, 1) => 8.0,
                    (Tip::Corner, false, 2) => 4.0,
                    _ => continue,
                };
                let mut descent = Descent::new(&cage, *cell, corner);
                let mut product = || {
                    descent.step();
                    let opposite = descent.cage.at(descent.cell.face, corner + 2);
                    let [du, dv] = descent.cage.derivatives(descent.cell.face, opposite)?;
                    Some((du.cross(dv), tangent_plane(&descent, class)?))
                };
                let last_two: Vec<_> = (0..22).map(|_| product()).skip(20).collect();
                let [Some((before, _)), Some((after, limit))] = last_two[..] else { continue };
                let turned = angle_deg(growth * after - before, limit);
                assert!(turned < 1e-2, "{} ptex {} {uv:?}: {turned} degrees", mesh.name, cell.ptex);
                checked += 1;
            }
        }
    }
    println!("{checked} sectors");
    assert!(checked >= 15);
}
