//! Requests that the driver would trip over.
//!
//! It takes the number of an endpoint as it comes and panics behind its last one, so that any program on the PC could
//! restart the board by asking for the status of endpoint 15. USB 2.0, 9.4: such a request is an error.
//!
//! It keeps data that came with a request which was refused meanwhile. They would fill the place of the next ones, which
//! then never reach the board: no PC could set it up again. So would an answer that the PC never fetched.
//!
//! It waits for data and for an answer's end although the PC has given up and asks something else. And it leaves a
//! request for nothing, which has only to be agreed to, without an answer.

use super::usb_bus::CarefulBus;
use super::usb_recovery;
use core::future::{Future, poll_fn};
use core::pin::pin;
use core::task::{Context, Poll};
use embassy_futures::poll_once;
use embassy_usb::driver::{
    ControlPipe, Driver, Endpoint, EndpointAddress, EndpointAllocError, EndpointError, EndpointType,
};

/// Of a request's first byte: who it is for, and "an endpoint" among them (USB 2.0, table 9-2).
const RECIPIENT: u8 = 0x1f;
const ENDPOINT: u8 = 2;

/// Set there if the board is to send something.
const ASKS: u8 = 0x80;

/// Of the address of an endpoint: its number, and set if it sends (USB 2.0, figure 9-2).
const NUMBER: u8 = 0x0f;
const SENDS: u8 = 0x80;

/// The largest packet of full-speed USB.
const PACKET: usize = 64;

/// Addresses of endpoints.
#[derive(Clone, Copy)]
struct Known {
    receive: u16,
    send: u16,
}

impl Known {
    fn add(&mut self, address: EndpointAddress) {
        let endpoints = if address.is_in() { &mut self.send } else { &mut self.receive };
        *endpoints |= 1 << address.index();
    }

    fn has(self, address: u8) -> bool {
        let endpoints = if address & SENDS == 0 { self.receive } else { self.send };
        endpoints >> (address & NUMBER) & 1 == 1
    }
}

/// A driver that remembers which endpoints it gave away.
pub struct Careful<D> {
    driver: D,
    known: Known,
}

impl<D> Careful<D> {
    /// Around this driver, which has given none away yet; the control endpoint is always there.
    pub fn new(driver: D) -> Self {
        Self { driver, known: Known { receive: 1, send: 1 } }
    }
}

impl<'d, D: Driver<'d>> Driver<'d> for Careful<D> {
    type EndpointOut = D::EndpointOut;
    type EndpointIn = D::EndpointIn;
    type ControlPipe = CarefulPipe<D::ControlPipe>;
    type Bus = CarefulBus<D::Bus>;

    fn alloc_endpoint_out(
        &mut self,
        kind: EndpointType,
        address: Option<EndpointAddress>,
        packet: u16,
        interval_ms: u8,
    ) -> Result<Self::EndpointOut, EndpointAllocError> {
        let endpoint = self.driver.alloc_endpoint_out(kind, address, packet, interval_ms)?;
        self.known.add(endpoint.info().addr);
        Ok(endpoint)
    }

    fn alloc_endpoint_in(
        &mut self,
        kind: EndpointType,
        address: Option<EndpointAddress>,
        packet: u16,
        interval_ms: u8,
    ) -> Result<Self::EndpointIn, EndpointAllocError> {
        let endpoint = self.driver.alloc_endpoint_in(kind, address, packet, interval_ms)?;
        self.known.add(endpoint.info().addr);
        Ok(endpoint)
    }

    fn start(self, control_packet: u16) -> (Self::Bus, Self::ControlPipe) {
        let (bus, pipe) = self.driver.start(control_packet);
        (CarefulBus::new(bus), CarefulPipe { pipe, known: self.known })
    }
}

/// A control pipe that passes on what concerns endpoints that are there, with its own data only, and gives up what the PC
/// has given up.
pub struct CarefulPipe<P> {
    pipe: P,
    known: Known,
}

impl<P: ControlPipe> CarefulPipe<P> {
    /// Until the driver has taken a request, all that it has to receive or to send is older than this request. No
    /// interrupt may bring anything in between; the driver's futures hold nothing, so that new ones go on where it was.
    fn look_for_request(&mut self, context: &mut Context<'_>) -> Poll<[u8; 8]> {
        cortex_m::interrupt::free(|_| {
            let request = pin!(self.pipe.setup()).poll(context);
            if request.is_ready() {
                let _ = poll_once(self.pipe.data_out(&mut [0; PACKET], true, true));
                usb_recovery::take_back(0);
            }
            request
        })
    }

    /// Looks until something is done, or another request has come in its place.
    async fn unless_given_up<T>(
        &mut self,
        mut look: impl FnMut(&mut P, &mut Context<'_>) -> Poll<Result<T, EndpointError>>,
    ) -> Result<T, EndpointError> {
        poll_fn(|context| match look(&mut self.pipe, context) {
            Poll::Pending => self.look_for_request(context).map(|request| {
                usb_recovery::put_off(request);
                Err(EndpointError::Disabled)
            }),
            done => done,
        })
        .await
    }

    async fn next_request(&mut self) -> [u8; 8] {
        match usb_recovery::was_put_off() {
            Some(request) => request,
            None => poll_fn(|context| self.look_for_request(context)).await,
        }
    }
}

impl<P: ControlPipe> ControlPipe for CarefulPipe<P> {
    fn max_packet_size(&self) -> usize {
        self.pipe.max_packet_size()
    }

    async fn setup(&mut self) -> [u8; 8] {
        loop {
            let request = self.next_request().await;
            let [kind, _, _, _, address, _, length @ ..] = request;
            if kind & RECIPIENT == ENDPOINT && !self.known.has(address) {
                self.pipe.reject().await;
            } else if kind & ASKS != 0 && length == [0, 0] {
                self.pipe.accept().await;
            } else {
                return request;
            }
        }
    }

    async fn data_out(&mut self, bytes: &mut [u8], first: bool, last: bool) -> Result<usize, EndpointError> {
        self.unless_given_up(|pipe, context| pin!(pipe.data_out(bytes, first, last)).poll(context)).await
    }

    async fn data_in(&mut self, bytes: &[u8], first: bool, last: bool) -> Result<(), EndpointError> {
        self.unless_given_up(|pipe, context| pin!(pipe.data_in(bytes, first, false)).poll(context)).await?;
        if last {
            // The PC says by an empty packet that it has everything.
            self.data_out(&mut [], first, last).await?;
        }
        Ok(())
    }

    async fn accept(&mut self) {
        self.pipe.accept().await;
    }

    async fn reject(&mut self) {
        self.pipe.reject().await;
    }

    async fn accept_set_address(&mut self, address: u8) {
        self.pipe.accept_set_address(address).await;
    }
}
