//! A new firmware image onto a board.
//!
//! In: a rig, and an image of the release. The image is checked first: for which board, which version, and that it
//! leaves the store alone. Then other programs do the work: dfu-util over USB through the chip's own bootloader, or
//! probe-rs through a debug probe.

use crate::error::Failure;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// How an image gets onto the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// The chip's bootloader, over the rig's own USB.
    Usb,
    /// A debug probe; on a Nucleo it is on the board.
    Probe {
        /// As probe-rs calls it.
        chip: &'static str,
    },
}

/// A board as a rig names it, and how it is updated.
const BOARDS: [(&str, Way); 2] = [("feather-f405", Way::Usb), ("nucleo-f446", Way::Probe { chip: "STM32F446RETx" })];

/// Before the version in every image, and between it and the board.
const IDENTITY: &str = "pendulum-rig firmware ";
const FOR: &str = " for ";
const END: char = ';';

/// Where the saved model and calibration lie.
const STORE: std::ops::Range<u32> = 0x0800_4000..0x0801_0000;

/// ST's bootloader on USB.
const BOOTLOADER: &str = "0483:df11";

impl Way {
    /// For the board that a rig says it is.
    ///
    /// # Errors
    /// There is no firmware of ours for it.
    pub fn of(board: &str) -> Result<Self, Failure> {
        let known = BOARDS.iter().find(|(name, _)| *name == board);
        known.map(|(_, way)| *way).ok_or_else(|| {
            Failure::failed(format!("a rig of the kind {board} cannot be updated by this program"))
                .next("it can update feather-f405 and nucleo-f446; flash another board with its own tools")
        })
    }

    /// The program that does it.
    pub fn tool(self) -> &'static str {
        match self {
            Self::Usb => "dfu-util",
            Self::Probe { .. } => "probe-rs",
        }
    }

    fn suffix(self) -> &'static str {
        match self {
            Self::Usb => "dfu",
            Self::Probe { .. } => "elf",
        }
    }

    /// Is its program installed?
    ///
    /// # Errors
    /// It is not; with how to get it.
    pub fn check_tool(self) -> Result<(), Failure> {
        let answer = Command::new(self.tool()).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        if answer.is_ok_and(|status| status.success()) {
            return Ok(());
        }
        let install = match self {
            Self::Usb => "install it (apt-get install dfu-util, brew install dfu-util, or dfu-util.sourceforge.net)",
            Self::Probe { .. } => "install it from https://probe.rs",
        };
        Err(Failure::failed(format!("{} is needed to update this board, and it is not installed", self.tool()))
            .next(format!("{install} and repeat the command; nothing was changed")))
    }

    /// What its program is told, call by call. `which` says which of several: the chip's serial number over USB, or the
    /// probe as probe-rs selects it.
    pub fn calls(self, image: &Path, which: Option<&str>) -> Vec<Vec<String>> {
        let image = image.display().to_string();
        match self {
            Self::Usb => {
                let chip = which.map_or(Vec::new(), |serial| vec!["--serial".to_owned(), format!(",{serial}")]);
                let device = ["--device", &format!(",{BOOTLOADER}"), "--alt", "0"].map(str::to_owned);
                let work = ["--dfuse-address", ":leave", "--download", &image].map(str::to_owned);
                vec![[device.to_vec(), chip, work.to_vec()].concat()]
            }
            // It leaves the processor halted.
            Self::Probe { chip } => {
                let of = which.map_or(Vec::new(), |probe| vec!["--probe", probe]);
                let call = |command: &[&str], last: &[&str]| {
                    [command, &["--chip", chip], &of, last].concat().into_iter().map(str::to_owned).collect()
                };
                vec![call(&["download"], &[&image]), call(&["reset"], &[])]
            }
        }
    }
}

/// An image that was read and checked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// The file.
    pub path: PathBuf,
    /// Its version, such as `0.1.0`.
    pub version: String,
}

impl Image {
    /// The image for `board` at `path`: the file, or the folder of a release with one in it.
    ///
    /// # Errors
    /// No such file, an image of another board, or one that would overwrite what is saved.
    pub fn read(path: &Path, board: &str, way: Way) -> Result<Self, Failure> {
        let path = if path.is_dir() { path.join(format!("{board}.{}", way.suffix())) } else { path.to_owned() };
        let shown = path.display();
        let wanted = format!("give the {board}.{} of a release, or the folder it lies in", way.suffix());
        let bytes = std::fs::read(&path)
            .map_err(|error| Failure::failed(format!("could not read {shown}: {error}")).next(&wanted))?;
        let Some((version, of)) = identity(&bytes) else {
            return Err(Failure::failed(format!("{shown} is no firmware of a pendulum rig")).next(&wanted));
        };
        if of != board {
            return Err(Failure::failed(format!("{shown} is for {of}, but the rig is {board}")).next(&wanted));
        }
        let fits = match way {
            Way::Usb => elements(&bytes).is_some_and(|parts| parts.iter().all(leaves_the_store_alone)),
            Way::Probe { .. } => bytes.starts_with(b"\x7fELF"),
        };
        if !fits {
            let what = format!("{shown} is no .{} file that leaves the saved model alone", way.suffix());
            return Err(Failure::failed(what).next(&wanted));
        }
        Ok(Self { path, version })
    }
}

