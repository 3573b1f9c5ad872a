//! Every method's shader against its f64 twin, pixel by pixel.

#[allow(dead_code, reason = "each test program uses its part")]
mod gpu_support;

use catoptric::compare::Exact;
use catoptric::field::{CurvatureKind, Field, Grid, HighlightKind, Light, Method, Mirrored, PlaneCurve, Scout};
use catoptric::gpu::{NO_PATCH, TableLayout, View};
use catoptric::stam::LimitSurface;
use glam::{DVec3, dvec3};
use gpu_support::{gpu, mesh, meshes};

/// A grid of waves, wide enough for what the meshes mirror.
fn waves() -> Grid {
    const SIZE: [u32; 2] = [61, 47];
    let value = |k: u32| {
        let [x, y] = [k % SIZE[0], k / SIZE[0]].map(f64::from);
        (0.31 * x).sin() + (0.23 * y + 0.1 * x).cos() + 0.02 * x
    };
    Grid::new(SIZE, (0..SIZE[0] * SIZE[1]).map(value).collect(), 160.0).expect("a grid")
}

/// Every method, with a spacing in units of a mesh's diagonal or in degrees.
fn methods() -> Vec<(Method, f64)> {
    let expression = "x^2 - x * y / (2 + cos(y))".parse().expect("an expression");
    let mut all = vec![
        (Method::Reflection, 0.3),
        (Method::Curve(PlaneCurve::Circle), 0.3),
        (Method::Curve(PlaneCurve::Ellipse { aspect: 0.6 }), 0.3),
        (Method::Curve(PlaneCurve::Expression(expression)), 0.3),
        (Method::Curve(PlaneCurve::Grid(waves())), 0.1),
        (Method::RayDistance, 0.3),
        (Method::Isophote, 10.0),
        (Method::Section, 0.05),
        (Method::Sphere(Mirrored::Normal), 10.0),
        (Method::Sphere(Mirrored::Reflection), 10.0),
    ];
    use HighlightKind::{Alternative, Array, Nearest, Pseudo, Signed};
    all.extend([Array, Signed, Nearest, Pseudo, Alternative(0.2)].map(|kind| (Method::Highlight(kind), 0.2)));
    use CurvatureKind::{Gaussian, Largest, Mean, Smallest};
    all.extend([Gaussian, Mean, Largest, Smallest].map(|kind| (Method::Curvature(kind), 0.5)));
    all
}

/// Values agree with f64 to within a hundredth of a pixel of the lines that they make; and they are defined in the same places, but for
/// pixels on the brink.
#[test]
fn shaders_read_what_f64_reads() {
    const SIZE: [u32; 2] = [200, 150];
    let meshes = [mesh("pole_5.obj"), mesh("semi_sharp_crease.obj"), mesh("corner.obj")];
    for mesh in &meshes {
        let surface = LimitSurface::new(mesh).expect("the mesh is valid");
        let scout = Scout::new(&surface).expect("it has faces");
        let mut camera = scout.camera(SIZE, DVec3::Z);
        camera.eye += 0.1 * mesh.diagonal() * DVec3::X;
        let tables = gpu().upload_as(&surface, TableLayout::Expanded).expect("they fit");
        let middle = surface.bounds().map(|[low, high]| (low + high) * 0.5).expect("it has patches");
        for (method, spacing) in methods() {
            let diagonal = mesh.diagonal();
            let light = Light::new(
                middle + diagonal * dvec3(0.3, 0.2, 2.5),
                dvec3(0.1, 0.1, -1.0),
                dvec3(0.3, 1.0, 0.0),
                spacing,
            );
            let view = View { field: Field { light, method: method.clone() }, samples: 1, ..View::new(camera, light) };
            let image = gpu().inspect(&tables, &view).expect("the adapter works");
            let same = Exact { surface: &surface, view: &view, image: &image }.compare(&surface, &image);
            let seen: Vec<usize> = (0..image.patch.len()).filter(|&i| image.patch[i] != NO_PATCH).collect();
            let expected =
                |i: usize| view.field.at(&surface, &camera, image.patch[i] as usize, image.uv[i].map(f64::from));
            let brink = seen.iter().filter(|&&i| image.field[i].is_some() != expected(i).is_some()).count();
            println!("{} {method:?}: {} pixels, lines {:?}, {brink} on the brink", mesh.name, seen.len(), same.lines);
            assert!(seen.len() > 3000 && same.lines.count > 1000, "{} {method:?}", mesh.name);
            assert!(same.lines.p99 < 0.01, "{} {method:?}: {:?}", mesh.name, same.lines);
            assert!(brink * 1000 <= seen.len(), "{} {method:?}: {brink} of {}", mesh.name, seen.len());
            // Second coordinates, where they mean something.
            for &i in &seen {
                if let (Some(found), Some(expected)) = (image.field[i], expected(i))
                    && matches!(method, Method::Reflection | Method::Section)
                    // Not near the horizon, where f32 loses them.
                    && expected.length() < 100.0 * diagonal
                {
                    assert!(
                        (found.y - expected.y).abs() <= 1e-5 * (expected.length() + diagonal),
                        "{found} {expected}"
                    );
                }
            }
        }
    }
}

/// Curvature needs every level of the tables point by point.
#[test]
fn curvature_in_other_layouts_is_refused() {
    let surface = LimitSurface::new(&meshes()[0]).expect("the mesh is valid");
    let scout = Scout::new(&surface).expect("it has faces");
    let camera = scout.camera([32, 32], DVec3::Z);
    let mut view = View::new(camera, scout.light(&camera));
    view.field.method = Method::Curvature(CurvatureKind::Mean);
    let tables = gpu().upload_as(&surface, TableLayout::Compact).expect("they fit");
    let error = gpu().render(&tables, &view).expect_err("it is refused");
    assert!(error.to_string().contains("expanded"), "{error}");
}
