//! Counts instructions per stage. Run it with `-icount shift=0`: then QEMU's SysTick advances by the instruction.
//! Prints one line each: `count NAME INSTRUCTIONS`.
#![no_std]
#![no_main]

use core::hint::black_box;
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_rt::entry;
use semihosting::println;
use shared::filter::{Butterworth, FilterState};
use shared::model::Model;
use shared::observer::Observer;
use shared::parameters::base;
use shared::potentiometer::Potentiometer;
use shared::real::Real;
use shared::rig::Rig;
use shared::units::Code;
use shared::wire::{Command, Frame, SAMPLES_PER_FRAME, StoreState, Stream};
use target_tests::traces::{codes, parameters};

/// With `shift=0` an instruction takes 1 ns, and SysTick runs at 168 MHz.
const TICKS_PER_1000_INSTRUCTIONS: u32 = 168;

const DT_S: f32 = 1e-3;
const N_CALLS: u32 = 1024;

/// By then the released pendulum is well outside the velocity band.
const SLIDING_AFTER: u32 = 100;

fn ticks(mut call: impl FnMut()) -> u32 {
    // SysTick counts down in 24 bits: 16.7 million ticks are 100 million instructions.
    let before = SYST::get_current();
    (0..N_CALLS).for_each(|_| call());
    before.wrapping_sub(SYST::get_current()) & 0x00ff_ffff
}

fn count(name: &str, call: impl FnMut()) {
    let loop_alone = ticks(|| {
        black_box(());
    });
    let ticks = ticks(call) - loop_alone;
    let instructions = u64::from(ticks) * 1000 / u64::from(TICKS_PER_1000_INSTRUCTIONS * N_CALLS);
    println!("count {} {}", name, instructions);
}

#[entry]
fn main() -> ! {
    let mut systick = cortex_m::Peripherals::take().expect("first use").SYST;
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(0x00ff_ffff);
    systick.clear_current();
    systick.enable_counter();

    let potentiometer = Potentiometer::nominal(firmware::ports::FULL_SCALE);
    count("code-to-angle", || {
        black_box(potentiometer.angle(black_box(Code(9000))));
    });

    let filter = Butterworth::<f32>::new(50.0, 1000.0).expect("a usual cut-off");
    let mut filtered = FilterState::settled_at(0.5);
    count("filter", || {
        black_box(filtered.step(&filter, black_box(0.4)));
    });

    count("sine", || {
        black_box(Real::sin(black_box(0.7_f32)));
    });

    let model = Model::new(&parameters());
    let mut state = model.release(1.0, 0.0);
    (0..SLIDING_AFTER).for_each(|_| model.step(&mut state, DT_S));
    count("rk4-step-smooth", || {
        let mut same = black_box(state);
        model.step(&mut same, DT_S);
        black_box(same);
    });

    // The last step before the swing turns round: sliding ends within it.
    let velocity_band = parameters().values(base::STICTION).map_or(0.0, |values| values[1]);
    let mut before_reversal = state;
    while state.velocity_rad_s.abs() > velocity_band {
        before_reversal = state;
        model.step(&mut state, DT_S);
    }
    count("rk4-step-at-a-reversal", || {
        let mut same = black_box(before_reversal);
        model.step(&mut same, DT_S);
        black_box(same);
    });

    let mut observer = Observer::new(&parameters(), 3.0);
    let mut measured = [0.0_f32; N_CALLS as usize];
    let mut i = 0;
    let each = |code: Code| {
        measured[i] = potentiometer.angle(code).0;
        i += 1;
    };
    codes(each, N_CALLS as usize);
    let mut next = measured.iter().cycle();
    count("observer", || {
        if let Some(angle_rad) = next.next() {
            black_box(observer.on_measurement(black_box(*angle_rad), DT_S));
        }
    });

    count_rig("sample-quiet", None);
    count_rig("sample-raw", Some(Stream { raw: true, live_every: 0 }));
    count_rig("sample-raw-and-live-10", Some(Stream { raw: true, live_every: 10 }));
    count_rig("sample-raw-and-live", Some(Stream { raw: true, live_every: 1 }));
    semihosting::process::exit(0)
}

/// The whole chain for one sample: angle, filter, observer, and the share of the frames with their encoding and queue.
fn count_rig(name: &str, stream: Option<Stream>) {
    let mut rig = Rig::new("count", firmware::ports::FULL_SCALE, Err(StoreState::Empty));
    if let Some(stream) = stream {
        rig.on_frame(Frame::Command(1, Command::Start(stream)));
    }
    let queue = firmware::frame_queue::FrameQueue::new();
    let mut recorded = [Code(0); N_CALLS as usize];
    let mut i = 0;
    let each = |code| {
        recorded[i] = code;
        i += 1;
    };
    codes(each, N_CALLS as usize);
    let mut next = recorded.iter().cycle();
    let mut n_until_emptied = SAMPLES_PER_FRAME;
    count(name, || {
        if let Some(code) = next.next() {
            rig.on_sample(*code, |frame| {
                queue.push(&frame);
            });
        }
        n_until_emptied -= 1;
        if n_until_emptied == 0 {
            n_until_emptied = SAMPLES_PER_FRAME;
            queue.clear();
        }
    });
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    semihosting::eprintln!("{info}");
    semihosting::process::exit(101)
}
