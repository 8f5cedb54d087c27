//! The one place where files are written, so that nothing is lost: no file is replaced unasked, none that is being read
//! at all, and whoever looks sees the old file or the new one, never half of it.
//!
//! What is complete at once goes into a file beside its place and is renamed ([`write()`], [`NewFile::whole`]). A
//! recording grows in its place ([`NewFile::growing`]): killed in the middle, the program leaves the beginning of it.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;
use thiserror::Error;

/// Links in a row, more than the system itself follows.
const MOST_LINKS: usize = 50;

/// What to do when the file is there already.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// Refuse.
    Keep,
    /// Replace it.
    Overwrite,
    /// Keep it, and take the next name with a number: two programs may choose a name in the same second.
    Number,
}

impl Existing {
    /// As `--force` says.
    pub fn forced(force: bool) -> Self {
        if force { Self::Overwrite } else { Self::Keep }
    }
}

/// Why a file is not written.
#[derive(Debug, Error)]
pub enum FileError {
    /// The file is there already.
    #[error("{} exists already", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// What would be lost is what the result is made from.
    #[error("{} is being read", path.display())]
    IsRead {
        /// The file.
        path: PathBuf,
    },
    /// Two results, one file.
    #[error("{} is asked for twice", path.display())]
    Twice {
        /// The file.
        path: PathBuf,
    },
    /// The system refused.
    #[error("could not write {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
}

impl FileError {
    /// What to do next.
    pub fn next_step(&self) -> &'static str {
        match self {
            Self::Exists { .. } => "choose another name, or replace it with --force",
            Self::IsRead { .. } => "choose another name: a file that is read is not replaced, with --force neither",
            Self::Twice { .. } => "give each result a name of its own",
            Self::Io { .. } => "name one in a folder that exists, may be written to and has space",
        }
    }
}

/// May these files be written by a command that reads those, and can they be? Asked before anything is computed.
///
/// # Errors
/// A file that is read or named twice, whatever `existing` says; one that exists, if it is to be kept; a folder that is not
/// there or in which nothing can be written.
pub fn check(writes: &[&Path], reads: &[&Path], existing: Existing) -> Result<(), FileError> {
    for (idx, path) in writes.iter().enumerate() {
        let path = path.to_path_buf();
        if reads.iter().any(|read| are_one(&path, read)) {
            return Err(FileError::IsRead { path });
        }
        if writes[..idx].iter().any(|other| are_one(&path, other)) {
            return Err(FileError::Twice { path });
        }
        refuse_existing(&path, existing)?;
        try_place(&path)?;
    }
    Ok(())
}

/// Can files be written into this folder, which is made if need be?
///
/// # Errors
/// The system refuses.
pub fn check_folder(path: &Path) -> Result<(), FileError> {
    let there = path.ancestors().find(|folder| folder.exists()).unwrap_or(Path::new("."));
    tempfile::tempfile_in(there).map(drop).map_err(|source| why(path, source))
}

fn refuse_existing(path: &Path, existing: Existing) -> Result<(), FileError> {
    // A link that leads to nothing is there, too.
    if existing == Existing::Keep && path.symlink_metadata().is_ok() {
        return Err(FileError::Exists { path: path.to_owned() });
    }
    Ok(())
}

/// Tries what writing the file will need, so that no work is done for nothing; a device is left alone.
fn try_place(path: &Path) -> Result<(), FileError> {
    if path.is_dir() {
        return Err(why(path, io::ErrorKind::IsADirectory.into()));
    }
    if is_device(path) { Ok(()) } else { file_beside(path).map(drop) }
}

/// Do two names lead to one file, through links too? Devices may be named as often as one likes.
pub fn are_one(a: &Path, b: &Path) -> bool {
    if a.exists() && !a.is_file() {
        return false;
    }
    let same_name = || match (whole_path(a), whole_path(b)) {
        (Some(a), Some(b)) => a == b,
        _ => a == b,
    };
    same_inode(a, b) || same_name()
}

/// The path without links and dots, also of a file that is not there yet.
fn whole_path(path: &Path) -> Option<PathBuf> {
    let target = target(path);
    let there = || target.canonicalize().ok();
    let beside = || Some(folder_of(&target).canonicalize().ok()?.join(target.file_name()?));
    there().or_else(beside)
}

