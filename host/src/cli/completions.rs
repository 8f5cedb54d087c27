//! `host completions` and `host man`: what a shell and `man` want to know of the commands.

use super::{Arguments, output};
use crate::error::Failure;
use clap::{Args, CommandFactory};
use clap_complete::Shell;
use std::path::PathBuf;

/// Print the completions of a shell.
#[derive(Debug, Args)]
#[command(after_help = COMPLETIONS)]
pub(super) struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

const COMPLETIONS: &str = "\
Example:
  host completions bash > ~/.local/share/bash-completion/completions/host
  host completions zsh > ~/.zfunc/_host             (with fpath+=~/.zfunc before compinit)
  host completions fish > ~/.config/fish/completions/host.fish";

/// Write a manual page for each command into a folder.
#[derive(Debug, Args)]
#[command(after_help = MAN)]
pub(super) struct Manual {
    /// The folder; it is made if it is not there
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

const MAN: &str = "\
Example:
  host man ~/.local/share/man/man1      then: man host, man host-fit";

/// Prints completions.
pub(super) fn completions(options: &Completions) {
    let mut text = Vec::new();
    clap_complete::generate(options.shell, &mut Arguments::command(), "host", &mut text);
    output::result(String::from_utf8_lossy(&text).trim_end());
}

/// Writes the pages.
pub(super) fn manual(options: &Manual) -> Result<(), Failure> {
    let folder = options.folder.display();
    let failed = |error| Failure::failed(format!("could not write manual pages to {folder}: {error}"));
    std::fs::create_dir_all(&options.folder).map_err(failed)?;
    clap_mangen::generate_to(Arguments::command(), &options.folder).map_err(failed)?;
    output::result(&format!("wrote the manual pages to {folder}"));
    Ok(())
}
