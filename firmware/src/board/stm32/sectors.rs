//! The store's sectors of the flash, erased and written as fast as the supply allows.

use embassy_stm32::flash::{Async, Bank1Region1, Error, Flash, InterruptHandler};
use embassy_stm32::interrupt::typelevel::{Binding, FLASH as FLASH_INTERRUPT};
use embassy_stm32::pac::flash::vals::Psize;
use embassy_stm32::pac::{FLASH, PWR};
use embassy_stm32::{Peri, peripherals};
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// The store: sectors 1 to 3 of 16 KB, as memory.x leaves them free.
pub const STORE: core::ops::Range<u32> = 0x4000..0x1_0000;

/// The supply's detector at its highest level, 2.9 V (PLS): erasing by words wants 2.7 V.
const LOWEST_SUPPLY: u8 = 7;

/// What unlocks the flash's control register (RM0090, 3.6.1).
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// The first sectors only: erased 16 KB at a time, while the whole flash counts as 128 KB.
pub struct Sectors(Bank1Region1<'static, Async>);

impl Sectors {
    /// Of this flash.
    pub fn new(
        flash: Peri<'static, peripherals::FLASH>,
        irq: impl Binding<FLASH_INTERRUPT, InterruptHandler> + 'static,
    ) -> Self {
        PWR.cr1().modify(|w| {
            w.set_pls(LOWEST_SUPPLY);
            w.set_pvde(true);
        });
        Self(Flash::new(flash, irq).into_regions().bank1_region1)
    }
}

/// Is there voltage enough to write to the flash?
pub fn supply_is_good() -> bool {
    !PWR.csr1().read().pvdo()
}

impl ErrorType for Sectors {
    type Error = Error;
}

impl ReadNorFlash for Sectors {
    const READ_SIZE: usize = <Bank1Region1<'static, Async> as ReadNorFlash>::READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Error> {
        self.0.read(offset, bytes).await
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for Sectors {
    const WRITE_SIZE: usize = <Bank1Region1<'static, Async> as NorFlash>::WRITE_SIZE;
    const ERASE_SIZE: usize = <Bank1Region1<'static, Async> as NorFlash>::ERASE_SIZE;

    /// By words: 250 ms a sector and at most 500; by bytes, as the chip starts, 400 and 800 (data sheet).
    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Error> {
        if FLASH.cr().read().lock() {
            KEYS.iter().for_each(|key| FLASH.keyr().write_value(*key));
        }
        FLASH.cr().modify(|w| w.set_psize(Psize::PSIZE32));
        let outcome = self.0.erase(from, to).await;
        forget_data();
        outcome
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Error> {
        self.0.write(offset, bytes).await
    }
}

/// The data cache keeps what it had of an erased sector (RM0090, 3.5.3); it can be emptied while it is off.
fn forget_data() {
    FLASH.acr().modify(|w| w.set_dcen(false));
    FLASH.acr().modify(|w| w.set_dcrst(true));
    FLASH.acr().modify(|w| w.set_dcrst(false));
    FLASH.acr().modify(|w| w.set_dcen(true));
}
