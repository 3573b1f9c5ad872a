//! A scene without its repetitions.

use std::ops::Range;

use super::{BadFace, Corner, Crease, Part, Repeat, SubdivMesh};

/// The parts of a scene that repeat none, as a mesh of their own.
#[derive(Debug)]
pub struct Originals {
    /// Their faces and points in the order of the scene; it has a part for each.
    pub mesh: SubdivMesh,
    /// For each part of the scene, which part of `mesh` it is.
    pub part: Vec<u32>,
}

/// What is sharp in a part, and its holes, counted from the part's start.
#[derive(Default, PartialEq)]
struct Features {
    creases: Vec<([u32; 2], u32)>,
    corners: Vec<(u32, u32)>,
    holes: Vec<u32>,
}

impl SubdivMesh {
    /// The mesh without the parts that repeat others. `None` if no part does, or if one that says so has another topology than
    /// what it repeats.
    pub fn originals(&self) -> Option<Originals> {
        let repeated = |part: &Part| part.repeats.is_some();
        if !self.parts.iter().any(repeated) || !self.parts_cover_all() {
            return None;
        }
        let starts = self.face_vertex_starts();
        let features = self.features()?;
        let fits = |(index, part): (usize, &Part)| match part.repeats {
            None => true,
            Some(Repeat { part: first, .. }) => {
                let first = first as usize;
                first < index
                    && self.parts[first].repeats.is_none()
                    && self.faces_of(part, &starts) == self.faces_of(&self.parts[first], &starts)
                    && features[index] == features[first]
            }
        };
        if !self.parts.iter().enumerate().all(fits) {
            return None;
        }
        let mut mesh = SubdivMesh {
            name: self.name.clone(),
            scheme: self.scheme,
            boundary: self.boundary,
            creasing: self.creasing,
            triangles: self.triangles,
            ..SubdivMesh::default()
        };
        let mut index = Vec::with_capacity(self.parts.len());
        for (part, features) in self.parts.iter().zip(features) {
            match part.repeats {
                Some(repeat) => index.push(index[repeat.part as usize]),
                None => {
                    index.push(mesh.parts.len() as u32);
                    self.append(&mut mesh, part, features, &starts);
                }
            }
        }
        Some(Originals { mesh, part: index })
    }

    fn append(&self, to: &mut SubdivMesh, part: &Part, features: Features, starts: &[usize]) {
        let [face, point] = [to.face_sizes.len(), to.points.len()].map(|count| count as u32);
        let (sizes, vertices) = self.faces_of(part, starts);
        to.face_sizes.extend(sizes);
        to.face_vertices.extend(vertices.iter().map(|vertex| vertex + point));
        to.points.extend(&self.points[span(&part.points)]);
        let crease = |(vertices, bits): ([u32; 2], u32)| Crease {
            vertices: vertices.map(|vertex| vertex + point),
            sharpness: f32::from_bits(bits),
        };
        to.creases.extend(features.creases.into_iter().map(crease));
        let corner = |(vertex, bits): (u32, u32)| Corner { vertex: vertex + point, sharpness: f32::from_bits(bits) };
        to.corners.extend(features.corners.into_iter().map(corner));
        to.holes.extend(features.holes.into_iter().map(|hole| hole + face));
        let bad = |end: u32| self.bad_faces.partition_point(|bad| bad.face < end);
        let bad = &self.bad_faces[bad(part.faces.start)..bad(part.faces.end)];
        to.bad_faces.extend(bad.iter().map(|bad| BadFace { face: bad.face - part.faces.start + face, ..*bad }));
        to.parts.push(Part {
            name: part.name.clone(),
            faces: face..to.face_sizes.len() as u32,
            points: point..to.points.len() as u32,
            repeats: None,
        });
    }

    fn parts_cover_all(&self) -> bool {
        let mut ends = [0, 0];
        for part in &self.parts {
            let starts = [part.faces.start, part.points.start];
            if starts != ends || part.faces.end < starts[0] || part.points.end < starts[1] {
                return false;
            }
            ends = [part.faces.end, part.points.end];
        }
        ends.map(|end| end as usize) == [self.face_sizes.len(), self.points.len()]
    }

    /// First of each face's vertices in `face_vertices`, and their end.
    fn face_vertex_starts(&self) -> Vec<usize> {
        let ends = self.face_sizes.iter().scan(0, |end, &size| {
            *end += size as usize;
            Some(*end)
        });
        std::iter::once(0).chain(ends).collect()
    }

    /// Sizes of a part's faces and their vertices, counted from the part's first one.
    fn faces_of(&self, part: &Part, starts: &[usize]) -> (&[u32], Vec<u32>) {
        let faces = span(&part.faces);
        let vertices = self.face_vertices.get(starts[faces.start]..starts[faces.end]).unwrap_or_default();
        let own = vertices.iter().map(|vertex| vertex.wrapping_sub(part.points.start));
        (&self.face_sizes[faces], own.collect())
    }

    /// Features of each part; `None` if one names a vertex or face that is in no part.
    fn features(&self) -> Option<Vec<Features>> {
        let mut all: Vec<Features> = self.parts.iter().map(|_| Features::default()).collect();
        let of_point = |vertex: u32| self.parts.partition_point(|part| part.points.end <= vertex);
        for Crease { vertices, sharpness } in &self.creases {
            let index = of_point(vertices[0]);
            let start = self.parts.get(index)?.points.start;
            all[index].creases.push((vertices.map(|vertex| vertex.wrapping_sub(start)), sharpness.to_bits()));
        }
        for Corner { vertex, sharpness } in &self.corners {
            let index = of_point(*vertex);
            let start = self.parts.get(index)?.points.start;
            all[index].corners.push((vertex - start, sharpness.to_bits()));
        }
        for &hole in &self.holes {
            let index = self.parts.partition_point(|part| part.faces.end <= hole);
            let start = self.parts.get(index)?.faces.start;
            all[index].holes.push(hole - start);
        }
        Some(all)
    }
}

fn span(range: &Range<u32>) -> Range<usize> {
    range.start as usize..range.end as usize
}
