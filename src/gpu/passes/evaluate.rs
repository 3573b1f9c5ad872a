//! `shaders/evaluate.wgsl`: the limit at samples.

use super::{Passes, bind, compute};
use crate::gpu::device::Device;
use crate::gpu::records::{JetRecord, SampleRecord};
use crate::gpu::shader::{EVALUATE, WORKGROUP};
use crate::gpu::tables::numbered;
use crate::gpu::{GpuError, Sample, Tables};
use crate::stam::Jet;
use glam::Vec3;
use wgpu::BindingResource::TextureView;
use wgpu::BufferUsages;

/// Samples a dispatch: 65,535 workgroups at most, and 64 MiB of results.
const BATCH: usize = 1 << 20;

fn pipeline<'a>(passes: &'a Passes, device: &Device) -> &'a wgpu::ComputePipeline {
    passes.evaluate.get_or_init(|| compute(passes, device, &EVALUATE, "evaluate", &[]))
}

pub fn run(device: &Device, passes: &Passes, tables: &Tables, samples: &[Sample]) -> Result<Vec<Jet>, GpuError> {
    let patches = tables.patches();
    if let Some(sample) = samples.iter().position(|s| s.patch as usize >= patches) {
        return Err(GpuError::Patch { sample, patch: samples[sample].patch, patches });
    }
    let mut jets = Vec::with_capacity(samples.len());
    if tables.is_resident() {
        for batch in samples.chunks(BATCH) {
            jets.extend(run_batch(device, passes, tables, batch)?);
        }
        return Ok(jets);
    }
    for batch in samples.chunks(BATCH.min(tables.largest_part().max(1))) {
        let patches: Vec<u32> = batch.iter().map(|sample| sample.patch).collect();
        let (patches, places) = numbered(&patches, u32::MAX);
        let batch: Vec<Sample> =
            batch.iter().zip(places).map(|(sample, patch)| Sample { patch, uv: sample.uv }).collect();
        jets.extend(run_batch(device, passes, &tables.part(device, patches)?, &batch)?);
    }
    Ok(jets)
}

fn run_batch(device: &Device, passes: &Passes, tables: &Tables, samples: &[Sample]) -> Result<Vec<Jet>, GpuError> {
    let pipeline = pipeline(passes, device);
    let records: Vec<_> = samples.iter().map(|s| SampleRecord { uv: s.uv, patch_id: s.patch, padding: 0 }).collect();
    let input = device.buffer("the samples", &records, BufferUsages::STORAGE)?;
    let output = device.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("the results"),
        size: (samples.len() * size_of::<JetRecord>()) as u64,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let [records, points, scales] = tables.views();
    let groups = [
        bind(
            device,
            pipeline.get_bind_group_layout(0),
            &[(0, TextureView(&records)), (1, TextureView(&points)), (2, TextureView(&scales))],
        ),
        bind(
            device,
            pipeline.get_bind_group_layout(1),
            &[(0, input.as_entire_binding()), (1, output.as_entire_binding())],
        ),
    ];
    let mut encoder = device.encoder();
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(pipeline);
    for (index, group) in groups.iter().enumerate() {
        pass.set_bind_group(index as u32, group, &[]);
    }
    pass.dispatch_workgroups((samples.len() as u32).div_ceil(WORKGROUP), 1, 1);
    drop(pass);
    device.submit(encoder)?;
    let results: Vec<JetRecord> = device.read(&output)?;
    let unit = tables.unit();
    let world = |v: [f32; 3]| Vec3::from(v).as_dvec3() * unit;
    let jet = |(sample, jet): (&Sample, JetRecord)| Jet {
        position: tables.origin(sample.patch as usize) + world(jet.position),
        du: world(jet.du),
        dv: world(jet.dv),
        normal: Vec3::from(jet.normal).as_dvec3(),
    };
    Ok(samples.iter().zip(results).map(jet).collect())
}
