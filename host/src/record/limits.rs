//! When a swing ends, or never begins: the rules that a recording and a listener share.

use super::detector::{Detector, Stage};
use super::{End, RecordError};
use shared::wire::Settings;

/// The wiper may leave its track for a moment at the top; longer is a broken wire.
const DISCONNECTED_S: f64 = 0.2;

/// When to give up.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// If there is no release within so many seconds.
    pub wait_s: f64,
    /// A swing ends so many seconds after the release.
    pub limit_s: f64,
}

impl Limits {
    /// Unless somebody says otherwise.
    pub const USUAL: Self = Self { wait_s: 120.0, limit_s: 300.0 };

    /// Ends what takes too long; `seconds` have passed in the detector's stage.
    pub(super) fn patience(&self, detector: &Detector, seconds: f64) -> Result<Option<End>, RecordError> {
        match detector.stage() {
            Stage::AtRest => Ok(Some(End::AtRest)),
            Stage::Swinging if seconds > self.limit_s => Ok(Some(End::TimeLimit)),
            Stage::Waiting if seconds > self.wait_s => Err(RecordError::NoRelease { seconds: self.wait_s }),
            Stage::Settling if seconds > self.wait_s => {
                Err(RecordError::NeverStill { seconds: self.wait_s, spread_rad: detector.spread_rad() })
            }
            _ => Ok(None),
        }
    }
}

/// Of so many readings in a row at an end of the range, the last one `code`: too many end the swing.
pub(super) fn disconnected(
    settings: &Settings,
    stage: Stage,
    n_in_a_row: u32,
    code: u16,
) -> Result<Option<End>, RecordError> {
    match (f64::from(n_in_a_row) > DISCONNECTED_S * f64::from(settings.rate_hz), stage) {
        (false, _) => Ok(None),
        (true, Stage::Swinging) => Ok(Some(End::Disconnected { code, sensor: settings.sensor })),
        (true, _) => Err(RecordError::Disconnected { code, sensor: settings.sensor }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::sensor::{Potentiometer, Sensor};

    const LIMITS: Limits = Limits { wait_s: 2.0, limit_s: 5.0 };

    #[test]
    fn what_never_stands_still_is_given_up_after_the_wait() {
        let detector = Detector::new(1000.0, 1e-3);
        assert!(matches!(LIMITS.patience(&detector, 1.9), Ok(None)));
        let given_up = LIMITS.patience(&detector, 2.5);
        assert!(matches!(given_up, Err(RecordError::NeverStill { seconds: 2.0, .. })), "{given_up:?}");
        let mut still = detector;
        (0..600).for_each(|_| {
            still.push(0.5);
        });
        assert!(still.stage() == Stage::Waiting && matches!(LIMITS.patience(&still, 1.9), Ok(None)));
        let given_up = LIMITS.patience(&still, 2.5);
        assert!(matches!(given_up, Err(RecordError::NoRelease { seconds: 2.0 })), "{given_up:?}");
    }

    #[test]
    fn a_sensor_may_leave_its_range_for_a_fifth_of_a_second() {
        let sensor = Sensor::Potentiometer(Potentiometer::nominal(4095));
        let settings = Settings { rate_hz: 1000.0, cutoff_hz: 50.0, bandwidth_rad_s: 3.0, sensor };
        for stage in [Stage::Settling, Stage::Waiting, Stage::Swinging] {
            assert!(matches!(disconnected(&settings, stage, 190, 7), Ok(None)), "{stage:?}");
        }
        let ended = disconnected(&settings, Stage::Swinging, 300, 7);
        assert!(matches!(ended, Ok(Some(End::Disconnected { code: 7, .. }))), "{ended:?}");
        let refused = disconnected(&settings, Stage::Waiting, 300, 7);
        assert!(matches!(refused, Err(RecordError::Disconnected { code: 7, .. })), "{refused:?}");
    }
}
