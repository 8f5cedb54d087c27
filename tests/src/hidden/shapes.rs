//! Laws that no usual law of the list contains: what a rig has in reality is never quite what a list has. Each stands for
//! one that somebody published, and a diagnosis is right if it names the one that comes nearest, or its family.

use super::{Random, Rig};

/// Their names, each with the effects of the list that come nearest.
pub const SHAPES: [(&str, &[&str]); 10] = [
    ("slow-stribeck", &["stribeck", "general-stribeck"]),
    ("ageing-friction", &["drifting-friction", "general-drift"]),
    ("wide-brake", &["eddy-brake", "general-brake"]),
    ("lever-load", &["gear-load", "general-gear-load"]),
    ("hard-bristle", &["presliding", "general-presliding"]),
    ("hard-spring", &["torsional-spring", "general-spring"]),
    ("loaded-track", &["sensor-nonlinearity", "sensor-gain"]),
    ("rough-drag", &["quadratic-drag", "power-law-drag"]),
    ("soft-wiper", &["shear-thinning", "general-thinning"]),
    ("disc-brake", &["shear-thinning", "general-thinning"]),
];

/// Drag grows with the square of the speed below this one, in proportion to it above, rad/s.
const DRAG_TURNS_RAD_S: f64 = 4.0;

/// The friction of teeth grows with this power of their load, and falls with its excess over one of their speed: µ is as
/// (load/speed)^0.2 by ISO/TR 14179-2 (2001). It is capped below the speed, rad/s.
const LOAD_EXPONENT: f64 = 1.2;
const SLOWEST_TEETH_RAD_S: f64 = 0.1;

/// The track of a potentiometer, rad.
const TRACK_RAD: f64 = 340.0 * std::f64::consts::PI / 180.0;

/// Size, shape and largest size of a law of this file.
pub(super) fn form(name: &str, random: &mut Random) -> Option<(f64, [f64; 2], f64)> {
    let sign = random.sign();
    Some(match name {
        "slow-stribeck" => (4e-4, [random.log_between(0.15, 1.0), random.pick(&[0.5, 1.0])], 5e-3),
        "ageing-friction" => {
            (sign * 0.3, [random.log_between(4.0, 30.0), random.pick(&[-1.0, 1.0])], if sign < 0.0 { 0.7 } else { 3.0 })
        }
        "wide-brake" => (5e-4, [random.between(-0.8, 0.8), random.log_between(0.08, 0.3)], 2e-2),
        "lever-load" => (0.01, [0.0; 2], 0.3),
        "hard-bristle" => (5e-3, [random.pick(&[0.5, 2.0]), 0.0], 0.06),
        "hard-spring" => (2e-3, [0.0; 2], 0.05),
        "loaded-track" => (0.05, [random.between(-0.2, 0.2), 0.0], 1.0),
        "rough-drag" => (6e-5, [0.0; 2], 1e-3),
        "soft-wiper" => (6e-4, [random.log_between(0.3, 3.0), 0.0], 5e-3),
        "disc-brake" => (6e-4, [random.log_between(0.5, 3.0), 0.0], 5e-3),
        _ => return None,
    })
}

/// Size and shape of all of them on a rig; zero where there is none.
pub(super) struct Shapes {
    /// Most rigs have none, and a plant asks twenty thousand times a second.
    is_any: bool,
    weight_nm: f64,
    coulomb_nm: f64,
    viscous: f64,
    slow: [f64; 3],
    ageing: [f64; 3],
    brake: [f64; 3],
    lever: f64,
    bristle: [f64; 2],
    spring: f64,
    loaded: [f64; 2],
    drag: f64,
    wiper: [f64; 2],
    disc: [f64; 2],
}

impl Shapes {
    pub(super) fn of(rig: &Rig) -> Self {
        let three = |name: &str| rig.hidden(name).map_or([0.0; 3], |h| [h.size, h.shape[0], h.shape[1]]);
        let two = |name: &str| [three(name)[0], three(name)[1]];
        Self {
            is_any: SHAPES.iter().any(|(name, _)| rig.hidden(name).is_some()),
            weight_nm: rig.mass_kg * rig.gravity_m_s2 * rig.length_m,
            coulomb_nm: rig.coulomb_nm,
            viscous: rig.viscous,
            slow: three("slow-stribeck"),
            ageing: three("ageing-friction"),
            brake: three("wide-brake"),
            lever: two("lever-load")[0],
            bristle: two("hard-bristle"),
            spring: two("hard-spring")[0],
            loaded: two("loaded-track"),
            drag: two("rough-drag")[0],
            wiper: two("soft-wiper"),
            disc: two("disc-brake"),
        }
    }

