//! Rows that draw pictures.

use super::{BenchError, Contest, Unit};
use crate::field::Scout;
use crate::gpu::{Corner, Gpu, NO_PATCH, Pipeline, View};
use crate::mesh::SubdivMesh;
use crate::stam::LimitSurface;
use crate::statistics::{angle_deg, scatter, short};
use glam::DVec3;
use rayon::prelude::*;
use std::hint::black_box;
use std::rc::Rc;

/// Side of the picture.
const SIDE: u32 = 1024;
/// What normals may be off, in degrees: a hundredth of a pixel of reflection line on a face 200 pixels wide that turns by half a radian.
const BUDGET: f64 = 1.4e-3;
/// Parts of a ptex face each way that are tried, and what is too much: a gigabyte.
const PARTS: [u32; 5] = [8, 16, 32, 64, 128];
const MOST_BYTES: u64 = 1 << 30;
/// Places where a tessellation's normals are looked at.
const PLACES: u32 = 20_000;

/// The limit at the vertices of a grid on every ptex face, which shares none with its neighbours: creases stay sharp.
struct Grid {
    parts: u32,
    corners: Vec<Corner>,
    indices: Vec<u32>,
    /// 99th percentile of how far interpolated normals are off.
    error: f64,
}

impl Grid {
    fn new(surface: &LimitSurface, faces: &[u32], parts: u32) -> Self {
        let row = parts + 1;
        let of_face = |&face: &u32| {
            let corner = move |k: u32| {
                let uv = [k % row, k / row].map(|k| f64::from(k) / f64::from(parts));
                let (_, jet) = surface.evaluate_ptex(face, uv).expect("faces with a surface");
                [jet.position.as_vec3().to_array(), jet.normal.as_vec3().to_array()]
            };
            (0..row * row).map(corner).collect::<Vec<_>>()
        };
        let corners = faces.par_iter().flat_map_iter(of_face).collect();
        let cell = |face: u32, k: u32| {
            let first = face * row * row + k / parts * row + k % parts;
            [first, first + 1, first + row + 1, first, first + row + 1, first + row]
        };
        let indices =
            (0..faces.len() as u32).flat_map(|face| (0..parts * parts).flat_map(move |k| cell(face, k))).collect();
        let mut grid = Self { parts, corners, indices, error: 0.0 };
        let mut errors: Vec<f64> = (0..PLACES).into_par_iter().map(|k| grid.error_at(surface, faces, k)).collect();
        errors.retain(|error| !error.is_nan());
        errors.sort_by(f64::total_cmp);
        grid.error = errors.get(errors.len() * 99 / 100).copied().unwrap_or(f64::NAN);
        grid
    }

    /// Degrees between the interpolated normal and that of the limit, at one of many places.
    fn error_at(&self, surface: &LimitSurface, faces: &[u32], place: u32) -> f64 {
        let at = place as usize % faces.len();
        let uv = scatter(place);
        let [i, j] = uv.map(|t| ((t * f64::from(self.parts)) as u32).min(self.parts - 1));
        let [a, b] = [uv[0] * f64::from(self.parts) - f64::from(i), uv[1] * f64::from(self.parts) - f64::from(j)];
        let row = self.parts + 1;
        let normal = |di: u32, dj: u32| {
            let corner = at as u32 * row * row + (j + dj) * row + i + di;
            DVec3::from_array(self.corners[corner as usize][1].map(f64::from))
        };
        // The diagonal runs from (0,0) to (1,1).
        let between = match a > b {
            true => normal(0, 0) * (1.0 - a) + normal(1, 0) * (a - b) + normal(1, 1) * b,
            false => normal(0, 0) * (1.0 - b) + normal(0, 1) * (b - a) + normal(1, 1) * a,
        };
        let (_, jet) = surface.evaluate_ptex(faces[at], uv).expect("faces with a surface");
        angle_deg(between, jet.normal)
    }

    /// The coarsest grid that is accurate enough, or the finest that fits.
    fn accurate(surface: &LimitSurface, faces: &[u32]) -> Self {
        let bytes = |parts: &u32| faces.len() as u64 * u64::from(parts * parts) * 48;
        let mut tried = PARTS.iter().filter(|parts| bytes(parts) < MOST_BYTES);
        let mut grid = Self::new(surface, faces, *tried.next().unwrap_or(&PARTS[0]));
        for &parts in tried {
            if grid.error <= BUDGET {
                break;
            }
            grid = Self::new(surface, faces, parts);
        }
        grid
    }
}

