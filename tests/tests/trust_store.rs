//! Parameters in flash that wears out, and content of other versions: what is loaded was saved whole, or there is a
//! reason; and a save says whether it held.

use embassy_futures::block_on;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use firmware::store::Store;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};
use shared::parameters::Parameters;
use shared::rig::{MAX_STORED, Rig, Stored};
use shared::wire::{Refusal, StoreState};
use target_tests::noise::Noise;

const SECTOR: usize = 1024;
const SIZE: usize = 3 * SECTOR;
const WORD: usize = 4;

/// The key under which the firmware keeps its parameters.
const KEY: u8 = 1;

/// Flash of which some bits no longer change: stuck at what they were.
struct WornFlash {
    bytes: [u8; SIZE],
    stuck_high: [u8; SIZE],
    stuck_low: [u8; SIZE],
}

/// It never reports anything: worn flash does not.
#[derive(Debug)]
struct Never;

impl NorFlashError for Never {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl WornFlash {
    fn new() -> Self {
        Self { bytes: [0xff; SIZE], stuck_high: [0; SIZE], stuck_low: [0; SIZE] }
    }

    /// Some bits of a word get stuck, high or low.
    fn wear(&mut self, noise: &mut Noise) {
        let at = WORD * noise.below((SIZE / WORD) as u32) as usize;
        let stuck = if noise.below(2) == 0 { &mut self.stuck_high } else { &mut self.stuck_low };
        stuck[at + noise.below(WORD as u32) as usize] |= 1 << noise.below(8);
    }

    fn byte(&self, at: usize) -> u8 {
        (self.bytes[at] | self.stuck_high[at]) & !self.stuck_low[at]
    }
}

impl ErrorType for &mut WornFlash {
    type Error = Never;
}

impl ReadNorFlash for &mut WornFlash {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Never> {
        bytes.iter_mut().enumerate().for_each(|(i, byte)| *byte = self.byte(offset as usize + i));
        Ok(())
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl NorFlash for &mut WornFlash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Never> {
        self.bytes[from as usize..to as usize].fill(0xff);
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Never> {
        bytes.iter().enumerate().for_each(|(i, byte)| self.bytes[offset as usize + i] &= byte);
        Ok(())
    }
}

fn stored(i: u32) -> Stored {
    let mut parameters = Parameters::paper().map(|value| value as f32);
    parameters.pendulum.inertia_kg_m2 = 2e-3 + 1e-7 * i as f32;
    Stored { parameters, settings: *Rig::new("worn", 4095, Err(StoreState::Empty)).settings() }
}

fn store(flash: &mut WornFlash) -> Store<&mut WornFlash> {
    Store::new(flash, 0..SIZE as u32)
}

#[test]
fn worn_words_never_give_parameters_that_were_not_saved() {
    let (mut n_held, mut n_refused, mut n_lost) = (0, 0, 0);
    for seed in 0..300 {
        let mut noise = Noise::new(seed);
        let mut flash = WornFlash::new();
        let mut saved: Vec<Stored> = Vec::new();
        for i in 0..60 {
            if noise.below(3) == 0 {
                flash.wear(&mut noise);
            }
            let next = stored(1000 * seed + i);
            let outcome = block_on(store(&mut flash).save(&next));
            let left = block_on(store(&mut flash).load());
            match outcome {
                Ok(()) => {
                    assert_eq!(left.as_ref(), Ok(&next), "seed {seed}, save {i}");
                    n_held += 1;
                }
                Err(reason) => {
                    assert_eq!(reason, Refusal::Flash);
                    n_refused += 1;
                }
            }
            saved.push(next);
            // A word may wear out under what was saved well.
            flash.wear(&mut noise);
            match block_on(store(&mut flash).load()) {
                Ok(left) => assert!(saved.contains(&left), "seed {seed}: {left:?} after save {i}"),
                Err(reason) => {
                    assert!(matches!(reason, StoreState::Damaged | StoreState::Empty | StoreState::OtherVersion));
                    n_lost += 1;
                }
            }
        }
    }
    println!("{n_held} saves held, {n_refused} were refused, {n_lost} were unreadable afterwards; none was wrong");
    assert!(n_held > 1000 && n_refused > 100 && n_lost > 0);
}

/// Puts bytes into flash as the firmware does.
fn put(flash: &mut WornFlash, bytes: &[u8]) {
    let cache: Cache<Uncached, Uncached, Uncached, u8> = Cache::new_uncached();
    let mut map: MapStorage<u8, _, _> = MapStorage::new(flash, MapConfig::new(0..SIZE as u32), cache);
    let mut scratch = [0; MAX_STORED + 32];
    assert!(block_on(map.store_item(&mut scratch, &KEY, &bytes)).is_ok());
}

#[test]
fn content_of_an_older_and_of_a_newer_version_is_told_and_then_replaced() {
    let mut buffer = [0; MAX_STORED];
    let present = stored(1).encode(&mut buffer).unwrap().to_vec();
    for version in [0, present[0] + 1, present[0] + 100] {
        let mut flash = WornFlash::new();
        put(&mut flash, &present);
        assert_eq!(block_on(store(&mut flash).load()), Ok(stored(1)), "put as the firmware would");
        put(&mut flash, &[&[version], &present[1..]].concat());
        let loaded = block_on(store(&mut flash).load());
        assert_eq!(loaded, Err(StoreState::OtherVersion), "version {version}");
        // The rig goes on with its defaults and says why.
        let mut rig = Rig::new("other", 4095, loaded);
        assert_eq!(rig.health().store, StoreState::OtherVersion);
        assert_eq!(block_on(store(&mut flash).save(&stored(2))), Ok(()));
        assert_eq!(block_on(store(&mut flash).load()), Ok(stored(2)));
    }
}

#[test]
fn content_that_is_cut_or_has_more_behind_it_is_damaged() {
    let mut buffer = [0; MAX_STORED];
    let present = stored(1).encode(&mut buffer).unwrap().to_vec();
    let longer = [&present[..], &[0; 3]].concat();
    let cut = (0..present.len()).map(|length| &present[..length]);
    for content in cut.chain([longer.as_slice()]) {
        let mut flash = WornFlash::new();
        put(&mut flash, content);
        assert_eq!(block_on(store(&mut flash).load()), Err(StoreState::Damaged), "{} bytes", content.len());
    }
}

/// Filled to the last word with items of another program, which sequential-storage cannot give up.
fn full_flash() -> WornFlash {
    let mut flash = WornFlash::new();
    let cache: Cache<Uncached, Uncached, Uncached, u8> = Cache::new_uncached();
    let mut map: MapStorage<u8, _, _> = MapStorage::new(&mut flash, MapConfig::new(0..SIZE as u32), cache);
    let (mut scratch, item) = ([0; MAX_STORED + 32], [0xa5_u8; 100]);
    let keys = KEY + 1..=u8::MAX;
    let n_items = keys.take_while(|key| block_on(map.store_item(&mut scratch, key, &&item[..])).is_ok()).count();
    assert!((10..200).contains(&n_items), "{n_items} items fill the flash");
    flash
}

#[test]
fn flash_that_is_full_is_erased_for_what_is_saved() {
    let mut flash = full_flash();
    assert_eq!(block_on(store(&mut flash).load()), Err(StoreState::Empty));
    for i in 0..30 {
        assert_eq!(block_on(store(&mut flash).save(&stored(i))), Ok(()), "save {i}");
        assert_eq!(block_on(store(&mut flash).load()), Ok(stored(i)), "save {i}");
    }
}