    /// Dry friction, N·m.
    pub(super) fn dry_nm(&self, angle: f64, velocity: f64, time_s: f64) -> f64 {
        if !self.is_any {
            return 0.0;
        }
        // A. Tustin, J. IEE 94 (1947) 143 has δ = 1; polymers have less.
        let [extra, speed, delta] = self.slow;
        let slow = if extra == 0.0 { 0.0 } else { extra * (-(velocity.abs() / speed).powf(delta)).exp() };
        slow + self.coulomb_nm * self.aged(time_s) + self.lever_nm(angle, velocity)
    }

    /// The load of a gear train is what gravity turns it with.
    fn lever_nm(&self, angle: f64, velocity: f64) -> f64 {
        if self.lever == 0.0 {
            return 0.0;
        }
        let sheared = velocity.abs().max(SLOWEST_TEETH_RAD_S).powf(1.0 - LOAD_EXPONENT);
        self.lever * self.weight_nm * angle.sin().abs().powf(LOAD_EXPONENT) * sheared
    }

    /// Friction that vanishes at rest, N·m.
    pub(super) fn smooth_nm(&self, angle: f64, velocity: f64, time_s: f64) -> f64 {
        if !self.is_any {
            return 0.0;
        }
        // A field that falls as Lorentz's curve, not as Gauss's.
        let [strength, place, width] = self.brake;
        let brake = if strength == 0.0 { 0.0 } else { strength / (1.0 + ((angle - place) / width).powi(2)) };
        let drag = self.drag * velocity.powi(2) / (1.0 + velocity.abs() / DRAG_TURNS_RAD_S);
        (brake + self.viscous * self.aged(time_s)) * velocity + drag * velocity.signum() + self.saturating_nm(velocity)
    }

    /// A hyperbolic tangent, as simulations often have dry friction; a conducting disc, whose torque is largest at its
    /// critical speed (W. R. Smythe, Trans. AIEE 61 (1942) 681).
    fn saturating_nm(&self, velocity: f64) -> f64 {
        let [wiper_nm, soft_rad_s] = self.wiper;
        let [disc_nm, critical_rad_s] = self.disc;
        let wiper = if wiper_nm == 0.0 { 0.0 } else { wiper_nm * (velocity / soft_rad_s).tanh() };
        let slip = if disc_nm == 0.0 { 0.0 } else { velocity / critical_rad_s };
        wiper + disc_nm * 2.0 * slip / (1.0 + slip * slip)
    }

    /// (1 + κ·t/τ)₊^(−1/κ): κ = −1 is a straight line that ends, κ = 1 a hyperbola; an exponential lies between.
    fn aged(&self, time_s: f64) -> f64 {
        let [size, tau_s, kappa] = self.ageing;
        if size == 0.0 { 0.0 } else { size * (1.0 + kappa * time_s / tau_s).max(0.0).powf(-1.0 / kappa) }
    }

    /// A torque that acts at rest too, N·m: a spring that hardens (Duffing).
    pub(super) fn drive_nm(&self, angle: f64) -> f64 {
        if self.is_any { -self.spring * angle.powi(3) } else { 0.0 }
    }

    /// The range of the bristle, rad.
    pub(super) fn bristle_rad(&self) -> f64 {
        self.bristle[0]
    }

    /// How much of the way bends the bristle, which is bent by this share of its range in the direction of motion
    /// already: (1 − share)^i, P. R. Dahl, AIAA J. 14 (1976) 1675, of which the list has i = 1.
    pub(super) fn bristle_gives(&self, share: f64) -> f64 {
        let exponent = if self.bristle[0] == 0.0 { 1.0 } else { self.bristle[1] };
        (1.0 - share).max(0.0).powf(exponent)
    }

    /// What the sensor adds to an angle, rad: the wiper of a potentiometer is loaded by what measures its voltage
    /// v = x/(1 + ρ·x·(1 − x)), ρ the track's resistance over the load's, x the share of the track.
    pub(super) fn read_rad(&self, angle: f64) -> f64 {
        let [ratio, centre] = self.loaded;
        let voltage = |angle: f64| {
            let share = 0.5 + centre + angle / TRACK_RAD;
            share / (1.0 + ratio * share * (1.0 - share))
        };
        if ratio == 0.0 { 0.0 } else { TRACK_RAD * (voltage(angle) - voltage(0.0)) - angle }
    }
}