/// 99.99th percentile of how far the normals of a picture are off, in degrees.
fn picture_error(
    surface: &LimitSurface,
    gpu: &Gpu,
    tables: &crate::gpu::Tables,
    view: &View,
) -> Result<f64, BenchError> {
    let image = gpu.inspect(tables, view)?;
    let seen = (0..image.patch.len()).filter(|&pixel| image.patch[pixel] != NO_PATCH);
    let error = |pixel: usize| {
        let exact = surface.evaluate(image.patch[pixel] as usize, image.uv[pixel].map(f64::from)).normal;
        angle_deg(DVec3::from_array(image.normal[pixel].map(f64::from)), exact)
    };
    let mut errors: Vec<f64> = seen.map(error).filter(|error| !error.is_nan()).collect();
    errors.sort_by(f64::total_cmp);
    Ok(errors.get((errors.len() * 9999).div_ceil(10_000).saturating_sub(1)).copied().unwrap_or(f64::NAN))
}

pub(super) fn frame<'a>(mesh: &'a SubdivMesh, gpu: &'a Gpu) -> Result<Vec<Contest<'a>>, BenchError> {
    let surface = LimitSurface::new(mesh)?;
    let scout = Scout::new(&surface).ok_or("no surface: there is no picture of it")?;
    let camera = scout.camera([SIDE, SIDE], mesh.up.unwrap_or(DVec3::Y));
    let exact = View { samples: 1, ..View::new(camera, scout.light(&camera)) };
    let limit = View { pipeline: Pipeline::Limit, ..exact.clone() };
    let tables = Rc::new(gpu.upload(&surface)?);
    let faces: Vec<u32> =
        (0..surface.ptex_count() as u32).filter(|&face| surface.locate(face, [0.5; 2]).is_some()).collect();
    let grid = Grid::accurate(&surface, &faces);
    let triangles = Rc::new(gpu.tessellate(&grid.corners, &grid.indices, &exact)?);
    gpu.draw_tessellated(&triangles)?;
    let contest = |name: &str, view: &View, what: &str| {
        let note = format!(
            "{SIDE} x {SIDE}, one sample a pixel, tables resident, {what}, picture read back; tables {} bytes, normals {} degrees off at p99.99; \
             tessellation: {} x {} quads a ptex face, resident, not read back, {} bytes ({}x), normals {} degrees off at p99 (asked {BUDGET}; \
             at extraordinary vertices no tessellation is as near at p99.99)",
            tables.size(),
            short(picture_error(&surface, gpu, &tables, view)?),
            grid.parts,
            grid.parts,
            triangles.bytes(),
            short(triangles.bytes() as f64 / tables.size() as f64),
            short(grid.error),
        );
        gpu.render(&tables, view)?;
        let (tables, triangles, view) = (tables.clone(), triangles.clone(), view.clone());
        let ours = move || _ = black_box(gpu.render(&tables, &view).expect("it was drawn before"));
        let theirs = move || gpu.draw_tessellated(&triangles).expect("it was drawn before");
        Ok::<_, BenchError>(Contest::new(name, Unit::MILLISECONDS, note, ours).against("tessellation", theirs))
    };
    let limit = contest("frame", &limit, "the limit at the parameters of a rasterised proxy")?;
    let exact_frame = contest("frame_exact", &exact, "the limit where each pixel's ray meets it")?;
    Ok(vec![limit, traced(exact_frame, &grid, &exact)?])
}

/// With the peer that traces a ray a pixel, on two threads.
#[cfg(feature = "peers")]
fn traced<'a>(contest: Contest<'a>, grid: &Grid, view: &View) -> Result<Contest<'a>, BenchError> {
    use crate::osd::{EmbreeCamera, EmbreeTriangles};
    const THREADS: u32 = 2;
    let points: Vec<[f32; 3]> = grid.corners.iter().map(|corner| corner[0]).collect();
    let start = std::time::Instant::now();
    let triangles = EmbreeTriangles::new(&points, bytemuck::cast_slice(&grid.indices), THREADS)?;
    let built = start.elapsed().as_secs_f64();
    let axes = view.camera.axes();
    let at = |x: f64, y: f64| {
        let [x, y] = [2.0 * x / f64::from(SIDE) - 1.0, 1.0 - 2.0 * y / f64::from(SIDE)];
        axes.forward + axes.right * (x / axes.scale[0]) + axes.up * (y / axes.scale[1])
    };
    let (eye, first) = (view.camera.eye, at(0.5, 0.5));
    let single = |x: DVec3| x.as_vec3().to_array();
    let camera = EmbreeCamera {
        eye: single(eye),
        first: single(eye + first),
        right: single(at(1.5, 0.5) - first),
        down: single(at(0.5, 1.5) - first),
        width: SIDE as i32,
        height: SIDE as i32,
    };
    let mut depths = vec![0.0; (SIDE * SIDE) as usize];
    let note = format!(
        "; Embree: rtcIntersect16 of a ray a pixel with the tessellation, {THREADS} threads, no shading; its hierarchy took {} s before",
        short(built)
    );
    Ok(contest.noting(&note).against("embree", move || {
        black_box(triangles.trace(&camera, THREADS, &mut depths).expect("it was traced before"));
    }))
}

#[cfg(not(feature = "peers"))]
fn traced<'a>(contest: Contest<'a>, _: &Grid, _: &View) -> Result<Contest<'a>, BenchError> {
    Ok(contest)
}
