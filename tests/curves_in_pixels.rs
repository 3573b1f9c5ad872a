//! Traced curves against the pixels of pictures: the borders of the stripes, which pixels show by the values of the
//! field at their centres, are where the curves are, and the other way round, to half a pixel.
//!
//! Tracer and pipeline share the patches and the tables, nothing else: the tracer knows no pixels, the shader no
//! curves. Both directions look where the picture is smooth alone: between pixels of one patch, or of two that meet at
//! an edge that is not sharp, whose normals and positions say that they see one layer, and where stripes are wider than
//! pixels.

#[allow(dead_code, reason = "each test program uses its part")]
mod gpu_support;

use catoptric::curves;
use catoptric::field::{Camera, Field, HighlightKind, Method, Pattern, Scout};
use catoptric::gpu::{NO_PATCH, SurfaceImage, View};
use catoptric::mesh::{self, SubdivMesh};
use catoptric::patch::Adjacency;
use catoptric::stam::LimitSurface;
use glam::{DVec2, DVec3};
use gpu_support::{gpu, mesh};
use std::collections::HashMap;

/// Pixels of the picture.
const PIXELS: [u32; 2] = [400, 320];
/// Samples of a pixel each way, as many as a picture may have: between two of them the field is taken for linear.
const SAMPLES: u32 = 4;
/// Samples of the picture.
const SIZE: [u32; 2] = [PIXELS[0] * SAMPLES, PIXELS[1] * SAMPLES];
/// How far stripes and curves may be apart, in pixels.
const HALF: f64 = 0.5;
/// Samples of the picture between samples of a curve.
const STEP: f64 = 0.5;
/// Largest angle between normals of neighbouring samples, degrees; straight pieces of a layer rise by half of it.
const BEND: f64 = 3.0;
/// Least cosine between normal and line of sight: nearer to silhouettes a sample sees too much of the surface.
const SLANT: f64 = 0.1;
/// Width of the stripes in periods, as `render` draws them.
const WIDTH: f64 = 0.42;

/// A sample of a traced curve; the picture's samples are the unit, as everywhere below.
struct Sample {
    at: DVec2,
    position: DVec3,
    /// Ptex faces of the curve's points before and after it.
    faces: [u32; 2],
    /// Index of its value.
    value: usize,
    /// Whether the next sample goes on with the curve.
    goes_on: bool,
}

struct Scene<'a> {
    surface: &'a LimitSurface,
    adjacency: Adjacency,
    camera: Camera,
    image: SurfaceImage,
    spacing: f64,
    values: Vec<f64>,
}

/// Distances in pixels of what was compared.
#[derive(Default)]
struct Found {
    distances: Vec<f64>,
    /// What is in the picture, but not where it is smooth.
    elsewhere: usize,
}

impl Found {
    fn say(&self, what: &str) -> f64 {
        let worst = self.distances.iter().copied().fold(0.0, f64::max);
        let mean = self.distances.iter().sum::<f64>() / self.distances.len().max(1) as f64;
        println!(
            "  {what}: {} compared, {} elsewhere, mean {mean:.1e}, at most {worst:.3} pixels",
            self.distances.len(),
            self.elsewhere
        );
        worst
    }
}

