//! `host completions` and `host man`: what a shell and `man` want to know of the commands.

use super::{Arguments, output};
use crate::error::Failure;
use clap::{Args, CommandFactory};
use clap_complete::Shell;
use std::ffi::OsString;
use std::fs::DirEntry;
use std::path::{Path, PathBuf};

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
    /// Replace pages that exist there
    #[arg(long)]
    force: bool,
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

/// Writes the pages: made in a folder of their own first, so that none of the user's is replaced unasked.
pub(super) fn manual(options: &Manual) -> Result<(), Failure> {
    let made = made_pages().map_err(|error| Failure::failed(format!("could not make the manual pages: {error}")))?;
    output::make_folder(&options.folder)?;
    let pages: Vec<(PathBuf, &String)> = made.iter().map(|(name, page)| (options.folder.join(name), page)).collect();
    let paths: Vec<&Path> = pages.iter().map(|(path, _)| path.as_path()).collect();
    output::check(&paths, &[], options.force)?;
    pages.iter().try_for_each(|(path, page)| output::write(path, page, options.force))?;
    output::result(&format!("wrote the manual pages to {}", options.folder.display()));
    Ok(())
}

/// Name and text of every page.
fn made_pages() -> std::io::Result<Vec<(OsString, String)>> {
    let folder = tempfile::tempdir()?;
    clap_mangen::generate_to(Arguments::command(), folder.path())?;
    let page = |entry: std::io::Result<DirEntry>| {
        let entry = entry?;
        Ok((entry.file_name(), std::fs::read_to_string(entry.path())?))
    };
    folder.path().read_dir()?.map(page).collect()
}
