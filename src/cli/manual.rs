//! `man` and `completions`: what packages ship beside the program.

use super::args::{Cli, CompletionsArgs, ManArgs};
use super::{Failure, outgoing};
use crate::output::write_whole;
use clap::CommandFactory;

/// Writes `catoptric.1`, and a page a command such as `catoptric-render.1`.
pub(super) fn man(args: &ManArgs) -> Result<(), Failure> {
    let folder = &args.folder;
    std::fs::create_dir_all(folder).map_err(|error| {
        let problem = crate::absent::no_folder(Some(folder)).unwrap_or_else(|| error.to_string());
        Failure::Bad(format!("{}: cannot make the folder: {problem}; choose another one", folder.display()))
    })?;
    let mut all = Cli::command().disable_help_subcommand(true);
    // Commands get their names from the program then.
    all.build();
    let of_commands = all.get_subcommands().filter(|command| !command.is_hide_set()).cloned();
    for command in std::iter::once(all.clone()).chain(of_commands) {
        let page = clap_mangen::Man::new(command);
        let path = folder.join(page.get_filename());
        write_whole(&path, |mut out| page.render(&mut out))?;
        outgoing::note(&path, "");
    }
    Ok(())
}

/// Writes the completions of a shell to standard output.
pub(super) fn completions(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "catoptric", &mut text);
    outgoing::say(&text)
}
