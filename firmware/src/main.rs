//! The firmware: starts the chosen board and runs the application on it.
#![no_std]
#![no_main]
#![allow(unreachable_pub, reason = "a program has no users: `pub` in its modules means for the other modules")]

mod board;
mod crash;
mod stack;

use board::cycles::cycles_since_start;
use board::pac::interrupt;
use board::spare::SPARE;
use board::usage;
use embassy_executor::{InterruptExecutor, Spawner};
use shared::bank::findings::Room;

/// Tasks run in an interrupt that nothing else uses, below all others, so that `main` is left to look at the last
/// releases, to sleep, and to measure how long it slept.
static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut ROOM: Room<f32> = Room::empty(0.0);
    board::before_all();
    stack::prepare();
    board::lowest_priority(interrupt::CAN1_TX);
    EXECUTOR.start(interrupt::CAN1_TX).spawn(application().expect("there is one application"));
    usage::spend(|| SPARE.work(ROOM, cycles_since_start))
}

#[allow(unsafe_code, reason = "a task may only spawn others on its own executor")]
#[embassy_executor::task]
async fn application() {
    // SAFETY: this task is polled by an executor, and the spawner stays within it.
    let spawner = unsafe { Spawner::for_current_executor().await };
    firmware::app::run(board::start(spawner)).await;
}

#[allow(unsafe_code, reason = "the executor has to be polled from its interrupt")]
#[interrupt]
fn CAN1_TX() {
    // SAFETY: called from this handler only, and the interrupt is enabled by `start` only.
    usage::counted(|| unsafe { EXECUTOR.on_interrupt() });
}
