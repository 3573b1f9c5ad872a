//! `info`: what a mesh is made of, and what it will take.

mod adaptive;

use adaptive::AdaptiveLevel;

use super::args::InfoArgs;
use super::{Failure, Steps, progress, refined, write_out};
use crate::gpu;
use crate::mesh::{Boundary, Creasing, FacePlace, Orientation, Part, SubdivMesh, TriangleRule};
use crate::osd::{INFINITE_SHARPNESS, Level, MAX_ISOLATION, Refiner, Rule};
use crate::patch::PatchKind;
use crate::stam::LimitSurface;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::ops::Range;

/// Faces up to which all levels are listed without being asked for: some seconds.
const MANY_FACES: usize = 20_000;

/// Faces at a vertex, or corners of a face, up to which levels are listed without being asked for: what OpenSubdiv takes for an end cap grows faster
/// than they do, to six seconds a level at 2,048.
const LARGE_VALENCE: usize = 1024;

#[derive(Debug, Default, Serialize)]
struct Info {
    mesh: String,
    /// Of a USD stage: metres of a unit, the axis that points up, and the meshes.
    #[serde(skip_serializing_if = "Option::is_none")]
    meters_per_unit: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    up: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    prims: Vec<Prim>,
    vertices: usize,
    faces: usize,
    ptex_faces: usize,
    /// Faces by number of corners.
    face_sizes: BTreeMap<u32, usize>,
    /// Interior vertices by number of faces.
    interior_valences: BTreeMap<usize, usize>,
    /// Boundary vertices by number of faces.
    boundary_valences: BTreeMap<usize, usize>,
    /// Vertices by rule of the control mesh.
    rules: BTreeMap<&'static str, usize>,
    isolated_vertices: usize,
    edges: usize,
    boundary_edges: usize,
    non_manifold_edges: usize,
    semi_sharp_edges: usize,
    infinitely_sharp_edges: usize,
    semi_sharp_vertices: usize,
    largest_finite_sharpness: f32,
    holes: usize,
    /// Faces that run against their neighbours, and components with one side only.
    reversed_faces: Faces,
    one_sided_components: Faces,
    /// Those of the holes that are faces which cannot be part of a surface.
    bad_faces: usize,
    scheme: &'static str,
    boundary: &'static str,
    creasing: &'static str,
    triangles: &'static str,
    /// Patches by kind.
    patches: BTreeMap<&'static str, usize>,
    /// Patches that are stored: those of instances are those of what they repeat.
    stored_patches: usize,
    /// Patches whose extraordinary vertex has no tangent plane.
    without_tangent_plane: usize,
    /// Patches by depth in the quadtree of their ptex face.
    patch_depths: BTreeMap<u8, usize>,
    /// Classes of irregular patches.
    classes: usize,
    /// Bytes of the class matrices in f64 and of the tables on the GPU.
    class_table_bytes: usize,
    gpu_table_bytes: u64,
    /// Bytes of those by layout.
    gpu_table_bytes_by_layout: BTreeMap<String, u64>,
    /// OpenSubdiv's feature-adaptive patches, level by level.
    opensubdiv: Vec<AdaptiveLevel>,
}

/// Some faces: how many, and the first.
#[derive(Debug, Default, Serialize)]
struct Faces {
    count: usize,
    first: Option<FirstFace>,
}

/// A face, as the file counts it.
#[derive(Debug, Serialize)]
struct FirstFace {
    face: u32,
    line: Option<u32>,
    prim: Option<String>,
    #[serde(skip)]
    name: String,
}

impl Faces {
    fn new(mesh: &SubdivMesh, faces: &[u32]) -> Faces {
        let first = faces.first().map(|&face| {
            let place = mesh.face_place(face);
            let FacePlace { face, line, prim } = place;
            FirstFace { face, line, prim: prim.map(str::to_owned), name: place.to_string() }
        });
        Faces { count: faces.len(), first }
    }

