//! Pipelines that depend on the field.

use super::Passes;
use crate::gpu::device::Device;
use crate::gpu::shader::{Content, Module};
use std::sync::OnceLock;

/// The pipelines that read a field.
#[derive(Debug)]
pub struct FieldPasses {
    content: Content,
    source: String,
    pub limit: OnceLock<wgpu::RenderPipeline>,
    pub limit_full: OnceLock<wgpu::RenderPipeline>,
    pub polygon: OnceLock<wgpu::RenderPipeline>,
    pub polygon_full: OnceLock<wgpu::RenderPipeline>,
    pub limit_compute: OnceLock<wgpu::ComputePipeline>,
}

impl FieldPasses {
    pub fn new(content: Content, source: String) -> FieldPasses {
        FieldPasses {
            content,
            source,
            limit: OnceLock::new(),
            limit_full: OnceLock::new(),
            polygon: OnceLock::new(),
            polygon_full: OnceLock::new(),
            limit_compute: OnceLock::new(),
        }
    }
}

/// What compiles shaders for some tables and a field.
pub trait Compiles {
    fn shader(&self, device: &Device, module: &Module) -> wgpu::ShaderModule;
}

fn compiled(device: &Device, module: &Module, content: Content, field: &str) -> wgpu::ShaderModule {
    let variant = content.variant(device.block_rows);
    device.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(module.name),
        source: wgpu::ShaderSource::Wgsl(module.source_for(&variant, field).into()),
    })
}

impl Compiles for Passes {
    fn shader(&self, device: &Device, module: &Module) -> wgpu::ShaderModule {
        assert!(!module.reads_field(), "{} is compiled for a field", module.name);
        compiled(device, module, self.content, "")
    }
}

impl Compiles for FieldPasses {
    fn shader(&self, device: &Device, module: &Module) -> wgpu::ShaderModule {
        compiled(device, module, self.content, &self.source)
    }
}
