//! Both boards fit with room to spare: flash and static RAM of the images, built as they are flashed.

use object::{Object, ObjectSection, SectionFlags, SectionKind, elf};
use tests::image::{Board, firmware};

/// KB of a chip with 1024 (Feather) or 512 (Nucleo); what stays below also leaves the store's sectors alone.
const MOST_FLASH: u64 = 160 * 1024;

/// Of 128 KB; the rest is stack.
const MOST_RAM: u64 = 96 * 1024;

const RAM_BEGINS: u64 = 0x2000_0000;

/// Flash and RAM that are taken before the program runs.
fn sizes(image: &[u8]) -> (u64, u64) {
    let file = object::File::parse(image).unwrap();
    let (mut flash, mut ram) = (0, 0);
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
        if sh_flags & u64::from(elf::SHF_ALLOC) == 0 {
            continue;
        }
        let in_ram = section.address() >= RAM_BEGINS;
        let has_content = !matches!(section.kind(), SectionKind::UninitializedData) && section.name() != Ok(".uninit");
        ram += if in_ram { section.size() } else { 0 };
        flash += if has_content { section.size() } else { 0 };
    }
    (flash, ram)
}

#[test]
fn both_boards_fit() {
    for board in [Board::FeatherF405, Board::NucleoF446] {
        let (flash, ram) = sizes(&std::fs::read(firmware(board).unwrap()).unwrap());
        println!("{}: {flash} bytes of flash, {ram} of static RAM", board.feature());
        assert!(flash > 0 && flash <= MOST_FLASH, "{}: {flash} bytes of flash", board.feature());
        assert!(ram > 0 && ram <= MOST_RAM, "{}: {ram} bytes of RAM", board.feature());
    }
}
