//! The built-in sample: the right front fender of a car with the corner of its bonnet.
//!
//! The panel is drawn the way a body is lofted. A **shape** (one surface over the plane of `x`, along the car, and
//! `s`, up the section) says where metal is; a **layout** says which points of that plane carry control points and how
//! faces join them. The layout is one lattice of columns and rows in which two rectangles are replaced by rings: one
//! ring system turns around the wheel arch (its two upper corners are poles of valence 5), one around the charging flap
//! (four poles of valence 5 outside, six of valence 3 and one of valence 6 inside).
//!
//! Metres. `x` points to the rear, `y` out of the car, `z` up.

use super::{Boundary, Corner, Crease, Creasing, Scheme, SubdivMesh};
use glam::{DVec2, DVec3, dvec2};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::{Range, RangeInclusive};

/// Sharpness from which a crease never decays.
const INFINITE: f32 = 10.0;

// Dimensions, in the (x, s) plane. Up to the shoulder the section is so nearly upright that a circle there is one in
// side view to 1 mm.
const LENGTH: f64 = 1.4;
const SILL: f64 = -0.06;
const WHEEL: DVec2 = dvec2(0.60, 0.0);
const ARCH: f64 = 0.31;
const FLAP: DVec2 = dvec2(1.19, 0.19);
const FLAP_RADIUS: f64 = 0.062;
const HEM: f64 = 0.018;
const GROOVE_DEPTH: f64 = 0.010;
/// Half the width of the groove around the flap (the one along the bonnet has the same, in `UPPER_ROWS`).
const GROOVE_HALF: f64 = 0.003;

// The lattice: `COLUMNS` (front to rear) times `ROWS` (upwards) cells, and the cells that rings replace.
const COLUMNS: usize = 18;
const ROWS: usize = 19;
const ARCH_COLUMNS: Range<usize> = 2..12;
const ARCH_ROWS: Range<usize> = 0..5;
const FLAP_COLUMNS: Range<usize> = 13..16;
const FLAP_ROWS: Range<usize> = 1..4;
/// The feature line lies on this row, from the rear to this column.
const FEATURE_ROW: usize = 7;
const FEATURE_END: usize = 7;
/// The row that supports it from below goes on to this column, where the surface is smooth again.
const SUPPORT_END: usize = 5;
/// Lip of the groove between fender and bonnet, on the fender; its bottom and the lip on the bonnet are the next rows.
const SHUT_ROW: usize = 13;
/// The crease on the bonnet lies on this row, from the front to this column.
const BONNET_ROW: usize = 17;
const BONNET_END: usize = 11;

/// How far up the rows from the feature line lie, counted from where the shoulder starts to turn.
const UPPER_ROWS: [f64; ROWS - FEATURE_ROW + 1] =
    [-0.055, 0.0, 0.06, 0.12, 0.185, 0.25, 0.32, 0.323, 0.326, 0.41, 0.46, 0.51, 0.64];

