//! Flash that lets the other tasks run: one sector is erased at a time, and long reads and writes pause.
//!
//! The storage library scans whole sectors without ever waiting. Erasing stops the processor of an STM32F4 anyway, but
//! between two sectors, and within a scan, samples have to be taken and the watchdog has to be fed.

use core::marker::PhantomData;
use embassy_futures::yield_now;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// Between two pauses the library checks what it reads bit by bit, 40 instructions a byte at most: 5 ms at four cycles
/// an instruction. Half of it would cost a save 2 % more time, twice as much a fifth of the converter's ring.
const READ_AT_ONCE: usize = 4096;

/// 16 words, at most 100 µs each by the data sheet.
const WRITTEN_AT_ONCE: usize = 64;

/// Every read costs at least as much as so many bytes, however short it is.
const LEAST_READ: usize = 64;

/// What happens after an erase, before the next one may begin.
pub trait Pause {
    /// Waits until samples come again.
    async fn pause();
}

/// Nothing else is going on.
pub struct NoPause;

impl Pause for NoPause {
    async fn pause() {}
}

/// Flash with pauses.
pub(crate) struct PatientFlash<F, P> {
    flash: F,
    since_pause: usize,
    pause: PhantomData<P>,
}

impl<F, P> PatientFlash<F, P> {
    /// Around this flash.
    pub(crate) const fn new(flash: F) -> Self {
        Self { flash, since_pause: 0, pause: PhantomData }
    }
}

impl<F: ErrorType, P> ErrorType for PatientFlash<F, P> {
    type Error = F::Error;
}

impl<F: ReadNorFlash, P> ReadNorFlash for PatientFlash<F, P> {
    const READ_SIZE: usize = F::READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), F::Error> {
        self.since_pause += bytes.len().max(LEAST_READ);
        if self.since_pause >= READ_AT_ONCE {
            self.since_pause = 0;
            yield_now().await;
        }
        self.flash.read(offset, bytes).await
    }

    fn capacity(&self) -> usize {
        self.flash.capacity()
    }
}

impl<F: NorFlash, P: Pause> NorFlash for PatientFlash<F, P> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), F::Error> {
        for sector in (from..to).step_by(F::ERASE_SIZE) {
            self.flash.erase(sector, to.min(sector + F::ERASE_SIZE as u32)).await?;
            P::pause().await;
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), F::Error> {
        for (i, part) in bytes.chunks(WRITTEN_AT_ONCE).enumerate() {
            self.flash.write(offset + (i * WRITTEN_AT_ONCE) as u32, part).await?;
            yield_now().await;
        }
        Ok(())
    }
}
