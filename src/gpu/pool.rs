//! What passes write, kept from one tile or picture to the next: the system clears memory that it hands out, which costs a fifth of a
//! picture on the software adapter.

use std::ops::Deref;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Textures that nobody uses.
#[derive(Debug, Clone, Default)]
pub(super) struct Pool(Arc<Mutex<Vec<wgpu::Texture>>>);

impl Pool {
    fn idle(&self) -> MutexGuard<'_, Vec<wgpu::Texture>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A texture with what it held last, or a new one, which is zero. Those of other sizes are given up when a new one is made: the pool
    /// holds what one picture needs.
    pub fn take(&self, device: &wgpu::Device, descriptor: &wgpu::TextureDescriptor<'_>) -> Target {
        let mut idle = self.idle();
        let fits = |texture: &wgpu::Texture| {
            (texture.size(), texture.format(), texture.usage())
                == (descriptor.size, descriptor.format, descriptor.usage)
        };
        let texture = match idle.iter().position(fits) {
            Some(index) => idle.swap_remove(index),
            None => {
                idle.retain(|texture| texture.size() == descriptor.size);
                device.create_texture(descriptor)
            }
        };
        Target { texture, pool: self.clone() }
    }
}

/// A texture that goes back to its pool.
#[derive(Debug)]
pub(super) struct Target {
    texture: wgpu::Texture,
    pool: Pool,
}

impl Deref for Target {
    type Target = wgpu::Texture;

    fn deref(&self) -> &wgpu::Texture {
        &self.texture
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        self.pool.idle().push(self.texture.clone());
    }
}
