//! Rows that evaluate the limit at samples.

use super::{BenchError, Contest, Effort, Unit};
use crate::mesh::SubdivMesh;
use crate::osd::{Bfr, BfrPeer, MAX_ISOLATION, OsdPeer, PeerSamples};
use crate::stam::{Evaluator, LimitSurface, Real, Results, Wanted};
use crate::statistics::scatter;
use std::hint::black_box;

/// Samples of a face where they are grouped.
const OF_A_FACE: usize = 256;

const WANTED: Wanted = Wanted { first: true, second: false, normal: false };

/// Samples on faces with a surface, in groups, as many as asked for or less.
fn grouped(surface: &LimitSurface, count: usize) -> Vec<(u32, f64, f64)> {
    let faces: Vec<u32> =
        (0..surface.ptex_count() as u32).filter(|&face| surface.locate(face, [0.5; 2]).is_some()).collect();
    let groups = count.div_ceil(OF_A_FACE).min(faces.len());
    let of_face = |group: usize| {
        let face = faces[group * faces.len() / groups];
        (0..OF_A_FACE).map(move |k| {
            let [u, v] = scatter((k + group) as u32);
            (face, u, v)
        })
    };
    (0..groups).flat_map(of_face).collect()
}

/// Samples in the order of the evaluator, which keeps those of a patch together.
fn in_order<T: Real>(evaluator: &Evaluator<T>, samples: &[(u32, f64, f64)]) -> Vec<(u32, T, T)> {
    let typed: Vec<(u32, T, T)> = samples.iter().map(|&(face, u, v)| (face, T::of(u), T::of(v))).collect();
    evaluator.place(&typed).order().iter().map(|&index| typed[index as usize]).collect()
}

/// Position, du and dv in single precision.
pub(super) type Jet = [[f32; 3]; 3];

/// What evaluates samples.
pub(super) type Evaluates<T> = Box<dyn FnMut(&PeerSamples<T>, &mut [[[T; 3]; 3]])>;

/// A number type that Bfr evaluates in.
pub(super) trait Peered: Real {
    fn bfr(mesh: &SubdivMesh) -> Result<Evaluates<Self>, BenchError>;
    /// Osd, in `f32` alone: the samples are placed here.
    fn osd(mesh: &SubdivMesh, samples: &[(u32, Self, Self)]) -> Result<Option<Box<dyn FnMut()>>, BenchError>;
    /// Embree, in `f32` alone and where it is built in.
    fn embree(mesh: &SubdivMesh, samples: &[(u32, Self, Self)]) -> Result<Option<Box<dyn FnMut()>>, BenchError>;
    const NAME: &'static str;
}

macro_rules! peered {
    ($type:ty, $name:literal, $osd:expr, $embree:expr) => {
        impl Peered for $type {
            fn bfr(mesh: &SubdivMesh) -> Result<Evaluates<Self>, BenchError> {
                let peer = BfrPeer::<$type>::new(mesh, Bfr::DEFAULT_LEVELS)?;
                Ok(Box::new(move |samples, jets| peer.evaluate(samples, jets).expect("it evaluated before")))
            }

            fn osd(mesh: &SubdivMesh, samples: &[(u32, Self, Self)]) -> Result<Option<Box<dyn FnMut()>>, BenchError> {
                $osd(mesh, samples)
            }

            fn embree(
                mesh: &SubdivMesh,
                samples: &[(u32, Self, Self)],
            ) -> Result<Option<Box<dyn FnMut()>>, BenchError> {
                $embree(mesh, samples)
            }

            const NAME: &'static str = $name;
        }
    };
}

peered!(f32, "evaluate_batched", osd_placed, embree_placed);
peered!(f64, "evaluate_batched_f64", |_, _| Ok(None), |_, _| Ok(None));

#[cfg(feature = "peers")]
fn embree_placed(mesh: &SubdivMesh, samples: &[(u32, f32, f32)]) -> Result<Option<Box<dyn FnMut()>>, BenchError> {
    use crate::osd::{EmbreeSamples, EmbreeSubdivision};
    if !EmbreeSubdivision::takes(mesh) {
        return Ok(None);
    }
    let (embree, samples) = (EmbreeSubdivision::new(mesh)?, EmbreeSamples::new(mesh, samples));
    let mut out = vec![0.0f32; samples.room()];
    Ok(Some(Box::new(move || embree.evaluate(&samples, black_box(&mut out)).expect("it evaluated before"))))
}

#[cfg(not(feature = "peers"))]
fn embree_placed(_: &SubdivMesh, _: &[(u32, f32, f32)]) -> Result<Option<Box<dyn FnMut()>>, BenchError> {
    Ok(None)
}

