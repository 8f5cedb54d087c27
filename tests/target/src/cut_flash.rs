//! Flash that loses power in the middle of an operation, as often as a test wants.
//!
//! A word that was being programmed keeps any mixture of its old bits and the cleared ones; a sector that was being
//! erased is erased up to some word, has noise in the next one, and is untouched behind it.

use crate::noise::Noise;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

/// Small sectors, so that erases are frequent.
pub const SECTOR: usize = 1024;

/// As many as on the boards.
pub const SIZE: usize = 3 * SECTOR;

const WORD: usize = 4;

/// Why an operation failed: the power is off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PowerCut;

impl NorFlashError for PowerCut {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

/// What was being done when the power went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum During {
    /// A word was programmed.
    Write,
    /// A sector was erased.
    Erase,
}

/// The flash.
#[derive(Clone, Debug)]
pub struct CutFlash {
    bytes: [u8; SIZE],
    noise: Noise,
    /// Operations until the power goes.
    left: Option<u32>,
    at_an_erase: bool,
    /// What the last cut interrupted.
    pub cut: Option<During>,
}

impl CutFlash {
    /// Erased, with power for ever.
    pub fn new(seed: u32) -> Self {
        Self { bytes: [0xff; SIZE], noise: Noise::new(seed), left: None, at_an_erase: false, cut: None }
    }

    /// Full of somebody else's bytes.
    pub fn foreign(seed: u32) -> Self {
        let mut flash = Self::new(seed);
        let mut noise = Noise::new(seed);
        flash.bytes.fill_with(|| noise.bits() as u8);
        flash
    }

    /// The power goes during the operation after the next `n_operations`.
    pub fn cut_after(&mut self, n_operations: u32) {
        self.left = Some(n_operations);
    }

    /// The power goes during the next erase.
    pub fn cut_at_an_erase(&mut self) {
        self.at_an_erase = true;
    }

    /// Power again, for ever.
    pub fn restore_power(&mut self) {
        (self.left, self.at_an_erase, self.cut) = (None, false, None);
    }

    /// Spends one operation; false when the power goes during it.
    fn spend(&mut self, during: During) -> Result<bool, PowerCut> {
        if self.cut.is_some() {
            return Err(PowerCut);
        }
        let goes = self.left == Some(0) || (self.at_an_erase && during == During::Erase);
        self.left = self.left.map(|left| left.saturating_sub(1));
        self.cut = goes.then_some(during);
        Ok(!goes)
    }
}

impl ErrorType for &mut CutFlash {
    type Error = PowerCut;
}

impl ReadNorFlash for &mut CutFlash {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerCut> {
        bytes.copy_from_slice(&self.bytes[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl NorFlash for &mut CutFlash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerCut> {
        for sector in (from as usize..to as usize).step_by(SECTOR) {
            if self.spend(During::Erase)? {
                self.bytes[sector..sector + SECTOR].fill(0xff);
                continue;
            }
            let reached = sector + WORD * self.noise.below((SECTOR / WORD) as u32) as usize;
            self.bytes[sector..reached].fill(0xff);
            let noise = self.noise.bits().to_le_bytes();
            self.bytes[reached..reached + WORD].copy_from_slice(&noise);
            return Err(PowerCut);
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerCut> {
        for (i, word) in bytes.chunks(WORD).enumerate() {
            let whole = self.spend(During::Write)?;
            let spared = if whole { [0; WORD] } else { self.noise.bits().to_le_bytes() };
            let place = &mut self.bytes[offset as usize + WORD * i..][..WORD];
            for ((old, new), spared) in place.iter_mut().zip(word).zip(spared) {
                *old &= new | spared;
            }
            if !whole {
                return Err(PowerCut);
            }
        }
        Ok(())
    }
}
