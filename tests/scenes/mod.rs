//! Surfaces and cameras that are hard on a pixel-exact pipeline.

use crate::gpu_support::mesh;
use catoptric::field::{Camera, Projection, Scout};
use catoptric::gpu::{Pipeline, View};
use catoptric::mesh::{self, SubdivMesh};
use catoptric::patch::PatchKind;
use catoptric::stam::{Jet, LimitSurface};
use glam::{DVec3, dvec3};

/// Small enough for many views, large enough for silhouettes of hundreds of pixels; not square, so that axes cannot be
/// mixed up.
const SIZE: [u32; 2] = [200, 180];

/// A surface and a camera.
#[derive(Debug)]
pub struct Scene {
    pub name: String,
    pub surface: LimitSurface,
    pub camera: Camera,
}

impl Scene {
    fn new(name: &str, mesh: &SubdivMesh, camera: impl Fn(&LimitSurface) -> Camera) -> Scene {
        let surface = LimitSurface::new(mesh).expect("it has a surface");
        let camera = camera(&surface);
        Scene { name: format!("{} {name}", mesh.name), surface, camera }
    }

    /// One sample a pixel, in its centre.
    pub fn view(&self, pipeline: Pipeline, proxy_level: Option<u32>) -> View {
        let light = Scout::new(&self.surface).expect("it has patches").light(&self.camera);
        View { pipeline, proxy_level, samples: 1, ..View::new(self.camera, light) }
    }
}

/// What a mesh is looked at for: a patch, and where in it.
struct Feature {
    name: &'static str,
    kind: PatchKind,
}

/// Six meshes from four sides each: fitted, grazing, near to their feature, and grazing there.
pub fn views() -> Vec<Scene> {
    let meshes = [
        (mesh::sample(), Feature { name: "pole", kind: PatchKind::Smooth }),
        (mesh("pole_3.obj"), Feature { name: "pole", kind: PatchKind::Smooth }),
        (mesh("pole_8.obj"), Feature { name: "pole", kind: PatchKind::Smooth }),
        (mesh("dart_5.obj"), Feature { name: "dart", kind: PatchKind::Dart }),
        (mesh("boundary_pole_3.obj"), Feature { name: "boundary", kind: PatchKind::Crease }),
        (mesh("n_gons.obj"), Feature { name: "pole", kind: PatchKind::Smooth }),
    ];
    let all = |(mesh, feature): &(SubdivMesh, Feature)| {
        let fitted = |direction: DVec3| {
            move |surface: &LimitSurface| {
                Scout::new(surface).expect("it has patches").camera_from(SIZE, DVec3::Z, direction, 26.0)
            }
        };
        let near = |part: f64, elevation: f64| {
            move |surface: &LimitSurface| {
                let jet = tip(surface, feature.kind);
                close(&jet, part * surface.diagonal(), elevation)
            }
        };
        [
            Scene::new("fit", mesh, fitted(dvec3(0.6, -0.7, 0.5))),
            Scene::new("grazing", mesh, fitted(dvec3(-0.8, -0.6, 0.05))),
            Scene::new(feature.name, mesh, near(0.05, 60.0)),
            Scene::new(&format!("{}, grazing", feature.name), mesh, near(0.1, 6.0)),
        ]
    };
    meshes.iter().flat_map(all).collect()
}

/// The first vertex of this kind; its normal is that of the patch beside it.
fn tip(surface: &LimitSurface, kind: PatchKind) -> Jet {
    let patch = (0..surface.patches().len()).find(|&patch| surface.kind(patch) == kind).expect("a patch of this kind");
    surface.evaluate(patch, [1e-6, 1e-6])
}

/// From a distance, at so many degrees over the tangent plane.
fn close(jet: &Jet, distance: f64, elevation: f64) -> Camera {
    let (sin, cos) = elevation.to_radians().sin_cos();
    let along = jet.du.normalize();
    let eye = jet.position + distance * (sin * jet.normal + cos * along);
    Camera { eye, target: jet.position, up: jet.normal, projection: Projection::Perspective { fov: 30.0 }, size: SIZE }
}

/// From within a closed object, wide.
pub fn inside(name: &str) -> Scene {
    Scene::new("from inside", &mesh(name), |surface| {
        let [low, high] = surface.bounds().expect("it has patches");
        let eye = (low + high) * 0.5 + 0.1 * (high - low) * dvec3(1.0, -0.5, 0.3);
        Camera {
            eye,
            target: eye + dvec3(0.3, 0.8, 0.6),
            up: DVec3::Z,
            projection: Projection::Perspective { fov: 100.0 },
            size: SIZE,
        }
    })
}

