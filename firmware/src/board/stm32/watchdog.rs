//! The watchdog that no program stops: it runs from an oscillator of its own, and from before the clocks are set up. It
//! waits while a debugger halts the processor (RM0090, 38.16.4).

use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_stm32::pac::{DBGMCU, IWDG};

/// 4 s at the oscillator's nominal 32 kHz, 2.7 s at its highest 47, 7.5 s at its lowest 17 (data sheet): longer than
/// the longest erase of a sector, 0.5 s, after which it is fed; shorter than anyone's patience.
const RELOAD: u16 = 2000;

/// Some milliseconds, several times what it takes.
const MOST_LOOKS: u32 = 10_000;

/// From now on it has to be fed.
pub fn start() {
    DBGMCU.apb1fzr().modify(|w| w.set_iwdg(true));
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY64));
    IWDG.rlr().write(|w| w.set_rl(RELOAD - 1));
    IWDG.kr().write(|w| w.set_key(Key::START));
    // The two registers are taken over by the slow clock, within five of its cycles.
    let is_taken_over = |_: &u32| {
        let status = IWDG.sr().read();
        !status.rvu() && !status.pvu()
    };
    let _ = (0..MOST_LOOKS).find(is_taken_over);
    feed();
}

/// All is well.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
