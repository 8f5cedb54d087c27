//! Finding the model for a command, and showing it.

use super::output;
use crate::error::Failure;
use crate::files::are_one;
use crate::link::Session;
use crate::number::{significant, with_spread};
use crate::operations::model::{Value, values};
use crate::rigfile::{RigFile, Source, USUAL_NAME};
use std::path::{Path, PathBuf};

/// The model file of a command: the named one, or `rig.toml` here.
pub(super) fn chosen_path(named: Option<&Path>) -> Option<PathBuf> {
    let usual = Path::new(USUAL_NAME);
    named.or(usual.exists().then_some(usual)).map(Path::to_owned)
}

/// The named file, or `rig.toml` here.
pub(super) fn load(named: Option<&Path>) -> Result<RigFile, Failure> {
    let Some(path) = chosen_path(named) else {
        return Err(Failure::wrong_use(format!("no model was named, and there is no {USUAL_NAME} here")).next(
            "name one with --rig, take it from the rig with `host pull`, or make one with `host init`; \
                   `host init --unknown-geometry` will do where nothing is known but the motion",
        ));
    };
    let file = RigFile::load(&path)?;
    if named.is_none() {
        output::say(&taken(&path, &file));
    }
    Ok(file)
}

/// The model that was taken because it lies here: it may be another pendulum's.
pub(super) fn taken(path: &Path, file: &RigFile) -> String {
    let pendulum = &file.parameters().pendulum;
    let geometry = if file.is_normalised() {
        "geometry unknown".to_owned()
    } else {
        let [mass, length] = [pendulum.mass_kg, pendulum.length_m].map(|value| significant(value, 4));
        format!("m = {mass} kg, l = {length} m")
    };
    format!("model: {} ({geometry}); --rig names another", path.display())
}

/// Says what the units of a model without geometry mean.
pub(super) fn tell_if_normalised(file: &RigFile) {
    if file.is_normalised() {
        output::warn("the geometry is unknown: every torque and inertia is per m·g·l, which counts as 1 N·m");
    }
}

/// Where values came from that a rig reported.
pub(super) fn source(session: &Session) -> Source {
    Source::read_from(&session.rig().name)
}

/// May a command that reads a model file and recordings write its own model and drawing? The model file that it reads
/// may be updated in place.
pub(super) fn check_outputs(
    rig: Option<&Path>,
    model: Option<&Path>,
    drawing: Option<&Path>,
    recordings: &[&[PathBuf]],
    force: bool,
) -> Result<(), Failure> {
    let rig = chosen_path(rig);
    let recordings = || recordings.iter().flat_map(|paths| paths.iter()).map(PathBuf::as_path);
    let all: Vec<&Path> = model.into_iter().chain(drawing).collect();
    output::check(&all, &recordings().collect::<Vec<_>>(), true)?;
    let is_update = |path: &&Path| rig.as_deref().is_some_and(|rig| are_one(path, rig));
    let new: Vec<&Path> = model.filter(|path| !is_update(path)).into_iter().chain(drawing).collect();
    output::check(&new, &recordings().chain(rig.as_deref()).collect::<Vec<_>>(), force)
}

/// Every number of a model for a person: one number a line.
pub(super) fn listing(file: &RigFile) -> String {
    let values = values(file);
    let number = |value: &Value| match value.std {
        Some(_) => with_spread(value.value, value.std),
        None => short(value.value),
    };
    let width = values.iter().map(|value| number(value).chars().count()).max().unwrap_or(0);
    let line =
        |value: &Value| format!("  {:<4} {:<width$}  {:<13} {}", value.symbol, number(value), value.unit, value.name);
    values.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// Six digits are more than any of these is known to.
fn short(value: f64) -> String {
    let plain = value == 0.0 || (1e-3..1e6).contains(&value.abs());
    if plain { format!("{}", (value * 1e9).round() / 1e9) } else { format!("{value:.5e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::motion::Pendulum;

    #[test]
    fn a_model_that_nobody_named_is_told_with_its_mass_and_length() {
        let told = |file: &RigFile| taken(Path::new("rig.toml"), file);
        let mut paper = Pendulum::paper();
        (paper.mass_kg, paper.length_m) = (0.1466084, 0.15);
        let file = RigFile::new(paper).unwrap();
        assert_eq!(told(&file), "model: rig.toml (m = 0.1466 kg, l = 0.1500 m); --rig names another");
        let unknown = RigFile::normalised(9.81).unwrap();
        assert_eq!(told(&unknown), "model: rig.toml (geometry unknown); --rig names another");
    }
}
