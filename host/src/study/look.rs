//! What a file looks like from outside: who finds it as it was need not read it to know that its hash is the same.
//!
//! Size and time of the last change; where the system has it also the time at which anything of the file changed, which
//! no program can set back. A file that was changed just now may be changed once more within one tick of the clock and
//! look the same (as in Git's index, Documentation/technical/racy-git), so that it has no look yet.

use std::fs::Metadata;
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// The longest tick of a file system's clock: FAT's. With half a file on FAT could change unseen, twice only makes a
/// study that is run again within seconds read some files more.
const TICK: Duration = Duration::from_secs(2);

/// A look, as it is compared and stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Look(pub(super) String);

impl Look {
    /// At a file, before it is read; `None` if it was changed just now, or can't be looked at.
    pub fn at(path: &Path) -> Option<Self> {
        let metadata = path.metadata().ok()?;
        let changed = metadata.modified().ok()?;
        is_settled(changed, SystemTime::now()).then_some(())?;
        let nanoseconds = changed.duration_since(UNIX_EPOCH).ok()?.as_nanos();
        Some(Self(format!("{} {nanoseconds} {}", metadata.len(), anything_changed(&metadata))))
    }
}

/// Also not where the file's clock is ahead of ours.
fn is_settled(changed: SystemTime, now: SystemTime) -> bool {
    now.duration_since(changed).is_ok_and(|ago| ago > TICK)
}

#[cfg(unix)]
fn anything_changed(metadata: &Metadata) -> String {
    use std::os::unix::fs::MetadataExt;
    format!("{}.{:09}", metadata.ctime(), metadata.ctime_nsec())
}

#[cfg(not(unix))]
fn anything_changed(_: &Metadata) -> String {
    String::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_changed_just_now_or_in_the_future_has_no_look_yet() {
        let changed = UNIX_EPOCH + Duration::from_secs(1_000_000);
        for (seconds_later, is_known) in [(0, false), (2, false), (3, true), (86_400, true)] {
            assert_eq!(is_settled(changed, changed + Duration::from_secs(seconds_later)), is_known, "{seconds_later}");
        }
        assert!(!is_settled(changed + Duration::from_secs(60), changed));
    }
}
