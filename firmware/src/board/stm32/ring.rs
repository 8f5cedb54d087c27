//! Rings that a stream of the DMA fills: it carries a peripheral's register there, once a request, and begins again at
//! the end. One of them holds readings at exact instants.

use core::sync::atomic::{AtomicU16, Ordering};
use embassy_stm32::pac::dma::Dma;
pub use embassy_stm32::pac::dma::vals::Size;
use embassy_stm32::pac::dma::vals::{Dir, Pl};

/// Readings in the ring.
pub const RING: usize = 2048;

static READINGS: [AtomicU16; RING] = [const { AtomicU16::new(0) }; RING];

/// What stands at a place of the ring.
pub fn reading(place: usize) -> u16 {
    READINGS[place].load(Ordering::Relaxed)
}

/// A stream of the DMA; only one may fill a ring at a time.
pub struct Stream {
    /// Which controller.
    pub dma: Dma,
    /// Its stream.
    pub number: usize,
    /// Whose requests the stream answers.
    pub channel: u8,
}

impl Stream {
    /// Nothing is written any more.
    pub fn stop(&self) {
        let stream = self.dma.st(self.number);
        stream.cr().modify(|w| w.set_en(false));
        while stream.cr().read().en() {}
        let place = self.number % 4;
        self.dma.ifcr(self.number / 4).write(|w| {
            w.set_tcif(place, true);
            w.set_htif(place, true);
            w.set_teif(place, true);
            w.set_dmeif(place, true);
            w.set_feif(place, true);
        });
    }

    /// As [`Stream::fill`], the ring of readings.
    pub fn fill_readings(&self, from: *mut ()) {
        self.fill(from, READINGS.as_ptr().cast(), RING, Size::BITS16);
    }

    /// From the first of the ring's `length` places on, at each request what is in the register at `from`. The stream
    /// must stand still.
    pub fn fill(&self, from: *mut (), ring: *const (), length: usize, size: Size) {
        let stream = self.dma.st(self.number);
        stream.par().write_value(from as u32);
        stream.m0ar().write_value(ring as u32);
        stream.ndtr().write(|w| w.set_ndt(length as u16));
        stream.cr().write(|w| {
            w.set_chsel(self.channel);
            w.set_dir(Dir::PERIPHERAL_TO_MEMORY);
            w.set_psize(size);
            w.set_msize(size);
            w.set_minc(true);
            w.set_circ(true);
            w.set_pl(Pl::VERY_HIGH);
        });
        stream.cr().modify(|w| w.set_en(true));
    }

    /// The place of a ring of that length that is written next.
    pub fn writes_to(&self, length: usize) -> usize {
        (length - usize::from(self.dma.st(self.number).ndtr().read().ndt())) % length
    }
}
