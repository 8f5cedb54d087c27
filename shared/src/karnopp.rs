//! The Karnopp rule: does the pendulum slide, creep through the velocity band, or rest?
//!
//! Source: D. Karnopp, J. Dyn. Sys. Meas. Control 107 (1985) 100; paper, Eq 14, with the physical sign (friction
//! balances gravity; the paper's own sign is in [`crate::paper`]).
//!
//! - **Sliding**, |ω| ≥ DV: viscous, Coulomb and the added frictions act against the direction of sliding.
//! - **Band**, |ω| < DV: only the breakaway torque acts, against the drive (gravity, springs). It is Ms, or the
//!   friction at the band's edge if that is larger, so that a pendulum which breaks away also gets out of the band.
//! - **Rest**: the drive does not exceed the breakaway torque, the velocity is zero.
//!
//! With DV = 0 the band has no width: the pendulum rests or turns round at once.

use crate::real::{Mask, Real};

/// Which of the three a pendulum is in. Numbers instead of an enum, so that several lanes can differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<R> {
    /// Direction of sliding: −1, +1, or 0 if it does not slide.
    pub(crate) slide: R,
    /// Direction of the drive in the band: −1, +1, or 0 outside the band and at rest.
    pub(crate) push: R,
    /// The breakaway torque that acts in the band, N·m.
    pub(crate) level_nm: R,
}

impl<R: Real> Contact<R> {
    pub(crate) fn sliding(direction: R) -> Self {
        Self { slide: direction, push: R::zero(), level_nm: R::zero() }
    }

    /// True where the pendulum slides.
    pub fn is_sliding(&self) -> R::Mask {
        R::zero().lt(self.slide.abs())
    }

    /// True where it creeps through the velocity band.
    pub fn is_in_band(&self) -> R::Mask {
        R::zero().lt(self.push.abs())
    }

    /// True where it rests.
    pub fn is_resting(&self) -> R::Mask {
        self.is_sliding().or(self.is_in_band()).not()
    }

    pub(crate) fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            slide: R::select(mask, yes.slide, no.slide),
            push: R::select(mask, yes.push, no.push),
            level_nm: R::select(mask, yes.level_nm, no.level_nm),
        }
    }
}

/// The torques that decide, at an instant with |ω| ≤ DV, all in N·m.
pub(crate) struct Balance<R> {
    /// Gravity, springs, magnets: what would move the pendulum.
    pub(crate) drive_nm: R,
    /// The most that friction holds against a positive drive.
    pub(crate) hold_positive_nm: R,
    /// The most that friction holds against a negative drive, as a positive number.
    pub(crate) hold_negative_nm: R,
    /// DV in rad/s.
    pub(crate) velocity_band: R,
}

impl<R: Real> Balance<R> {
    /// True where friction holds the drive.
    pub(crate) fn holds(&self) -> R::Mask {
        self.drive_nm.le(self.hold_positive_nm).and((-self.drive_nm).le(self.hold_negative_nm))
    }

    /// Rest, band or (with DV = 0) sliding.
    pub(crate) fn contact(&self) -> Contact<R> {
        let positive = R::zero().lt(self.drive_nm);
        let push = self.drive_nm.sign();
        let level_nm = R::select(positive, self.hold_positive_nm, self.hold_negative_nm);
        let rest = Contact { slide: R::zero(), push: R::zero(), level_nm };
        let band = Contact { slide: R::zero(), push, level_nm };
        let has_band = R::zero().lt(self.velocity_band);
        Contact::select(self.holds(), rest, Contact::select(has_band, band, Contact::sliding(push)))
    }
}