/// 0 below 0, 1 above 1, between them the quintic with two zero derivatives at both ends.
fn ease(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

/// Distance from the rear edge as a fraction of the length: the panel tapers with its powers.
fn ahead(x: f64) -> f64 {
    1.0 - x / LENGTH
}

/// Where the shoulder starts to turn; it drops towards the front of the car.
fn shoulder(x: f64) -> f64 {
    0.57 - 0.10 * ahead(x) * ahead(x)
}

/// The front edge leans back as it rises.
fn front_edge(s: f64) -> f64 {
    0.03 + 0.36 * s * s
}

/// The hollow under a feature line, `below` it: a kink of slope 1 at the line that runs out smoothly at `width`.
fn hollow(below: f64, width: f64) -> f64 {
    let t = (below / width).clamp(0.0, 1.0);
    width * t * (1.0 - t).powi(3)
}

/// Angle of the section's tangent from the vertical: a long crown, and the shoulder added to it.
fn turn(x: f64, s: f64) -> f64 {
    0.7 * (s - 0.2) + 0.8 * ease((s - shoulder(x)) / (0.24 + 0.08 * ahead(x)))
}

/// The point of the panel at (x, s), moved inwards by `depth`.
///
/// Sections are given by their turning angle, so that curvature is what is designed; the midpoint rule integrates them.
/// The plan shape, the flare of the arch and the hollows under the two lines are added to them.
fn surface(at: DVec2, depth: f64) -> DVec3 {
    const STEPS: usize = 64;
    let (x, s) = (at.x, at.y);
    let step = s / STEPS as f64;
    let (mut y, mut z) = (0.0, 0.0);
    for k in 0..STEPS {
        let (sin, cos) = turn(x, (k as f64 + 0.5) * step).sin_cos();
        y -= sin * step;
        z += cos * step;
    }
    let u = ahead(x);
    let plan = -0.06 * u * u - 0.20 * u * u * u;
    let away = ((at.distance(WHEEL) - ARCH) / 0.2).clamp(0.0, 1.0);
    let flare = 0.026 * (1.0 - away).powi(3) * (1.0 + 3.0 * away);

    let feature_end = station(FEATURE_END, FEATURE_ROW);
    let feature =
        0.42 * ease((x - feature_end.x) / (LENGTH - feature_end.x)) * hollow(shoulder(x) + UPPER_ROWS[0] - s, 0.2);
    let bonnet_end = station(BONNET_END, BONNET_ROW);
    let bonnet = 0.45
        * ease((bonnet_end.x - x) / bonnet_end.x)
        * hollow(shoulder(x) + UPPER_ROWS[BONNET_ROW - FEATURE_ROW] - s, 0.14);

    let (sin, cos) = turn(x, s).sin_cos();
    let normal = DVec3::new(0.0, cos, sin);
    DVec3::new(x, y + plan + flare, z) - normal * (feature + bonnet + depth)
}

/// Where the lattice puts column `i` of row `j` in the (x, s) plane, before relaxation.
fn station(i: usize, j: usize) -> DVec2 {
    let Range { start, end } = ARCH_COLUMNS;
    let along = if i <= start {
        0.10 * i as f64 / start as f64
    } else if i <= end {
        0.10 + 0.65 * (i - start) as f64 / (end - start) as f64
    } else {
        0.75 + 0.25 * (i - end) as f64 / (COLUMNS - end) as f64
    };
    // The row depends on x and x on the row, through the slanted front edge: a few rounds settle both.
    let mut at = dvec2(along * LENGTH, 0.0);
    for _ in 0..8 {
        at.y = if j < FEATURE_ROW {
            let top = shoulder(at.x) + UPPER_ROWS[0];
            SILL + (top - SILL) * j as f64 / FEATURE_ROW as f64
        } else {
            shoulder(at.x) + UPPER_ROWS[j - FEATURE_ROW]
        };
        let front = front_edge(at.y);
        at.x = front + along * (LENGTH - front);
    }
    at
}

/// A control point as the layout knows it.
#[derive(Clone, Copy)]
struct Site {
    at: DVec2,
    depth: f64,
    /// Relaxation may move it.
    free: bool,
}

fn fixed(at: DVec2, depth: f64) -> Site {
    Site { at, depth, free: false }
}

#[derive(Default)]
struct Layout {
    sites: Vec<Site>,
    faces: Vec<Vec<u32>>,
    creases: Vec<Crease>,
}

impl Layout {
    fn add(&mut self, site: Site) -> u32 {
        self.sites.push(site);
        self.sites.len() as u32 - 1
    }

    /// Adds a strip of quads on the right-hand side of `path` (x to the right, s up) and returns its other side.
    /// A path whose ends are the same vertex is closed.
    fn strip(&mut self, path: &[u32], site: impl Fn(usize, Site) -> Site) -> Vec<u32> {
        let closed = path[0] == path[path.len() - 1];
        let mut side: Vec<u32> = Vec::with_capacity(path.len());
        for (k, &vertex) in path.iter().enumerate() {
            side.push(if closed && k + 1 == path.len() {
                side[0]
            } else {
                self.add(site(k, self.sites[vertex as usize]))
            });
        }
        for k in 1..path.len() {
            self.faces.push(vec![path[k - 1], path[k], side[k], side[k - 1]]);
        }
        side
    }

    fn crease(&mut self, path: &[u32], sharpness: impl Fn(usize) -> f32) {
        for (k, edge) in path.windows(2).enumerate() {
            self.creases.push(Crease { vertices: [edge[0], edge[1]], sharpness: sharpness(k) });
        }
    }

    /// Moves every free site to the middle of its neighbours, over and over: rows and columns then flow evenly around
    /// the poles.
    fn relax(&mut self) {
        let neighbours = neighbours(self.sites.len(), &self.faces);
        for _ in 0..300 {
            for (v, around) in neighbours.iter().enumerate() {
                if self.sites[v].free {
                    let sum: DVec2 = around.iter().map(|&n| self.sites[n as usize].at).sum();
                    self.sites[v].at = sum / around.len() as f64;
                }
            }
        }
    }
}

/// The vertices at the other ends of each vertex's edges.
fn neighbours(count: usize, faces: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut list = vec![Vec::new(); count];
    for face in faces {
        for k in 0..face.len() {
            let (a, b) = (face[k], face[(k + 1) % face.len()]);
            for (from, to) in [(a, b), (b, a)] {
                if !list[from as usize].contains(&to) {
                    list[from as usize].push(to);
                }
            }
        }
    }
    list
}

/// Control points whose limit points lie on the shape, to fourth order: `control = 2 target - limit(target)`.
///
/// Control points on the shape itself would pull the surface in by h^2 k / 6 (h spacing, k curvature) where it is
/// smooth and not at all across creases, which leaves a dent along each crease. One correction removes that; more of
/// them interpolate the targets but ripple at the poles (tried, and seen in the reflection lines).
fn fit(targets: &[DVec3], layout: &Layout, corners: &[Corner]) -> Vec<DVec3> {
    let neighbours = neighbours(targets.len(), &layout.faces);
    let mut centres = vec![Vec::new(); targets.len()];
    let mut sides = BTreeMap::new();
    for face in &layout.faces {
        let sum: DVec3 = face.iter().map(|&v| targets[v as usize]).sum();
        for (k, &v) in face.iter().enumerate() {
            let next = face[(k + 1) % face.len()];
            centres[v as usize].push(sum / face.len() as f64);
            *sides.entry((v.min(next), v.max(next))).or_insert(0) += 1;
        }
    }
    // The other ends of each vertex's sharp edges: creases, and the boundary, where edges have one side.
    let mut sharp = vec![Vec::new(); targets.len()];
    let boundary = sides.iter().filter(|(_, count)| **count == 1).map(|(&(a, b), _)| [a, b]);
    for [a, b] in boundary.chain(layout.creases.iter().map(|c| c.vertices)) {
        sharp[a as usize].push(targets[b as usize]);
        sharp[b as usize].push(targets[a as usize]);
    }
    let limit = |v: usize| match sharp[v].as_slice() {
        _ if corners.iter().any(|c| c.vertex as usize == v) => targets[v],
        // The limit mask of Halstead, Kass & DeRose 1993 (appendix A) in edge and face centres, so that n-gons may
        // touch the vertex.
        [] | [_] => {
            let n = centres[v].len() as f64;
            let to_edge = |&e: &u32| (targets[v] + targets[e as usize]) / 2.0;
            let around = neighbours[v].iter().map(to_edge).chain(centres[v].iter().copied());
            ((n - 3.0) * targets[v] + 4.0 / n * around.sum::<DVec3>()) / (n + 5.0)
        }
        [a, b] if centres[v].len() > 1 => (a + 4.0 * targets[v] + b) / 6.0,
        _ => targets[v],
    };
    (0..targets.len()).map(|v| 2.0 * targets[v] - limit(v)).collect()
}

/// The vertices of the lattice, by column and row (those inside the two holes are never asked for).
type Lattice = Vec<[u32; ROWS + 1]>;

/// Adds the lattice without its two holes; returns it with the row of vertices that supports the feature line.
fn add_lattice(layout: &mut Layout) -> (Lattice, Vec<u32>) {
    let support: Vec<u32> = (SUPPORT_END..=COLUMNS)
        .map(|i| {
            let fade = (COLUMNS - i) as f64 / (COLUMNS - SUPPORT_END) as f64;
            let at = station(i, FEATURE_ROW) - dvec2(0.0, 0.02 + 0.015 * fade);
            layout.add(Site { at, depth: 0.0, free: i < FEATURE_END })
        })
        .collect();
    let mut lattice = vec![[u32::MAX; ROWS + 1]; COLUMNS + 1];
    for i in 0..COLUMNS {
        for j in 0..ROWS {
            let in_arch = ARCH_COLUMNS.contains(&i) && ARCH_ROWS.contains(&j);
            let in_flap = FLAP_COLUMNS.contains(&i) && FLAP_ROWS.contains(&j);
            if in_arch || in_flap {
                continue;
            }
            // Clockwise in the (x, s) plane: that is counter-clockwise from outside, where x points to the left.
            let [a, b, c, d] = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)].map(|(i, j)| {
                if lattice[i][j] == u32::MAX {
                    lattice[i][j] = layout.add(Site {
                        at: station(i, j),
                        depth: if j == SHUT_ROW + 1 { GROOVE_DEPTH } else { 0.0 },
                        free: 0 < i && i < COLUMNS && 0 < j && j < FEATURE_ROW,
                    });
                }
                lattice[i][j]
            });
            if j + 1 == FEATURE_ROW && i >= SUPPORT_END {
                let (m, n) = (support[i - SUPPORT_END], support[i - SUPPORT_END + 1]);
                layout.faces.extend([vec![a, m, n, d], vec![m, b, c, n]]);
            } else if j + 1 == FEATURE_ROW && i + 1 == SUPPORT_END {
                layout.faces.push(vec![a, b, c, support[0], d]);
            } else {
                layout.faces.push(vec![a, b, c, d]);
            }
        }
    }
    (lattice, support)
}

