//! What is remembered over a restart: why, where the last panic or fault was, how many restarts since power-up.
//!
//! The record lies in memory that start-up code leaves alone. After a power cut it holds noise, which the magic number
//! tells apart.
#![allow(unsafe_code, reason = "memory that survives a restart is outside the language; fault handlers too")]

use crate::stack;
use core::fmt::Write;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use core::ptr::{addr_of, addr_of_mut};
use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;
use cortex_m_rt::{ExceptionFrame, exception};
use heapless::String;
use shared::wire::ResetCause;

const MAGIC: u32 = 0x50_4e_44_4c;

/// Bytes of text kept.
const TEXT: usize = 48;

#[derive(Clone, Copy)]
#[repr(C)]
struct Record {
    magic: u32,
    cause: u32,
    resets: u32,
    length: u32,
    text: [u8; TEXT],
}

mod cause {
    pub(super) const NONE: u32 = 0;
    pub(super) const PANIC: u32 = 1;
    pub(super) const HARD_FAULT: u32 = 2;
}

#[unsafe(link_section = ".uninit.crash")]
static mut RECORD: MaybeUninit<Record> = MaybeUninit::uninit();

fn read() -> Option<Record> {
    // SAFETY: any bits are a valid `Record`; nobody else runs while start-up or a fault handler reads it.
    let record = unsafe { addr_of!(RECORD).cast::<Record>().read_volatile() };
    (record.magic == MAGIC && record.length as usize <= TEXT).then_some(record)
}

fn write(record: Record) {
    // SAFETY: as for reading.
    unsafe { addr_of_mut!(RECORD).cast::<Record>().write_volatile(record) }
}

/// Power came on: whatever memory still holds is of no restart.
#[cfg(feature = "stm32")]
pub fn forget() {
    // SAFETY: as for reading.
    unsafe { addr_of_mut!(RECORD).cast::<u32>().write_volatile(!MAGIC) }
}

/// What is known of the time before this start.
pub struct Before {
    /// Why it restarted, if the program itself knows.
    pub cause: Option<ResetCause>,
    /// Restarts since power came on.
    pub resets: u16,
    /// Where the last panic or fault was.
    pub last_fault: String<TEXT>,
    /// False after a power cut.
    pub warm: bool,
}

/// Reads the record and counts this start. Call it once.
pub fn before_this_start() -> Before {
    let Some(mut record) = read() else {
        write(Record { magic: MAGIC, cause: cause::NONE, resets: 0, length: 0, text: [0; TEXT] });
        return Before { cause: None, resets: 0, last_fault: String::new(), warm: false };
    };
    let known = match record.cause {
        cause::PANIC => Some(ResetCause::Panic),
        cause::HARD_FAULT => Some(ResetCause::HardFault),
        _ => None,
    };
    record.cause = cause::NONE;
    record.resets = record.resets.wrapping_add(1);
    write(record);
    let text = core::str::from_utf8(&record.text[..record.length as usize]).unwrap_or("");
    let last_fault = String::try_from(text).unwrap_or_default();
    Before { cause: known, resets: record.resets.min(u32::from(u16::MAX)) as u16, last_fault, warm: true }
}

fn record_and_restart(cause: u32, what: &String<TEXT>) -> ! {
    let resets = read().map_or(0, |record| record.resets);
    let mut text = [0; TEXT];
    text[..what.len()].copy_from_slice(what.as_bytes());
    write(Record { magic: MAGIC, cause, resets, length: what.len() as u32, text });
    cortex_m::peripheral::SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    cortex_m::interrupt::disable();
    let mut what = String::new();
    if let Some(location) = info.location() {
        // The end of a path says more than its beginning; room is left for the line.
        let file = location.file();
        let tail = file.get(file.len().saturating_sub(TEXT - 8)..).unwrap_or(file);
        let _ = write!(what, "{}:{}", tail, location.line());
    }
    record_and_restart(cause::PANIC, &what)
}

/// Where the last fault was: pc and lr.
static PLACE: [AtomicU32; 2] = [const { AtomicU32::new(0) }; 2];

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    if !stack::frame_was_lost() {
        PLACE[0].store(frame.pc(), Relaxed);
        PLACE[1].store(frame.lr(), Relaxed);
    }
    if stack::overflowed() {
        // Down here the report's own frames would lie over what it writes: below the guard are the static variables.
        // SAFETY: nothing on the stack is needed any more, and nobody comes back.
        unsafe { cortex_m::asm::bootstrap(stack::top() as *const u32, report as *const u32) }
    }
    report()
}

/// Says where the fault was and restarts.
extern "C" fn report() -> ! {
    let mut what = String::new();
    if stack::overflowed() {
        let _ = what.push_str("stack overflow ");
    }
    if !stack::frame_was_lost() {
        let [pc, lr] = [&PLACE[0], &PLACE[1]].map(|place| place.load(Relaxed));
        let _ = write!(what, "pc {pc:#010x} lr {lr:#010x}");
    }
    record_and_restart(cause::HARD_FAULT, &what)
}
