//! An independent ray caster for limit surfaces, in f64 on the CPU: what the pixels of the GPU are checked against.
//!
//! # Theory
//! Every patch is a set of bicubic Bezier pieces: a regular patch is one, an irregular one has three a level of its
//! normalised table (docs/LIMIT.md, section 4) down to a tip that is smaller than any tolerance. In coordinates of the
//! ray (x and y the signed distances from two planes that meet in it, z along it; Kajiya 1982) a hit is a point with
//! x = y = 0. A Bezier piece lies in the hull of its control points, so a piece whose hull misses the origin of the
//! (x,y) plane has no hit (the convex hull property that Bezier clipping rests on: Nishita, Sederberg & Kakimoto 1990);
//! the others are halved, the nearer half first, until (u,v) -> (x,y) is provably one to one on the piece. Newton's
//! method then finds its only hit, and is believed only if it stays in the piece.
//!
//! # Practice
//! [`Caster::new`] collects pieces and boxes; [`Caster::first_hit`] and [`Caster::all_hits`] cast one ray. Nothing is
//! shared with the shaders or their tables; `LimitSurface` gives nets, and the normal at a hit that was found.
#![allow(dead_code, reason = "each test program uses its part")]

mod bezier;
mod boxes;

use bezier::{Found, Search};
use boxes::Boxes;
use catoptric::stam::{LEVELS, LimitSurface, Net};
use glam::{DMat3, DVec3};

/// A half line.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    pub origin: DVec3,
    /// Of any length above zero; `t` counts it.
    pub direction: DVec3,
    /// Hits nearer than this do not count; minus infinity for a whole line.
    pub start: f64,
}

impl Ray {
    pub fn new(origin: DVec3, direction: DVec3) -> Ray {
        Ray { origin, direction, start: 0.0 }
    }

    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

/// A point of the surface that a ray meets.
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// The ray's parameter.
    pub t: f64,
    /// Patch index.
    pub patch: usize,
    /// Patch-local parameters.
    pub uv: [f64; 2],
    /// The surface there.
    pub position: DVec3,
    /// Unit normal of the parametrisation (du x dv), whichever side the ray comes from.
    pub normal: DVec3,
}

/// Part of a patch's size within which a ray meets it: four orders above the rounding of nets, which is 2.5e-15 at most
/// (docs/LIMIT.md, section 6), so that patches overlap at their common edges; and 1e-10 of a pixel where a patch covers
/// a hundred of them.
const CLOSED: f64 = 1e-12;

/// Roundings of a world coordinate between the surface's points and their distance from a ray: a few for the net, three
/// products and sums for the frame.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// A bicubic Bezier piece of a patch.
#[derive(Debug)]
struct Piece {
    net: [DVec3; 16],
    patch: u32,
    /// The piece spans `corner` to `corner + size` of the patch's parameters.
    corner: [f64; 2],
    size: f64,
    /// Distance within which a ray meets it.
    tolerance: f64,
}

/// A ray with its frame.
struct Cast {
    origin: DVec3,
    /// Columns: the normals of two planes that meet in the ray, and the unit direction.
    frame: DMat3,
    /// Length of the direction as given.
    length: f64,
    /// Rounding that comes from the place of the origin.
    rounding: f64,
}

/// The pieces of a surface, ready for rays.
#[derive(Debug)]
pub struct Caster<'a> {
    surface: &'a LimitSurface,
    pieces: Vec<Piece>,
    boxes: Boxes,
}

impl<'a> Caster<'a> {
    pub fn new(surface: &'a LimitSurface) -> Caster<'a> {
        let pieces: Vec<Piece> = (0..surface.patches().len()).flat_map(|patch| pieces(surface, patch)).collect();
        let bounds = |piece: &Piece| {
            let ends = |f: fn(DVec3, DVec3) -> DVec3| piece.net.into_iter().reduce(f).expect("16 points");
            [ends(DVec3::min) - piece.tolerance, ends(DVec3::max) + piece.tolerance]
        };
        let boxes = Boxes::new(&pieces.iter().map(bounds).collect::<Vec<_>>());
        Caster { surface, pieces, boxes }
    }

    pub fn surface(&self) -> &LimitSurface {
        self.surface
    }

    /// The nearest hit.
    pub fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        self.cast(ray, Search::nearest(self.start(ray))).pop()
    }

