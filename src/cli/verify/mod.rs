//! `verify`: the regression against OpenSubdiv.

use super::args::VerifyArgs;
use super::{Failure, load, progress, write_out};

use crate::gpu::Gpu;
use crate::output::check_writable;
use crate::verify::{Report, VerifyError, verify};
use std::path::Path;

pub(super) fn run(args: &VerifyArgs) -> Result<(), Failure> {
    args.json.as_deref().map_or(Ok(()), check_writable)?;
    let paths: Vec<Option<&Path>> = match args.meshes[..] {
        [] => vec![None],
        _ => args.meshes.iter().map(|path| Some(path.as_path())).collect(),
    };
    // Every mesh is read before the first is verified: a typing error should not cost minutes.
    let meshes = paths.into_iter().map(load).collect::<Result<Vec<_>, _>>()?;
    let gpu = Gpu::new()?;
    let mut reports = Vec::new();
    for (i, mesh) in meshes.iter().enumerate() {
        let bar = progress(format!("verifying {} ({} of {})", mesh.name, i + 1, meshes.len()));
        let report = verify(mesh, &gpu, args.size).map_err(|error| match error {
            VerifyError::Gpu(error) => error.into(),
            error => Failure::of(mesh, error),
        })?;
        bar.finish_and_clear();
        write_out(None, report.to_string().as_bytes())?;
        reports.push(report);
    }
    let report = Report::new(args.size, reports, Vec::new(), false);
    if let Some(path) = &args.json {
        let mut text = serde_json::to_vec_pretty(&report).map_err(std::io::Error::from)?;
        text.push(b'\n');
        write_out(Some(path), &text)?;
    }
    write_out(None, format!("{}\n", report.verdict()).as_bytes())?;
    if report.pass { Ok(()) } else { Err(Failure::Check) }
}
