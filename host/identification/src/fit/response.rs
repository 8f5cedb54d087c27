//! How readings answer small torques along a swing: the variational equations, integrated beside the model.
//!
//! δ = (δθ, δω) obeys δ′ = A(t)·δ + (0, τ/J). The transition of each short step comes from the model itself
//! ([`simulation::Follower`]); torques act by the trapezoidal rule. What remembers, as a bristle does, follows as it would
//! after another start. A sensor is taken to be even: its readings answer as the angle does.

use super::problem::Start;
use crate::recording::Measured;
use crate::swing::Swing;
use shared::parameters::Parameters;
use simulation::{Follower, Transition};

/// No step is longer, at the usual pace, s: about as the fit's own.
const STEP_S: f64 = 6e-3;

/// One short step of a model along a swing.
struct Step {
    seconds: f64,
    transition: Transition,
    /// Angle and velocity behind it.
    to: [f64; 2],
    /// Is there a sample?
    is_sample: bool,
}

/// A model's way along a swing.
pub struct Path {
    from: [f64; 2],
    steps: Vec<Step>,
    measured: Measured,
    inertia: f64,
}

impl Path {
    /// Of a model that starts somewhere, at the times of a swing.
    pub fn of(parameters: &Parameters<f64>, start: Start, swing: &Swing) -> Self {
        let mut follower = Follower::new(parameters, start.angle_rad, start.velocity_rad_s);
        let from = follower.motion();
        let mut steps = Vec::new();
        for pair in swing.times_s.windows(2) {
            let n_steps = ((pair[1] - pair[0]) / (STEP_S * swing.pace)).ceil().max(1.0);
            let seconds = (pair[1] - pair[0]) / n_steps;
            for k in 1..=n_steps as usize {
                let transition = follower.step(seconds);
                steps.push(Step { seconds, transition, to: follower.motion(), is_sample: k == n_steps as usize });
            }
        }
        Self { from, steps, measured: swing.measured, inertia: parameters.pendulum.pivot_inertia_kg_m2() }
    }

    /// Angle and velocity at the samples.
    pub fn at_samples(&self) -> impl Iterator<Item = [f64; 2]> {
        let behind = self.steps.iter().filter(|step| step.is_sample).map(|step| step.to);
        std::iter::once(self.from).chain(behind)
    }

    /// How angle and velocity at each sample answer angle and velocity at the first one.
    pub fn from_the_first(&self) -> Vec<Transition> {
        let mut so_far = [[1.0, 0.0], [0.0, 1.0]];
        let mut all = vec![so_far];
        for step in &self.steps {
            so_far = product(&step.transition, &so_far);
            if step.is_sample {
                all.push(so_far);
            }
        }
        all
    }

    /// What each of so many torques, of 1 N·m where its weight is one, does to the readings: a column a torque. The
    /// weights belong to an angle and a velocity.
    pub fn answers(&self, n_torques: usize, weights: impl Fn([f64; 2]) -> Vec<(usize, f64)>) -> Vec<Vec<f64>> {
        let mut deltas = vec![[0.0; 2]; n_torques];
        let mut columns = vec![vec![0.0]; n_torques];
        let mut before = weights(self.from);
        for step in &self.steps {
            let kick = 0.5 * step.seconds / self.inertia;
            before.iter().for_each(|(at, weight)| deltas[*at][1] += kick * weight);
            deltas.iter_mut().for_each(|delta| *delta = moved(&step.transition, *delta));
            before = weights(step.to);
            before.iter().for_each(|(at, weight)| deltas[*at][1] += kick * weight);
            if step.is_sample {
                columns.iter_mut().zip(&deltas).for_each(|(column, delta)| column.push(self.read(*delta)));
            }
        }
        columns
    }

    /// What is read of a small change.
    pub fn read(&self, [angle, velocity]: [f64; 2]) -> f64 {
        match self.measured {
            Measured::Angle => angle,
            Measured::Rate => velocity,
        }
    }
}

/// What a transition makes of a small change.
pub fn moved(by: &Transition, delta: [f64; 2]) -> [f64; 2] {
    by.map(|row| row[0] * delta[0] + row[1] * delta[1])
}

fn product(second: &Transition, first: &Transition) -> Transition {
    second.map(|row| [0, 1].map(|j| row[0] * first[0][j] + row[1] * first[1][j]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::effect::Effect;
    use shared::model::Model;
    use shared::parameters::base;

    fn readings(parameters: &Parameters<f64>, times_s: &[f64]) -> Vec<f64> {
        let model = Model::new(parameters);
        let mut state = model.release(START.angle_rad, START.velocity_rad_s);
        let mut readings = vec![state.angle_rad];
        for pair in times_s.windows(2) {
            (0..20).for_each(|_| model.step(&mut state, (pair[1] - pair[0]) / 20.0));
            readings.push(state.angle_rad);
        }
        readings
    }

    const START: Start = Start { angle_rad: 1.2, velocity_rad_s: 0.0, offset_rad: 0.0 };

    /// A little more viscous friction is a torque −ω, a little more Coulomb friction one of −1 along the motion.
    #[test]
    fn readings_answer_a_torque_as_the_model_answers_more_friction() {
        let times_s: Vec<f64> = (0..500).map(|i| 0.02 * f64::from(i)).collect();
        let paper = Parameters::paper();
        let before = readings(&paper, &times_s);
        let swing = Swing::new("", &times_s, &before, 1e-3);
        let path = Path::of(&paper, START, &swing);
        for id in [base::VISCOUS, base::COULOMB] {
            let weights = |[_, velocity]: [f64; 2]| {
                vec![(
                    0,
                    if id == base::VISCOUS {
                        -velocity
                    } else {
                        -velocity.signum() * f64::from(u8::from(velocity != 0.0))
                    },
                )]
            };
            let answer = path.answers(1, weights).remove(0);
            let mut more = paper.clone();
            let step = 1e-4 * Effect::<f64>::by_id(id).map_or(0.0, |effect| effect.parameters[0].high);
            more.set(id, &[paper.values(id).unwrap()[0] + step]).unwrap();
            let after = readings(&more, &times_s);
            let largest = answer.iter().fold(0.0_f64, |largest, change| largest.max(change.abs()));
            for ((before, after), expected) in before.iter().zip(&after).zip(&answer) {
                let change = (after - before) / step;
                assert!((change - expected).abs() < 0.02 * largest, "{id}: {change} {expected} of {largest}");
            }
        }
    }
}
