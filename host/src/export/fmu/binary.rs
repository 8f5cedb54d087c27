//! The unit's library for this computer, by its C compiler: `cc`, or what `CC` names.

use std::path::Path;
use std::process::Command;

/// Path in the archive, and content.
type Library = (String, Vec<u8>);

/// Compiles sources, the first of which includes the others.
///
/// # Errors
/// Why there is none, for a person.
pub(super) fn compiled(identifier: &str, sources: &[(&str, &str)]) -> Result<Library, String> {
    let (platform, ending) = platform().ok_or("the standard has no name for this computer's system")?;
    let folder = tempfile::tempdir().map_err(|error| format!("no temporary folder: {error}"))?;
    for (name, text) in sources {
        std::fs::write(folder.path().join(name), text).map_err(|error| format!("{name}: {error}"))?;
    }
    let library = format!("{identifier}.{ending}");
    compile(folder.path(), sources[0].0, &library)?;
    let bytes = std::fs::read(folder.path().join(&library)).map_err(|error| format!("{library}: {error}"))?;
    Ok((format!("binaries/{platform}/{library}"), bytes))
}

fn compile(folder: &Path, source: &str, library: &str) -> Result<(), String> {
    let named = std::env::var("CC").ok().filter(|name| !name.trim().is_empty()).unwrap_or_else(|| "cc".to_owned());
    let words = shlex::split(&named).filter(|words| !words.is_empty()).ok_or(format!("CC is {named:?}"))?;
    let output = Command::new(&words[0])
        .args(&words[1..])
        .args(["-std=c99", "-O2", "-shared", "-fPIC", "-fvisibility=hidden", source, "-o", library, "-lm"])
        .current_dir(folder)
        .output()
        .map_err(|error| format!("the C compiler {named:?} does not run: {error}"))?;
    let complaint = String::from_utf8_lossy(&output.stderr);
    let first = complaint.lines().next().unwrap_or("it says nothing");
    if output.status.success() { Ok(()) } else { Err(format!("{named} failed: {first}")) }
}

/// What the standard calls this computer, and the ending of its libraries.
fn platform() -> Option<(String, &'static str)> {
    let (system, ending) = match std::env::consts::OS {
        "linux" => ("linux", "so"),
        "macos" => ("darwin", "dylib"),
        "windows" => ("windows", "dll"),
        _ => return None,
    };
    Some((format!("{}-{system}", std::env::consts::ARCH), ending))
}
