//! `adapters`: what can draw on this machine.

use super::{Failure, outgoing};
use crate::gpu::{Adapter, AdapterChoice, GpuError, adapters};

/// A line an adapter, the chosen one marked by a star.
pub(super) fn run() -> Result<(), Failure> {
    let choice = AdapterChoice::from_env();
    let found = adapters(&choice);
    let width = found.iter().map(|adapter| adapter.name.chars().count()).max().unwrap_or(0);
    let line = |adapter: &Adapter| {
        let Adapter { name, kind, driver, is_chosen } = adapter;
        let mark = if *is_chosen { '*' } else { ' ' };
        format!("{mark} {name:<width$}  {kind:<14}  {driver}").trim_end().to_owned() + "\n"
    };
    outgoing::say(found.iter().map(line).collect::<String>().as_bytes())?;
    match (found.is_empty(), found.iter().any(|adapter| adapter.is_chosen)) {
        (true, _) => Err(GpuError::NoAdapter.into()),
        (_, true) => Ok(()),
        (_, false) => Err(choice.unknown(found.into_iter().map(|adapter| adapter.name).collect()).into()),
    }
}
