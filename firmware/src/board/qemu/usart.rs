//! The two serial ports, byte by byte. Received bytes wait in a pipe; when it is full the port's interrupt is masked,
//! which makes QEMU hold the rest back.
#![allow(unsafe_code, reason = "interrupts are unmasked when their handler has what it needs")]

use core::convert::Infallible;
use cortex_m::peripheral::NVIC;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embedded_io_async::{ErrorType, Read, Write};
use stm32_metapac::{self as pac, Interrupt, interrupt, usart::Usart};

/// More than the longest frame, and four times what the plant sends ahead.
const PIPE: usize = 512;

type Bytes = Pipe<CriticalSectionRawMutex, PIPE>;

static LINK: Bytes = Pipe::new();
static PLANT: Bytes = Pipe::new();

/// The link to the PC.
pub fn link() -> (Sender, Receiver) {
    open(pac::USART1, &LINK, Interrupt::USART1)
}

/// The line to the simulated pendulum.
pub fn plant() -> (Sender, Receiver) {
    open(pac::USART2, &PLANT, Interrupt::USART2)
}

fn open(usart: Usart, bytes: &'static Bytes, interrupt: Interrupt) -> (Sender, Receiver) {
    usart.cr1().write(|w| {
        w.set_ue(true);
        w.set_te(true);
        w.set_re(true);
        w.set_rxneie(true);
    });
    unmask(interrupt);
    (Sender(usart), Receiver { bytes, interrupt })
}

fn unmask(interrupt: Interrupt) {
    // SAFETY: the handlers below need nothing but statics.
    unsafe { NVIC::unmask(interrupt) }
}

/// Bytes that came in.
pub struct Receiver {
    bytes: &'static Bytes,
    interrupt: Interrupt,
}

impl ErrorType for Receiver {
    type Error = Infallible;
}

impl Read for Receiver {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let n_bytes = self.bytes.read(buffer).await;
        unmask(self.interrupt);
        Ok(n_bytes)
    }
}

/// Bytes that go out. QEMU takes each at once, so nothing ever waits; on a real port this would.
pub struct Sender(Usart);

impl ErrorType for Sender {
    type Error = Infallible;
}

impl Write for Sender {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for byte in bytes {
            while !self.0.sr().read().txe() {}
            self.0.dr().write(|w| w.set_dr(u16::from(*byte)));
        }
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

fn receive(usart: Usart, bytes: &Bytes, interrupt: Interrupt) {
    if bytes.free_capacity() == 0 {
        NVIC::mask(interrupt);
    } else if usart.sr().read().rxne() {
        let byte = usart.dr().read().dr() as u8;
        let _ = bytes.try_write(&[byte]);
    }
}

#[interrupt]
fn USART1() {
    receive(pac::USART1, &LINK, Interrupt::USART1);
}

#[interrupt]
fn USART2() {
    receive(pac::USART2, &PLANT, Interrupt::USART2);
}
