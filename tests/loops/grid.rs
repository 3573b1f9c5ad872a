//! Contours on a fine grid, by signs at its nodes: what a tracer must not miss, found without one.
//!
//! Every ptex face has a grid; a quad's has twice as many steps as those of the quarters of an n-gon, so that grids meet node by node
//! everywhere. Cells are joined where a contour crosses the edge between them.

use catoptric::field::{Camera, Field, HighlightKind, Method};
use catoptric::mesh::SubdivMesh;
use catoptric::stam::LimitSurface;
use glam::DVec3;
use std::collections::HashMap;

/// Pieces of a line that is too short to be compared.
pub const SHORT: usize = 3;

/// Sine of the angle to the light below which a node's normal is parallel to it.
const PARALLEL: f64 = 0.05;

/// Part of a patch round a vertex without a tangent plane that is left out.
const TIP: f64 = 0.1;

/// Values at the nodes of one ptex face, `steps + 1` each way, u fastest.
struct Face {
    steps: usize,
    values: Vec<Option<f64>>,
    positions: Vec<DVec3>,
}

/// A grid on every face of a mesh.
pub struct Grid {
    faces: Vec<Option<Face>>,
    diagonal: f64,
}

/// How many lines there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Count {
    pub open: usize,
    pub closed: usize,
}

impl Grid {
    /// `steps` a quad, even.
    pub fn new(mesh: &SubdivMesh, surface: &LimitSurface, field: &Field, camera: &Camera, steps: usize) -> Grid {
        let sizes = mesh.face_sizes.iter().flat_map(|&size| match size {
            4 => vec![steps],
            n => vec![steps / 2; n as usize],
        });
        let face = |(ptex, steps): (usize, usize)| {
            let (mut values, mut positions) = (Vec::new(), Vec::new());
            for k in 0..(steps + 1) * (steps + 1) {
                let uv = [k % (steps + 1), k / (steps + 1)].map(|i| i as f64 / steps as f64);
                let (patch, local) = surface.locate(ptex as u32, uv)?;
                // At vertices without a tangent plane the field has as many values as there are ways in, and lines run into them side by
                // side, which no grid tells apart.
                let is_plane = surface.class(patch).is_none_or(|class| surface.classes()[class].has_tangent_plane());
                // And where the normal is parallel to the light, d_s has all of them: lines end there, which no grid sees.
                let jet = surface.evaluate(patch, local);
                let is_parallel = field.method == Method::Highlight(HighlightKind::Signed)
                    && jet.normal.cross(field.light.axes[1]).length() < PARALLEL;
                let is_defined = (is_plane || local[0].max(local[1]) > TIP) && !is_parallel;
                values.push(field.at(surface, camera, patch, local).filter(|_| is_defined).map(|value| value.x));
                positions.push(jet.position);
            }
            Some(Face { steps, values, positions })
        };
        Grid { faces: sizes.enumerate().map(face).collect(), diagonal: surface.diagonal() }
    }

    /// Steps of a face.
    pub fn steps(&self, face: u32) -> usize {
        self.faces[face as usize].as_ref().map_or(1, |face| face.steps)
    }

    /// Whether a place lies in a cell that is defined at its corners.
    pub fn sees(&self, face: u32, uv: [f64; 2]) -> bool {
        let Some(face) = &self.faces[face as usize] else { return false };
        let [i, j] = uv.map(|x| ((x * face.steps as f64) as usize).min(face.steps - 1));
        let node = |di: usize, dj: usize| (j + dj) * (face.steps + 1) + i + di;
        values_at(face, [node(0, 0), node(1, 0), node(1, 1), node(0, 1)]).is_some()
    }

    /// All values, for a choice among them.
    pub fn values(&self) -> Vec<f64> {
        self.faces.iter().flatten().flat_map(|face| face.values.iter().flatten().copied()).collect()
    }

