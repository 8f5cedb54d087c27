//! A simulated pendulum on its rig: hangs at rest, is lifted, held still, let go, and swings until it rests again; over
//! and over. Gives converter codes.

use shared::model::{Model, State};
use shared::parameters::Parameters;
use shared::potentiometer::Potentiometer;
use shared::units::{Code, Radian};

/// What happens to the pendulum, in seconds and radians.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The pendulum itself.
    pub parameters: Parameters<f64>,
    /// Samples per second.
    pub rate_hz: f64,
    /// Hangs at rest this long before each lift.
    pub rest_s: f64,
    /// Lifted within this time …
    pub lift_s: f64,
    /// … to this angle, with alternating sides if negative releases are wanted …
    pub release_rad: f64,
    /// … held still this long …
    pub hold_s: f64,
    /// … and let swing this long.
    pub swing_s: f64,
    /// Every other swing starts on the other side.
    pub alternate: bool,
    /// Standard deviation of the noise on the angle, rad.
    pub noise_rad: f64,
    /// The largest converter code.
    pub full_scale: u16,
    /// Instead of a potentiometer an encoder with so many edges a turn, four times its lines; negative if they fall
    /// while the angle grows. Its code is how many have passed since the start, modulo 65,536.
    pub edges_per_turn: Option<i32>,
    /// Seed of the noise.
    pub seed: u64,
}

impl Default for Scenario {
    /// The paper's pendulum, released from 1 rad as in its recording, on the firmware's 14-bit scale.
    fn default() -> Self {
        Self {
            parameters: Parameters::paper(),
            rate_hz: 1000.0,
            rest_s: 3.0,
            lift_s: 1.0,
            release_rad: 1.0,
            hold_s: 1.0,
            swing_s: 50.0,
            alternate: false,
            noise_rad: 1e-3,
            full_scale: firmware::ports::FULL_SCALE,
            edges_per_turn: None,
            seed: 1,
        }
    }
}

/// What the hand does now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Nothing; the pendulum hangs.
    Rest,
    /// Lifts it.
    Lift,
    /// Holds it.
    Hold,
    /// Nothing; the pendulum swings.
    Swing,
}

/// The pendulum in its scenario.
pub struct Plant {
    scenario: Scenario,
    model: Model<f64>,
    state: State<f64>,
    potentiometer: Potentiometer,
    noise: Noise,
    phase: Phase,
    in_phase_s: f64,
    lifted_from_rad: f64,
    n_swings: u32,
}

impl Plant {
    /// Hangs at rest.
    pub fn new(scenario: Scenario) -> Self {
        let model = Model::new(&scenario.parameters);
        Self {
            state: model.release(0.0, 0.0),
            model,
            potentiometer: Potentiometer::nominal(scenario.full_scale),
            noise: Noise(scenario.seed | 1),
            phase: Phase::Rest,
            in_phase_s: 0.0,
            lifted_from_rad: 0.0,
            n_swings: 0,
            scenario,
        }
    }

    /// What happens now.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// How many swings have begun.
    pub fn n_swings(&self) -> u32 {
        self.n_swings
    }

    /// The true angle, rad.
    pub fn angle_rad(&self) -> f64 {
        self.state.angle_rad
    }

    /// The next sample's code.
    pub fn next_code(&mut self) -> Code {
        let dt_s = 1.0 / self.scenario.rate_hz;
        self.in_phase_s += dt_s;
        self.change_phase();
        match self.phase {
            Phase::Rest | Phase::Swing => self.model.step(&mut self.state, dt_s),
            Phase::Lift => self.state = self.model.release(self.lifted_rad(), 0.0),
            Phase::Hold => self.state = self.model.release(self.target_rad(), 0.0),
        }
        if let Some(edges) = self.scenario.edges_per_turn {
            // An edge has passed or not: nothing is rounded, and there is no noise.
            let passed = (self.state.angle_rad / std::f64::consts::TAU * f64::from(edges)).floor();
            return Code(passed as i64 as u16);
        }
        let measured_rad = self.state.angle_rad + self.scenario.noise_rad * self.noise.next();
        self.potentiometer.code(Radian(measured_rad as f32))
    }

    fn change_phase(&mut self) {
        let (length_s, next) = match self.phase {
            Phase::Rest => (self.scenario.rest_s, Phase::Lift),
            Phase::Lift => (self.scenario.lift_s, Phase::Hold),
            Phase::Hold => (self.scenario.hold_s, Phase::Swing),
            Phase::Swing => (self.scenario.swing_s, Phase::Rest),
        };
        if self.in_phase_s < length_s {
            return;
        }
        (self.phase, self.in_phase_s) = (next, 0.0);
        match next {
            Phase::Lift => self.lifted_from_rad = self.state.angle_rad,
            Phase::Swing => {
                self.state = self.model.release(self.target_rad(), 0.0);
                self.n_swings += 1;
            }
            Phase::Rest | Phase::Hold => {}
        }
    }

    fn target_rad(&self) -> f64 {
        let other_side = self.scenario.alternate && self.n_swings % 2 == 1;
        if other_side { -self.scenario.release_rad } else { self.scenario.release_rad }
    }

    /// A hand starts and stops gently: half a cosine.
    fn lifted_rad(&self) -> f64 {
        let share = 0.5 - 0.5 * (std::f64::consts::PI * self.in_phase_s / self.scenario.lift_s).cos();
        self.lifted_from_rad + share * (self.target_rad() - self.lifted_from_rad)
    }
}

/// Normal noise: twelve uniform numbers of a xorshift generator (Marsaglia 2003) less six.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}
