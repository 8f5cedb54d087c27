//! Endpoints that begin anew when a PC asks for it: with nothing left to be sent, and with DATA0 (USB 2.0, 9.1.1.5 and
//! 9.4.5).
//!
//! A PC may choose the configuration once more while the board is sending. The driver then empties the queue of a
//! packet that waits but leaves its endpoint enabled, so that the next write would wait for ever; and it goes on with
//! whichever of DATA0 and DATA1 is next, so that one side takes the other's first packet for one that it has already.
//!
//! And a bus that goes on without saying so is one that goes on: while it believes in a suspended bus, the driver answers
//! no request.

use super::usb_recovery::take_back;
use embassy_futures::select::{Either, select};
use embassy_stm32::pac::USB_OTG_FS as OTG;
use embassy_time::Timer;
use embassy_usb::driver::{Bus, EndpointAddress, Event, Unsupported};

/// A suspended bus is looked at this often. Half of it would cost more than it brings, twice as much could be felt.
const LOOK_EVERY_MS: u64 = 10;

/// A bus with such endpoints.
pub struct CarefulBus<B> {
    bus: B,
    is_suspended: bool,
}

impl<B> CarefulBus<B> {
    /// Around this bus.
    pub fn new(bus: B) -> Self {
        Self { bus, is_suspended: false }
    }
}

/// Returns when the lines are not idle any more.
async fn goes_on() {
    loop {
        Timer::after_millis(LOOK_EVERY_MS).await;
        if !OTG.dsts().read().suspsts() {
            return;
        }
    }
}

impl<B: Bus> Bus for CarefulBus<B> {
    async fn enable(&mut self) {
        self.bus.enable().await;
    }

    async fn disable(&mut self) {
        self.bus.disable().await;
    }

    async fn poll(&mut self) -> Event {
        let event = if self.is_suspended {
            match select(self.bus.poll(), goes_on()).await {
                Either::First(event) => event,
                Either::Second(()) => Event::Resume,
            }
        } else {
            self.bus.poll().await
        };
        self.is_suspended = matches!(event, Event::Suspend);
        event
    }

    fn endpoint_set_enabled(&mut self, endpoint: EndpointAddress, enabled: bool) {
        if endpoint.is_in() {
            take_back(endpoint.index());
        }
        begin_with_data0(endpoint);
        self.bus.endpoint_set_enabled(endpoint, enabled);
    }

    fn endpoint_set_stalled(&mut self, endpoint: EndpointAddress, stalled: bool) {
        if !stalled {
            begin_with_data0(endpoint);
        }
        self.bus.endpoint_set_stalled(endpoint, stalled);
    }

    fn endpoint_is_stalled(&mut self, endpoint: EndpointAddress) -> bool {
        self.bus.endpoint_is_stalled(endpoint)
    }

    async fn remote_wakeup(&mut self) -> Result<(), Unsupported> {
        self.bus.remote_wakeup().await
    }
}

/// The control endpoint sees to this itself. Zeros neither enable nor disable.
fn begin_with_data0(endpoint: EndpointAddress) {
    if endpoint.index() == 0 {
        return;
    }
    cortex_m::interrupt::free(|_| {
        if endpoint.is_in() {
            OTG.diepctl(endpoint.index()).modify(|w| {
                w.set_epena(false);
                w.set_epdis(false);
                w.set_sd0pid_sevnfrm(true);
            });
        } else {
            OTG.doepctl(endpoint.index()).modify(|w| {
                w.set_epena(false);
                w.set_epdis(false);
                w.set_sd0pid_sevnfrm(true);
            });
        }
    });
}
