//! Which mesh a command reads: the file, and what of it.

use super::Failure;
use super::settings::CommandLine;
use crate::mesh::{self, Choice, SubdivMesh};
use clap::Args;
use std::path::Path;

#[derive(Debug, Clone, Default, Args)]
pub(super) struct SceneArgs {
    /// Of a USD stage, read the meshes of this prim and of those below it alone; give as many as there are to be
    #[arg(long = "prim", value_name = "PATH")]
    prims: Vec<String>,
}

impl SceneArgs {
    /// Reads the mesh, or makes the built-in sample; says on standard error what the reader has to say.
    pub(super) fn load(&self, path: Option<&Path>) -> Result<SubdivMesh, Failure> {
        self.read(path).map_err(Failure::Bad)
    }

    /// As [`load`](Self::load); the error is one line.
    pub(super) fn read(&self, path: Option<&Path>) -> Result<SubdivMesh, String> {
        let Some(path) = path else {
            return match self.prims.is_empty() {
                true => Ok(mesh::sample()),
                false => Err("--prim is for USD files; give one before it".to_owned()),
            };
        };
        let mesh = mesh::read_choice(path, &self.choice()).map_err(|error| error.to_string())?;
        for note in &mesh.notes {
            eprintln!("catoptric: {}: {note}", path.display());
        }
        Ok(mesh)
    }

    fn choice(&self) -> Choice {
        Choice { prims: self.prims.clone() }
    }

    /// Adds these flags to a command that is recorded.
    pub(super) fn record(&self, line: &mut CommandLine) {
        self.prims.iter().for_each(|prim| line.flag("prim", prim));
    }

    /// These flags as a shell takes them, each after a space.
    pub(super) fn flags(&self) -> String {
        let mut line = CommandLine::default();
        self.record(&mut line);
        line.into_words()
    }
}
