//! How far normals in single precision are off.

use super::evaluate::{Jet, Peered, all_placed, embree_jets};
use super::{BenchError, Effort, Row};
use crate::mesh::SubdivMesh;
use crate::osd::{MAX_ISOLATION, OsdPeer, PeerSamples};
use crate::stam::{Evaluator, LimitSurface, Results, Wanted};
use crate::statistics::{angle_deg, scatter};
use glam::DVec3;
use std::collections::BTreeMap;

/// How far the mesh is moved, in its own units, along each axis.
const OFFSETS: [f64; 3] = [0.0, 100.0, 1000.0];

pub(super) fn errors(mesh: &SubdivMesh, effort: Effort) -> Result<Vec<Row>, BenchError> {
    let exact = LimitSurface::new(mesh)?;
    let faces = (0..exact.ptex_count() as u32).filter(|&face| exact.locate(face, [0.5; 2]).is_some());
    let faces: Vec<u32> = faces.collect();
    let sample = |k: usize| {
        let [u, v] = scatter(k as u32);
        (faces[k % faces.len()], u as f32, v as f32)
    };
    let samples: Vec<(u32, f32, f32)> = (0..effort.samples).map(sample).collect();
    let normals: Vec<DVec3> = samples
        .iter()
        .map(|&(face, u, v)| {
            let (_, jet) = exact.evaluate_ptex(face, [u, v].map(f64::from)).expect("faces with a surface");
            jet.normal
        })
        .collect();
    OFFSETS
        .into_iter()
        .map(|offset| at(mesh, offset, &samples, &normals))
        .collect::<Result<Vec<_>, _>>()
        .map(|rows| rows.concat())
}

/// The value that this part of them does not exceed (nearest rank), of all but NaN: where the limit has no normal.
fn percentile(values: &[f64], part: f64) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|x| !x.is_nan()).collect();
    sorted.sort_by(f64::total_cmp);
    let rank = (part * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied().unwrap_or(f64::NAN)
}

/// Degrees between a normal and the exact one, if there is one; none at all is as wrong as can be.
fn error(normal: DVec3, exact: DVec3) -> f64 {
    let angle = angle_deg(normal, exact);
    if angle.is_nan() && exact != DVec3::ZERO { 180.0 } else { angle }
}

fn of_jets(jets: &[Jet], normals: &[DVec3]) -> Vec<f64> {
    let vector = |x: [f32; 3]| DVec3::from_array(x.map(f64::from));
    let normal = |jet: &Jet| vector(jet[1]).normalize_or_zero().cross(vector(jet[2]).normalize_or_zero());
    jets.iter().zip(normals).map(|(jet, &exact)| error(normal(jet), exact)).collect()
}

fn at(mesh: &SubdivMesh, offset: f64, samples: &[(u32, f32, f32)], normals: &[DVec3]) -> Result<Vec<Row>, BenchError> {
    let moved = mesh.points.iter().map(|&point| point + DVec3::splat(offset)).collect();
    let mesh = SubdivMesh { points: moved, ..mesh.clone() };
    let evaluator = Evaluator::<f32>::new(&LimitSurface::new(&mesh)?)?;
    let placed = evaluator.place(samples);
    let mut results = Results::new(Wanted { normal: true, ..Wanted::default() }, samples.len());
    evaluator.evaluate(&placed, results.columns());
    let rows = placed.order().iter().enumerate();
    let ours: Vec<f64> = rows
        .map(|(row, &index)| {
            let normal = results.normal(row).expect("asked for");
            error(DVec3::from_array(normal.map(f64::from)), normals[index as usize])
        })
        .collect();

    let peer_samples = PeerSamples::new(samples, mesh.ptex_count());
    let mut jets = vec![[[0.0f32; 3]; 3]; samples.len()];
    f32::bfr(&mesh)?(&peer_samples, &mut jets);
    let bfr = of_jets(&jets, normals);
    let mut osd = OsdPeer::new(&mesh, MAX_ISOLATION)?;
    all_placed(osd.place(&peer_samples)?, samples.len())?;
    osd.evaluate(&mut jets)?;
    let osd = of_jets(&jets, normals);
    let embree = embree_jets(&mesh, samples)?.map(|jets| of_jets(&jets, normals));

    let row = |what: &str, part: f64| {
        let of = |errors: &[f64]| percentile(errors, part);
        let embree = embree.as_deref().map(of);
        let peers: BTreeMap<&str, Option<f64>> =
            [("bfr", Some(of(&bfr))), ("osd", Some(of(&osd))), ("embree", embree)].into();
        let ratios = peers.iter().filter_map(|(peer, error)| Some((*peer, [(*error)? / of(&ours); 2]))).collect();
        Row {
            name: format!("normal_error_{what}_at_{offset}"),
            unit: "degrees",
            catoptric: of(&ours),
            peers,
            floor: None,
            ratios,
            note: format!(
                "{what} of {} samples in f32, mesh moved by {offset} along each axis, against the exact limit in f64; peers: cross product of \
                 their derivatives; Bfr at levels 2 and 6, Osd at isolation 10",
                ours.len()
            ),
        }
    };
    Ok(vec![row("p99.99", 0.9999), row("max", 1.0)])
}
