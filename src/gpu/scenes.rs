//! What each sample of a tile sees, and the tables from which the passes that follow read it.

use super::charts::Cutter;
use super::device::Device;
use super::frame::Timings;
use super::passes::{self, Passes, Scene, Visible};
use super::tables::numbered;
use super::view::{Tile, View};
use super::watch::Watch;
use super::{GpuError, Pipeline, Tables};
use std::ops::Deref;

/// The scene of a picture: one for all tiles, or where tables are not on the adapter, one for each with those that it sees.
pub(super) struct Scenes<'a> {
    device: &'a Device,
    tables: &'a Tables,
    view: &'a View,
    whole: Option<Scene<'a>>,
    part: Option<Tables>,
}

/// The scene of a tile.
pub(super) enum TileScene<'a> {
    Whole(&'a Scene<'a>),
    Part(Box<Scene<'a>>),
}

impl<'a> Deref for TileScene<'a> {
    type Target = Scene<'a>;

    fn deref(&self) -> &Scene<'a> {
        match self {
            TileScene::Whole(scene) => scene,
            TileScene::Part(scene) => scene,
        }
    }
}

impl<'a> Scenes<'a> {
    pub fn new(
        device: &'a Device,
        tables: &'a Tables,
        view: &'a View,
        timings: &mut Timings,
    ) -> Result<Self, GpuError> {
        let whole = match tables.is_resident() {
            true => Some(timings.time("scene", || Scene::new(device, tables, view))?),
            false => None,
        };
        Ok(Scenes { device, tables, view, whole, part: None })
    }

    /// Largest side of tiles: so that the tables of as many patches as there are samples fit.
    pub fn side(&self, largest: u32) -> u32 {
        match self.whole {
            Some(_) => largest,
            None => largest.min((self.tables.largest_part().isqrt() as u32).max(3 * self.view.samples)),
        }
    }

    /// Fills in what the samples of a tile see.
    pub fn see(
        &mut self,
        passes: &Passes,
        visible: &mut Visible,
        tile: &Tile,
        timings: &mut Timings,
        watch: Watch<'_>,
    ) -> Result<TileScene<'_>, GpuError> {
        let Scenes { device, tables, view, .. } = *self;
        match &self.whole {
            Some(scene) if view.pipeline != Pipeline::Exact => {
                timings.time("visibility", || passes::visibility::run(device, passes, scene, visible, tile))?;
            }
            _ => {
                let cutter = timings.time("charts", || Cutter::new(tables, view, tile));
                // Cutting takes a quarter to nine tenths of this, the more patches the more.
                let [first, second] = if cutter.has_rest() { [0.4, 0.8] } else { [0.4; 2] };
                let charts = timings.time("charts", || cutter.first(watch.part(0.0, first)));
                timings.time("visibility", || passes::charts::run(device, passes, &charts, visible))?;
                if cutter.has_rest() {
                    let depths: Vec<f32> = timings.time("visibility", || device.read_texture(&visible.depth))?;
                    let charts = timings.time("charts", || cutter.rest(&depths, watch.part(first, second)));
                    timings.time("visibility", || passes::charts::run(device, passes, &charts, visible))?;
                }
            }
        }
        watch.tell(1.0);
        if let Some(scene) = &self.whole {
            return Ok(TileScene::Whole(scene));
        }
        let part = timings.time("tables", || -> Result<Tables, GpuError> {
            // Patch + 1; 0 where there is none. Places are counted from 1 too once 0 is among the values.
            let seen: Vec<u32> = device.read_texture(&visible.patch)?;
            let (patches, places) = numbered(&seen, 0);
            let ids: Vec<u32> =
                seen.iter().zip(&places).map(|(&id, &place)| if id == 0 { 0 } else { place + 1 }).collect();
            visible.renumber(device, &ids);
            tables.part(device, patches.into_iter().map(|id| id - 1).collect())
        })?;
        let part = &*self.part.insert(part);
        Ok(TileScene::Part(Box::new(timings.time("scene", || Scene::new(device, part, view))?)))
    }
}