    /// All hits, the nearest first; one for a hit on an edge, although every patch at the edge has it.
    pub fn all_hits(&self, ray: &Ray) -> Vec<Hit> {
        let mut hits = self.cast(ray, Search::all(self.start(ray)));
        hits.sort_by(|a, b| a.t.total_cmp(&b.t));
        // On a common edge patches differ by CLOSED; 1e-3 is the sine of the flattest angle at which that is one hit.
        let same = CLOSED * 1e3 * self.surface.diagonal();
        hits.dedup_by(|next, kept| next.position.distance(kept.position) <= same);
        hits
    }

    fn start(&self, ray: &Ray) -> f64 {
        ray.start * ray.direction.length()
    }

    fn cast(&self, ray: &Ray, mut search: Search) -> Vec<Hit> {
        let cast = Cast::new(ray);
        self.boxes.walk(&cast, &mut search, |piece, search| {
            let Piece { net, tolerance, .. } = &self.pieces[piece];
            search.piece(piece, &net.map(|p| cast.local(p)), tolerance + cast.rounding);
        });
        search.found.iter().map(|found| self.hit(&cast, found)).collect()
    }

    fn hit(&self, cast: &Cast, found: &Found) -> Hit {
        let piece = &self.pieces[found.piece];
        let uv = [0, 1].map(|k| (piece.corner[k] + piece.size * found.uv[k]).clamp(0.0, 1.0));
        let jet = self.surface.evaluate(piece.patch as usize, uv);
        Hit { t: found.z / cast.length, patch: piece.patch as usize, uv, position: jet.position, normal: jet.normal }
    }
}

impl Cast {
    fn new(ray: &Ray) -> Cast {
        let length = ray.direction.length();
        let along = ray.direction / length;
        let (x, y) = along.any_orthonormal_pair();
        let rounding = ROUNDINGS * ray.origin.length();
        Cast { origin: ray.origin, frame: DMat3::from_cols(x, y, along), length, rounding }
    }

    /// Distances from the two planes, and along the ray.
    fn local(&self, point: DVec3) -> DVec3 {
        let d = point - self.origin;
        DVec3::new(self.frame.x_axis.dot(d), self.frame.y_axis.dot(d), self.frame.z_axis.dot(d))
    }
}

/// The pieces that make up a patch.
fn pieces(surface: &LimitSurface, patch: usize) -> Vec<Piece> {
    let id = patch as u32;
    let size_of = |points: &[DVec3]| points.iter().map(|p| p.distance(points[0])).fold(0.0, f64::max);
    let rounding = |points: &[DVec3]| ROUNDINGS * points.iter().map(|p| p.length()).fold(0.0, f64::max);
    match surface.net(patch, LEVELS) {
        Net::Regular(net) => {
            let tolerance = CLOSED * size_of(&net) + rounding(&net);
            vec![Piece { net: bezier::from_b_spline(&net), patch: id, corner: [0.0; 2], size: 1.0, tolerance }]
        }
        Net::Irregular { limit, lambda, levels } => {
            let reach = |level: &[DVec3; 24]| level.iter().map(|p| p.length()).fold(0.0, f64::max);
            let tolerance = CLOSED * reach(&levels[0]) + rounding(&levels[0].map(|p| p + limit));
            // All levels together reach this far from the vertex: they converge to the characteristic map, or grow at
            // most like n where the matrix is defective, and lambda^n n falls from n = 3 on (lambda <= 0.655). Twice,
            // for those not in the table.
            let farthest = 2.0 * levels.iter().map(reach).fold(0.0, f64::max);
            let mut pieces = Vec::new();
            let mut scale = 1.0;
            for (n, level) in levels.iter().enumerate() {
                let size = 0.5f64.powi(n as i32 + 1);
                for (i, j) in [(1, 0), (1, 1), (0, 1)] {
                    // Point (a,b) of the level, a and b from -1 to 3, is at 5 (b + 1) + (a + 1) - 1; window (i,j) has
                    // those from (i - 1, j - 1) to (i + 2, j + 2).
                    let net = std::array::from_fn(|k| limit + scale * level[5 * (j + k / 4) + (i + k % 4) - 1]);
                    let corner = [i, j].map(|x| x as f64 * size);
                    pieces.push(Piece { net: bezier::from_b_spline(&net), patch: id, corner, size, tolerance });
                }
                scale *= lambda;
                if scale * farthest <= tolerance {
                    break;
                }
            }
            // The rest of the patch as one point that a ray meets if it passes as near as the rest can reach: at most
            // 0.655^52 = 3e-10 of the patch (cones), the tolerance for most.
            let tolerance = tolerance + scale * farthest;
            pieces.push(Piece { net: [limit; 16], patch: id, corner: [0.0; 2], size: 0.0, tolerance });
            pieces
        }
        Net::Triangle(_) | Net::IrregularTriangle { .. } => panic!("the caster knows quads alone"),
    }
}
