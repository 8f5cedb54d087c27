//! What a physical effect may read, and the pendulum's fixed quantities.

use crate::real::Real;
use serde::{Deserialize, Serialize};

/// g where nobody tells it, m/s²: the paper's (Table 1), and that of the middle latitudes to 0.1 %.
pub const GRAVITY_M_S2: f64 = 9.81;

/// The rigid pendulum (paper, Table 1).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pendulum<R> {
    /// m: mass in kg, positive.
    pub mass_kg: R,
    /// l: distance from pivot to centre of mass in m, positive.
    pub length_m: R,
    /// I: moment of inertia about the centre of mass in kg·m², not negative.
    pub inertia_kg_m2: R,
    /// g: gravitational acceleration in m/s², positive.
    pub gravity_m_s2: R,
}

impl<R: Copy> Pendulum<R> {
    /// One number everywhere.
    pub(crate) const fn all(number: R) -> Self {
        Self { mass_kg: number, length_m: number, inertia_kg_m2: number, gravity_m_s2: number }
    }
}

impl<R: Real> Pendulum<R> {
    /// The paper's pendulum (Table 1), its inertia that of the CAD drawing.
    pub fn paper() -> Self {
        Self {
            mass_kg: R::of(0.146_608_4),
            length_m: R::of(0.156_217_7),
            inertia_kg_m2: R::of(0.002_842_52),
            gravity_m_s2: R::of(GRAVITY_M_S2),
        }
    }
    /// m·l² + I: moment of inertia about the pivot in kg·m².
    pub fn pivot_inertia_kg_m2(&self) -> R {
        self.mass_kg * self.length_m * self.length_m + self.inertia_kg_m2
    }
    /// m·g·l: the torque of gravity on the horizontal pendulum in N·m.
    pub fn gravity_torque_nm(&self) -> R {
        self.mass_kg * self.gravity_m_s2 * self.length_m
    }
    /// |m·(g·cos θ + l·ω²)|: the force of the rod on the bearing, along the rod, in N.
    pub fn bearing_load_n(&self, angle_rad: R, velocity_rad_s: R) -> R {
        let centripetal = self.length_m * velocity_rad_s * velocity_rad_s;
        (self.mass_kg * (self.gravity_m_s2 * angle_rad.cos() + centripetal)).abs()
    }
}

/// One instant of the motion, as an effect sees it.
#[derive(Clone, Copy, Debug)]
pub struct Motion<R> {
    /// θ in rad.
    pub angle_rad: R,
    /// ω in rad/s.
    pub velocity_rad_s: R,
    /// The direction of sliding, −1 or +1; constant between two reversals even where ω passes zero within rounding.
    /// Dry friction opposes it. Zero while the pendulum does not slide.
    pub direction: R,
    /// Seconds since the release.
    pub time_s: R,
    /// The pendulum that moves.
    pub pendulum: Pendulum<R>,
}

impl<R: Real> Motion<R> {
    /// Force on the bearing along the rod, in N.
    pub fn load_n(&self) -> R {
        self.pendulum.bearing_load_n(self.angle_rad, self.velocity_rad_s)
    }
}