impl Scene<'_> {
    fn pixel(&self, x: i64, y: i64) -> Option<usize> {
        let inside = x >= 0 && y >= 0 && x < i64::from(SIZE[0]) && y < i64::from(SIZE[1]);
        let i = (y * i64::from(SIZE[0]) + x) as usize;
        (inside && self.image.patch[i] != NO_PATCH).then_some(i)
    }

    fn value(&self, i: usize) -> Option<f64> {
        self.image.field[i].map(|value| value.x)
    }

    fn face(&self, i: usize) -> u32 {
        self.surface.patches()[self.image.patch[i] as usize].ptex
    }

    fn normal(&self, i: usize) -> DVec3 {
        DVec3::from_array(self.image.normal[i].map(f64::from))
    }

    /// Whether the field is smooth between two neighbouring pixels.
    fn is_smooth(&self, a: usize, b: usize) -> bool {
        let [first, second] = [a, b].map(|i| self.image.patch[i]);
        let meets = |edge: u8| {
            let across = self.adjacency.across(first as usize, edge);
            across.iter().any(|neighbour| neighbour.patch == second && !neighbour.sharp)
        };
        let (n, m) = (self.normal(a), self.normal(b));
        let step = self.image.position[b] - self.image.position[a];
        let bend = n.cross(m).length().atan2(n.dot(m)).to_degrees();
        let sight = self.camera.sight(self.image.position[a]).normalize();
        (first == second || (0..4).any(meets))
            && bend < BEND
            && step.dot(n).abs() < BEND.to_radians() * step.length()
            && sight.dot(n).abs() > SLANT
            && [a, b].map(|i| self.value(i)).into_iter().flatten().count() == 2
    }

    /// Half a stripe a sample is as much as may change.
    fn is_wide(&self, values: &[f64]) -> bool {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        high - low < 0.5 * WIDTH.min(1.0 - WIDTH) * self.spacing
    }

    /// Whether the picture shows a sample of a curve: nothing hides it, and the field is smooth there.
    fn shows(&self, sample: &Sample) -> bool {
        let corner = (sample.at - 0.5).floor();
        let part = sample.at - 0.5 - corner;
        let Some(pixels) = self.quad(corner.x as i64, corner.y as i64) else { return false };
        let [a, b, c, d] = pixels;
        let weights =
            [(1.0 - part.x) * (1.0 - part.y), part.x * (1.0 - part.y), (1.0 - part.x) * part.y, part.x * part.y];
        let seen: DVec3 = pixels.iter().zip(weights).map(|(&i, w)| self.image.position[i] * w).sum();
        let size = self.image.position[a].distance(self.image.position[d]);
        [(a, b), (c, d), (a, c), (b, d)].into_iter().all(|(i, j)| self.is_smooth(i, j))
            && seen.distance(sample.position) <= size
            // Layers may be nearer to each other than samples.
            && pixels.iter().any(|&i| sample.faces.contains(&self.face(i)))
            && self.is_wide(&pixels.map(|i| self.value(i).unwrap_or(f64::NAN)))
    }

    /// Four neighbouring samples that see the surface.
    fn quad(&self, x: i64, y: i64) -> Option<[usize; 4]> {
        Some([self.pixel(x, y)?, self.pixel(x + 1, y)?, self.pixel(x, y + 1)?, self.pixel(x + 1, y + 1)?])
    }

    /// Where the field has its values in the picture, as pieces of lines: between the places on the sides of four
    /// neighbouring samples where a linear field would have them. By index of the value and place of the four.
    fn level_lines(&self) -> HashMap<(usize, i64, i64), Vec<[DVec2; 2]>> {
        let mut lines: HashMap<(usize, i64, i64), Vec<[DVec2; 2]>> = HashMap::new();
        for (x, y) in (0..i64::from(SIZE[1])).flat_map(|y| (0..i64::from(SIZE[0])).map(move |x| (x, y))) {
            let Some([a, b, c, d]) = self.quad(x, y).map(|quad| quad.map(|i| self.value(i).unwrap_or(f64::NAN))) else {
                continue;
            };
            let corner = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let sides = [
                (a, b, DVec2::ZERO, DVec2::X),
                (b, d, DVec2::X, DVec2::Y),
                (d, c, DVec2::ONE, DVec2::NEG_X),
                (c, a, DVec2::Y, DVec2::NEG_Y),
            ];
            for (k, value) in self.values.iter().enumerate() {
                let crossing = |&(from, to, start, along): &(f64, f64, DVec2, DVec2)| {
                    ((from < *value) != (to < *value)).then(|| corner + start + along * ((value - from) / (to - from)))
                };
                let found: Vec<DVec2> = sides.iter().filter_map(crossing).filter(|at| at.is_finite()).collect();
                let pieces = found.iter().enumerate().flat_map(|(i, &p)| found[i + 1..].iter().map(move |&q| [p, q]));
                if found.len() > 1 {
                    lines.entry((k, x, y)).or_default().extend(pieces);
                }
            }
        }
        lines
    }

    /// Where stripes begin and end between two neighbouring pixels, as the values at their centres say, with the
    /// value's index and the point of the surface; and between how many others it is not smooth.
    fn borders(&self) -> (Vec<(DVec2, usize, DVec3)>, usize) {
        let (mut borders, mut elsewhere) = (Vec::new(), 0);
        for (x, y) in (0..i64::from(SIZE[1])).flat_map(|y| (0..i64::from(SIZE[0])).map(move |x| (x, y))) {
            for (dx, dy) in [(1, 0), (0, 1)] {
                let (Some(a), Some(b)) = (self.pixel(x, y), self.pixel(x + dx, y + dy)) else { continue };
                let (Some(first), Some(second)) = (self.value(a), self.value(b)) else { continue };
                let crossed = |value: &f64| (first < *value) != (second < *value);
                if !(self.is_smooth(a, b) && self.is_wide(&[first, second])) {
                    elsewhere += usize::from(self.values.iter().any(crossed));
                    continue;
                }
                for (k, value) in self.values.iter().enumerate().filter(|(_, value)| crossed(value)) {
                    let part = (value - first) / (second - first);
                    let at = DVec2::new(x as f64 + 0.5 + part * dx as f64, y as f64 + 0.5 + part * dy as f64);
                    borders.push((at, k, self.image.position[a].lerp(self.image.position[b], part)));
                }
            }
        }
        (borders, elsewhere)
    }
}

