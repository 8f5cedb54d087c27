//! The looks that the simulated rig makes by itself, as a board does: it keeps releases while somebody records, and
//! looks when it is asked what it found.

use shared::bank::findings::Room;
use shared::bank::keeper::Keeper;
use shared::bank::order::Order;
use shared::bank::tape::Tape;
use shared::rig::Rig;
use shared::units::Code;
use shared::wire::Suspects;

/// What is kept, what is to be looked at, and what was found last.
pub(super) struct Looks {
    tape: Box<Tape>,
    keeper: Keeper,
    order: Option<Order>,
    found: Suspects,
    /// [`Rig::n_models`] of the model that was looked at last.
    n_models: u32,
}

impl Looks {
    /// Of a rig that was just switched on.
    pub(super) fn new(rig: &Rig) -> Self {
        Self {
            tape: Box::new(Tape::new()),
            keeper: keeper(rig),
            order: None,
            found: Suspects::none(),
            n_models: rig.n_models(),
        }
    }

    /// Takes a sample; when a release has ended with it, there is something to look at.
    pub(super) fn take(&mut self, code: Code, rig: &Rig) {
        if self.keeper.take(code, &self.tape) {
            self.order(rig);
        }
    }

    /// A model that was changed is looked at anew; releases that were measured otherwise are forgotten.
    pub(super) fn notice_changes(&mut self, rig: &Rig) {
        let settings = rig.settings();
        let is_measured_alike = self.keeper.is_for(settings.rate_hz, &settings.sensor);
        if is_measured_alike && self.n_models == rig.n_models() {
            return;
        }
        self.n_models = rig.n_models();
        self.order = None;
        self.found = Suspects { n_looks: self.found.n_looks, ..Suspects::none() };
        if is_measured_alike {
            self.order(rig);
        } else {
            self.keeper = keeper(rig);
        }
    }

    /// Looks, if there is something to look at, and says what was found last.
    pub(super) fn answer(&mut self) -> Suspects {
        let found = self.order.take().and_then(|order| order.carry_out(&self.tape, &mut Room::empty(0.0)));
        if let Some(found) = found {
            self.found = Suspects { n_looks: self.found.n_looks + 1, ..found };
        }
        self.found.clone()
    }

    fn order(&mut self, rig: &Rig) {
        let releases = self.keeper.releases(&self.tape);
        let (interval_s, radian_per_step) = (self.keeper.interval_s(), self.keeper.radian_per_step());
        let order = Order { parameters: rig.parameters().clone(), radian_per_step, interval_s, releases };
        self.order = (!order.releases.is_empty()).then_some(order);
    }
}

fn keeper(rig: &Rig) -> Keeper {
    Keeper::new(rig.settings().rate_hz, rig.settings().sensor)
}
