//! Flash made of SRAM: three sectors like the chip's, but of 4 KB, because a look at releases needs the RAM;
//! kept over a restart, erased when power comes on.
#![allow(unsafe_code, reason = "memory that survives a restart is outside the language")]

use core::convert::Infallible;
use core::mem::MaybeUninit;
use core::ptr::addr_of_mut;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// Sectors 1–3 of the chip.
pub const SIZE: usize = 3 * SECTOR;

const SECTOR: usize = 4 * 1024;
const ERASED: u8 = 0xff;
const MAGIC: u32 = 0x0f1a_5c0d;

#[repr(C, align(4))]
struct Memory {
    bytes: [u8; SIZE],
    magic: u32,
}

#[unsafe(link_section = ".uninit.flash")]
static mut MEMORY: MaybeUninit<Memory> = MaybeUninit::uninit();

/// The one owner of the memory.
pub struct RamFlash(&'static mut Memory);

impl RamFlash {
    /// Call it once.
    pub fn new() -> Self {
        // SAFETY: any bits are a valid `Memory`, and this is the only reference to it.
        let memory = unsafe { &mut *addr_of_mut!(MEMORY).cast::<Memory>() };
        if memory.magic != MAGIC {
            memory.bytes.fill(ERASED);
            memory.magic = MAGIC;
        }
        Self(memory)
    }
}

impl ErrorType for RamFlash {
    type Error = Infallible;
}

impl ReadNorFlash for RamFlash {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
        bytes.copy_from_slice(&self.0.bytes[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl NorFlash for RamFlash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Infallible> {
        self.0.bytes[from as usize..to as usize].fill(ERASED);
        Ok(())
    }

    /// Like the chip: bits can only be cleared.
    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Infallible> {
        self.0.bytes[offset as usize..].iter_mut().zip(bytes).for_each(|(old, new)| *old &= new);
        Ok(())
    }
}