/// Where a file of this name lies or would lie: what links lead to, also if it is not there.
fn target(path: &Path) -> PathBuf {
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(next) = target.read_link() else { break };
        target = folder_of(&target).join(next);
    }
    target
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(unix)]
fn same_inode(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let inode = |path: &Path| path.metadata().map(|data| (data.dev(), data.ino())).ok();
    inode(a).is_some_and(|of_a| inode(b) == Some(of_a))
}

#[cfg(not(unix))]
fn same_inode(_: &Path, _: &Path) -> bool {
    false
}

/// Writes a whole file or none.
///
/// # Errors
/// The file exists and is to be kept, or the system refuses; what was there stays.
pub fn write(path: &Path, content: impl AsRef<[u8]>, existing: Existing) -> Result<(), FileError> {
    let mut file = NewFile::whole(path, existing)?;
    file.write_all(content.as_ref()).map_err(|source| file.failed(source))?;
    file.finish()
}

/// A file that is being written.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    existing: Existing,
    place: Place,
}

#[derive(Debug)]
enum Place {
    /// Where it belongs.
    Itself(BufWriter<File>),
    /// Beside it, until it is complete.
    Beside(BufWriter<NamedTempFile>),
}

impl NewFile {
    /// A file that appears when it is complete; one that is not finished is taken away again.
    ///
    /// # Errors
    /// As [`write()`].
    pub fn whole(path: &Path, existing: Existing) -> Result<Self, FileError> {
        if is_device(path) {
            return Self::in_its_place(path, existing);
        }
        Self::beside(path, existing)
    }

    /// A file that is there from its first line on. One that replaces another grows beside it, as `NAME.XXXXXX.new`, and
    /// takes its place at the end; if it never comes to that, both are there.
    ///
    /// # Errors
    /// As [`write()`].
    pub fn growing(path: &Path, existing: Existing) -> Result<Self, FileError> {
        if existing != Existing::Overwrite || is_device(path) || !path.exists() {
            return Self::in_its_place(path, existing);
        }
        let mut file = Self::beside(path, existing)?;
        if let Place::Beside(beside) = &mut file.place {
            beside.get_mut().disable_cleanup(true);
        }
        Ok(file)
    }

    fn in_its_place(path: &Path, existing: Existing) -> Result<Self, FileError> {
        let mut options = OpenOptions::new();
        options.write(true);
        match existing {
            Existing::Keep | Existing::Number => options.create_new(true),
            Existing::Overwrite => options.create(true).truncate(true),
        };
        let opened = match existing {
            Existing::Number => open_numbered(&options, path),
            _ => options.open(path).map(|file| (path.to_owned(), file)),
        };
        let (path, file) = opened.map_err(|source| why(path, source))?;
        Ok(Self { path, existing, place: Place::Itself(BufWriter::new(file)) })
    }

    fn beside(path: &Path, existing: Existing) -> Result<Self, FileError> {
        refuse_existing(path, existing)?;
        Ok(Self { path: path.to_owned(), existing, place: Place::Beside(BufWriter::new(file_beside(path)?)) })
    }

    /// Hands everything to the disk and, if it is beside its place, puts it there.
    ///
    /// # Errors
    /// The system refuses (disk full), or another file has come into its place that is to be kept.
    pub fn finish(mut self) -> Result<(), FileError> {
        let path = self.path.clone();
        self.flush().map_err(|source| why(&path, source))?;
        match self.place {
            Place::Itself(file) if is_device(&path) => drop(file),
            Place::Itself(file) => file.get_ref().sync_all().map_err(|source| why(&path, source))?,
            Place::Beside(file) => {
                let file = file.into_inner().map_err(|error| why(&path, error.into_error()))?;
                file.as_file().sync_all().map_err(|source| why(&path, source))?;
                put(file, &path, self.existing).map_err(|source| why(&path, source))?;
            }
        }
        Ok(())
    }

    /// Hands everything to the disk and leaves an older file in its place; gives where the new one is.
    ///
    /// # Errors
    /// The system refuses (disk full).
    pub fn leave(mut self) -> Result<PathBuf, FileError> {
        let path = self.lies_at().to_owned();
        self.flush().map_err(|source| why(&path, source))?;
        match self.place {
            Place::Itself(_) => self.finish()?,
            Place::Beside(file) => {
                let file = file.into_inner().map_err(|error| why(&path, error.into_error()))?;
                file.as_file().sync_all().map_err(|source| why(&path, source))?;
                file.keep().map_err(|error| why(&path, error.error))?;
            }
        }
        Ok(path)
    }