/// Version and board that an image names.
fn identity(bytes: &[u8]) -> Option<(String, String)> {
    const LONGEST: usize = 64;
    let at = bytes.windows(IDENTITY.len()).position(|window| window == IDENTITY.as_bytes())? + IDENTITY.len();
    let rest = String::from_utf8_lossy(&bytes[at..bytes.len().min(at + LONGEST)]);
    let (version, board) = rest.split_once(END)?.0.split_once(FOR)?;
    Some((version.to_owned(), board.to_owned()))
}

/// Address and length of each element of a DfuSe file (ST's UM0391) with one target.
fn elements(bytes: &[u8]) -> Option<Vec<(u32, u32)>> {
    const TARGET: usize = 11;
    const FIRST: usize = TARGET + 274;
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    if !bytes.starts_with(b"DfuSe\x01") || bytes.get(TARGET..TARGET + 6)? != b"Target" {
        return None;
    }
    let mut at = FIRST;
    (0..word(FIRST - 4)?.min(64))
        .map(|_| {
            let (address, length) = (word(at)?, word(at + 4)?);
            at = at.checked_add(8)?.checked_add(length as usize)?;
            (at <= bytes.len()).then_some((address, length))
        })
        .collect()
}

fn leaves_the_store_alone(part: &(u32, u32)) -> bool {
    let end = part.0.saturating_add(part.1);
    end <= STORE.start || part.0 >= STORE.end
}

/// Serial numbers of the bootloaders on USB.
pub fn bootloaders() -> Vec<String> {
    let output = Command::new(Way::Usb.tool()).arg("--list").output();
    output.map_or(Vec::new(), |output| listed(&String::from_utf8_lossy(&output.stdout)))
}

/// The same of what `dfu-util --list` says: a line for each kind of memory of each chip.
fn listed(list: &str) -> Vec<String> {
    let of_chip = list.lines().filter(|line| line.starts_with("Found DFU") && line.contains(BOOTLOADER));
    let mut serials: Vec<String> =
        of_chip.filter_map(|line| Some(line.split_once("serial=\"")?.1.split_once('"')?.0.to_owned())).collect();
    serials.sort();
    serials.dedup();
    serials
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dfuse(parts: &[(u32, &[u8])]) -> Vec<u8> {
        let mut file = b"DfuSe\x01....\x01Target".to_vec();
        file.resize(11 + 270, 0);
        file.extend((parts.len() as u32).to_le_bytes());
        for (address, data) in parts {
            file.extend(address.to_le_bytes());
            file.extend((data.len() as u32).to_le_bytes());
            file.extend_from_slice(data);
        }
        file
    }

    /// What reading this file as the Feather's image gives.
    fn read(bytes: &[u8]) -> Result<String, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("feather-f405.dfu"), bytes).unwrap();
        let image = Image::read(folder.path(), "feather-f405", Way::Usb);
        image.map(|image| image.version).map_err(|failure| failure.what().to_owned())
    }

    #[test]
    fn an_image_is_known_by_its_board_and_by_what_it_leaves_alone() {
        let code = b"..pendulum-rig firmware 1.2.3 for feather-f405;..";
        let vectors = (0x0800_0000, &[1_u8; 400][..]);
        assert_eq!(read(&dfuse(&[vectors, (0x0801_0000, code)])), Ok("1.2.3".to_owned()));
        let flat = [&[0; 0x1_0000][..], code].concat();
        let refused = [
            (dfuse(&[(0x0800_0000, &flat)]), "leaves the saved model alone"),
            (dfuse(&[vectors, (0x0800_ffff, code)]), "leaves the saved model alone"),
            (dfuse(&[vectors, (0x0801_0000, b"pendulum-rig firmware 1.2.3 for nucleo-f446;")]), "is for nucleo-f446"),
            (dfuse(&[vectors]), "is no firmware"),
            (flat, "leaves the saved model alone"),
            (Vec::new(), "is no firmware"),
        ];
        for (bytes, reason) in refused {
            let said = read(&bytes).unwrap_err();
            assert!(said.contains(reason), "{said}");
        }
    }

    #[test]
    fn of_several_probes_one_is_named_in_every_call() {
        let way = Way::of("nucleo-f446").unwrap();
        let calls =
            |probe| way.calls(Path::new("new.elf"), probe).iter().map(|call| call.join(" ")).collect::<Vec<_>>();
        assert_eq!(calls(None), ["download --chip STM32F446RETx new.elf", "reset --chip STM32F446RETx"]);
        let named = "--chip STM32F446RETx --probe 0483:374b:066AFF2";
        assert_eq!(calls(Some("0483:374b:066AFF2")), [format!("download {named} new.elf"), format!("reset {named}")]);
    }

    #[test]
    fn the_bootloaders_on_usb_are_told_apart() {
        let line = |serial: &str, alt: u8| {
            format!(
                "Found DFU: [0483:df11] ver=2200, devnum=9, cfg=1, intf=0, path=\"1-2\", alt={alt}, \
                 name=\"@Internal Flash  /0x08000000/04*016Kg,01*064Kg,07*128Kg\", serial=\"{serial}\"\n"
            )
        };
        let other = "Found Runtime: [1209:0001] ver=0010, serial=\"1\"\n";
        let list = [line("B", 0), line("B", 1), line("A", 0), other.to_owned()].concat();
        assert_eq!(listed(&list), ["A", "B"]);
        assert!(listed("dfu-util 0.11\n").is_empty());
    }
}