/// A thousandth of the object fills the picture: by a near eye, and by a long lens.
pub fn thousandfold() -> Vec<Scene> {
    let lens = |mesh: &SubdivMesh, kind: PatchKind| {
        Scene::new("long lens", mesh, |surface| {
            let fitted =
                Scout::new(surface).expect("it has patches").camera_from(SIZE, DVec3::Z, dvec3(0.6, -0.7, 0.5), 26.0);
            Camera { target: tip(surface, kind).position, projection: Projection::Perspective { fov: 0.026 }, ..fitted }
        })
    };
    let eye = |mesh: &SubdivMesh, kind: PatchKind, elevation: f64| {
        Scene::new(&format!("near eye, {elevation}"), mesh, |surface| {
            close(&tip(surface, kind), 2e-3 * surface.diagonal(), elevation)
        })
    };
    vec![
        lens(&mesh("pole_3.obj"), PatchKind::Smooth),
        lens(&mesh("dart_5.obj"), PatchKind::Dart),
        lens(&mesh("boundary_pole_3.obj"), PatchKind::Crease),
        eye(&mesh("pole_8.obj"), PatchKind::Smooth, 50.0),
        eye(&mesh("pole_8.obj"), PatchKind::Smooth, 5.0),
        eye(&mesh("n_gons.obj"), PatchKind::Smooth, 40.0),
    ]
}

/// Two cubes of the same size in the picture, one a million times as far away and as large.
pub fn million_to_one() -> Scene {
    const FAR: f64 = 1e6;
    let cube = mesh("cube.obj");
    let copy = |scale: f64, aside: f64| cube.points.iter().map(move |p| scale * (0.3 * *p + dvec3(aside, 0.02, -1.0)));
    let count = cube.points.len() as u32;
    let both = SubdivMesh {
        name: "cubes".into(),
        points: copy(1.0, 0.3).chain(copy(FAR, -0.3)).collect(),
        face_sizes: [cube.face_sizes.clone(), cube.face_sizes.clone()].concat(),
        face_vertices: cube.face_vertices.iter().copied().chain(cube.face_vertices.iter().map(|v| v + count)).collect(),
        ..cube
    };
    Scene::new("1 and 1e6 away", &both, |_| Camera {
        eye: DVec3::ZERO,
        target: DVec3::NEG_Z,
        up: DVec3::Y,
        projection: Projection::Perspective { fov: 60.0 },
        size: SIZE,
    })
}

/// Parallel lines of sight: fitted, a thousandth of the object, and with the eye's plane through its middle.
pub fn orthographic() -> Vec<Scene> {
    let fitted = |surface: &LimitSurface| {
        let scout = Scout::new(surface).expect("it has patches");
        scout.orthographic_from(SIZE, DVec3::Z, dvec3(0.6, -0.7, 0.5))
    };
    let near = |surface: &LimitSurface| {
        let target = tip(surface, PatchKind::Smooth).position;
        let camera = fitted(surface);
        let projection = Projection::Orthographic { height: 1e-3 * surface.diagonal() };
        Camera { eye: camera.eye - camera.target + target, target, projection, ..camera }
    };
    let within = |surface: &LimitSurface| {
        let camera = fitted(surface);
        Camera { eye: camera.target, target: camera.target * 2.0 - camera.eye, ..camera }
    };
    let names = ["pole_8.obj", "cube.obj", "n_gons.obj"];
    let mesh_scenes = names.map(mesh).into_iter().flat_map(|mesh| {
        [
            Scene::new("orthographic", &mesh, fitted),
            Scene::new("orthographic, a thousandth", &mesh, near),
            Scene::new("orthographic, from the middle", &mesh, within),
        ]
    });
    mesh_scenes.chain([Scene::new("orthographic", &mesh::sample(), fitted)]).collect()
}

/// Near to vertices whose innermost pieces are far thinner than long: sectors of a single face, rings of two.
pub fn slivers() -> Vec<Scene> {
    let scene = |name: &str, kind: PatchKind, elevation: f64| {
        Scene::new(&format!("sliver, {elevation}"), &mesh(name), |surface| {
            close(&tip(surface, kind), 0.02 * surface.diagonal(), elevation)
        })
    };
    let places = [
        ("boundary_pole_1.obj", PatchKind::Crease),
        ("crease_sectors_1_3.obj", PatchKind::Crease),
        ("valence_2_interior.obj", PatchKind::Smooth),
        ("valence_2_sharp.obj", PatchKind::Corner),
        ("corner.obj", PatchKind::Corner),
    ];
    let has = |&(name, kind): &(&str, PatchKind)| {
        let surface = LimitSurface::new(&mesh(name)).expect("it has a surface");
        (0..surface.patches().len()).any(|patch| surface.kind(patch) == kind)
    };
    places.into_iter().filter(has).flat_map(|(name, kind)| [40.0, 8.0].map(|angle| scene(name, kind, angle))).collect()
}

/// Every mesh of a folder, fitted.
pub fn corpus(folder: &std::path::Path) -> Vec<Scene> {
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("it is readable").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let meshes = paths.iter().filter_map(|path| mesh::read(path).ok());
    let fitted = |surface: &LimitSurface| {
        Scout::new(surface).expect("it has patches").camera_from(SIZE, DVec3::Z, dvec3(0.6, -0.7, 0.5), 26.0)
    };
    meshes.map(|mesh| Scene::new("", &mesh, fitted)).collect()
}
