//! The store's sectors of the flash, erased and written as fast as the supply allows (RM0090 3.6, RM0390 3.5).
//!
//! Nothing rests on the flash's interrupt, which says no more than its status does: an error or an end that is missed,
//! or said twice, must not hold up the rig. While the flash works, the processor stands still where it needs its next
//! instruction from there; where it does not, everything else goes on.
#![allow(unsafe_code, reason = "flash is memory that the language knows nothing of")]

use core::slice::from_raw_parts;
use embassy_futures::yield_now;
use embassy_stm32::pac::flash::regs::{Cr, Sr};
use embassy_stm32::pac::flash::vals::Psize;
use embassy_stm32::pac::{FLASH, PWR};
use embassy_stm32::{Peri, peripherals};
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};

/// The store: sectors 1 to 3 of 16 KB, as memory.x leaves them free.
pub const STORE: core::ops::Range<u32> = 0x4000..0x1_0000;

const SECTOR: usize = 0x4000;

/// Where the flash is.
const BASE: usize = 0x0800_0000;

/// What is programmed at once.
const WORD: usize = 4;

/// The supply's detector at its highest level, 2.9 V (PLS): erasing by words wants 2.7 V.
const LOWEST_SUPPLY: u8 = 7;

/// What unlocks the flash's control register (RM0090, 3.6.1).
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// The first sectors of the flash, each of 16 KB.
pub struct Sectors {
    _flash: Peri<'static, peripherals::FLASH>,
}

impl Sectors {
    /// Of this flash.
    pub fn new(flash: Peri<'static, peripherals::FLASH>) -> Self {
        PWR.cr1().modify(|w| {
            w.set_pls(LOWEST_SUPPLY);
            w.set_pvde(true);
        });
        Self { _flash: flash }
    }
}

/// Is there voltage enough to write to the flash?
pub fn supply_is_good() -> bool {
    !PWR.csr1().read().pvdo()
}

impl ErrorType for Sectors {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Sectors {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        let from = place(offset, bytes.len(), Self::READ_SIZE)?;
        // SAFETY: within the flash, which only `self` changes.
        bytes.copy_from_slice(unsafe { from_raw_parts(from as *const u8, bytes.len()) });
        Ok(())
    }

    fn capacity(&self) -> usize {
        STORE.end as usize
    }
}

impl NorFlash for Sectors {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    /// By words: 250 ms a sector and at most 500; by bytes, as the chip starts, 400 and 800 (data sheet).
    async fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        place(from, (to - from) as usize, SECTOR)?;
        for sector in from as usize / SECTOR..to as usize / SECTOR {
            let work = Work::begin(|w| {
                w.set_ser(true);
                w.set_snb(sector as u8);
            })?;
            FLASH.cr().modify(|w| w.set_strt(true));
            let outcome = work.end().await;
            forget_data();
            outcome?;
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        let to = place(offset, bytes.len(), WORD)?;
        for (i, word) in bytes.as_chunks::<WORD>().0.iter().enumerate() {
            let work = Work::begin(|w| w.set_pg(true))?;
            // SAFETY: an aligned word of the store, of which nobody holds a reference.
            unsafe { (to as *mut u32).add(i).write_volatile(u32::from_le_bytes(*word)) }
            work.end().await?;
        }
        Ok(())
    }
}

/// The address of so many bytes, in whole units, of the store.
fn place(offset: u32, length: usize, unit: usize) -> Result<usize, NorFlashErrorKind> {
    let (begin, end) = (offset as usize, offset as usize + length);
    if begin < STORE.start as usize || end > STORE.end as usize {
        Err(NorFlashErrorKind::OutOfBounds)
    } else if begin % unit != 0 || end % unit != 0 {
        Err(NorFlashErrorKind::NotAligned)
    } else {
        Ok(BASE + begin)
    }
}

/// The flash while it is being changed; locked whenever it is not.
struct Work;

impl Work {
    /// Unlocked for this; errors of before are forgotten. A save may erase three times, so that the supply is looked at before
    /// each.
    fn begin(what: impl FnOnce(&mut Cr)) -> Result<Self, NorFlashErrorKind> {
        if !supply_is_good() {
            return Err(NorFlashErrorKind::Other);
        }
        if FLASH.cr().read().lock() {
            KEYS.iter().for_each(|key| FLASH.keyr().write_value(*key));
        }
        // Ones clear.
        FLASH.sr().write_value(Sr(u32::MAX));
        FLASH.cr().write(|w| {
            w.set_psize(Psize::PSIZE32);
            what(w);
        });
        Ok(Self)
    }

    /// Looks until it is done.
    async fn end(self) -> Result<(), NorFlashErrorKind> {
        cortex_m::asm::dsb();
        while FLASH.sr().read().bsy() {
            yield_now().await;
        }
        let found = FLASH.sr().read();
        if found.operr() || found.wrperr() || found.pgaerr() || found.pgperr() || found.pgserr() {
            return Err(NorFlashErrorKind::Other);
        }
        Ok(())
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        FLASH.cr().write(|w| w.set_lock(true));
    }
}

/// The data cache keeps what it had of an erased sector (RM0090, 3.5.3); it can be emptied while it is off.
fn forget_data() {
    FLASH.acr().modify(|w| w.set_dcen(false));
    FLASH.acr().modify(|w| w.set_dcrst(true));
    FLASH.acr().modify(|w| w.set_dcrst(false));
    FLASH.acr().modify(|w| w.set_dcen(true));
}