/// Samples of the traced curves, a quarter of a pixel apart.
fn samples(curves: &[curves::Curve], values: &[f64], camera: &Camera) -> Vec<Sample> {
    let mut samples = Vec::new();
    for curve in curves {
        let value = values.iter().position(|value| *value == curve.value).expect("it was asked for");
        let count = curve.points.len();
        for i in 0..if curve.closed { count } else { count - 1 } {
            let [a, b] = [curve.points[i], curve.points[(i + 1) % count]];
            let faces = [i, (i + 1) % count].map(|i| curve.places[i].face);
            let project = |p: DVec3| camera.project(p).map(DVec2::from_array);
            let (Some(p), Some(q)) = (project(a), project(b)) else { continue };
            let steps = (p.distance(q) / STEP).ceil().max(1.0) as u32;
            for k in 0..=steps {
                let position = a.lerp(b, f64::from(k) / f64::from(steps));
                let at = project(position).expect("between two that are seen");
                samples.push(Sample { at, position, faces, value, goes_on: k < steps });
            }
        }
    }
    samples
}

/// Distance of a point from a piece of a line.
fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let t = (p - a).dot(b - a) / (b - a).length_squared();
    p.distance(a.lerp(b, if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 }))
}

/// Cells about one, as far as is looked.
fn around([x, y]: [i64; 2]) -> impl Iterator<Item = [i64; 2]> {
    (-3..=3).flat_map(move |dy| (-3..=3).map(move |dx| [x + dx, y + dy]))
}

