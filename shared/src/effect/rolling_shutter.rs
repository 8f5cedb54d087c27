//! Rolling shutter: a camera reads its picture line by line, so that the pendulum is seen the later the farther it is
//! to one side.
//! Source: C.-K. Liang, L.-W. Chang, H. H. Chen, IEEE Trans. Image Process. 17 (2008) 1323, for a camera at rest.
//!
//! Seen is the angle a time d·reading earlier, up to a delay that all of the picture has, which no swing shows. To
//! second order in d·ω, where what changes in the velocity within that time is left out: 7e-4 rad at d = 5 ms/rad and
//! 1.3 rad.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules, SENSOR_MEMORY, Sensor};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 36,
        name: "rolling-shutter",
        summary: "The pendulum is seen the later the farther it is to one side, as in a video read line by line.",
        formula: "reading = theta*(1 - d*omega + (d*omega)^2)",
        source: "C.-K. Liang, L.-W. Chang, H. H. Chen, IEEE Trans. Image Process. 17 (2008) 1323",
        experiment: "Turn the camera by half a turn: the delay changes its sign.",
        parameters: &[Parameter {
            symbol: "d",
            unit: "s/rad",
            low: -0.03,
            high: 0.03,
            start: 0.0,
            meaning: prose!("how much later a radian farther is seen"),
        }],
        starts: &[[0.0, 0.0, 0.0, 0.0]],
        family: Family::Reading,
        generalises: None,
        is_fine: false,
        rules: Rules { is_of_pictures: true, ..Rules::NONE },
        action: Action::Sensor(Sensor { start, read }),
    }
}

fn start<R: Real>(_: R, _: &Motion<R>, _: &[R; MAX_VALUES]) -> [R; SENSOR_MEMORY] {
    [R::zero(); SENSOR_MEMORY]
}

fn read<R: Real>(reading_rad: R, motion: &Motion<R>, _: &mut [R; SENSOR_MEMORY], values: &[R; MAX_VALUES]) -> R {
    let turned = values[0] * motion.velocity_rad_s;
    reading_rad * (R::one() - turned + turned * turned)
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::reading_at;

    /// An even motion, whose reading r has r = θ − d·r·ω.
    #[test]
    fn an_even_motion_is_seen_where_it_was_when_its_line_was_read() {
        let (angle, velocity, delay) = (0.8, -4.0, 5e-3);
        let exact = angle / (1.0 + delay * velocity);
        let seen = reading_at(&super::effect(), angle, velocity, &[delay]);
        assert!((seen - exact).abs() < 1e-5 && (seen - angle).abs() > 1e-2, "{seen} {exact}");
    }

    #[test]
    fn at_the_turning_point_and_in_the_middle_nothing_is_changed() {
        assert_eq!(reading_at(&super::effect(), 0.8, 0.0, &[5e-3]), 0.8);
        assert_eq!(reading_at(&super::effect(), 0.0, 6.0, &[5e-3]), 0.0);
    }
}
