//! Detent: the cogging of magnets, or a notchy bearing; torque that changes sign several times a turn.
//! Source: D. C. Hanselman, Brushless Permanent-Magnet Motor Design (McGraw-Hill, 1994): cogging torque.
//!
//! Sine and cosine parts instead of amplitude and phase: a fit that starts at zero strength then finds the phase in one
//! step. The number of periods a turn is a real number, because the notches need not be evenly spaced over a turn.
//! With few periods it looks like a spring.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Pattern, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 15,
        name: "detent",
        summary: "Magnets or notches pull the pendulum towards preferred angles, again and again along its way.",
        formula: "torque = Mds*sin(n*theta) + Mdc*cos(n*theta)",
        source: "D. C. Hanselman, Brushless Permanent-Magnet Motor Design (McGraw-Hill, 1994)",
        experiment: "Where the pendulum stops over many releases, and the period of small swings: both prefer certain angles.",
        parameters: &[
            Parameter {
                symbol: "Mds",
                unit: "N·m",
                low: -2e-2,
                high: 2e-2,
                start: 0.0,
                meaning: prose!("sine part of the torque"),
            },
            Parameter {
                symbol: "Mdc",
                unit: "N·m",
                low: -2e-2,
                high: 2e-2,
                start: 0.0,
                meaning: prose!("cosine part of the torque"),
            },
            Parameter { symbol: "n", unit: "1", low: 1.5, high: 60.0, start: 6.0, meaning: prose!("periods a turn") },
        ],
        starts: &[
            [0.0, 0.0, 6.0, 0.0],
            [0.0, 0.0, 3.0, 0.0],
            [0.0, 0.0, 4.5, 0.0],
            [0.0, 0.0, 8.0, 0.0],
            [0.0, 0.0, 11.0, 0.0],
            [0.0, 0.0, 15.0, 0.0],
            [0.0, 0.0, 20.0, 0.0],
            [0.0, 0.0, 30.0, 0.0],
        ],
        family: Family::Spring,
        generalises: None,
        is_fine: true,
        rules: Rules { must_lie_within: Some(2), pattern: Some(Pattern::Periods(2)), ..Rules::NONE },
        action: Action::Drive(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let phase = values[2] * motion.angle_rad;
    values[0] * phase.sin() + values[1] * phase.cos()
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn it_repeats_after_a_period_and_does_no_work_over_one() {
        let torque = |angle: f64| torque_at(&super::effect(), angle, 0.0, &[2e-3, -1e-3, 5.0]);
        let period = core::f64::consts::TAU / 5.0;
        assert!((torque(0.3) - torque(0.3 + period)).abs() < 1e-15);
        let work: f64 = (0..100).map(|i| torque(period * f64::from(i) / 100.0)).sum();
        assert!(work.abs() < 1e-14);
    }
}