/// Adds the rings around the wheel; returns the way along the sill from the lattice to the arch, around it and back.
fn add_arch(layout: &mut Layout, lattice: &Lattice) -> (Vec<u32>, [u32; 2]) {
    let (columns, rows) = (ARCH_COLUMNS, ARCH_ROWS);
    let mut rim: Vec<u32> = rows.clone().map(|j| lattice[columns.start][j]).collect();
    rim.extend((columns.start..=columns.end).map(|i| lattice[i][rows.end]));
    rim.extend(rows.rev().map(|j| lattice[columns.end][j]));
    let last = rim.len() - 1;
    let below = (-SILL / ARCH).asin();
    let arch = |k: usize, radius: f64| {
        let angle = (PI + 2.0 * below) * (1.0 - k as f64 / last as f64) - below;
        WHEEL + radius * dvec2(angle.cos(), angle.sin())
    };
    let (mut front, mut rear) = (Vec::new(), Vec::new());
    for layer in [2.0, 1.0, 0.0] {
        front.push(rim[0]);
        rear.push(rim[last]);
        rim = layout.strip(&rim, |k, outside| {
            let lip = arch(k, ARCH);
            if k == 0 || k == last {
                // Along the sill the layers are equally wide.
                return fixed(lip + (outside.at - lip) * layer / (layer + 1.0), 0.0);
            }
            Site { at: arch(k, ARCH + 0.028 * layer), depth: 0.0, free: layer > 1.0 }
        });
    }
    let ends = [rim[0], rim[last]];
    (front.into_iter().chain(rim).chain(rear.into_iter().rev()).collect(), ends)
}

