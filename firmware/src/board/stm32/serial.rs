//! Bytes from a serial port that no error on the line stops: the DMA carries them into a ring, and goes on.
//!
//! A break, noise, or a PC with another speed only put wrong bytes into the ring, which the frames' check sums find.
//! Nothing has to be started again, so that nothing of before can be read for a second time.

use super::clock::wait_for_clock;
use super::ring::{Size, Stream};
use core::convert::Infallible;
use core::future::poll_fn;
use core::sync::atomic::{AtomicU8, Ordering};
use core::task::Poll;
use embassy_stm32::Peri;
use embassy_stm32::gpio::{AfType, Flex, Pin, Pull};
use embassy_stm32::interrupt::typelevel::{Handler, USART2 as Interrupt};
use embassy_stm32::pac::{RCC, USART2};
use embassy_stm32::peripherals::DMA1_CH5;
use embassy_sync::waitqueue::AtomicWaker;
use embedded_io_async::{ErrorType, Read};

/// Bytes while nobody reads: several frames, 11 ms at 921,600 baud.
const RING: usize = 1024;

static BYTES: [AtomicU8; RING] = [const { AtomicU8::new(0) }; RING];

/// USART2's receiver among DMA1's requests (RM0390, table of DMA1's requests).
const STREAM: Stream = Stream { dma: embassy_stm32::pac::DMA1, number: 5, channel: 4 };

/// The alternate function of its pin (DS10693, table 11).
const PIN_FUNCTION: u8 = 7;

static HEARD: AtomicWaker = AtomicWaker::new();

/// The line is idle again: somebody has said something.
pub struct Heard;

#[allow(unsafe_code, reason = "that is how handlers are declared")]
impl Handler<Interrupt> for Heard {
    unsafe fn on_interrupt() {
        if USART2.sr().read().idle() {
            // Reading both registers clears it.
            let _ = USART2.dr().read();
            HEARD.wake();
        }
    }
}

/// The receiver of USART2.
pub struct Receiver {
    read_to: usize,
    _pin: Flex<'static>,
    _dma: Peri<'static, DMA1_CH5>,
}

impl Receiver {
    /// On this pin; the port's speed has been set.
    pub fn new(pin: Peri<'static, impl Pin>, dma: Peri<'static, DMA1_CH5>) -> Self {
        RCC.ahb1enr().modify(|w| w.set_dma1en(true));
        wait_for_clock();
        let mut pin = Flex::new(pin);
        // A line that nobody drives is idle.
        pin.set_as_af_unchecked(PIN_FUNCTION, AfType::input(Pull::Up));
        STREAM.stop();
        STREAM.fill(USART2.dr().as_ptr().cast(), BYTES.as_ptr().cast(), RING, Size::BITS8);
        USART2.cr3().modify(|w| w.set_dmar(true));
        USART2.cr1().modify(|w| w.set_re(true));
        Self { read_to: 0, _pin: pin, _dma: dma }
    }

    /// What has come since the last time. Behind a flash erase the ring may have been overtaken; then it is the end of
    /// what has come.
    fn take(&mut self, bytes: &mut [u8]) -> usize {
        let written_to = STREAM.writes_to(RING);
        let mut n = 0;
        while self.read_to != written_to && n < bytes.len() {
            bytes[n] = BYTES[self.read_to].load(Ordering::Relaxed);
            self.read_to = (self.read_to + 1) % RING;
            n += 1;
        }
        n
    }
}

/// The sender's driver serves the same interrupt, and may turn this off.
fn want_interrupt() {
    cortex_m::interrupt::free(|_| USART2.cr1().modify(|w| w.set_idleie(true)));
}

impl ErrorType for Receiver {
    type Error = Infallible;
}

impl Read for Receiver {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        poll_fn(|context| {
            HEARD.register(context.waker());
            want_interrupt();
            match self.take(bytes) {
                0 => Poll::Pending,
                n => Poll::Ready(Ok(n)),
            }
        })
        .await
    }
}