    /// The number, with the first face and what to do.
    fn describe(&self, remedy: &str) -> String {
        match &self.first {
            None => "none".to_owned(),
            Some(first) => format!("{} (the first: {}; {remedy})", self.count, first.name),
        }
    }
}

/// A mesh of a stage.
#[derive(Debug, Serialize)]
struct Prim {
    prim: String,
    /// The prim whose patches, refined points and tables it shares: it is the same mesh in another place.
    #[serde(skip_serializing_if = "Option::is_none")]
    shares: Option<String>,
    /// First and number of its faces, ptex faces and vertices among those of the whole.
    faces: [u32; 2],
    ptex_faces: [u32; 2],
    vertices: [u32; 2],
}

pub(super) fn run(args: &InfoArgs) -> Result<(), Failure> {
    let mesh = args.scene.load(args.mesh.as_deref())?;
    let surface = refined(&mesh, &progress("counting".to_owned()))?;
    let control = Refiner::uniform(&mesh, 1).and_then(|r| r.level(0)).map_err(|e| Failure::of(&mesh, e))?;
    let mut info = collect(&mesh, &surface, &control);
    let deepest = args.levels.unwrap_or(match mesh.face_count() {
        _ if info.largest_valence() > LARGE_VALENCE => 0,
        ..=MANY_FACES => MAX_ISOLATION,
        _ => 3,
    });
    // OpenSubdiv's patches of triangles are not read.
    let deepest = if surface.has_triangles() { 0 } else { deepest };
    let steps = Steps::new(deepest as usize, "levels of OpenSubdiv's patches");
    let levels = (1..=deepest).map(|level| {
        let level = AdaptiveLevel::new(&mesh, &surface, level);
        steps.done_one();
        level
    });
    info.opensubdiv = levels.collect::<Result<_, _>>().map_err(|e| Failure::of(&mesh, e))?;
    drop(steps);
    let text = if args.json {
        serde_json::to_string_pretty(&info).map_err(std::io::Error::from)? + "\n"
    } else {
        describe(&info)
    };
    write_out(None, text.as_bytes())
}

impl Info {
    /// The most faces at a vertex, those that refinement makes in the middle of faces among them.
    fn largest_valence(&self) -> usize {
        let valences = self.interior_valences.keys().chain(self.boundary_valences.keys()).copied();
        valences.chain(self.face_sizes.keys().map(|&size| size as usize)).max().unwrap_or(0)
    }
}

fn collect(mesh: &SubdivMesh, surface: &LimitSurface, control: &Level) -> Info {
    let mut info = Info {
        mesh: mesh.name.clone(),
        meters_per_unit: mesh.meters_per_unit,
        up: mesh.up.map(|up| up.to_array()),
        prims: prims(mesh),
        vertices: mesh.points.len() - mesh.spare_vertices().len(),
        faces: mesh.face_count(),
        ptex_faces: surface.ptex_count(),
        holes: control.face_holes.iter().filter(|&&hole| hole != 0).count(),
        bad_faces: mesh.bad_faces.len(),
        classes: surface.classes().len(),
        stored_patches: surface.stored_patches(),
        class_table_bytes: surface.tables().iter().map(|table| table.bytes()).sum(),
        gpu_table_bytes: gpu::tables::bytes(surface, gpu::TableLayout::Auto),
        gpu_table_bytes_by_layout: gpu::TableLayout::ALL
            .iter()
            .map(|&layout| (layout.to_string(), gpu::tables::bytes(surface, layout)))
            .collect(),
        scheme: mesh.scheme.name(),
        boundary: match mesh.boundary {
            Boundary::None => "none",
            Boundary::EdgeOnly => "edge only",
            Boundary::EdgeAndCorner => "edge and corner",
        },
        creasing: match mesh.creasing {
            Creasing::Uniform => "uniform",
            Creasing::Chaikin => "chaikin",
        },
        triangles: match mesh.triangles {
            TriangleRule::CatmullClark => "catmull-clark",
            TriangleRule::Smooth => "smooth",
        },
        ..Info::default()
    };
    let classes = (0..surface.patches().len()).filter_map(|patch| surface.class(patch));
    info.without_tangent_plane = classes.filter(|&class| !surface.classes()[class].has_tangent_plane()).count();
    for &size in &mesh.face_sizes {
        *info.face_sizes.entry(size).or_default() += 1;
    }
    for patch in surface.patches() {
        *info.patch_depths.entry(patch.depth[0].max(patch.depth[1])).or_default() += 1;
    }
    for kind in PatchKind::ALL {
        info.patches.insert(kind.name(), surface.patches().iter().filter(|patch| patch.kind == kind).count());
    }
    let Orientation { reversed, one_sided } = mesh.orientation();
    info.reversed_faces = Faces::new(mesh, &reversed);
    info.one_sided_components = Faces::new(mesh, &one_sided);
    edges(mesh, control, &mut info);
    vertices(mesh, control, &mut info);
    info
}

