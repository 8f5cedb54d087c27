//! The parameter store: one value in sequential-storage over a few sectors of flash.
//!
//! A write that is cut short by a power failure leaves the old value or the new one, never a mixture. The library
//! guards each item with a check sum; [`Stored`] adds its own version, so that content of another firmware is
//! recognised and refused instead of misread.

use crate::patient_flash::PatientFlash;
pub use crate::patient_flash::{NoPause, Pause};
use core::ops::Range;
use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::cache::Cache;
use sequential_storage::cache::key_pointers::ArrayKeyPointers;
use sequential_storage::cache::page_pointers::ArrayPagePointers;
use sequential_storage::cache::page_states::ArrayPageStates;
use sequential_storage::map::{MapConfig, MapStorage};
use shared::rig::{MAX_STORED, Stored};
use shared::wire::{Refusal, StoreState};

/// The only key there is.
const KEY: u8 = 1;

/// Scratch space: the longest value, its key, and the library's alignment to flash words.
const SCRATCH: usize = MAX_STORED + 32;

/// Sectors that the store may have.
const SECTORS: usize = 3;

/// What the library remembers of the flash. Without it, a save that moves on to the next sector reads all sectors once
/// for every item in the oldest one, which takes a chip seconds.
type Memory = Cache<ArrayPageStates<SECTORS>, ArrayPagePointers<SECTORS>, ArrayKeyPointers<u8, 1>, u8>;

type Map<'s, F, P> = MapStorage<u8, &'s mut PatientFlash<F, P>, Memory>;

/// The store on some flash, which waits as `P` says after each erase.
pub struct Store<F: NorFlash, P: Pause = NoPause> {
    flash: PatientFlash<F, P>,
    range: Range<u32>,
    memory: Memory,
}

impl<F: NorFlash> Store<F> {
    /// On the bytes `range` of `flash`: two or three whole sectors.
    pub fn new(flash: F, range: Range<u32>) -> Self {
        Self::pausing(flash, range)
    }
}

impl<F: NorFlash, P: Pause> Store<F, P> {
    /// As [`Store::new`], with pauses.
    pub fn pausing(flash: F, range: Range<u32>) -> Self {
        assert!(range.len() <= SECTORS * F::ERASE_SIZE, "the store remembers {SECTORS} sectors");
        Self { flash: PatientFlash::new(flash), range, memory: no_memory() }
    }

    /// What was saved last, or why there is nothing to use.
    pub async fn load(&mut self) -> Result<Stored, StoreState> {
        let mut scratch = [0; SCRATCH];
        match self.read(&mut scratch).await {
            Ok(Some(bytes)) => Stored::decode(bytes),
            Ok(None) => Err(StoreState::Empty),
            Err(_) => Err(StoreState::Damaged),
        }
    }

    /// Saves, and reads back to be sure. Flash that holds something foreign is erased first.
    pub async fn save(&mut self, stored: &Stored) -> Result<(), Refusal> {
        let mut buffer = [0; MAX_STORED];
        let bytes = stored.encode(&mut buffer).ok_or(Refusal::Flash)?;
        if self.write(bytes).await.is_err() {
            self.erase().await?;
            self.write(bytes).await?;
        }
        let mut scratch = [0; SCRATCH];
        match self.read(&mut scratch).await {
            Ok(Some(read)) if read == bytes => Ok(()),
            _ => Err(Refusal::Flash),
        }
    }

    async fn read<'b>(&mut self, scratch: &'b mut [u8]) -> Result<Option<&'b [u8]>, Refusal> {
        let mut map = self.open();
        let bytes = map.fetch_item(scratch, &KEY).await.map_err(|_| Refusal::Flash);
        self.memory = map.destroy().1;
        bytes
    }

    async fn write(&mut self, bytes: &[u8]) -> Result<(), Refusal> {
        let mut scratch = [0; SCRATCH];
        let mut map = self.open();
        map.store_item(&mut scratch, &KEY, &bytes).await.map_err(|_| Refusal::Flash)?;
        self.memory = map.destroy().1;
        Ok(())
    }

    async fn erase(&mut self) -> Result<(), Refusal> {
        self.open().erase_all().await.map_err(|_| Refusal::Flash)
    }

    /// Takes the memory out: what fails, or is given up half-way, leaves none behind.
    fn open(&mut self) -> Map<'_, F, P> {
        let memory = core::mem::replace(&mut self.memory, no_memory());
        MapStorage::new(&mut self.flash, MapConfig::new(self.range.clone()), memory)
    }
}

fn no_memory() -> Memory {
    Cache::new(ArrayPageStates::new(), ArrayPagePointers::new(), ArrayKeyPointers::new())
}