fn check(mesh: &SubdivMesh, method: &Method) {
    let surface = LimitSurface::new(mesh).expect("the mesh is valid");
    let scout = Scout::new(&surface).expect("it has faces");
    let camera = scout.camera(SIZE, DVec3::Z);
    let field: Field = scout.field(method, &camera);
    let spacing = field.light.spacing;
    // The middle of what is seen: at the horizon of the light stripes are narrower than pixels.
    let [low, high] = scout.quantiles(&field, &camera, [0.1, 0.9]).map(|value| (value / spacing).round() as i32);
    let borders = |k: i32| [(k, (f64::from(k) - 0.5 * WIDTH) * spacing), (k, (f64::from(k) + 0.5 * WIDTH) * spacing)];
    let wanted: Vec<(i32, f64)> = (low..=high.min(low + 20)).flat_map(borders).collect();
    let values: Vec<f64> = wanted.iter().map(|(_, value)| *value).collect();
    let curves = curves::trace(&surface, &field, &camera, &wanted, 1e-4 * surface.diagonal());

    let mut view = View::new(camera, field.light);
    view.pattern = Pattern::Stripes { width: WIDTH };
    view.samples = 1;
    view.field = field;
    let tables = gpu().upload(&surface).expect("they fit");
    let image = gpu().inspect(&tables, &view).expect("the adapter works");
    let scene = Scene { surface: &surface, adjacency: surface.adjacency(), camera, image, spacing, values };
    let samples = samples(&curves, &scene.values, &camera);

    println!("{}, {method}: {} values, {} curves", mesh.name, wanted.len(), curves.len());
    let mut on_curves = Found::default();
    let level_lines = scene.level_lines();
    for sample in &samples {
        if !scene.shows(sample) {
            on_curves.elsewhere += 1;
            continue;
        }
        let corner = (sample.at - 0.5).floor();
        let pieces = around([corner.x as i64, corner.y as i64])
            .filter_map(|[x, y]| level_lines.get(&(sample.value, x, y)))
            .flatten();
        let nearest = pieces.map(|[a, b]| distance(sample.at, *a, *b)).fold(f64::INFINITY, f64::min);
        on_curves.distances.push(nearest / f64::from(SAMPLES));
    }
    let worst = on_curves.say("curves on stripes");
    assert!(worst <= HALF, "{}, {method}: a curve is {worst} pixels off", mesh.name);

    // The pieces of curves by value and pixel.
    let mut pieces: HashMap<(usize, i64, i64), Vec<usize>> = HashMap::new();
    for (i, sample) in samples.iter().enumerate().filter(|(_, sample)| sample.goes_on) {
        let cell = sample.at.floor();
        pieces.entry((sample.value, cell.x as i64, cell.y as i64)).or_default().push(i);
    }
    let (stripes, elsewhere) = scene.borders();
    let mut on_stripes = Found { elsewhere, ..Found::default() };
    for (at, value, position) in stripes {
        let cell = at.floor();
        let footprint = camera.sight(position).length() * 2.0 / (camera.axes().scale[1] * f64::from(SIZE[1])) / SLANT;
        let near = around([cell.x as i64, cell.y as i64]);
        let pieces = near.filter_map(|[x, y]| pieces.get(&(value, x, y))).flatten();
        // On this layer.
        let pieces =
            pieces.filter(|&&i| samples[i].position.distance(position) <= HALF * f64::from(SAMPLES) * footprint);
        let nearest = pieces.map(|&i| distance(at, samples[i].at, samples[i + 1].at)).fold(f64::INFINITY, f64::min);
        on_stripes.distances.push(nearest / f64::from(SAMPLES));
    }
    let worst = on_stripes.say("stripes on curves");
    assert!(worst <= HALF, "{}, {method}: no curve within {worst} pixels of a stripe's border", mesh.name);

    // The picture shows enough of both, and most of it is smooth.
    let [curves, stripes] = [&on_curves, &on_stripes].map(|found| found.distances.len());
    assert!(curves > 4000 && stripes > 1000, "{}, {method}: {curves} {stripes}", mesh.name);
    assert!(on_stripes.elsewhere < stripes, "{}, {method}: {} of {stripes}", mesh.name, on_stripes.elsewhere);
    assert!(scene.surface.patches().len() > 8, "there are borders of patches to cross");
}

#[test]
fn curves_are_where_stripes_begin_and_end() {
    let meshes = [mesh::sample(), mesh("pole_5.obj"), mesh("semi_sharp_crease.obj"), mesh("dart_8.obj")];
    let methods = [Method::Reflection, Method::Highlight(HighlightKind::Array), Method::Isophote];
    for (mesh, method) in meshes.iter().flat_map(|mesh| methods.iter().map(move |method| (mesh, method))) {
        check(mesh, method);
    }
}