/// Adds the charging flap: two rings around it, a groove between two sharp circles, and a lid around a pole of valence 6.
fn add_flap(layout: &mut Layout, lattice: &Lattice) {
    let (columns, rows) = (FLAP_COLUMNS, FLAP_ROWS);
    let mut rim: Vec<u32> = rows.clone().map(|j| lattice[columns.start][j]).collect();
    rim.extend(columns.clone().map(|i| lattice[i][rows.end]));
    rim.extend(rows.clone().rev().map(|j| lattice[columns.end][j + 1]));
    rim.extend((columns.start..=columns.end).rev().map(|i| lattice[i][rows.start]));
    let round = rim.len() - 1;
    let circle = |k: usize, radius: f64| {
        // From the corner below and in front, clockwise.
        let angle = 2.0 * PI * (0.625 - k as f64 / round as f64);
        FLAP + radius * dvec2(angle.cos(), angle.sin())
    };
    let around = |k, _| Site { at: circle(k, 1.3 * FLAP_RADIUS), depth: 0.0, free: true };
    let around = layout.strip(&rim, around);
    let edge = layout.strip(&around, |k, _| fixed(circle(k, FLAP_RADIUS), 0.0));
    let bottom = |k, _| fixed(circle(k, FLAP_RADIUS - GROOVE_HALF), GROOVE_DEPTH);
    let bottom = layout.strip(&edge, bottom);
    let lid = layout.strip(&bottom, |k, _| fixed(circle(k, FLAP_RADIUS - 2.0 * GROOVE_HALF), 0.0));
    let inner = layout.strip(&lid, |k, _| fixed(circle(k, 0.58 * FLAP_RADIUS), 0.0));
    let pole = layout.add(fixed(FLAP, 0.0));
    for k in (0..round).step_by(2) {
        layout.faces.push(vec![pole, inner[k], inner[k + 1], inner[k + 2]]);
    }
    layout.crease(&edge, |_| INFINITE);
    layout.crease(&lid, |_| INFINITE);
}

