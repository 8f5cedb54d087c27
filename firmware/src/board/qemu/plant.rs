//! Samples from a simulated pendulum outside, which is also the clock: one code is one sample, however long it takes.
//!
//! QEMU takes one byte of a serial port at a time, and for each its two threads wait for one another. So codes come in
//! blocks, through a file in the folder that it was started in: sixteen of two bytes each, low byte first, in one of
//! eight places. A byte on the line says that a block is there: 0pppnnnn, its place and how many codes it has beyond the
//! first. For each block one byte goes back, so that the pendulum never runs far ahead of the firmware. A zero says that
//! the firmware starts; what comes before the answer to it, 0x80, was meant for the run before.

use super::usart::{Receiver, Sender};
use crate::board::spare::SPARE;
use embassy_time::{Duration, Instant, Timer};
use embedded_io_async::{Read, Write};
use firmware::ports::{BATCH, Batch, Sampler};
use semihosting::fs::File;
use semihosting::io::{self, Read as _, Seek as _, SeekFrom};
use shared::sensor::Sensor;
use shared::units::Code;

/// What the pendulum writes and the firmware reads.
const FILE: &core::ffi::CStr = c"codes";

/// Codes of a block.
const BLOCK: usize = 16;
const _: () = assert!(BLOCK <= BATCH);

const BYTES_PER_CODE: usize = 2;

const STARTS: u8 = 0;
const TAKEN: u8 = 1;

/// From here on blocks are meant for this run.
const BEGINS: u8 = 0x80;

/// While the rig looks at its last releases, the next block waits for it, but no longer than this: samples that come as
/// fast as they are taken would leave no time for the look, and the next release would overtake it, which takes most of
/// a minute on a board.
const LOOKED_AT_MOST: Duration = Duration::from_millis(100);

/// The pendulum's end of the line.
pub struct Plant {
    blocks: Receiver,
    replies: Sender,
    /// Open from the start on.
    codes: Option<File>,
}

impl Plant {
    /// On the two directions of a serial port.
    pub fn new(blocks: Receiver, replies: Sender) -> Self {
        Self { blocks, replies, codes: None }
    }

    async fn say(&mut self, reply: u8) {
        let Ok(()) = self.replies.write_all(&[reply]).await;
    }

    async fn hear(&mut self) -> u8 {
        let mut byte = [0];
        let Ok(_) = self.blocks.read(&mut byte).await;
        byte[0]
    }

    async fn begin(&mut self) {
        self.codes = Some(File::open(FILE).expect("QEMU's folder has the pendulum's codes"));
        self.say(STARTS).await;
        while self.hear().await != BEGINS {}
    }

    /// The next block. Whoever starts twice before the first answer has another one between them.
    async fn next_block(&mut self) -> u8 {
        loop {
            match self.hear().await {
                BEGINS => {}
                block => return block,
            }
        }
    }

    fn read(&mut self, block: u8, batch: &mut Batch) -> io::Result<()> {
        let (place, n_codes) = (usize::from(block >> 4), usize::from(block & 0xf) + 1);
        let mut bytes = [0; BYTES_PER_CODE * BLOCK];
        let start = (place * bytes.len()) as u64;
        let taken = &mut bytes[..BYTES_PER_CODE * n_codes];
        if let Some(file) = &mut self.codes {
            file.seek(SeekFrom::Start(start))?;
            file.read_exact(taken)?;
        }
        batch.codes.extend(taken.as_chunks().0.iter().map(|two| Code(u16::from_le_bytes(*two))));
        Ok(())
    }
}

async fn let_it_look() {
    let until = Instant::now() + LOOKED_AT_MOST;
    while SPARE.is_wanted() && Instant::now() < until {
        Timer::after_millis(1).await;
    }
}

impl Sampler for Plant {
    /// The pendulum outside is the clock.
    fn nearest_rate(rate_hz: f32) -> f32 {
        rate_hz
    }

    /// Fourteen bits of a code are enough for a potentiometer.
    fn can_read(sensor: &Sensor) -> bool {
        matches!(sensor, Sensor::Potentiometer(_))
    }

    fn start(&mut self, _: &Sensor, _: f32) {}

    async fn next(&mut self) -> Batch {
        if self.codes.is_none() {
            self.begin().await;
        }
        let_it_look().await;
        let mut batch = Batch::default();
        let block = self.next_block().await;
        self.read(block, &mut batch).expect("a block of the pendulum's codes");
        self.say(TAKEN).await;
        batch
    }
}
