//! USB that goes on after whatever the PC did: a bus reset, a suspended bus or a dead host in the middle of a packet.
//!
//! Two things the driver leaves undone. A bus reset, and a request in place of fetching the answer to the one before,
//! end what an endpoint was to send; but a packet that waits in it keeps it enabled, and the next write would wait for
//! ever (RM0090, 34.17.5, device core: an endpoint is disabled by asking it to be). And while a control transfer waits
//! for a host that is gone, nobody looks at the bus.

use core::cell::Cell;
use embassy_futures::select::select;
use embassy_stm32::pac::USB_OTG_FS as OTG;
use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};
use embassy_time::Timer;
use embassy_usb::{Handler, UsbDevice, driver::Driver};

/// Endpoints that send: control, notifications, data, and one that is free.
const ENDPOINTS: usize = 4;

/// The core answers within a few of its cycles; nothing depends on it if it does not.
const MOST_LOOKS: u32 = 1000;

/// How often the bus is looked at, and how often it must have been left alone to be sure: 30 ms. Without an erase in
/// between it takes less than 1 ms.
const LOOK_EVERY_MS: u64 = 10;
const MOST_UNANSWERED: u32 = 3;

/// Takes packets back that were meant for the host before the reset.
pub struct TakeBack;

impl Handler for TakeBack {
    fn reset(&mut self) {
        was_put_off();
        (0..ENDPOINTS).for_each(take_back);
        // A suspension that was noticed together with the reset came before it.
        OTG.gintsts().write(|w| w.set_usbsusp(true));
    }
}

/// A request that came while another one was being answered; a reset of the bus ends it.
static NEXT: Mutex<CriticalSectionRawMutex, Cell<Option<[u8; 8]>>> = Mutex::new(Cell::new(None));

/// This request is to be answered next.
pub(super) fn put_off(request: [u8; 8]) {
    NEXT.lock(|next| next.set(Some(request)));
}

/// The one that is to be answered next, once.
pub(super) fn was_put_off() -> Option<[u8; 8]> {
    NEXT.lock(Cell::take)
}

/// An endpoint's packet will not be sent.
pub(super) fn take_back(endpoint: usize) {
    let control = OTG.diepctl(endpoint);
    if !control.read().epena() {
        return;
    }
    critical_section(|| {
        control.modify(|w| {
            w.set_snak(true);
            w.set_epdis(true);
        });
        wait_while(|| control.read().epena());
        OTG.grstctl().write(|w| {
            w.set_txfflsh(true);
            w.set_txfnum(endpoint as u8);
        });
        wait_while(|| OTG.grstctl().read().txfflsh());
    });
}

/// The driver's interrupt must not come between these registers.
fn critical_section(work: impl FnOnce()) {
    cortex_m::interrupt::free(|_| work());
}

fn wait_while(busy: impl Fn() -> bool) {
    let _ = (0..MOST_LOOKS).find(|_| !busy());
}

/// Runs the device for ever.
pub async fn run<'d, D: Driver<'d>>(mut device: UsbDevice<'d, D>) -> ! {
    loop {
        select(device.run(), left_alone()).await;
        // What the transfer has set in the device stays right; the next event on the bus is taken from here.
        defmt::warn!("USB: a transfer was given up");
        take_back(0);
    }
}

/// Returns when the bus was reset and nobody notices.
async fn left_alone() {
    let mut unanswered = 0;
    while unanswered < MOST_UNANSWERED {
        Timer::after_millis(LOOK_EVERY_MS).await;
        let bus = OTG.gintsts().read();
        unanswered = if bus.usbrst() || bus.enumdne() { unanswered + 1 } else { 0 };
    }
}