    /// The lines of a value, and the length of their cells.
    pub fn count(&self, value: f64) -> Count {
        // Each end of a piece of line in a cell: which piece, and which other end it is joined to.
        let mut pieces: Vec<[Option<usize>; 2]> = Vec::new();
        let mut waiting: HashMap<[i64; 3], Vec<(usize, DVec3)>> = HashMap::new();
        let mut links: HashMap<usize, usize> = HashMap::new();
        for face in self.faces.iter().flatten() {
            // Crossings of the edges inside a face are the same from both cells.
            let mut inside: HashMap<(usize, usize), usize> = HashMap::new();
            for cell in 0..face.steps * face.steps {
                let (i, j) = (cell % face.steps, cell / face.steps);
                let node = |di: usize, dj: usize| (j + dj) * (face.steps + 1) + i + di;
                let corners = [node(0, 0), node(1, 0), node(1, 1), node(0, 1)];
                let Some(values) = values_at(face, corners) else { continue };
                let crossed: Vec<usize> =
                    (0..4).filter(|&k| (values[k] > value) != (values[(k + 1) % 4] > value)).collect();
                let pairs: Vec<[usize; 2]> = match crossed[..] {
                    [a, b] => vec![[a, b]],
                    [_, _, _, _] => {
                        // The bilinear surface's saddle says which corners belong together (Nielson & Hamann 1991).
                        let [a, b, c, d] = values;
                        let saddle = (a * c - b * d) / (a + c - b - d);
                        if (saddle > value) == (a > value) { vec![[0, 1], [2, 3]] } else { vec![[3, 0], [1, 2]] }
                    }
                    _ => Vec::new(),
                };
                for pair in pairs {
                    let piece = pieces.len();
                    pieces.push([None; 2]);
                    for (end, side) in pair.into_iter().enumerate() {
                        let id = 2 * piece + end;
                        let [a, b] = [corners[side], corners[(side + 1) % 4]];
                        let [x, y] = [values[side], values[(side + 1) % 4]];
                        let at = face.positions[a].lerp(face.positions[b], (value - x) / (y - x));
                        let is_border = [(0, j, 0), (1, i, face.steps - 1), (2, j, face.steps - 1), (3, i, 0)]
                            .iter()
                            .any(|&(s, place, limit)| s == side && place == limit);
                        if !is_border {
                            match inside.remove(&(a.min(b), a.max(b))) {
                                Some(other) => {
                                    links.insert(id, other);
                                    links.insert(other, id);
                                }
                                None => {
                                    inside.insert((a.min(b), a.max(b)), id);
                                }
                            }
                            continue;
                        }
                        self.meet(face.positions[a].midpoint(face.positions[b]), id, at, &mut waiting, &mut links);
                    }
                }
            }
        }
        count(&links, pieces.len())
    }

    /// Joins an end on the border of a face to the one across, if it is at the same place: not where a sharp edge breaks the line.
    fn meet(
        &self,
        middle: DVec3,
        id: usize,
        at: DVec3,
        waiting: &mut HashMap<[i64; 3], Vec<(usize, DVec3)>>,
        links: &mut HashMap<usize, usize>,
    ) {
        // The same edge of the grid has the same middle to rounding, which may lie on the border of a box.
        let size = 1e-7 * self.diagonal;
        let near = |shift: DVec3| (middle / size + shift).floor().as_i64vec3().to_array();
        for shift in (0..8).map(|k| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) - 0.5) {
            if let Some(there) = waiting.get_mut(&near(shift))
                && let Some(index) = there.iter().position(|(_, other)| other.distance(at) < 1e-7 * self.diagonal)
            {
                let (other, _) = there.remove(index);
                links.insert(id, other);
                links.insert(other, id);
                return;
            }
        }
        waiting.entry(near(DVec3::ZERO)).or_default().push((id, at));
    }
}

fn values_at(face: &Face, corners: [usize; 4]) -> Option<[f64; 4]> {
    let [a, b, c, d] = corners.map(|node| face.values[node]);
    Some([a?, b?, c?, d?])
}

/// Follows the links from end to end; lines of few pieces are left out.
fn count(links: &HashMap<usize, usize>, pieces: usize) -> Count {
    let mut seen = vec![false; pieces];
    let mut follow = |start: usize| {
        let mut end = start;
        let mut length = 0;
        while !std::mem::replace(&mut seen[end / 2], true) {
            length += 1;
            match links.get(&(end ^ 1)) {
                Some(next) => end = *next,
                None => break,
            }
        }
        usize::from(length > SHORT)
    };
    let open = (0..2 * pieces).filter(|end| !links.contains_key(end)).map(&mut follow).sum();
    let closed = (0..2 * pieces).map(&mut follow).sum();
    Count { open, closed }
}
