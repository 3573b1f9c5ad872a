//! `--memory-limit`.

use super::Failure;
use crate::memory;
use bytesize::ByteSize;
use clap::Args;

#[derive(Debug, Args)]
pub(super) struct MemoryArgs {
    /// Memory that the command may take, such as 6GiB or 500MB: what needs more is refused beforehand [default: what is free]
    #[arg(long, global = true, value_name = "SIZE", value_parser = size)]
    memory_limit: Option<ByteSize>,
}

fn size(text: &str) -> Result<ByteSize, String> {
    text.parse().map_err(|_| "give a size such as 6GiB or 500MB".to_owned())
}

impl MemoryArgs {
    /// Lets the limit hold from now on.
    pub fn apply(&self) -> Result<(), Failure> {
        match self.memory_limit {
            Some(ByteSize(0)) => {
                Err(Failure::Bad("--memory-limit 0: nothing fits in there; give a size above 0".to_owned()))
            }
            Some(ByteSize(limit)) => {
                memory::set_limit(limit);
                Ok(())
            }
            None => {
                if let Some(free) = memory::free() {
                    memory::set_limit(free);
                }
                Ok(())
            }
        }
    }
}