fn prims(mesh: &SubdivMesh) -> Vec<Prim> {
    let span = |range: &Range<u32>| [range.start, range.end - range.start];
    let spare = mesh.spare_vertices();
    let spare_before = |end: u32| spare.partition_point(|&vertex| vertex < end) as u32;
    let own = |points: &Range<u32>| points.start..points.end - (spare_before(points.end) - spare_before(points.start));
    let prim = |(part, ptex): (&Part, Range<u32>)| Prim {
        prim: part.name.clone(),
        shares: part.repeats.map(|repeat| mesh.parts[repeat.part as usize].name.clone()),
        faces: span(&part.faces),
        ptex_faces: span(&ptex),
        vertices: span(&own(&part.points)),
    };
    mesh.ptex_parts().iter().map(prim).collect()
}

fn edges(mesh: &SubdivMesh, control: &Level, info: &mut Info) {
    // Bad faces share no edge with others.
    let of_bad = |edge: &[i32; 2]| usize::try_from(edge[0]).is_ok_and(|face| mesh.is_bad_face(face));
    for (faces, &sharpness) in control.edge_faces.iter().zip(&control.edge_sharpness) {
        if of_bad(faces) {
            continue;
        }
        info.edges += 1;
        match faces {
            [_, -2] => info.non_manifold_edges += 1,
            [_, -1] => info.boundary_edges += 1,
            // Boundaries are infinitely sharp by rule; what is counted here was asked for.
            _ if sharpness >= INFINITE_SHARPNESS => info.infinitely_sharp_edges += 1,
            _ if sharpness > 0.0 => info.semi_sharp_edges += 1,
            _ => {}
        }
        if sharpness < INFINITE_SHARPNESS {
            info.largest_finite_sharpness = info.largest_finite_sharpness.max(sharpness);
        }
    }
}

fn vertices(mesh: &SubdivMesh, control: &Level, info: &mut Info) {
    let mut faces = vec![0; control.vertex_count()];
    let mut boundary = vec![false; control.vertex_count()];
    for face in 0..control.face_count() {
        for [vertex, next, edge] in control.edges_of_face(face) {
            faces[vertex] += 1;
            if control.edge_faces[edge][1] < 0 {
                boundary[vertex] = true;
                boundary[next] = true;
            }
        }
    }
    let spare = mesh.spare_vertices();
    for (vertex, &count) in faces.iter().enumerate() {
        if spare.binary_search(&(vertex as u32)).is_ok() {
            continue;
        }
        let histogram = match (count, boundary[vertex]) {
            (0, _) => {
                info.isolated_vertices += 1;
                continue;
            }
            (_, true) => &mut info.boundary_valences,
            (_, false) => &mut info.interior_valences,
        };
        *histogram.entry(count).or_default() += 1;
        let rule = match control.vertex_rules[vertex] {
            Rule::Smooth => "smooth",
            Rule::Dart => "dart",
            Rule::Crease => "crease",
            Rule::Corner => "corner",
        };
        *info.rules.entry(rule).or_default() += 1;
        let sharpness = control.vertex_sharpness[vertex];
        if sharpness > 0.0 && sharpness < INFINITE_SHARPNESS {
            info.semi_sharp_vertices += 1;
            info.largest_finite_sharpness = info.largest_finite_sharpness.max(sharpness);
        }
    }
}

