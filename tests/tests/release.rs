//! The archives that are given away: complete, the program runs, and the .hex of a board is its .elf.
#![cfg(target_os = "linux")]

use object::{Object, ObjectSegment};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use tests::image::workspace;
use tests::program;

const BOARDS: [&str; 2] = ["feather-f405", "nucleo-f446"];

/// A command that must succeed; what it said.
fn said(command: &mut Command) -> String {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Makes the archives in a folder and unpacks them there.
fn unpacked(folder: &Path) -> Vec<PathBuf> {
    let script = workspace().join("tests/release");
    said(Command::new(script).arg(folder).env("HOST_PROGRAM", program::path()).env("CARGO_TARGET_DIR", target()));
    said(Command::new("sha256sum").args(["--check", "SHA256SUMS"]).current_dir(folder));
    said(
        Command::new("bash").args(["-euc", "for archive in *.tar.gz; do tar -xzf $archive; done"]).current_dir(folder),
    );
    let all = std::fs::read_dir(folder).unwrap().flatten().map(|entry| entry.path());
    all.filter(|path| path.is_dir()).collect()
}

/// Where the other tests build their images.
fn target() -> PathBuf {
    workspace().join("target")
}

/// Bytes by address of an image as a debugger loads it.
fn of_elf(path: &Path) -> BTreeMap<u64, u8> {
    let bytes = std::fs::read(path).unwrap();
    let file = object::read::elf::ElfFile32::<object::Endianness>::parse(&*bytes).unwrap();
    let mut image = BTreeMap::new();
    for segment in file.segments() {
        let header = segment.elf_program_header();
        let loaded_at = u64::from(header.p_paddr.get(file.endian()));
        for (offset, byte) in segment.data().unwrap().iter().enumerate() {
            image.insert(loaded_at + offset as u64, *byte);
        }
    }
    assert_eq!(file.architecture(), object::Architecture::Arm);
    image
}

/// The same of Intel HEX: length, address, kind, data, and a check sum that makes every line's sum zero.
fn of_hex(path: &Path) -> BTreeMap<u64, u8> {
    let mut image = BTreeMap::new();
    let mut upper = 0;
    for line in std::fs::read_to_string(path).unwrap().lines() {
        let digits = line.strip_prefix(':').unwrap();
        let bytes: Vec<u8> =
            (0..digits.len()).step_by(2).map(|at| u8::from_str_radix(&digits[at..at + 2], 16).unwrap()).collect();
        assert_eq!(bytes.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte)), 0, "{line}");
        let (address, data) = (u64::from(bytes[1]) << 8 | u64::from(bytes[2]), &bytes[4..bytes.len() - 1]);
        match bytes[3] {
            0 => image.extend(data.iter().zip(upper + address..).map(|(byte, address)| (address, *byte))),
            4 => upper = (u64::from(data[0]) << 8 | u64::from(data[1])) << 16,
            1 | 5 => {}
            kind => panic!("a record of kind {kind}: {line}"),
        }
    }
    image
}

/// Sectors 1 to 3, which hold what a user has saved.
const STORE: std::ops::Range<u64> = 0x0800_4000..0x0801_0000;

/// The same of DfuSe (ST's UM0391): prefix, one target of elements, suffix with a check sum. Gaps are filled as erased.
fn of_dfuse(path: &Path) -> BTreeMap<u64, u8> {
    let bytes = std::fs::read(path).unwrap();
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let end = bytes.len() - 16;
    assert_eq!((&bytes[..6], word(6) as usize, bytes[10]), (&b"DfuSe\x01"[..], end, 1));
    assert_eq!((&bytes[11..17], word(277) as usize, word(281)), (&b"Target"[..], end - 285, 2));
    assert_eq!(&bytes[end + 2..end + 12], b"\x11\xdf\x83\x04\x1a\x01UFD\x10");
    let crc = bytes[..end + 12].iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| crc >> 1 ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 })
    });
    assert_eq!(word(end + 12), crc);
    let mut image = BTreeMap::new();
    let mut at = 285;
    while at < end {
        let (address, length) = (u64::from(word(at)), word(at + 4) as usize);
        assert!(address + length as u64 <= STORE.start || address >= STORE.end, "{address:#x}: {length} bytes");
        image.extend((address..).zip(bytes[at + 8..at + 8 + length].iter().copied()));
        at += 8 + length;
    }
    image
}

#[test]
fn the_archives_are_complete_and_work() {
    let folder = tempfile::tempdir().unwrap();
    let all = unpacked(folder.path());
    let named = |word: &str| all.iter().find(|path| path.to_str().unwrap().ends_with(word)).unwrap();
    let firmware = named("-firmware");
    let machine = all.iter().find(|path| *path != firmware).unwrap();

    let version = said(Command::new(machine.join("host")).arg("--version"));
    let name = machine.file_name().unwrap().to_str().unwrap();
    assert!(name.contains(version.trim().trim_start_matches("host ")), "{name}: {version}");
    for file in ["README.md", "LICENSE-MIT", "docs/SUMMARY.md", "man/man1/host-fit.1", "completions/host.bash"] {
        assert!(machine.join(file).is_file(), "{file} is missing");
    }
    for board in BOARDS {
        let elf = of_elf(&firmware.join(format!("{board}.elf")));
        assert!(elf.len() > 10_000 && *elf.keys().next().unwrap() == 0x0800_0000, "{board}: {} bytes", elf.len());
        assert!(elf == of_hex(&firmware.join(format!("{board}.hex"))), "{board}: .hex and .elf differ");
        let mut dfuse = of_dfuse(&firmware.join(format!("{board}.dfu")));
        dfuse.retain(|address, byte| elf.contains_key(address) || *byte != 0xff);
        assert!(elf == dfuse, "{board}: .dfu and .elf differ");
    }
}
