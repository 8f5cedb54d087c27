//! An integrator that shares no code with the product: Dormand and Prince's fifth-order formula in steps of 0.1 ms,
//! regime changes located by bisection, the platform's sine. The physics it integrates is the product's: gravity,
//! viscous and Coulomb friction, Karnopp's band with the physical sign.
//! Source: J. R. Dormand, P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19.

use shared::parameters::{Parameters, base};

/// Steps of 0.1 ms leave a local error below rounding on a pendulum of 1 Hz.
const STEP_S: f64 = 1e-4;

/// Torque of an added law: angle, velocity, direction of sliding.
pub(crate) type Law = fn(f64, f64, f64) -> f64;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Regime {
    Sliding { direction: f64 },
    Band { push: f64, level_nm: f64 },
    Rest,
}

/// A pendulum in motion.
#[derive(Clone)]
pub(crate) struct Reference {
    pub(crate) angle_rad: f64,
    pub(crate) velocity_rad_s: f64,
    regime: Regime,
    gravity_nm: f64,
    inertia: f64,
    viscous: f64,
    coulomb_nm: f64,
    stiction_nm: f64,
    band: f64,
    law: Law,
}

impl Reference {
    /// Lets it go; `law` is an added torque that acts while sliding.
    pub(crate) fn release(parameters: &Parameters<f64>, law: Option<Law>, angle_rad: f64, velocity_rad_s: f64) -> Self {
        let value = |id, index: usize| parameters.values(id).map_or(0.0, |values| values[index]);
        let p = &parameters.pendulum;
        let mut reference = Self {
            angle_rad,
            velocity_rad_s,
            regime: Regime::Rest,
            gravity_nm: p.mass_kg * p.gravity_m_s2 * p.length_m,
            inertia: p.mass_kg * p.length_m.powi(2) + p.inertia_kg_m2,
            viscous: value(base::VISCOUS, 0),
            coulomb_nm: value(base::COULOMB, 0),
            stiction_nm: value(base::STICTION, 0),
            band: value(base::STICTION, 1),
            law: law.unwrap_or(|_, _, _| 0.0),
        };
        if velocity_rad_s != 0.0 && velocity_rad_s.abs() >= reference.band {
            reference.regime = Regime::Sliding { direction: velocity_rad_s.signum() };
        } else {
            reference.settle();
        }
        reference
    }

    pub(crate) fn advance(&mut self, seconds: f64) {
        let mut left = seconds;
        while left > 0.0 && self.regime != Regime::Rest {
            let h = left.min(STEP_S);
            let end = self.stepped(h);
            if self.lasts(end) {
                (self.angle_rad, self.velocity_rad_s) = end;
                left -= h;
            } else {
                left -= self.advance_to_change(h);
            }
        }
    }

    /// Bisects for the end of the regime within `h` and enters the next one; returns the time that took.
    fn advance_to_change(&mut self, h: f64) -> f64 {
        let (mut lasting, mut over) = (0.0, h);
        for _ in 0..60 {
            let middle = 0.5 * (lasting + over);
            if self.lasts(self.stepped(middle)) { lasting = middle } else { over = middle }
        }
        (self.angle_rad, self.velocity_rad_s) = self.stepped(over);
        match self.regime {
            Regime::Band { .. } if self.velocity_rad_s.abs() > self.band => {
                self.regime = Regime::Sliding { direction: self.velocity_rad_s.signum() };
            }
            Regime::Band { .. } => {
                self.regime = Regime::Rest;
                self.velocity_rad_s = 0.0;
            }
            Regime::Sliding { .. } => self.settle(),
            Regime::Rest => {}
        }
        over
    }

    fn lasts(&self, (angle, velocity): (f64, f64)) -> bool {
        match self.regime {
            Regime::Sliding { direction } => direction * velocity >= self.band,
            Regime::Band { push, level_nm } => {
                velocity.abs() <= self.band && -push * self.gravity_nm * angle.sin() >= level_nm
            }
            Regime::Rest => true,
        }
    }

    /// Inside the band: does friction hold?
    fn settle(&mut self) {
        let drive = -self.gravity_nm * self.angle_rad.sin();
        let direction = if drive < 0.0 { -1.0 } else { 1.0 };
        let edge_friction = -direction * self.friction_nm(self.angle_rad, direction * self.band, direction);
        let level_nm = self.stiction_nm.max(edge_friction);
        self.regime = if drive.abs() <= level_nm {
            self.velocity_rad_s = 0.0;
            Regime::Rest
        } else if self.band > 0.0 {
            Regime::Band { push: direction, level_nm }
        } else {
            Regime::Sliding { direction }
        };
    }

    fn friction_nm(&self, angle: f64, velocity: f64, direction: f64) -> f64 {
        -self.viscous * velocity - self.coulomb_nm * direction + (self.law)(angle, velocity, direction)
    }

    fn acceleration(&self, angle: f64, velocity: f64) -> f64 {
        let friction = match self.regime {
            Regime::Sliding { direction } => self.friction_nm(angle, velocity, direction),
            Regime::Band { push, level_nm } => -push * level_nm,
            Regime::Rest => return 0.0,
        };
        (friction - self.gravity_nm * angle.sin()) / self.inertia
    }

    /// Angle and velocity after `h` in the present regime.
    fn stepped(&self, h: f64) -> (f64, f64) {
        const STAGES: [&[f64]; 6] = [
            &[],
            &[1.0 / 5.0],
            &[3.0 / 40.0, 9.0 / 40.0],
            &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
            &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
            &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
        ];
        const WEIGHTS: [f64; 6] = [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0];
        let mut slopes = [(0.0, 0.0); 6];
        let moved = |weights: &[f64], slopes: &[(f64, f64); 6]| {
            let (mut angle, mut velocity) = (self.angle_rad, self.velocity_rad_s);
            // Where tests are hardly optimised, iterators cost more than the physics.
            let mut i = 0;
            while i < weights.len() {
                angle += h * weights[i] * slopes[i].0;
                velocity += h * weights[i] * slopes[i].1;
                i += 1;
            }
            (angle, velocity)
        };
        for (i, weights) in STAGES.iter().enumerate() {
            let (angle, velocity) = moved(weights, &slopes);
            slopes[i] = (velocity, self.acceleration(angle, velocity));
        }
        moved(&WEIGHTS, &slopes)
    }
}