fn describe(info: &Info) -> String {
    fn list<K: std::fmt::Display>(map: &BTreeMap<K, usize>) -> String {
        let items: Vec<_> = map.iter().filter(|(_, n)| **n > 0).map(|(key, n)| format!("{key}: {n}")).collect();
        if items.is_empty() { "none".to_owned() } else { items.join(", ") }
    }
    let mebibytes = |bytes: f64| format!("{:.2} MiB", bytes / f64::from(1 << 20));
    let edges = format!(
        "{} (boundary: {}, not manifold: {}, semi-sharp: {}, infinitely sharp: {})",
        info.edges, info.boundary_edges, info.non_manifold_edges, info.semi_sharp_edges, info.infinitely_sharp_edges
    );
    let bad = if info.bad_faces > 0 { format!(", of which bad faces: {}", info.bad_faces) } else { String::new() };
    let mut rows = vec![("mesh", info.mesh.clone())];
    for Prim { prim, shares, faces, ptex_faces, .. } in &info.prims {
        let [first, count] = ptex_faces;
        let end = first + count.saturating_sub(1);
        let shares = shares.as_ref().map_or_else(String::new, |prim| format!("; shared with {prim}"));
        rows.push(("  prim", format!("{prim} (faces: {}; ptex faces: {first} to {end}{shares})", faces[1])));
    }
    rows.extend(info.meters_per_unit.map(|meters| ("unit", format!("{meters} m (the stage's; nothing is converted)"))));
    rows.extend(info.up.map(|[_, y, _]| ("up", if y > 0.5 { "Y" } else { "Z" }.to_owned())));
    rows.extend([
        ("control vertices", format!("{} (isolated: {})", info.vertices, info.isolated_vertices)),
        ("control faces", format!("{} (holes: {}{bad}; ptex faces: {})", info.faces, info.holes, info.ptex_faces)),
        ("faces by corners", list(&info.face_sizes)),
        ("interior valences", list(&info.interior_valences)),
        ("boundary valences", list(&info.boundary_valences)),
        ("vertex rules", list(&info.rules)),
        ("edges", edges),
        ("against their neighbours", info.reversed_faces.describe("flip it")),
        ("one-sided components", info.one_sided_components.describe("cut it across")),
        ("semi-sharp vertices", info.semi_sharp_vertices.to_string()),
        ("largest finite sharpness", info.largest_finite_sharpness.to_string()),
        ("scheme", info.scheme.to_owned()),
        ("boundary rule", info.boundary.to_owned()),
        ("creasing rule", info.creasing.to_owned()),
        ("triangle rule", info.triangles.to_owned()),
        ("patches", format!("{} (all exact)", list(&info.patches))),
        ("without tangent plane", info.without_tangent_plane.to_string()),
        ("patches by depth", list(&info.patch_depths)),
        ("classes", format!("{} ({} of matrices)", info.classes, mebibytes(info.class_table_bytes as f64))),
        ("GPU tables", mebibytes(info.gpu_table_bytes as f64)),
    ]);
    for (layout, &bytes) in &info.gpu_table_bytes_by_layout {
        rows.push(("  of layout", format!("{layout}: {}", mebibytes(bytes as f64))));
    }
    let mut text = String::new();
    for (name, value) in rows {
        let _ = writeln!(text, "{name:<25} {value}"); // writing to a String cannot fail
    }
    text + &adaptive::describe(&info.opensubdiv)
}
