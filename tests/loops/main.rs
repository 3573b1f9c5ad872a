//! No line is missed: random scenes, traced and on a fine grid, have the same numbers of open and closed lines.

mod grid;
#[path = "../common/random_mesh.rs"]
mod random_mesh;

use catoptric::curves::{self, Curve};
use catoptric::field::{Field, Light, Method, Scout};
use catoptric::mesh::SubdivMesh;
use catoptric::stam::LimitSurface;
use glam::DVec3;
use grid::{Count, Grid, SHORT};
use random_mesh::{Rng, mesh as random_mesh};
use rayon::prelude::*;

/// Steps of the coarsest grid a quad: 16 times finer than 8.
const STEPS: usize = 128;

struct Scene {
    mesh: SubdivMesh,
    surface: LimitSurface,
    camera: catoptric::field::Camera,
    field: Field,
}

/// A mesh, a camera, a light and a method.
fn scene(seed: u64) -> Option<Scene> {
    let mut rng = Rng::new(seed ^ 0x5eed);
    let mut mesh = random_mesh(seed);
    // Features that a grid of 128 steps can see.
    mesh.creases.iter_mut().filter(|crease| crease.sharpness < 10.0).for_each(|c| c.sharpness = c.sharpness.min(1.5));
    mesh.corners.iter_mut().filter(|corner| corner.sharpness < 10.0).for_each(|c| c.sharpness = c.sharpness.min(1.5));
    let surface = LimitSurface::new(&mesh).ok()?;
    let scout = Scout::new(&surface)?;
    let mut direction = || DVec3::new(rng.unit() - 0.5, rng.unit() - 0.5, rng.unit() - 0.5).normalize();
    let camera = scout.camera_from([512; 2], DVec3::Z, direction(), 30.0);
    let [low, high] = surface.bounds()?;
    let (facing, lines) = (direction(), direction());
    let middle = 0.5 * (low + high);
    let distance = surface.diagonal() * 2.0;
    let light = Light::new(middle - facing * distance, facing, lines, 0.1 * surface.diagonal());
    const METHODS: [&str; 8] = [
        "reflection",
        "isophote",
        "highlight:pseudo",
        "section",
        "curve:circle",
        "highlight:signed",
        "highlight:alternative=0.2",
        "curve:ellipse=0.6",
    ];
    let method: Method = METHODS[(seed % 8) as usize].parse().expect("a method");
    Some(Scene { mesh, surface, camera, field: Field { light, method } })
}

impl Scene {
    /// Lines that are longer than a few steps of a grid, as far as it sees them: without what lies in its undefined cells.
    fn traced(&self, value: f64, grid: &Grid) -> Count {
        let curves =
            curves::trace(&self.surface, &self.field, &self.camera, &[(0, value)], 1e-3 * self.surface.diagonal());
        let mut counted = Count { open: 0, closed: 0 };
        for curve in &curves {
            let (pieces, is_whole) = self.seen(curve, grid);
            let long = pieces.into_iter().filter(|&steps| steps > SHORT as f64).count();
            match curve.closed && is_whole {
                true => counted.closed += long,
                false => counted.open += long,
            }
        }
        counted
    }

    /// Lengths, in steps of the grid, of the parts of a curve that it sees, and whether that is all of it.
    fn seen(&self, curve: &Curve, grid: &Grid) -> (Vec<f64>, bool) {
        let mut places = curve.places.clone();
        places.extend(curve.closed.then_some(curve.places[0]));
        let mut parts = vec![0.0];
        let mut is_whole = true;
        let mut starts_in_sight = true;
        for (k, pair) in places.windows(2).enumerate() {
            let [a, b] = [pair[0], pair[1]];
            // From face to face, only the points themselves are looked at.
            let samples = if a.face == b.face { 32 } else { 1 };
            for i in 0..samples {
                let part = (f64::from(i) + 0.5) / f64::from(samples);
                let at = [a.u + part * (b.u - a.u), a.v + part * (b.v - a.v)];
                let at = if samples == 1 { [a.u, a.v] } else { at };
                if grid.sees(a.face, at) {
                    let jet = self.surface.evaluate_ptex(a.face, at).expect("no hole").1;
                    let step = 0.5 * (jet.du.length() + jet.dv.length()) / grid.steps(a.face) as f64;
                    let length = curve.points[k].distance(curve.points[(k + 1) % curve.points.len()]);
                    *parts.last_mut().expect("there is one") += length / f64::from(samples) / step;
                } else {
                    starts_in_sight &= k + i as usize > 0;
                    is_whole = false;
                    parts.push(0.0);
                }
            }
        }
        if curve.closed && !is_whole && starts_in_sight {
            // The start lies within a part.
            let last = parts.pop().unwrap_or(0.0);
            parts[0] += last;
        }
        (parts, is_whole)
    }
}

/// What became of a scene: on which grid the numbers were equal, if on any.
fn judge(seed: u64) -> Option<Result<(usize, Count), String>> {
    let scene = scene(seed)?;
    let grid = |steps: usize| Grid::new(&scene.mesh, &scene.surface, &scene.field, &scene.camera, steps);
    let first = grid(STEPS);
    let mut values = first.values();
    if values.len() < 100 {
        return None;
    }
    values.sort_by(f64::total_cmp);
    let mut rng = Rng::new(seed ^ 0xc0de);
    let value = values[(values.len() as f64 * (0.1 + 0.8 * rng.unit())) as usize];
    // No node has the value itself.
    let value = value + 1e-6 * (values[values.len() - 1] - values[0]).abs().min(1.0) * (0.5 + rng.unit());
    let mut found = Vec::new();
    for refined in [1, 2, 4, 8] {
        let finer = (refined > 1).then(|| grid(STEPS * refined));
        let grid = finer.as_ref().unwrap_or(&first);
        let (traced, counted) = (scene.traced(value, grid), grid.count(value));
        if counted == traced {
            return Some(Ok((refined, traced)));
        }
        found.push((traced, counted));
    }
    let method = &scene.field.method;
    Some(Err(format!("seed {seed}, {method} = {value}: traced and on grids {found:?}")))
}

#[test]
fn counts_are_those_of_fine_grids() {
    let seeds: Vec<u64> = match (std::env::var("CATOPTRIC_SEED"), std::env::var("CATOPTRIC_SCENES")) {
        (Ok(seed), _) => vec![seed.parse().expect("a number")],
        (_, Ok(count)) => (0..count.parse().expect("a number")).collect(),
        _ => (0..60).collect(),
    };
    let judged: Vec<_> = seeds.into_par_iter().filter_map(judge).collect();
    let (mut lines, mut loops, mut finer, mut wrong) = (0, 0, 0, 0);
    for result in &judged {
        match result {
            Ok((refined, count)) => {
                lines += count.open + count.closed;
                loops += count.closed;
                finer += usize::from(*refined > 1);
            }
            Err(what) => {
                wrong += 1;
                println!("{what}");
            }
        }
    }
    println!(
        "{} scenes, {lines} lines, {loops} of them closed; {finer} needed a finer grid than {STEPS} steps a face; {wrong} differ",
        judged.len()
    );
    assert_eq!(wrong, 0);
}
