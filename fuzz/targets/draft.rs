//! Small meshes made from bytes: valid ones, and from them ones that need not be.

use arbitrary::{Result, Unstructured};
use catoptric::mesh::{Boundary, Corner, Crease, Creasing, Scheme, SubdivMesh};
use glam::DVec3;
use std::fmt::Write;

pub type Input<'a> = Unstructured<'a>;

/// Most vertices of a draft: an execution takes milliseconds.
const MOST_POINTS: usize = 40;

/// Points and polygons.
pub struct Draft {
    pub points: Vec<DVec3>,
    pub faces: Vec<Vec<u32>>,
}

impl Draft {
    /// A valid mesh: a grid, a fan, a prism or two faces back to back.
    pub fn base(input: &mut Input<'_>) -> Result<Draft> {
        let mut draft = match input.int_in_range(0..=3)? {
            0 => grid(input.int_in_range(1..=4)?, input.int_in_range(1..=4)?),
            1 => fan(input.int_in_range(1..=9)?, input.arbitrary()?),
            2 => prism(input.int_in_range(3..=7)?),
            _ => pillow(input.int_in_range(3..=5)?),
        };
        // Not flat, so that there are normals.
        for point in &mut draft.points {
            point.z += f64::from(input.arbitrary::<i8>()?) / 64.0;
        }
        Ok(draft)
    }

    /// A base to which faces of any vertices are added and points moved anywhere.
    pub fn wild(input: &mut Input<'_>) -> Result<Draft> {
        let mut draft = Draft::base(input)?;
        for _ in 0..input.int_in_range(0..=3)? {
            draft.points.push(DVec3::new(coordinate(input)?, coordinate(input)?, coordinate(input)?));
        }
        for _ in 0..input.int_in_range(0..=3)? {
            let at = input.choose_index(draft.points.len())?;
            draft.points[at] = match input.ratio(1, 2)? {
                true => draft.points[input.choose_index(draft.points.len())?],
                false => DVec3::new(coordinate(input)?, coordinate(input)?, coordinate(input)?),
            };
        }
        if input.ratio(1, 6)? {
            let at = input.choose_index(draft.faces.len())?;
            draft.faces.remove(at);
        }
        for _ in 0..input.int_in_range(0..=4)? {
            let mut face = Vec::new();
            for _ in 0..input.int_in_range(3..=6)? {
                face.push(input.int_in_range(0..=draft.points.len() as u32 - 1)?);
            }
            draft.faces.push(face);
        }
        Ok(draft)
    }

    /// With features of any sharpness.
    pub fn mesh(mut self, input: &mut Input<'_>) -> Result<SubdivMesh> {
        let of_quads = Scheme::CatmullClark;
        let scheme = *input.choose(&[of_quads, of_quads, of_quads, Scheme::Loop, Scheme::Bilinear, Scheme::None])?;
        if scheme == Scheme::Loop && input.ratio(7, 8)? {
            self = self.triangles();
        }
        let mut mesh = SubdivMesh {
            name: "draft".to_owned(),
            scheme,
            face_sizes: self.faces.iter().map(|face| face.len() as u32).collect(),
            face_vertices: self.faces.concat(),
            boundary: *input.choose(&[Boundary::None, Boundary::EdgeOnly, Boundary::EdgeAndCorner])?,
            creasing: *input.choose(&[Creasing::Uniform, Creasing::Chaikin])?,
            ..SubdivMesh::default()
        };
        // Sharpness beyond this many makes as many levels of many patches: cut to a few.
        let mut deep = 3;
        for _ in 0..input.int_in_range(0..=6)? {
            let sharpness = sharpness(input, &mut deep)?;
            for pair in self.chain(input)?.windows(2) {
                mesh.creases.push(Crease { vertices: [pair[0], pair[1]], sharpness });
            }
        }
        for _ in 0..input.int_in_range(0..=3)? {
            let vertex = input.int_in_range(0..=self.points.len() as u32 - 1)?;
            mesh.corners.push(Corner { vertex, sharpness: sharpness(input, &mut deep)? });
        }
        for _ in 0..input.int_in_range(0..=2)? {
            mesh.holes.push(input.int_in_range(0..=self.faces.len() as u32)?);
        }
        mesh.points = self.points;
        Ok(mesh)
    }

    /// With every face cut into triangles.
    fn triangles(self) -> Draft {
        let fan =
            |face: &Vec<u32>| face[1..].windows(2).map(|pair| vec![face[0], pair[0], pair[1]]).collect::<Vec<_>>();
        Draft { faces: self.faces.iter().flat_map(fan).collect(), ..self }
    }

