//! Adafruit Feather STM32F405 Express.
//!
//! | what | here |
//! |---|---|
//! | chip | STM32F405RG, 168 MHz |
//! | crystal | 12 MHz |
//! | potentiometer's wiper | A0 = PA4, converter channel 4 |
//! | encoder's A and B | SCL = PB6 and SDA = PB7, TIM4 |
//! | link | USB (PA11, PA12), `/dev/ttyACM0`; any baud rate |
//! | light | red, PC1: 2 Hz while an effect is named; faster without a crystal, and then there is no USB |
//! | update | `Bootloader` command, then DFU over the same USB |

use super::identity::NAME;
use super::stm32::usb_endpoints::Careful;
use super::stm32::{self, Chip, Converter, Input, Inputs, Quadrature, STORE, Sampling, Sectors, usb_recovery};
use core::convert::Infallible;
use embassy_executor::Spawner;
use embassy_stm32::gpio::{Level, Output, Pin, Speed};
pub use embassy_stm32::pac;
use embassy_stm32::peripherals::USB_OTG_FS;
use embassy_stm32::rcc::{Hse, HseMode, PllPreDiv, PllQDiv, mux};
use embassy_stm32::time::Hertz;
use embassy_stm32::usb::{self, Driver};
use embassy_stm32::{Config, Peri, bind_interrupts};
use embassy_usb::class::cdc_acm::{self, CdcAcmClass};
use embassy_usb::{Builder, UsbDevice};
use embedded_io_async::{ErrorType, Read, Write};
use firmware::ports::Board;
use heapless::String;
use shared::wire::Clock;
use static_cell::StaticCell;

const CRYSTAL: Hertz = Hertz(12_000_000);
const WIPER: Input = Input { channel: 4 };

/// The identity that pid.codes lends to tests. Boards that are sold or given away need their own: docs/add-a-board.md.
const USB_VENDOR: u16 = 0x1209;
const USB_PRODUCT: u16 = 0x0001;

/// USB carries every point at every rate.
const MOST_POINTS_PER_S: f32 = 10_000.0;

/// The largest packet of full-speed USB.
const PACKET: usize = 64;

/// Then it looks for the crystal again. A delay takes up to four times its cycles, so all of it lasts 0.5 to 2 s, within
/// the watchdog's patience.
const BLINKS: u32 = 5;
const HALF_A_BLINK: u32 = stm32::CLOCK_HZ / 20;

bind_interrupts!(struct Irqs {
    OTG_FS => usb::InterruptHandler<USB_OTG_FS>;
});

type Usb = Careful<Driver<'static, USB_OTG_FS>>;

/// Brings the board up.
pub fn start(spawner: Spawner) -> Board<Sampling, Receiver, Sender, Sectors, Chip> {
    let p = embassy_stm32::init(clocks());
    stm32::start_clock();
    let light = p.PC1;
    if stm32::clock_source() == Clock::Internal {
        blink_and_try_again(light);
    }
    let driver = {
        static OUT: StaticCell<[u8; 256]> = StaticCell::new();
        let mut config = usb::Config::default();
        // The Feather does not wire the USB supply to the chip's sensing pin.
        config.vbus_detection = false;
        Careful::new(Driver::new_fs(p.USB_OTG_FS, Irqs, p.PA12, p.PA11, OUT.init([0; 256]), config))
    };
    let (device, sender, receiver) = serial_over_usb(driver);
    spawner.spawn(run_usb(device).expect("there is one USB device"));
    let inputs = Inputs {
        converter: Converter::new(WIPER, p.PA4, p.ADC1, p.DMA2_CH0),
        quadrature: Quadrature::new(p.TIM4, p.PB6, p.PB7),
    };
    Board {
        name: NAME,
        most_points_per_s: MOST_POINTS_PER_S,
        sampler: Sampling::new(inputs, p.TIM3, p.TIM2),
        receiver,
        sender,
        flash: Sectors::new(p.FLASH),
        store: STORE,
        system: Chip::new(light),
    }
}

/// 12 MHz / 12 · 336 / 2 = 168 MHz, and / 7 = 48 MHz for USB.
fn clocks() -> Config {
    let mut config = stm32::clocks(Hse { freq: CRYSTAL, mode: HseMode::Oscillator }, PllPreDiv::DIV12);
    if let Some(pll) = &mut config.rcc.pll {
        pll.divq = Some(PllQDiv::DIV7);
    }
    config.rcc.mux.clk48sel = mux::Clk48sel::PLL1_Q;
    config
}

/// The internal oscillator is too coarse for USB.
fn blink_and_try_again(light: Peri<'static, impl Pin>) -> ! {
    let mut light = Output::new(light, Level::Low, Speed::Low);
    for _ in 0..2 * BLINKS {
        light.toggle();
        cortex_m::asm::delay(HALF_A_BLINK);
    }
    cortex_m::peripheral::SCB::sys_reset()
}

fn serial_over_usb(driver: Usb) -> (UsbDevice<'static, Usb>, Sender, Receiver) {
    static CONFIGURATION: StaticCell<[u8; 128]> = StaticCell::new();
    static BOS: StaticCell<[u8; 16]> = StaticCell::new();
    static CONTROL: StaticCell<[u8; 64]> = StaticCell::new();
    static STATE: StaticCell<cdc_acm::State> = StaticCell::new();
    static SERIAL: StaticCell<String<12>> = StaticCell::new();
    static TAKE_BACK: StaticCell<usb_recovery::TakeBack> = StaticCell::new();
    let mut config = embassy_usb::Config::new(USB_VENDOR, USB_PRODUCT);
    config.manufacturer = Some("pendulum");
    config.product = Some("Pendulum rig");
    config.serial_number = Some(SERIAL.init(stm32::serial()).as_str());
    config.max_packet_size_0 = PACKET as u8;
    let mut builder =
        Builder::new(driver, config, CONFIGURATION.init([0; 128]), BOS.init([0; 16]), &mut [], CONTROL.init([0; 64]));
    builder.handler(TAKE_BACK.init(usb_recovery::TakeBack));
    let class = CdcAcmClass::new(&mut builder, STATE.init(cdc_acm::State::new()), PACKET as u16);
    let (sender, receiver) = class.split();
    (builder.build(), Sender(sender), Receiver(receiver))
}

#[embassy_executor::task]
async fn run_usb(device: UsbDevice<'static, Usb>) {
    usb_recovery::run(device).await;
}

/// Bytes to the PC; while nobody is there they are lost.
pub struct Sender(cdc_acm::Sender<'static, Usb>);

impl ErrorType for Sender {
    type Error = Infallible;
}

impl Write for Sender {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        // A packet that is not full ends a transfer, so nothing ever waits in the PC for more.
        let packet = &bytes[..bytes.len().min(PACKET - 1)];
        if self.0.write_packet(packet).await.is_err() {
            self.0.wait_connection().await;
            return Ok(bytes.len());
        }
        Ok(packet.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Bytes from the PC.
pub struct Receiver(cdc_acm::Receiver<'static, Usb>);

impl ErrorType for Receiver {
    type Error = Infallible;
}

impl Read for Receiver {
    /// `bytes` must have room for a packet.
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        loop {
            self.0.wait_connection().await;
            if let Ok(n_bytes) = self.0.read_packet(bytes).await {
                return Ok(n_bytes);
            }
        }
    }
}
