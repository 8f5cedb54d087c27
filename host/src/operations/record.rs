//! A swing from the rig into a file, as `--json` tells it.

use super::json::named;
use crate::error::Failure;
use crate::link::Session;
use crate::record::{End, Taken};
use serde::Serialize;
use shared::wire::{Command, Settings};

/// What was recorded.
#[derive(Clone, Debug, Serialize)]
pub struct Recorded {
    file: String,
    rate_hz: f32,
    n_samples: usize,
    release_rad: f64,
    n_passages: u32,
    swing_s: f64,
    frames_lost: u64,
    samples_lost: u64,
    ended: &'static str,
}

impl Recorded {
    /// At so many samples a second.
    pub fn new(taken: &Taken, rate_hz: f32) -> Self {
        Self {
            file: named(&taken.path),
            rate_hz,
            n_samples: taken.n_samples,
            release_rad: taken.release_rad,
            n_passages: taken.n_passages,
            swing_s: taken.swing_s,
            frames_lost: taken.frames_lost,
            samples_lost: taken.samples_lost,
            ended: ended(&taken.end),
        }
    }
}

/// Does something while the rig samples at this rate, and afterwards as before; gives the rate it had, Hz, too.
///
/// # Errors
/// The link, and those of what is done.
pub fn at_rate<T>(
    session: &mut Session,
    rate_hz: Option<f32>,
    say: &dyn Fn(&str),
    work: impl FnOnce(&mut Session) -> Result<T, Failure>,
) -> Result<(T, f32), Failure> {
    let before = rate_hz.map(|rate_hz| sample_at(session, rate_hz, say)).transpose()?;
    let rate_hz = session.settings()?.rate_hz;
    let done = work(session);
    if let Some(before) = before {
        // The link may be what broke.
        let _ = session.tell(&Command::SetSettings(before));
    }
    Ok((done?, rate_hz))
}

/// Sets the rate, and says so if the rig makes another one of it; gives the settings before.
fn sample_at(session: &mut Session, rate_hz: f32, say: &dyn Fn(&str)) -> Result<Settings, Failure> {
    let (made_hz, before) = session.sample_at(rate_hz)?;
    if made_hz != rate_hz {
        let ppm = 1e6 * (f64::from(made_hz) / f64::from(rate_hz) - 1.0);
        say(&format!("the rig samples at {made_hz} Hz, the nearest to {rate_hz} Hz that it can make ({ppm:+.0} ppm)"));
    }
    Ok(before)
}

fn ended(end: &End) -> &'static str {
    match end {
        End::AtRest => "at rest",
        End::TimeLimit => "time limit",
        End::Stopped => "stopped",
        End::Disconnected { .. } => "disconnected",
        End::Lost(_) => "link lost",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::LinkError;
    use shared::sensor::{Potentiometer, Sensor};

    #[test]
    fn what_was_recorded_is_told_with_what_ended_it() {
        let told = |end| {
            let (path, n_samples, release_rad, n_passages) = ("a/swing.csv".into(), 1234, -0.5, 9);
            let (swing_s, frames_lost, samples_lost) = (20.5, 2, 7);
            let taken = Taken { path, n_samples, release_rad, n_passages, swing_s, frames_lost, samples_lost, end };
            serde_json::to_value(Recorded::new(&taken, 500.0)).unwrap()
        };
        let rest = told(End::AtRest);
        let expected = serde_json::json!({
            "file": "a/swing.csv", "rate_hz": 500.0, "n_samples": 1234, "release_rad": -0.5, "n_passages": 9,
            "swing_s": 20.5, "frames_lost": 2, "samples_lost": 7, "ended": "at rest",
        });
        assert_eq!(rest, expected);
        let sensor = Sensor::Potentiometer(Potentiometer::nominal(4095));
        let lost = End::Lost(LinkError::StreamStopped { port: "COM3".to_owned() });
        let ends = [End::TimeLimit, End::Stopped, End::Disconnected { code: 0, sensor }, lost];
        assert_eq!(
            ends.map(|end| told(end)["ended"].as_str().unwrap().to_owned()),
            ["time limit", "stopped", "disconnected", "link lost"]
        );
    }

    #[test]
    fn after_a_swing_at_another_rate_the_rig_samples_as_before() {
        let mut session = crate::link::connect("sim").unwrap();
        let before_hz = session.settings().unwrap().rate_hz;
        let rate = |session: &mut Session| Ok(session.settings()?.rate_hz);
        let (meanwhile_hz, told_hz) = at_rate(&mut session, Some(250.0), &|_| (), rate).unwrap();
        assert_eq!((meanwhile_hz, told_hz), (250.0, 250.0));
        assert!(before_hz != 250.0 && session.settings().unwrap().rate_hz == before_hz, "{before_hz}");
    }
}