    /// Consecutive vertices of a face.
    pub fn chain(&self, input: &mut Input<'_>) -> Result<Vec<u32>> {
        let face = input.choose(&self.faces)?;
        let start = input.choose_index(face.len())?;
        let count = input.int_in_range(2..=face.len())?;
        Ok((0..count).map(|k| face[(start + k) % face.len()]).collect())
    }

    /// As the text of an OBJ.
    pub fn obj(&self) -> String {
        let mut text = String::new();
        for point in &self.points {
            let _ = writeln!(text, "v {} {} {}", point.x, point.y, point.z);
        }
        for face in &self.faces {
            let _ = write!(text, "f");
            for vertex in face {
                let _ = write!(text, " {}", vertex + 1);
            }
            text.push('\n');
        }
        text
    }
}

/// A coordinate: a small one, or one of those where numbers end.
fn coordinate(input: &mut Input<'_>) -> Result<f64> {
    let special =
        [0.0, -0.0, 1e18, -1e18, 1e-18, 5e-324, 1e-300, 1e6, 1.0000000000000002, f64::NAN, f64::INFINITY, 2e18];
    Ok(match input.int_in_range(0..=3)? {
        0 => *input.choose(&special)?,
        1 => input.arbitrary()?,
        _ => f64::from(input.arbitrary::<i8>()?) / 16.0,
    })
}

/// A sharpness, `deep` times above 2.
fn sharpness(input: &mut Input<'_>, deep: &mut u32) -> Result<f32> {
    let special = [0.0, -0.0, 10.0, 10.0, 10.0, 1e-30, 1e-45, 1.0, 2.0, f32::MAX, f32::NAN, -1.0, f32::INFINITY];
    let value = match input.int_in_range(0..=3)? {
        0 => *input.choose(&special)?,
        1 => f32::from(input.arbitrary::<u8>()?) / 25.0,
        2 => input.arbitrary()?,
        _ => f32::from(input.arbitrary::<u8>()?) / 128.0,
    };
    if value > 2.0 && value < 10.0 {
        if *deep == 0 {
            return Ok(1.5);
        }
        *deep -= 1;
    }
    Ok(value)
}

fn grid(columns: u32, rows: u32) -> Draft {
    let points = (0..=rows).flat_map(|j| (0..=columns).map(move |i| DVec3::new(f64::from(i), f64::from(j), 0.0)));
    let at = |i: u32, j: u32| j * (columns + 1) + i;
    let faces =
        (0..rows).flat_map(|j| (0..columns).map(move |i| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
    Draft { points: points.collect(), faces: faces.collect() }
}

/// Faces round a vertex, all the way or not, and with others round them.
fn fan(count: u32, ringed: bool) -> Draft {
    let closed = count >= 3;
    let spokes = 2 * count + u32::from(!closed);
    let ring = |radius: f64| {
        (0..spokes).map(move |i| {
            let angle = f64::from(i) * std::f64::consts::TAU / f64::from(spokes.max(6));
            DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        })
    };
    let mut points = vec![DVec3::ZERO];
    points.extend(ring(1.0));
    let at = |ring: u32, i: u32| 1 + ring * spokes + i % spokes;
    let mut faces: Vec<_> = (0..count).map(|i| vec![0, at(0, 2 * i), at(0, 2 * i + 1), at(0, 2 * i + 2)]).collect();
    if ringed && points.len() + (spokes as usize) <= MOST_POINTS {
        points.extend(ring(2.0));
        let pieces = if closed { spokes } else { spokes - 1 };
        faces.extend((0..pieces).map(|i| vec![at(0, i), at(1, i), at(1, i + 1), at(0, i + 1)]));
    }
    Draft { points, faces }
}

/// A prism on a polygon, closed.
fn prism(sides: u32) -> Draft {
    let corner = |i: u32, z: f64| {
        let angle = f64::from(i) * std::f64::consts::TAU / f64::from(sides);
        DVec3::new(angle.cos(), angle.sin(), z)
    };
    let points = (0..sides).map(|i| corner(i, 0.0)).chain((0..sides).map(|i| corner(i, 1.0))).collect();
    let mut faces = vec![(0..sides).rev().collect(), (sides..2 * sides).collect()];
    faces.extend((0..sides).map(|i| [i, (i + 1) % sides]).map(|[i, k]| vec![i, k, k + sides, i + sides]));
    Draft { points, faces }
}

/// A polygon and its mirror image: every vertex has valence 2.
fn pillow(sides: u32) -> Draft {
    let prism = prism(sides);
    let points = prism.points[..sides as usize].to_vec();
    Draft { points, faces: vec![(0..sides).collect(), (0..sides).rev().collect()] }
}