/// The built-in sample, a creased car-body panel of 495 faces.
///
/// It has an open boundary around the wheel arch, infinitely sharp creases (the folded hem, two grooves, and one on the
/// bonnet that ends inside the surface), a semi-sharp feature line that fades out and ends inside the panel, corners
/// where three sharp edges meet, poles of valence 3, 5 and 6, and a pentagon.
pub fn sample() -> SubdivMesh {
    let mut layout = Layout::default();
    let (lattice, support) = add_lattice(&mut layout);
    let (arch, lip_ends) = add_arch(&mut layout, &lattice);
    add_flap(&mut layout, &lattice);

    // The outline from the bonnet down the front edge, along sill and arch, and up the rear edge: there the metal is
    // folded inwards into a hem.
    let mut outline: Vec<u32> = (0..=ROWS).rev().map(|j| lattice[0][j]).collect();
    outline.extend((1..ARCH_COLUMNS.start).map(|i| lattice[i][0]));
    outline.extend(arch);
    outline.extend((ARCH_COLUMNS.end + 1..COLUMNS).map(|i| lattice[i][0]));
    outline.extend((0..FEATURE_ROW).map(|j| lattice[COLUMNS][j]));
    outline.push(support[support.len() - 1]);
    outline.extend((FEATURE_ROW..=ROWS).map(|j| lattice[COLUMNS][j]));
    let hem = layout.strip(&outline, |_, edge| fixed(edge.at, edge.depth + HEM));
    layout.crease(&outline, |_| INFINITE);

    // Where the outline turns, the hem is a box corner: three sharp edges meet, and the tag says so.
    let turns = [lattice[0][0], lip_ends[0], lip_ends[1], lattice[COLUMNS][0]];
    let mut corners = Vec::new();
    for (&vertex, &inner) in outline.iter().zip(&hem).filter(|(v, _)| turns.contains(v)) {
        layout.crease(&[vertex, inner], |_| INFINITE);
        corners.push(Corner { vertex, sharpness: INFINITE });
    }

    let row = |j: usize, columns: RangeInclusive<usize>| columns.map(|i| lattice[i][j]).collect::<Vec<_>>();
    layout.crease(&row(SHUT_ROW, 0..=COLUMNS), |_| INFINITE);
    layout.crease(&row(SHUT_ROW + 2, 0..=COLUMNS), |_| INFINITE);
    layout.crease(&row(BONNET_ROW, 0..=BONNET_END), |_| INFINITE);
    let edges = (COLUMNS - FEATURE_END) as f32;
    layout.crease(&row(FEATURE_ROW, FEATURE_END..=COLUMNS), |k| 1.5 + 1.5 * k as f32 / (edges - 1.0));

    layout.relax();
    let targets: Vec<DVec3> = layout.sites.iter().map(|s| surface(s.at, s.depth)).collect();
    SubdivMesh {
        name: "sample".to_owned(),
        points: fit(&targets, &layout, &corners),
        face_sizes: layout.faces.iter().map(|f| f.len() as u32).collect(),
        face_vertices: layout.faces.concat(),
        creases: layout.creases,
        corners,
        holes: Vec::new(),
        scheme: Scheme::CatmullClark,
        boundary: Boundary::EdgeAndCorner,
        creasing: Creasing::Uniform,
        ..SubdivMesh::default()
    }
}
