//! What a rig had before it was given something else: kept on this computer, one model file a rig, so that it can be
//! brought back.
//!
//! The rig itself keeps one block in flash; what was there before is pulled before every push. The files lie where
//! programs keep their state: `$XDG_STATE_HOME/pendulum-rig`, or `~/.local/state/pendulum-rig`.

use super::{LinkError, Session};
use crate::error::Failure;
use crate::rigfile::{RigFile, Source};
use shared::parameters::Parameters;
use std::path::{Path, PathBuf};

impl Session {
    /// The parameters that the rig had before this computer gave it those it has now.
    ///
    /// # Errors
    /// Nothing was ever given to it from here, or the file cannot be read.
    pub fn previous(&self) -> Result<RigFile, Failure> {
        let none = || {
            Failure::failed(format!("nothing was pushed to {} on {} from this computer", self.rig().name, self.port()))
                .next("send a model with `host push`, or take what the rig has with `host pull`")
        };
        let path = self.kept_at().filter(|path| path.exists()).ok_or_else(none)?;
        Ok(RigFile::load(&path)?)
    }

    /// Keeps what the rig has, unless that is what it is about to get. A computer that cannot keep it is told so, and
    /// the rig gets its parameters all the same: gives why.
    pub(super) fn keep_before(&mut self, sent: &Parameters<f32>) -> Result<Option<String>, LinkError> {
        let before = match self.parameters() {
            Ok(before) => before,
            // Another program's formula: nothing that this one could bring back.
            Err(LinkError::UnknownFormula) => return Ok(None),
            Err(error) => return Err(error),
        };
        if before == *sent {
            return Ok(None);
        }
        let source = Source::read_from(&self.rig().name);
        let kept = self.kept_at().ok_or("there is no home folder".to_owned()).and_then(|path| {
            let file = RigFile::of_rig(&before, &source).map_err(|error| error.to_string())?;
            save(&file, &path).map_err(|error| format!("{}: {error}", path.display()))
        });
        let lost = |why| format!("what the rig had before is not kept, `host undo` will not bring it back: {why}");
        Ok(kept.err().map(lost))
    }

    /// One file for each name of a rig on each port.
    fn kept_at(&self) -> Option<PathBuf> {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        let name: String = format!("{} {}", self.rig().name, self.port()).chars().map(plain).collect();
        Some(self.state.as_ref()?.join(format!("before-{name}.toml")))
    }
}

fn save(file: &RigFile, path: &Path) -> Result<(), Box<dyn std::error::Error>> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    Ok(file.save(path)?)
}

pub(super) fn state_folder() -> Option<PathBuf> {
    let given = std::env::var_os("XDG_STATE_HOME").or_else(|| std::env::var_os("LOCALAPPDATA"));
    let given = given.map(PathBuf::from).filter(|folder| folder.is_absolute());
    let folder = given.or_else(|| std::env::home_dir().map(|home| home.join(".local/state")))?;
    Some(folder.join("pendulum-rig"))
}

#[cfg(test)]
mod tests {
    use crate::link::connect;
    use shared::parameters::Parameters;

    #[test]
    fn what_is_not_kept_is_told_and_what_is_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "no folder").unwrap();
        let mut model = Parameters::paper();
        model.pendulum.mass_kg = 0.2;
        for nowhere in [None, Some(file.as_path())] {
            let mut session = connect("sim").unwrap().keeping_in(nowhere);
            let told = session.push(&model).unwrap().unwrap();
            assert!(told.contains("`host undo` will not bring it back"), "{told}");
            assert!(session.previous().is_err());
        }
        let mut session = connect("sim").unwrap().keeping_in(Some(folder.path()));
        let before = session.parameters().unwrap();
        assert_eq!(session.push(&model).unwrap(), None);
        assert_eq!(session.previous().unwrap().parameters().map(|value| value as f32), before);
    }
}