    /// Takes away what was made, and nothing else: an older file stays, and so does a device.
    pub fn discard(self) {
        match self.place {
            Place::Itself(_) if is_device(&self.path) => {}
            // What can't be taken away does no harm.
            Place::Itself(_) => drop(std::fs::remove_file(target(&self.path))),
            Place::Beside(file) => drop(file.into_parts().0.close()),
        }
    }

    /// Where it belongs.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where it is now: in its place, or beside it.
    pub fn lies_at(&self) -> &Path {
        match &self.place {
            Place::Itself(_) => &self.path,
            Place::Beside(file) => file.get_ref().path(),
        }
    }

    /// An error of the system with the file's name.
    pub fn failed(&self, source: io::Error) -> FileError {
        why(&self.path, source)
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.place {
            Place::Itself(file) => file.write(bytes),
            Place::Beside(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.place {
            Place::Itself(file) => file.flush(),
            Place::Beside(file) => file.flush(),
        }
    }
}

/// Opens the first of `NAME`, `NAME-2`, `NAME-3`, … that no file has.
fn open_numbered(options: &OpenOptions, path: &Path) -> io::Result<(PathBuf, File)> {
    let (mut free, mut number) = (path.to_owned(), 1);
    loop {
        match options.open(&free) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
            opened => return opened.map(|file| (free, file)),
        }
        free = numbered(path, number);
    }
}

fn numbered(path: &Path, number: u32) -> PathBuf {
    let ending = path.extension().map_or(String::new(), |ending| format!(".{}", ending.display()));
    path.with_file_name(format!("{}-{number}{ending}", path.file_stem().unwrap_or_default().display()))
}

/// An empty file beside the place of another; taken away again when it is dropped.
fn file_beside(path: &Path) -> Result<NamedTempFile, FileError> {
    // A link stays a link: what it leads to is replaced.
    let target = target(path);
    let folder = folder_of(&target);
    let mut name = target.file_name().unwrap_or_default().to_owned();
    name.push(".");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&name).suffix(".new");
    set_permissions(&mut builder, &target);
    builder.tempfile_in(folder).map_err(|source| why(path, source))
}

/// A device or a pipe takes the text as it comes; a rename would put a file in its place.
fn is_device(path: &Path) -> bool {
    path.exists() && !path.is_file()
}

fn put(file: NamedTempFile, path: &Path, existing: Existing) -> io::Result<()> {
    let target = target(path);
    if existing == Existing::Overwrite {
        return file.persist(target).map(drop).map_err(|error| error.error);
    }
    match file.persist_noclobber(&target) {
        Ok(_) => Ok(()),
        Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists || target.exists() => Err(error.error),
        // Memory sticks know neither links nor a rename that refuses.
        Err(error) => error.file.persist(target).map(drop).map_err(|error| error.error),
    }
}

/// A new file may be read by whom the system usually allows, a replaced one by whom it could be read before.
#[cfg(unix)]
fn set_permissions(builder: &mut tempfile::Builder, target: &Path) {
    use std::os::unix::fs::PermissionsExt;
    let usual = || std::fs::Permissions::from_mode(0o666);
    builder.permissions(target.metadata().map_or_else(|_| usual(), |data| data.permissions()));
}

#[cfg(not(unix))]
fn set_permissions(_: &mut tempfile::Builder, _: &Path) {}

fn why(path: &Path, source: io::Error) -> FileError {
    let path = path.to_owned();
    match source.kind() {
        io::ErrorKind::AlreadyExists => FileError::Exists { path },
        _ => FileError::Io { path, source: without_path(source) },
    }
}

/// The reason alone: the library that makes files beside their places names those, which nobody asked for.
fn without_path(source: io::Error) -> io::Error {
    let text = source.to_string();
    match text.split_once(" at path ") {
        Some((reason, _)) => io::Error::new(source.kind(), reason.to_owned()),
        None => source,
    }
}

#[cfg(test)]
mod tests;
