//! The one object of `--json`: the command's own fields behind its name.

use crate::swing::Swing;
use serde::Serialize;
use std::path::Path;

/// Version of every `--json` object.
const FORMAT: u32 = 1;

/// The object as text. SI units; a number that is not finite is null; reading a number back gives the same bits.
///
/// # Errors
/// Fields that JSON can't hold.
pub fn text(command: &str, fields: &impl Serialize) -> serde_json::Result<String> {
    #[derive(Serialize)]
    struct Object<'a, T> {
        format: u32,
        command: &'a str,
        #[serde(flatten)]
        fields: &'a T,
    }
    serde_json::to_string_pretty(&Object { format: FORMAT, command, fields })
}

/// A path in such an object; what is not UTF-8 in it stands there as �.
pub fn named(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// What speaks against a recording.
#[derive(Debug, Serialize)]
pub struct Doubt<'a> {
    recording: &'a str,
    words: &'a str,
}

/// All that speaks against the recordings of these swings.
pub fn doubts(swings: &[Swing]) -> Vec<Doubt<'_>> {
    fn of(swing: &Swing) -> impl Iterator<Item = Doubt<'_>> {
        swing.doubts.iter().map(|words| Doubt { recording: &swing.name, words })
    }
    swings.iter().flat_map(of).collect()
}

/// The recordings of these swings: their files, and of files that hold several the run too.
pub fn all_named(swings: &[Swing]) -> Vec<String> {
    swings.iter().map(|swing| swing.name.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_doubt_is_told_with_the_recording_that_it_is_of() {
        let mut swing = crate::examples::swing();
        swing.doubts = vec!["its period is another one".to_owned()];
        let told = serde_json::to_value(doubts(&[swing])).unwrap();
        assert_eq!(told, serde_json::json!([{ "recording": "swing.csv", "words": "its period is another one" }]));
    }
}
