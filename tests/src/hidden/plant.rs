//! The pendulum itself: an integrator that shares no code with the product.
//!
//! Runge and Kutta's fourth-order steps with the platform's sine, short enough for what is hidden; dry friction as a set: the direction
//! of sliding is fixed within a step, the end of sliding is located by bisection, and there the balance of torques
//! decides between rest and sliding back. A velocity band (D. Karnopp, J. Dyn. Sys. Meas. Control 107 (1985) 100) is
//! there only where a rig has one. Pre-sliding and the yielding support are integrated as states of their own; the
//! support rings on while the bearing sticks, and shakes what it holds.

use super::listed::Listed;
use super::{Rig, Shapes};

/// No step is longer, s: whatever is hidden, a bristle or a support that rings is followed.
const STEP_S: f64 = 2e-4;

/// Hidden torques that change no faster than the pendulum swings, and sensors that only scale: with these, and with
/// nothing hidden, so many steps a period are enough. They are 1e-9 rad off; 2e-7 with a load that turns round where the
/// pendulum hangs (gear-load).
const SMOOTH: [&str; 12] = [
    "quadratic-drag",
    "power-law-drag",
    "stribeck",
    "load-dependent-coulomb",
    "asymmetric-coulomb",
    "asymmetric-viscous",
    "angle-dependent-friction",
    "eddy-brake",
    "drifting-friction",
    "torsional-spring",
    "angle-offset",
    "sensor-gain",
];
const STEPS_A_PERIOD: f64 = 1000.0;

/// Halvings of a step in search of its end of sliding: to the last digit.
const HALVINGS: usize = 48;

/// The support's own mass and damping, as shares of the bob's mass and of critical damping.
const SUPPORT_MASS: f64 = 0.2;
const SUPPORT_DAMPING: f64 = 0.05;

/// θ, ω, deflection of the bristle, position and speed of the support.
type Phase = [f64; 5];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Regime {
    Sliding { direction: f64 },
    Band { push: f64, level_nm: f64 },
    Rest,
}

/// A pendulum in motion.
pub(super) struct Plant<'a> {
    rig: &'a Rig,
    phase: Phase,
    time_s: f64,
    regime: Regime,
    gravity_nm: f64,
    inertia: f64,
    law: Laws,
    shapes: Shapes,
    support: Option<Support>,
    listed: Listed,
    longest_step_s: f64,
}

/// What holds the bearing, where it gives way sideways: moved mass with the bob's, spring, dashpot.
struct Support {
    mass_kg: f64,
    stiffness: f64,
    damping: f64,
}

impl Support {
    fn of(rig: &Rig, gravity_nm: f64, inertia: f64) -> Option<Self> {
        let (mass_kg, stiffness) = if let Some(stiff) = rig.hidden("pivot-compliance") {
            (rig.mass_kg * (1.0 + SUPPORT_MASS), 1.0 / stiff.size)
        } else {
            let soft = rig.hidden("resonant-support")?;
            let mass_kg = rig.mass_kg / soft.size;
            (mass_kg, mass_kg * soft.shape[0].powi(2) * gravity_nm / inertia)
        };
        Some(Self { mass_kg, stiffness, damping: 2.0 * SUPPORT_DAMPING * (stiffness * mass_kg).sqrt() })
    }
}

/// Size and shape numbers of all hidden torques; zero where there is none.
struct Laws {
    quadratic: f64,
    power: [f64; 2],
    thinning: [f64; 2],
    stribeck: [f64; 2],
    load: f64,
    gears: f64,
    asymmetric: f64,
    asymmetric_viscous: f64,
    angle_friction: [f64; 3],
    brake: [f64; 3],
    outside: [f64; 3],
    bump: [f64; 3],
    drift: [f64; 3],
    spring: [f64; 2],
    detent: [f64; 3],
    bristle_rad: f64,
}