/// Embree's answers, where it is built in and takes the mesh.
#[cfg(feature = "peers")]
pub(super) fn embree_jets(mesh: &SubdivMesh, samples: &[(u32, f32, f32)]) -> Result<Option<Vec<Jet>>, BenchError> {
    use crate::osd::{EmbreeSamples, EmbreeSubdivision};
    if !EmbreeSubdivision::takes(mesh) {
        return Ok(None);
    }
    let (embree, placed) = (EmbreeSubdivision::new(mesh)?, EmbreeSamples::new(mesh, samples));
    let mut out = vec![0.0f32; placed.room()];
    embree.evaluate(&placed, &mut out)?;
    Ok(Some((0..samples.len()).map(|sample| placed.jet(&out, sample)).collect()))
}

#[cfg(not(feature = "peers"))]
pub(super) fn embree_jets(_: &SubdivMesh, _: &[(u32, f32, f32)]) -> Result<Option<Vec<Jet>>, BenchError> {
    Ok(None)
}

fn osd_placed(mesh: &SubdivMesh, samples: &[(u32, f32, f32)]) -> Result<Option<Box<dyn FnMut()>>, BenchError> {
    let mut osd = OsdPeer::new(mesh, MAX_ISOLATION)?;
    all_placed(osd.place(&PeerSamples::new(samples, mesh.ptex_count()))?, samples.len())?;
    let mut jets = vec![[[0.0f32; 3]; 3]; samples.len()];
    Ok(Some(Box::new(move || osd.evaluate(black_box(&mut jets)).expect("it evaluated before"))))
}

/// Osd leaves samples without a patch out, which would be less work.
pub(super) fn all_placed(placed: usize, samples: usize) -> Result<(), BenchError> {
    if placed == samples { Ok(()) } else { Err(format!("Osd has patches for {placed} of {samples} samples").into()) }
}

pub(super) fn batched<T: Peered>(mesh: &SubdivMesh, effort: Effort) -> Result<Contest<'_>, BenchError> {
    let surface = LimitSurface::new(mesh)?;
    let evaluator = Evaluator::<T>::new(&surface)?;
    let samples = in_order(&evaluator, &grouped(&surface, effort.samples));
    let (count, placed) = (samples.len(), evaluator.place(&samples));
    let [mut results, mut untouched] = [(); 2].map(|()| Results::<T>::new(WANTED, count));
    let peer_samples = PeerSamples::new(&samples, surface.ptex_count());
    let mut jets = vec![[[T::default(); 3]; 3]; count];
    let (mut bfr, osd, embree) = (T::bfr(mesh)?, T::osd(mesh, &samples)?, T::embree(mesh, &samples)?);
    let note = format!(
        "{count} samples grouped by patch, {OF_A_FACE} a face: P, du, dv; patches found before (Bfr finds them itself); Bfr at its default \
         levels 2 and 6, Osd at isolation 10; floor: writing the {} bytes of a result; tables {} bytes",
        9 * size_of::<T>(),
        evaluator.bytes()
    );
    let ours = move || evaluator.evaluate(&placed, black_box(results.columns()));
    let mut contest = Contest::new(T::NAME, Unit::nanoseconds_a_sample(count), note, ours)
        .against("bfr", move || bfr(&peer_samples, black_box(&mut jets)));
    for (peer, work) in [("osd", osd), ("embree", embree)] {
        contest = work.into_iter().fold(contest, |contest, work| contest.against(peer, work));
    }
    Ok(contest.floor(move || untouched.fill(black_box(T::default()))))
}

pub(super) fn random(mesh: &SubdivMesh, effort: Effort) -> Result<Contest<'_>, BenchError> {
    let surface = LimitSurface::new(mesh)?;
    let evaluator = Evaluator::<f32>::new(&surface)?;
    let faces: Vec<u32> =
        (0..surface.ptex_count() as u32).filter(|&face| surface.locate(face, [0.5; 2]).is_some()).collect();
    let sample = |k: usize| {
        let [u, v] = scatter(k as u32);
        // Knuth's multiplicative hash: no order that a cache could follow.
        let face = faces[((k as u64 * 2_654_435_761) >> 7) as usize % faces.len()];
        (face, u as f32, v as f32)
    };
    let samples: Vec<_> = (0..effort.samples).map(sample).collect();
    let peer_samples = PeerSamples::new(&samples, surface.ptex_count());
    let of_bfr = peer_samples.clone();
    let [mut ours, mut theirs, mut others] = [(); 3].map(|()| vec![[[0.0f32; 3]; 3]; samples.len()]);
    let mut osd = OsdPeer::new(mesh, MAX_ISOLATION)?;
    all_placed(osd.place(&peer_samples)?, samples.len())?;
    let mut bfr = f32::bfr(mesh)?;
    let note = format!(
        "{} samples on random faces: the patch is found, then P, du, dv; Osd at isolation 10, FindPatch and EvalPatches; Bfr at its default levels",
        samples.len()
    );
    let unit = Unit::nanoseconds_a_sample(samples.len());
    Ok(Contest::new("evaluate_random", unit, note, move || evaluator.each(&samples, black_box(&mut ours)))
        .against("osd", move || {
            osd.place(&peer_samples).expect("it placed before");
            osd.evaluate(black_box(&mut theirs)).expect("it evaluated before");
        })
        .against("bfr", move || bfr(&of_bfr, black_box(&mut others))))
}
