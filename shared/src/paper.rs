//! The paper's own simulation, only for reproducing its tables; the product's model is [`crate::model`].
//!
//! Two things differ from physics. Inside the band |ω| < DV the published tables need Me = +m·g·l·sin θ in Eq 14, so
//! that stiction adds to gravity; and once |m·g·l·sin θ| ≤ Ms there, ω is set to zero for good. The step is the plain
//! Runge–Kutta step, not cut at the band's edges.

use crate::parameters::{Parameters, base};
use crate::real::{Mask, Real};
use crate::rk4::{self, Phase};

/// The paper's pendulum in motion.
#[derive(Clone, Debug)]
pub struct PaperSimulation<R> {
    gravity_nm: R,
    inverse_inertia: R,
    viscous: R,
    coulomb_nm: R,
    stiction_nm: R,
    velocity_band: R,
    phase: Phase<R>,
    stopped: bool,
}

impl<R: Real> PaperSimulation<R> {
    /// Released at rest from an angle in rad.
    pub fn release(parameters: &Parameters<R>, angle_rad: R) -> Self {
        let value = |id, index: usize| parameters.values(id).and_then(|v| v.get(index)).copied().unwrap_or(R::zero());
        Self {
            gravity_nm: parameters.pendulum.gravity_torque_nm(),
            inverse_inertia: R::one() / parameters.pendulum.pivot_inertia_kg_m2(),
            viscous: value(base::VISCOUS, 0),
            coulomb_nm: value(base::COULOMB, 0),
            stiction_nm: value(base::STICTION, 0),
            velocity_band: value(base::STICTION, 1),
            phase: Phase { angle: angle_rad, velocity: R::zero() },
            stopped: false,
        }
    }

    /// θ in rad.
    pub fn angle_rad(&self) -> R {
        self.phase.angle
    }

    /// ω in rad/s.
    pub fn velocity_rad_s(&self) -> R {
        self.phase.velocity
    }

    /// Advances by `dt_s` seconds.
    pub fn step(&mut self, dt_s: R) {
        if self.stopped {
            return;
        }
        self.phase = rk4::step(|angle, velocity, _| self.acceleration(angle, velocity), self.phase, R::zero(), dt_s);
        let slow = self.phase.velocity.abs().lt(self.velocity_band);
        let held = (self.gravity_nm * self.phase.angle.sin()).abs().le(self.stiction_nm);
        if slow.and(held).all() {
            self.phase.velocity = R::zero();
            self.stopped = true;
        }
    }

    fn acceleration(&self, angle: R, velocity: R) -> R {
        let gravity = self.gravity_nm * angle.sin();
        let sliding = self.viscous * velocity + self.coulomb_nm * velocity.sign();
        let sticking = gravity.max(-self.stiction_nm).min(self.stiction_nm);
        let friction = R::select(velocity.abs().lt(self.velocity_band), sticking, sliding);
        -(friction + gravity) * self.inverse_inertia
    }
}
