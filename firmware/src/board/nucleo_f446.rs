//! ST Nucleo-F446RE.
//!
//! | what | here |
//! |---|---|
//! | chip | STM32F446RE, run at 168 MHz like the Feather's |
//! | clock | 8 MHz from the ST-Link, bypassing the oscillator |
//! | potentiometer's wiper | A0 = PA0, converter channel 0 |
//! | encoder's A and B | PB6 = D10 and PB7 (CN7 pin 21), TIM4 |
//! | link | USART2 (PA2, PA3) to the ST-Link's serial port, `/dev/ttyACM0` at 921600 baud |
//! | light | green, PA5: 2 Hz while an effect is named |
//! | update | the ST-Link; the bootloader too, over USART1 or USB of the chip |

use super::identity::NAME;
use super::stm32::serial::{self, Receiver};
use super::stm32::{self, Chip, Converter, Input, Inputs, Quadrature, STORE, Sampling, Sectors};
use embassy_executor::Spawner;
pub use embassy_stm32::pac;
use embassy_stm32::peripherals::{DMA1_CH6, USART2};
use embassy_stm32::rcc::{Hse, HseMode, PllPreDiv};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::{self, UartTx};
use embassy_stm32::{Config, bind_interrupts, dma, mode};
use firmware::ports::Board;

const CLOCK_IN: Hertz = Hertz(8_000_000);
const WIPER: Input = Input { channel: 0 };

/// 92 kB/s, of which raw codes at 10 kHz take 33.
const BAUD: u32 = 921_600;

/// 22 bytes each.
const MOST_POINTS_PER_S: f32 = 2000.0;

bind_interrupts!(struct Irqs {
    USART2 => serial::Heard, usart::InterruptHandler<USART2>;
    DMA1_STREAM6 => dma::InterruptHandler<DMA1_CH6>;
});

type Sender = UartTx<'static, mode::Async>;

/// Brings the board up.
pub fn start(_: Spawner) -> Board<Sampling, Receiver, Sender, Sectors, Chip> {
    let p = embassy_stm32::init(clocks());
    stm32::start_clock();
    let mut config = usart::Config::default();
    config.baudrate = BAUD;
    let sender = UartTx::new(p.USART2, p.PA2, p.DMA1_CH6, Irqs, config);
    let sender = sender.expect("the baud rate can be made from this clock");
    let inputs = Inputs {
        converter: Converter::new(WIPER, p.PA0, p.ADC1, p.DMA2_CH0),
        quadrature: Quadrature::new(p.TIM4, p.PB6, p.PB7),
    };
    Board {
        name: NAME,
        most_points_per_s: MOST_POINTS_PER_S,
        sampler: Sampling::new(inputs, p.TIM3, p.TIM2),
        receiver: Receiver::new(p.PA3, p.DMA1_CH5),
        sender,
        flash: Sectors::new(p.FLASH),
        store: STORE,
        system: Chip::new(p.PA5),
    }
}

/// 8 MHz / 8 · 336 / 2 = 168 MHz.
fn clocks() -> Config {
    stm32::clocks(Hse { freq: CLOCK_IN, mode: HseMode::Bypass }, PllPreDiv::DIV8)
}
