//! A model on its way, and how each step answers small changes of angle and velocity before it.
//!
//! The transition of a step comes from the model itself, run with numbers that carry their derivatives
//! ([`shared::dual`]), jumps at events included, and begins anew with every step, so that a long swing loses no digits.

use shared::dual::Dual;
use shared::model::{Model, State};
use shared::parameters::Parameters;

/// A pendulum that rests has forgotten how it was moved: its transition has no inverse.
const FORGOTTEN: f64 = 1e-9;

/// From (δθ in rad, δω in rad/s) at one instant to the same at another.
pub type Transition = [[f64; 2]; 2];

/// The model on its way, with the derivatives by its angle and velocity of a step before.
pub struct Follower {
    model: Model<Dual<f64, 2>>,
    state: State<Dual<f64, 2>>,
}

impl Follower {
    /// Begins at an angle, rad, with a velocity, rad/s.
    pub fn new(parameters: &Parameters<f64>, angle_rad: f64, velocity_rad_s: f64) -> Self {
        let model = Model::new(&parameters.map(Dual::constant));
        let state = model.release(Dual::variable(angle_rad, 0), Dual::variable(velocity_rad_s, 1));
        Self { model, state }
    }

    /// Angle, rad, and velocity, rad/s.
    pub fn motion(&self) -> [f64; 2] {
        [self.state.angle_rad.value, self.state.velocity_rad_s.value]
    }

    /// One step of the model; how angle and velocity behind it answer those before.
    pub fn step(&mut self, seconds: f64) -> Transition {
        self.model.step(&mut self.state, Dual::constant(seconds));
        let transition = [self.state.angle_rad.slopes, self.state.velocity_rad_s.slopes];
        let back = inverse(&transition).unwrap_or([[0.0; 2]; 2]);
        let anew = |number: Dual<f64, 2>| {
            let [by_angle, by_velocity] = number.slopes;
            let slopes = std::array::from_fn(|i| by_angle * back[0][i] + by_velocity * back[1][i]);
            Dual { value: number.value, slopes }
        };
        self.state = State::from_numbers(&self.state.numbers().map(anew));
        self.state.angle_rad.slopes = [1.0, 0.0];
        self.state.velocity_rad_s.slopes = [0.0, 1.0];
        transition
    }
}

/// The way back; `None` where it is forgotten.
pub fn inverse([[a, b], [c, d]]: &Transition) -> Option<Transition> {
    let determinant = a * d - b * c;
    let is_known = determinant.abs() > FORGOTTEN && determinant.is_finite();
    is_known.then(|| [[d / determinant, -b / determinant], [-c / determinant, a / determinant]])
}
