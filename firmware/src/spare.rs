//! What the processor does when nothing else is to be done: it looks at the last releases for what the model lacks.
//!
//! The application leaves an order here and goes on; whoever has time takes it, and is interrupted by everything else.
//! While somebody records, orders wait: the processor is then left to the recording, until what was found is asked for.

use core::cell::RefCell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use shared::bank::findings::Room;
use shared::bank::order::Order;
use shared::bank::tape::Tape;
use shared::wire::Suspects;

/// The tape, and between the two sides a desk.
pub struct Spare<M: RawMutex> {
    /// On its own, so that all of it is zero and takes no flash.
    tape: &'static Tape,
    desk: Mutex<M, RefCell<Desk>>,
}

struct Desk {
    order: Option<Order>,
    /// Orders wait.
    is_held: bool,
    found: Suspects,
    is_busy: bool,
    /// The model has changed since the look began that goes on.
    is_stale: bool,
}

impl<M: RawMutex> Spare<M> {
    /// With this tape, and nothing to do yet.
    pub const fn new(tape: &'static Tape) -> Self {
        let desk = Desk { order: None, is_held: false, found: Suspects::none(), is_busy: false, is_stale: false };
        Self { tape, desk: Mutex::new(RefCell::new(desk)) }
    }

    /// The releases.
    pub fn tape(&self) -> &'static Tape {
        self.tape
    }

    /// To be done next, instead of what was to be done.
    pub fn order(&self, order: Order) {
        self.desk.lock(|desk| desk.borrow_mut().order = Some(order));
    }

    /// Lets orders wait, or not any longer. One that is being carried out goes on.
    pub fn hold(&self, is_held: bool) {
        self.desk.lock(|desk| desk.borrow_mut().is_held = is_held);
    }

    /// What was found is of another model, and so is what is being looked for.
    pub fn forget(&self) {
        self.desk.lock(|desk| {
            let mut desk = desk.borrow_mut();
            desk.found = Suspects { n_looks: desk.found.n_looks, ..Suspects::none() };
            (desk.order, desk.is_stale) = (None, true);
        });
    }

    /// What was found last.
    pub fn found(&self) -> Suspects {
        self.desk.lock(|desk| {
            let desk = desk.borrow();
            Suspects { is_looking: desk.is_busy || desk.order.is_some(), ..desk.found.clone() }
        })
    }

    /// Is there an order that is carried out, or will be as soon as there is time?
    pub fn is_wanted(&self) -> bool {
        self.desk.lock(|desk| {
            let desk = desk.borrow();
            desk.is_busy || desk.order.is_some() && !desk.is_held
        })
    }

    /// Is something named?
    pub fn names(&self) -> bool {
        self.desk.lock(|desk| desk.borrow().found.names())
    }

    /// Carries an order out in this room, if there is one. `cycles` counts what it takes, on a counter that comes round.
    /// Never inlined: whoever sleeps between two orders needs no stack for them.
    #[inline(never)]
    pub fn work(&self, room: &mut Room<f32>, cycles: impl Fn() -> u64) -> bool {
        let Some(order) = self.desk.lock(|desk| desk.borrow_mut().take()) else { return false };
        let began = cycles();
        let found = order.carry_out(self.tape, room);
        let took = cycles().wrapping_sub(began);
        self.desk.lock(|desk| desk.borrow_mut().put(found, took));
        true
    }
}

impl Desk {
    fn take(&mut self) -> Option<Order> {
        if self.is_held {
            return None;
        }
        let order = self.order.take()?;
        (self.is_busy, self.is_stale) = (true, false);
        Some(order)
    }

    fn put(&mut self, found: Option<Suspects>, cycles: u64) {
        self.is_busy = false;
        if let (Some(found), false) = (found, self.is_stale) {
            self.found = Suspects { n_looks: self.found.n_looks + 1, cycles, ..found };
        }
    }
}
