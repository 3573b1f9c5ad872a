//! Which adapters there are, and which one is wanted.

use super::GpuError;
use super::hush::hushed;

/// Which adapter to use.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum AdapterChoice {
    /// A real GPU where there is one, else the software adapter.
    #[default]
    Auto,
    /// The software adapter (Mesa lavapipe).
    Software,
    /// The first adapter whose name contains this text, in any case.
    Named(String),
}

/// An adapter of this machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adapter {
    /// Its name, as its driver says it.
    pub name: String,
    /// `discrete GPU`, `integrated GPU`, `virtual GPU`, `software` or `other`.
    pub kind: &'static str,
    /// Driver and version, as the driver says it; empty where it does not.
    pub driver: String,
    /// Whether it is the one that [`Gpu::with`](super::Gpu::with) opens for the choice that was asked about.
    pub is_chosen: bool,
}

impl AdapterChoice {
    /// Reads `CATOPTRIC_ADAPTER`: unset or `auto`, `software`, or part of an adapter's name.
    pub fn from_env() -> AdapterChoice {
        let wanted = std::env::var_os("CATOPTRIC_ADAPTER").unwrap_or_default();
        match wanted.to_string_lossy().trim() {
            "" => AdapterChoice::Auto,
            name if name.eq_ignore_ascii_case("auto") => AdapterChoice::Auto,
            name if name.eq_ignore_ascii_case("software") => AdapterChoice::Software,
            name => AdapterChoice::Named(name.to_owned()),
        }
    }

    /// Rank of an adapter, lowest first; `None` if it is not wanted.
    fn rank(&self, info: &wgpu::AdapterInfo) -> Option<u32> {
        let by_type = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Cpu => 3,
            wgpu::DeviceType::Other => 4,
        };
        let wanted = match self {
            AdapterChoice::Auto => true,
            AdapterChoice::Software => info.device_type == wgpu::DeviceType::Cpu,
            AdapterChoice::Named(name) => info.name.to_lowercase().contains(&name.to_lowercase()),
        };
        wanted.then_some(by_type)
    }

    /// Index of the adapter that is opened, if any is wanted.
    fn index(&self, adapters: &[wgpu::Adapter]) -> Option<usize> {
        let ranks = adapters.iter().enumerate().filter_map(|(i, adapter)| Some((self.rank(&adapter.get_info())?, i)));
        ranks.min().map(|(_, i)| i)
    }

    /// The adapter that is wanted.
    pub(super) fn find(&self) -> Result<wgpu::Adapter, GpuError> {
        let mut adapters = all();
        match self.index(&adapters) {
            Some(index) => Ok(adapters.swap_remove(index)),
            None if adapters.is_empty() => Err(GpuError::NoAdapter),
            None => Err(self.unknown(adapters.iter().map(|adapter| adapter.get_info().name).collect())),
        }
    }

    /// The error where none of the adapters that there are, by name, is the one that is wanted.
    pub(crate) fn unknown(&self, known: Vec<String>) -> GpuError {
        let wanted = match self {
            AdapterChoice::Named(name) => name,
            AdapterChoice::Auto => "auto",
            AdapterChoice::Software => "software",
        };
        GpuError::UnknownAdapter { wanted: wanted.to_owned(), known }
    }
}

/// All adapters of this machine, in the order of their drivers, and which one a choice opens.
pub fn adapters(choice: &AdapterChoice) -> Vec<Adapter> {
    let adapters = hushed(all);
    let chosen = choice.index(&adapters);
    let of = |(i, adapter): (usize, &wgpu::Adapter)| {
        let info = adapter.get_info();
        Adapter {
            kind: match info.device_type {
                wgpu::DeviceType::DiscreteGpu => "discrete GPU",
                wgpu::DeviceType::IntegratedGpu => "integrated GPU",
                wgpu::DeviceType::VirtualGpu => "virtual GPU",
                wgpu::DeviceType::Cpu => "software",
                wgpu::DeviceType::Other => "other",
            },
            driver: [info.driver.trim(), info.driver_info.trim()].join(" ").trim().to_owned(),
            name: info.name,
            is_chosen: chosen == Some(i),
        }
    };
    adapters.iter().enumerate().map(of).collect()
}

fn all() -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    // Validation layers are the business of tests that install them; their absence must not print warnings.
    descriptor.flags = wgpu::InstanceFlags::empty();
    let instance = wgpu::Instance::new(descriptor);
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN))
}