impl Laws {
    fn of(rig: &Rig) -> Self {
        let three = |name: &str| rig.hidden(name).map_or([0.0; 3], |h| [h.size, h.shape[0], h.shape[1]]);
        let two = |name: &str| [three(name)[0], three(name)[1]];
        let one = |name: &str| three(name)[0];
        Self {
            quadratic: one("quadratic-drag"),
            power: two("power-law-drag"),
            thinning: two("shear-thinning"),
            stribeck: two("stribeck"),
            load: one("load-dependent-coulomb"),
            gears: one("gear-load"),
            asymmetric: one("asymmetric-coulomb"),
            asymmetric_viscous: one("asymmetric-viscous"),
            angle_friction: three("angle-dependent-friction"),
            brake: three("eddy-brake"),
            outside: three("outside"),
            bump: three("bump"),
            drift: three("drifting-friction"),
            spring: two("torsional-spring"),
            detent: three("detent"),
            bristle_rad: one("presliding"),
        }
    }
}

/// By what is hidden and how long the pendulum takes for a radian of its phase.
fn longest_step_s(rig: &Rig, radian_s: f64) -> f64 {
    let is_smooth = rig.hidden.iter().all(|hidden| !hidden.is_listed && SMOOTH.contains(&hidden.name));
    if is_smooth { std::f64::consts::TAU * radian_s / STEPS_A_PERIOD } else { STEP_S }
}

impl<'a> Plant<'a> {
    /// Lets a rig go at rest from an angle, time zero.
    pub(super) fn release(rig: &'a Rig, angle_rad: f64) -> Self {
        let gravity_nm = rig.mass_kg * rig.gravity_m_s2 * rig.length_m;
        let inertia = rig.mass_kg * rig.length_m.powi(2) + rig.inertia_kg_m2;
        let phase = [angle_rad, 0.0, 0.0, 0.0, 0.0];
        let law = Laws::of(rig);
        let listed = Listed::held(rig, angle_rad);
        let (shapes, support) = (Shapes::of(rig), Support::of(rig, gravity_nm, inertia));
        let (time_s, regime) = (0.0, Regime::Rest);
        let longest_step_s = longest_step_s(rig, (inertia / gravity_nm).sqrt());
        let mut plant =
            Self { rig, phase, time_s, regime, gravity_nm, inertia, law, shapes, support, listed, longest_step_s };
        plant.settle();
        plant
    }

    /// The range of the bristle, 0 where there is none.
    fn bristle_rad(&self) -> f64 {
        self.law.bristle_rad + self.shapes.bristle_rad()
    }

    /// Angle and velocity, and the time since the release.
    pub(super) fn motion(&self) -> ([f64; 2], f64) {
        ([self.phase[0], self.phase[1]], self.time_s)
    }

    /// Takes a step that ended here.
    fn go_to(&mut self, end: Phase, step_s: f64) {
        let from = self.motion();
        (self.phase, self.time_s) = (end, self.time_s + step_s);
        if let Regime::Sliding { direction } = self.regime {
            self.listed.advance(from, self.motion(), direction);
        }
    }

    pub(super) fn rests(&self) -> bool {
        let still = self.phase[1].abs() < 1e-3 && self.held_nm(&self.phase).abs() < 1e-5;
        self.regime == Regime::Rest || (self.bristle_rad() > 0.0 && still)
    }

    /// So many steps take it through a time.
    pub(super) fn n_steps(&self, seconds: f64) -> usize {
        // The tolerance keeps an interval in as many steps as it holds, although it may be an ulp longer.
        (seconds / self.longest_step_s - 1e-6).ceil().max(0.0) as usize
    }

    /// Takes one step.
    pub(super) fn advance(&mut self, seconds: f64) {
        let mut left_s = seconds;
        for _ in 0..50 {
            if self.regime == Regime::Rest {
                self.phase = self.stepped(left_s);
                self.time_s += left_s;
                self.settle();
                return;
            }
            let end = self.stepped(left_s);
            if self.lasts(&end) {
                self.go_to(end, left_s);
                return;
            }
            left_s -= self.advance_to_change(left_s);
        }
    }

