//! The parameter store: one value in sequential-storage over a few sectors of flash.
//!
//! A write that is cut short by a power failure leaves the old value or the new one, never a mixture. The library
//! guards each item with a check sum; [`Stored`] adds its own version, so that content of another firmware is
//! recognised and refused instead of misread.

use core::ops::Range;
use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};
use shared::rig::{MAX_STORED, Stored};
use shared::wire::{Refusal, StoreState};

/// The only key there is.
const KEY: u8 = 1;

/// Scratch space: the longest value, its key, and the library's alignment to flash words.
const SCRATCH: usize = MAX_STORED + 32;

type Map<F> = MapStorage<u8, F, Cache<Uncached, Uncached, Uncached, u8>>;

/// The store on some flash.
pub struct Store<F: NorFlash> {
    map: Map<F>,
}

impl<F: NorFlash> Store<F> {
    /// On the bytes `range` of `flash`: whole sectors, at least two.
    pub fn new(flash: F, range: Range<u32>) -> Self {
        Self { map: MapStorage::new(flash, MapConfig::new(range), Cache::new_uncached()) }
    }

    /// What was saved last, or why there is nothing to use.
    pub async fn load(&mut self) -> Result<Stored, StoreState> {
        let mut scratch = [0; SCRATCH];
        match self.map.fetch_item::<&[u8]>(&mut scratch, &KEY).await {
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
            self.map.erase_all().await.map_err(|_| Refusal::Flash)?;
            self.write(bytes).await?;
        }
        let mut scratch = [0; SCRATCH];
        match self.map.fetch_item::<&[u8]>(&mut scratch, &KEY).await {
            Ok(Some(read)) if read == bytes => Ok(()),
            _ => Err(Refusal::Flash),
        }
    }

    async fn write(&mut self, bytes: &[u8]) -> Result<(), Refusal> {
        let mut scratch = [0; SCRATCH];
        self.map.store_item(&mut scratch, &KEY, &bytes).await.map_err(|_| Refusal::Flash)
    }
}
