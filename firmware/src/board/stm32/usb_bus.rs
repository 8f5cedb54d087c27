//! Endpoints that begin anew when a PC asks for it: with nothing left to be sent, and with DATA0 (USB 2.0, 9.1.1.5 and
//! 9.4.5).
//!
//! A PC may choose the configuration once more while the board is sending. The driver then empties the queue of a
//! packet that waits but leaves its endpoint enabled, so that the next write would wait for ever; and it goes on with
//! whichever of DATA0 and DATA1 is next, so that one side takes the other's first packet for one that it has already.

use super::usb_recovery::take_back;
use embassy_stm32::pac::USB_OTG_FS as OTG;
use embassy_usb::driver::{Bus, EndpointAddress, Event, Unsupported};

/// A bus with such endpoints.
pub struct CarefulBus<B>(B);

impl<B> CarefulBus<B> {
    /// Around this bus.
    pub fn new(bus: B) -> Self {
        Self(bus)
    }
}

impl<B: Bus> Bus for CarefulBus<B> {
    async fn enable(&mut self) {
        self.0.enable().await;
    }

    async fn disable(&mut self) {
        self.0.disable().await;
    }

    async fn poll(&mut self) -> Event {
        self.0.poll().await
    }

    fn endpoint_set_enabled(&mut self, endpoint: EndpointAddress, enabled: bool) {
        if endpoint.is_in() {
            take_back(endpoint.index());
        }
        begin_with_data0(endpoint);
        self.0.endpoint_set_enabled(endpoint, enabled);
    }

    fn endpoint_set_stalled(&mut self, endpoint: EndpointAddress, stalled: bool) {
        if !stalled {
            begin_with_data0(endpoint);
        }
        self.0.endpoint_set_stalled(endpoint, stalled);
    }

    fn endpoint_is_stalled(&mut self, endpoint: EndpointAddress) -> bool {
        self.0.endpoint_is_stalled(endpoint)
    }

    async fn remote_wakeup(&mut self) -> Result<(), Unsupported> {
        self.0.remote_wakeup().await
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