    fn advance_to_change(&mut self, step_s: f64) -> f64 {
        let (mut lasting, mut over) = (0.0, step_s);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (lasting + over);
            if self.lasts(&self.stepped(middle)) { lasting = middle } else { over = middle }
        }
        self.go_to(self.stepped(over), over);
        match self.regime {
            Regime::Band { .. } if self.phase[1].abs() > self.rig.velocity_band => {
                self.regime = Regime::Sliding { direction: self.phase[1].signum() };
            }
            Regime::Band { .. } => self.stop(),
            _ => self.settle(),
        }
        over
    }

    fn stop(&mut self) {
        self.regime = Regime::Rest;
        self.phase[1] = 0.0;
    }

    fn lasts(&self, phase: &Phase) -> bool {
        match self.regime {
            Regime::Sliding { direction } => direction * phase[1] >= self.rig.velocity_band,
            Regime::Band { push, level_nm } => {
                phase[1].abs() <= self.rig.velocity_band && push * self.held_nm(phase) >= level_nm
            }
            Regime::Rest => true,
        }
    }

    /// Slow enough to stick: does friction hold?
    fn settle(&mut self) {
        let drive = self.held_nm(&self.phase);
        let direction = if drive < 0.0 { -1.0 } else { 1.0 };
        let [angle, ..] = self.phase;
        let edge = direction * self.rig.velocity_band;
        let sliding = -direction * self.friction_nm(angle, edge, direction, self.time_s);
        let level_nm = sliding.max(if self.bristle_rad() > 0.0 { 0.0 } else { self.rig.stiction_nm });
        if drive.abs() <= level_nm {
            self.stop();
        } else if self.rig.velocity_band > 0.0 {
            self.regime = Regime::Band { push: direction, level_nm };
        } else {
            self.regime = Regime::Sliding { direction };
            self.phase[1] = 0.0;
        }
    }

    /// What the bearing has to hold if the pendulum is not to turn: all that acts at rest, and the support's shaking.
    fn held_nm(&self, phase: &Phase) -> f64 {
        let Some(stand) = &self.support else { return self.drive_nm(phase) };
        let coupling = self.rig.mass_kg * self.rig.length_m * phase[0].cos();
        self.drive_nm(phase) - coupling * self.shaken(stand, phase) / stand.mass_kg
    }

    /// The force that moves the support of a pendulum which turns evenly, N.
    fn shaken(&self, stand: &Support, phase: &Phase) -> f64 {
        let [angle, velocity, _, support, support_speed] = *phase;
        let moment = self.rig.mass_kg * self.rig.length_m;
        moment * angle.sin() * velocity * velocity - stand.stiffness * support - stand.damping * support_speed
    }

    /// What acts at rest too.
    fn drive_nm(&self, phase: &Phase) -> f64 {
        let [angle, _, bristle, ..] = *phase;
        let law = &self.law;
        let spring = -law.spring[0] * (angle - law.spring[1]);
        let detent = match law.detent[0] {
            0.0 => 0.0,
            height => height * (law.detent[1] * angle + law.detent[2]).sin(),
        };
        let held = if self.bristle_rad() > 0.0 { -self.rig.coulomb_nm * bristle / self.bristle_rad() } else { 0.0 };
        let listed = self.listed.drive_nm([angle, phase[1]], self.time_s);
        -self.gravity_nm * angle.sin() + spring + detent + held + listed + self.shapes.drive_nm(angle)
    }

    fn friction_nm(&self, angle: f64, velocity: f64, direction: f64, time_s: f64) -> f64 {
        let (rig, law) = (self.rig, &self.law);
        let drift = if law.drift[0] == 0.0 { 0.0 } else { law.drift[0] * (-time_s / law.drift[1]).exp() };
        let mut dry = if self.bristle_rad() > 0.0 { 0.0 } else { rig.coulomb_nm * (1.0 + drift) };
        dry += self.shapes.dry_nm(angle, velocity, time_s);
        if law.stribeck[0] != 0.0 {
            dry += law.stribeck[0] * (-(velocity / law.stribeck[1]).powi(2)).exp();
        }
        if law.load != 0.0 {
            dry += law.load * rig.mass_kg * (rig.gravity_m_s2 * angle.cos() + rig.length_m * velocity * velocity).abs();
        }
        // What gravity turns a gear train with is the load of its teeth.
        if law.gears != 0.0 {
            dry += law.gears * self.gravity_nm * angle.sin().abs();
        }
        if law.angle_friction[0] != 0.0 {
            dry += law.angle_friction[0] * (law.angle_friction[1] * angle + law.angle_friction[2]).cos();
        }
        dry += law.asymmetric * direction;
        let mut smooth = rig.viscous * (1.0 + law.drift[2] * drift) * velocity;
        smooth += law.quadratic * velocity * velocity.abs() + law.asymmetric_viscous * velocity.abs();
        if law.power[0] != 0.0 {
            smooth += law.power[0] * velocity.abs().powf(law.power[1]) * velocity.signum();
        }
        if law.thinning[0] != 0.0 {
            smooth += law.thinning[0] * velocity / velocity.hypot(law.thinning[1]);
        }
        if law.brake[0] != 0.0 {
            smooth += law.brake[0] * velocity * (-((angle - law.brake[1]) / law.brake[2]).powi(2)).exp();
        }
        smooth += self.shapes.smooth_nm(angle, velocity, time_s);
        if law.bump[0] != 0.0 {
            dry += law.bump[0] * (-((velocity.abs() - law.bump[1]) / law.bump[2]).powi(2)).exp();
        }
        if law.outside[0] != 0.0 {
            smooth += law.outside[0] * velocity * (-((angle.abs() - law.outside[1]) / law.outside[2]).powi(2)).exp();
        }
        -dry * direction - smooth + self.listed.friction_nm([angle, velocity], direction, time_s)
    }

    fn slope(&self, phase: &Phase, time_s: f64) -> Phase {
        let [angle, velocity, bristle, _, support_speed] = *phase;
        let torque = match self.regime {
            Regime::Sliding { direction } => {
                self.drive_nm(phase) + self.friction_nm(angle, velocity, direction, time_s)
            }
            Regime::Band { push, level_nm } => self.drive_nm(phase) - push * level_nm,
            Regime::Rest => {
                let shift = self.support.as_ref().map_or(0.0, |stand| self.shaken(stand, phase) / stand.mass_kg);
                return [0.0, 0.0, 0.0, support_speed, shift];
            }
        };
        let bending = match self.bristle_rad() {
            0.0 => 0.0,
            range => velocity * self.shapes.bristle_gives(velocity.signum() * bristle / range),
        };
        let Some(stand) = &self.support else {
            return [velocity, torque / self.inertia, bending, 0.0, 0.0];
        };
        // Two bodies: M·x″ + m·l·cos θ·θ″ = m·l·sin θ·ω² − k·x − d·x′; m·l·cos θ·x″ + J·θ″ = torque.
        let force = self.shaken(stand, phase);
        let coupling = self.rig.mass_kg * self.rig.length_m * angle.cos();
        let determinant = stand.mass_kg * self.inertia - coupling * coupling;
        let turning = (stand.mass_kg * torque - coupling * force) / determinant;
        let shift = (self.inertia * force - coupling * torque) / determinant;
        [velocity, turning, bending, support_speed, shift]
    }

    fn stepped(&self, step_s: f64) -> Phase {
        let moved = |slope: &Phase, by: f64| -> Phase { std::array::from_fn(|i| self.phase[i] + by * slope[i]) };
        let k1 = self.slope(&self.phase, self.time_s);
        let k2 = self.slope(&moved(&k1, 0.5 * step_s), self.time_s + 0.5 * step_s);
        let k3 = self.slope(&moved(&k2, 0.5 * step_s), self.time_s + 0.5 * step_s);
        let k4 = self.slope(&moved(&k3, step_s), self.time_s + step_s);
        std::array::from_fn(|i| self.phase[i] + step_s / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Angles of half a minute, rad.
    fn angles(mut plant: Plant) -> Vec<f64> {
        let angle = |_| {
            let n_steps = plant.n_steps(1e-2);
            (0..n_steps).for_each(|_| plant.advance(1e-2 / n_steps as f64));
            plant.phase[0]
        };
        (0..3000).map(angle).collect()
    }

    /// A hundred-thousandth of the usual noise.
    #[test]
    fn what_is_smooth_goes_the_same_way_in_long_steps_as_in_short_ones() {
        for seed in 0..3 {
            let plain = Rig::random(seed);
            let hidden = SMOOTH.iter().map(|name| plain.clone().with(name));
            for rig in hidden.chain([plain.clone()]) {
                let long = Plant::release(&rig, 1.4);
                assert!(long.longest_step_s > 2.0 * STEP_S, "{}", long.longest_step_s);
                let short = Plant { longest_step_s: STEP_S, ..Plant::release(&rig, 1.4) };
                let apart = angles(long).iter().zip(angles(short)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(apart < 1e-8, "{apart:.1e} rad with {:?}", rig.hidden);
            }
        }
    }
}
