//! The files of an archive.

use super::as_text::refused;
use crate::error::Fault;
use crate::limits::MOST_BYTES_WHOLE;
use crate::words::is_gyroscope;
use std::io::{Cursor, Read};
use zip::ZipArchive;

pub(super) fn unreadable(error: zip::result::ZipError) -> Fault {
    refused("zip archive", &format!("it can't be unpacked ({error})"))
}

/// A file of the archive.
pub(super) fn bytes_of(archive: &mut ZipArchive<Cursor<&[u8]>>, name: &str) -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    archive.by_name(name).map_err(unreadable)?.take(MOST_BYTES_WHOLE).read_to_end(&mut bytes)?;
    if bytes.len() as u64 == MOST_BYTES_WHOLE { Err(Fault::TooLarge) } else { Ok(bytes) }
}

/// A file of the archive as text.
pub(super) fn unpacked(archive: &mut ZipArchive<Cursor<&[u8]>>, name: &str) -> Result<String, Fault> {
    Ok(String::from_utf8_lossy(&bytes_of(archive, name)?).into_owned())
}

/// The only table, the one that is called `Gyroscope`, or the only one of a gyroscope.
pub(super) fn only_one<'a>(tables: &[&'a String]) -> Option<&'a String> {
    let only = |is_it: &dyn Fn(&str) -> bool| {
        let mut found = tables.iter().copied().filter(|name| is_it(stem(name)));
        found.next().filter(|_| found.next().is_none())
    };
    only(&|_| true).or_else(|| only(&|stem| stem.eq_ignore_ascii_case("gyroscope"))).or_else(|| only(&is_gyroscope))
}

/// The name of a file without its folder and its ending.
pub(super) fn stem(name: &str) -> &str {
    let file = name.rsplit('/').next().unwrap_or(name);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}
