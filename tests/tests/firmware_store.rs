//! Saving in pieces: however long it takes, the other tasks come to their turn, and no two sectors are erased without
//! samples in between.

use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use firmware::store::{NoPause, Pause, Store};
use shared::parameters::Parameters;
use shared::rig::{Rig, Stored};
use shared::wire::StoreState;
use std::cell::Cell;
use std::convert::Infallible;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// As on the boards.
const SECTOR: usize = 16 * 1024;
const SIZE: usize = 3 * SECTOR;

/// The library's check sum takes 34 instructions a byte; at four cycles an instruction and 168 MHz these bytes take
/// 8 ms, a sixth of what the converter's ring can wait.
const MOST_READ_AT_ONCE: usize = 10_000;

/// Flash that counts what is done to it within one turn.
struct CountingFlash {
    bytes: Vec<u8>,
    read: Cell<usize>,
    erased: Cell<u32>,
    written: Cell<usize>,
}

impl CountingFlash {
    fn filled_with(byte: u8) -> Self {
        Self { bytes: vec![byte; SIZE], read: Cell::new(0), erased: Cell::new(0), written: Cell::new(0) }
    }
}

/// Shared with the one who looks.
#[derive(Clone, Copy)]
struct Seen<'f>(&'f std::cell::RefCell<CountingFlash>);

impl ErrorType for Seen<'_> {
    type Error = Infallible;
}

impl ReadNorFlash for Seen<'_> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
        let flash = self.0.borrow();
        flash.read.set(flash.read.get() + bytes.len());
        bytes.copy_from_slice(&flash.bytes[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl NorFlash for Seen<'_> {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Infallible> {
        let mut flash = self.0.borrow_mut();
        flash.erased.set(flash.erased.get() + (to - from) / SECTOR as u32);
        flash.bytes[from as usize..to as usize].fill(0xff);
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Infallible> {
        let mut flash = self.0.borrow_mut();
        flash.written.set(flash.written.get() + bytes.len());
        flash.bytes[offset as usize..].iter_mut().zip(bytes).for_each(|(old, new)| *old &= new);
        Ok(())
    }
}

/// The most of anything in one turn.
#[derive(Debug, Default)]
struct Turns {
    n: u32,
    most_read: usize,
    most_erased: u32,
    most_written: usize,
    read: usize,
}

impl Turns {
    /// Runs `work` turn by turn, as an executor would.
    fn watch<T>(&mut self, flash: &std::cell::RefCell<CountingFlash>, work: impl Future<Output = T>) -> T {
        let mut work = pin!(work);
        let mut context = Context::from_waker(Waker::noop());
        loop {
            let outcome = work.as_mut().poll(&mut context);
            let flash = flash.borrow();
            let read = flash.read.take();
            self.n += 1;
            self.read += read;
            self.most_read = self.most_read.max(read);
            self.most_erased = self.most_erased.max(flash.erased.take());
            self.most_written = self.most_written.max(flash.written.take());
            if let Poll::Ready(outcome) = outcome {
                return outcome;
            }
        }
    }
}

fn stored(i: u32) -> Stored {
    let mut parameters = Parameters::paper().map(|value| value as f32);
    parameters.pendulum.inertia_kg_m2 = 2e-3 + 1e-7 * i as f32;
    Stored { parameters, settings: *Rig::new("turns", 4095, Err(StoreState::Empty)).settings() }
}

#[test]
fn no_turn_of_two_thousand_saves_is_long() {
    let flash = std::cell::RefCell::new(CountingFlash::filled_with(0xff));
    let mut store: Store<_, NoPause> = Store::pausing(Seen(&flash), 0..SIZE as u32);
    let mut worst_save = 0;
    let mut all = Turns::default();
    for i in 0..2000 {
        let before = all.read;
        assert_eq!(all.watch(&flash, store.save(&stored(i))), Ok(()));
        worst_save = worst_save.max(all.read - before);
    }
    assert_eq!(all.watch(&flash, store.load()), Ok(stored(1999)));
    println!("{all:?}, the longest save reads {worst_save} bytes");
    assert!(all.most_read <= MOST_READ_AT_ONCE && all.most_written <= 64 && all.most_erased == 1, "{all:?}");
    // Every item of the sector that is given up is read once, and with it the newest, not all others.
    assert!(worst_save < 5 * SIZE, "{worst_save} bytes");
}

thread_local! {
    static PAUSES: Cell<u32> = const { Cell::new(0) };
}

struct Counted;

impl Pause for Counted {
    async fn pause() {
        PAUSES.set(PAUSES.get() + 1);
        embassy_futures::yield_now().await;
    }
}

#[test]
fn foreign_flash_is_erased_sector_by_sector() {
    for filled_with in [0x00, 0x5a] {
        PAUSES.set(0);
        let flash = std::cell::RefCell::new(CountingFlash::filled_with(filled_with));
        let mut store: Store<_, Counted> = Store::pausing(Seen(&flash), 0..SIZE as u32);
        let mut turns = Turns::default();
        assert!(turns.watch(&flash, store.load()).is_err());
        assert_eq!(turns.watch(&flash, store.save(&stored(1))), Ok(()));
        assert_eq!(turns.watch(&flash, store.load()), Ok(stored(1)));
        assert!(turns.most_erased == 1 && PAUSES.get() >= 3, "{filled_with:#x}: {turns:?}, {} pauses", PAUSES.get());
    }
}
