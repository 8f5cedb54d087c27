//! Some seconds of converter codes: their rate, the noise of a still pendulum, hum, and whether the wiper has contact.

use super::Finding;
use crate::link::{LinkError, Session};
use serde::Serialize;
use shared::sensor::Sensor;
use shared::units::Code;
use shared::wire::{Frame, Settings, Stream};
use std::time::Duration;

/// Listened to for so long.
const LISTEN: Duration = Duration::from_secs(3);

/// A stream is looked for this often.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// The stillest stretch of this length gives the noise: a whole number of periods of 50 and of 60 Hz.
const STILL_S: f64 = 0.4;

/// The rate must be right within this share; the PC's own clock and the link's delays allow no finer statement.
const RATE_SHARE: f64 = 0.02;

/// A converter that reads one number only is not connected to a potentiometer.
const NO_NOISE: f64 = 1e-9;

/// A good rig stays below this standard deviation, in codes.
const MOST_NOISE_CODES: f64 = 2.0;

/// A still pendulum's codes spread no more than so many times their noise, and a code.
const SPREAD_OVER_NOISE: f64 = 1.5;

/// Hum is told from noise above this amplitude, in codes.
const LEAST_HUM_CODES: f64 = 0.5;

/// Mains.
const HUM_HZ: [f64; 2] = [50.0, 60.0];

/// What was heard.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Signal {
    /// Samples received.
    pub n_samples: usize,
    /// Samples missing in between.
    pub n_lost: u64,
    /// Frames that could not be read.
    pub n_damaged: u64,
    /// Measured sampling rate in Hz, by the PC's clock.
    pub rate_hz: f64,
    /// Samples at an end of the range.
    pub n_clipped: usize,
    /// Mean of the stillest stretch, in codes.
    pub mean_code: f64,
    /// Standard deviation there, in codes.
    pub spread_codes: f64,
    /// Standard deviation of white noise with these differences of neighbours, in codes.
    pub noise_codes: f64,
    /// Amplitude of mains hum there, in codes.
    pub hum_codes: f64,
    /// Mean of the first stretch in which it stands still, in codes: where the pendulum hangs before anybody lifts it.
    pub hangs_at_code: Option<f64>,
}

impl Signal {
    /// Streams codes for some seconds.
    ///
    /// # Errors
    /// The link breaks.
    pub fn listen(session: &mut Session, settings: &Settings) -> Result<Self, LinkError> {
        session.start(Stream { raw: true, live_every: 0 })?;
        let (mut codes, mut first_frame) = (Vec::new(), None);
        let began = session.elapsed();
        let mut last = began;
        while session.elapsed() < began + LISTEN {
            if let Some(Frame::Samples(samples)) = session.receive(LOOK_EVERY)? {
                last = session.elapsed();
                first_frame.get_or_insert((last, samples.codes.len()));
                codes.extend_from_slice(&samples.codes);
            }
        }
        let (n_lost, n_damaged) = (session.tally().samples_lost, session.tally().frames_damaged);
        session.stop()?;
        let Some((first, n_first)) = first_frame else { return Ok(Self { n_damaged, ..Self::default() }) };
        let seconds = (last - first).as_secs_f64();
        // The first frame was filled before the clock started.
        let counted = (codes.len() - n_first) as f64 + n_lost as f64;
        let rate_hz = if seconds > 0.0 { counted / seconds } else { 0.0 };
        Ok(Self { n_lost, n_damaged, rate_hz, ..Self::of_codes(&codes, settings) })
    }

    /// What the codes alone tell.
    pub fn of_codes(codes: &[u16], settings: &Settings) -> Self {
        let n_clipped = codes.iter().filter(|code| !settings.sensor.is_connected(Code(**code))).count();
        let rate_hz = f64::from(settings.rate_hz);
        let length = ((STILL_S * rate_hz) as usize).max(2);
        let stillest = codes.chunks_exact(length).min_by(|a, b| spread(a).total_cmp(&spread(b)));
        let still = stillest.unwrap_or(codes);
        Self {
            n_samples: codes.len(),
            n_clipped,
            mean_code: mean(still),
            spread_codes: spread(still),
            noise_codes: noise(still),
            hangs_at_code: codes.chunks_exact(length).find(|stretch| is_still(stretch)).map(mean),
            hum_codes: HUM_HZ.iter().map(|hum_hz| amplitude(still, hum_hz / rate_hz)).fold(0.0, f64::max),
            ..Self::default()
        }
    }

    /// Does the pendulum stand still there?
    pub fn is_still(&self) -> bool {
        stands(self.spread_codes, self.noise_codes)
    }

    /// What there is to say.
    pub(super) fn findings(&self, settings: &Settings) -> Vec<Finding> {
        if self.n_samples == 0 {
            return vec![self.nothing()];
        }
        let mut findings = vec![self.sampling(settings), self.contact(&settings.sensor)];
        if findings.iter().all(|finding| finding.ok) {
            findings.extend([self.noise(settings), self.hum()]);
        }
        findings
    }

    fn nothing(&self) -> Finding {
        let next = "press the rig's reset button and repeat";
        if self.n_damaged == 0 {
            return Finding::look("sampling", "not one sample came", next);
        }
        let found = format!("not one sample could be read, of {} frames that came damaged", self.n_damaged);
        let next = "use another port or cable, without a hub; if it stays so, the firmware's frames are not those of \
                    docs/protocol.md: a wrong check sum, or longer than allowed";
        Finding::look("sampling", found, next)
    }

    fn sampling(&self, settings: &Settings) -> Finding {
        let wanted = f64::from(settings.rate_hz);
        let found = format!("{:.0} samples/s (set: {wanted:.0}), {} lost on the way", self.rate_hz, self.n_lost);
        let complaint = if self.n_lost > 0 {
            Some("use another port or cable, without a hub, and close programs that keep the computer busy")
        } else if (self.rate_hz / wanted - 1.0).abs() > RATE_SHARE {
            Some("time comes from this rate: flash the firmware for this very board, and repeat")
        } else {
            None
        };
        Finding::of("sampling", found, complaint)
    }

    fn contact(&self, sensor: &Sensor) -> Finding {
        let next = format!("{}; see docs/wiring.md", sensor.wires());
        let stands_still = self.spread_codes < NO_NOISE;
        let found = match self.n_clipped {
            0 if stands_still && sensor.is_quiet() => {
                format!("stands at {:.0}; to see that it is connected, swing the pendulum and repeat", self.mean_code)
            }
            0 if stands_still => "reads one code only, without any noise".to_owned(),
            0 => "alive, no reading at an end of its range".to_owned(),
            n_clipped => format!("{n_clipped} of {} readings at an end of the range", self.n_samples),
        };
        let dead = self.n_clipped > 0 || (stands_still && !sensor.is_quiet());
        Finding::of(sensor.name(), found, dead.then_some(&next))
    }

    fn noise(&self, settings: &Settings) -> Finding {
        let mrad = |codes: f64| 1e3 * codes * f64::from(settings.sensor.step_rad());
        if !self.is_still() {
            let next = "let it hang still and repeat: noise can be told at rest only";
            return Finding::look("noise", "the pendulum moves", next);
        }
        let found = format!("{:.2} codes rms ({:.2} mrad) at rest", self.spread_codes, mrad(self.spread_codes));
        let next = "look at the supply and at the capacitor beside the converter first (docs/wiring.md)";
        Finding::of("noise", found, (self.spread_codes > MOST_NOISE_CODES).then_some(next))
    }

    fn hum(&self) -> Finding {
        let found = format!("{:.2} codes of 50 or 60 Hz", self.hum_codes);
        let heard = self.is_still() && self.hum_codes > LEAST_HUM_CODES;
        let next = "keep the wiper's wire short or shielded, away from mains and its supplies";
        Finding::of("hum", found, heard.then_some(next))
    }
}

fn is_still(codes: &[u16]) -> bool {
    stands(spread(codes), noise(codes))
}

fn stands(spread_codes: f64, noise_codes: f64) -> bool {
    spread_codes < SPREAD_OVER_NOISE * noise_codes + 1.0
}

fn mean(codes: &[u16]) -> f64 {
    codes.iter().map(|code| f64::from(*code)).sum::<f64>() / codes.len().max(1) as f64
}

fn spread(codes: &[u16]) -> f64 {
    let middle = mean(codes);
    let square = |code: &u16| (f64::from(*code) - middle).powi(2);
    (codes.iter().map(square).sum::<f64>() / codes.len().max(1) as f64).sqrt()
}

fn noise(codes: &[u16]) -> f64 {
    let square = |pair: &[u16]| (f64::from(pair[1]) - f64::from(pair[0])).powi(2);
    let n_steps = codes.len().saturating_sub(1).max(1) as f64;
    (codes.windows(2).map(square).sum::<f64>() / (2.0 * n_steps)).sqrt()
}

/// Amplitude of the wave with so many periods a sample (one bin of a Fourier transform).
fn amplitude(codes: &[u16], periods_a_sample: f64) -> f64 {
    let middle = mean(codes);
    let wave = |part: fn(f64) -> f64| {
        let phase = |idx: usize| std::f64::consts::TAU * periods_a_sample * idx as f64;
        codes.iter().enumerate().map(|(idx, code)| (f64::from(*code) - middle) * part(phase(idx))).sum::<f64>()
    };
    2.0 / codes.len().max(1) as f64 * wave(f64::cos).hypot(wave(f64::sin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;
    use shared::potentiometer::{FULL_SCALE_12_BIT, Potentiometer};

    fn settings() -> Settings {
        let sensor = Potentiometer::nominal(FULL_SCALE_12_BIT).into();
        Settings { rate_hz: 1000.0, cutoff_hz: 50.0, bandwidth_rad_s: 3.0, sensor }
    }

    fn heard(code: impl Fn(usize, f64) -> f64) -> (Signal, Vec<Finding>) {
        let mut noise = Noise::new(3);
        let codes: Vec<u16> = (0..3000).map(|idx| code(idx, noise.normal()).round() as u16).collect();
        let signal = Signal { rate_hz: 1000.0, ..Signal::of_codes(&codes, &settings()) };
        let findings = signal.findings(&settings());
        (signal, findings)
    }

    fn complaints(code: impl Fn(usize, f64) -> f64) -> Vec<&'static str> {
        heard(code).1.iter().filter(|finding| !finding.ok).map(|finding| finding.what).collect()
    }

    #[test]
    fn a_good_rig_gives_no_reason_to_look() {
        assert!(complaints(|_, noise| 2048.0 + 0.7 * noise).is_empty());
    }

    #[test]
    fn noise_is_measured_in_codes() {
        let (signal, findings) = heard(|_, noise| 2048.0 + 5.0 * noise);
        // Of 400 samples the standard deviation is known within 4 %; the stillest of seven stretches lies a bit low.
        assert!((4.3..5.3).contains(&signal.spread_codes), "{signal:?}");
        assert!(findings.iter().any(|finding| finding.what == "noise" && !finding.ok));
    }

    #[test]
    fn hum_is_told_from_noise() {
        let hum =
            |idx: usize, noise: f64| 2048.0 + 0.5 * noise + 1.2 * (std::f64::consts::TAU * 0.05 * idx as f64).sin();
        let (signal, _) = heard(hum);
        assert!((signal.hum_codes - 1.2).abs() < 0.15, "{signal:?}");
        assert_eq!(complaints(hum), ["hum"]);
    }

    #[test]
    fn broken_wires_and_motion_are_seen() {
        assert_eq!(complaints(|_, _| 0.0), ["potentiometer"]);
        assert_eq!(complaints(|_, _| 2048.0), ["potentiometer"]);
        assert_eq!(complaints(|idx, noise| 2048.0 + 900.0 * (0.007 * idx as f64).sin() + 0.7 * noise), ["noise"]);
    }

    #[test]
    fn noise_is_told_in_codes_and_as_the_angle_that_they_are() {
        let (signal, findings) = heard(|_, noise| 2048.0 + 0.7 * noise);
        let noise = findings.iter().find(|finding| finding.what == "noise").unwrap();
        // 340° over 4095 codes.
        let mrad = 1e3 * 340_f64.to_radians() / 4095.0 * signal.spread_codes;
        assert_eq!(noise.found, format!("{:.2} codes rms ({mrad:.2} mrad) at rest", signal.spread_codes));
    }

    #[test]
    fn frames_that_can_not_be_read_are_told_from_none() {
        let told = |n_damaged: u64| {
            let [finding] = Signal { n_damaged, ..Signal::default() }.findings(&settings()).try_into().unwrap();
            (finding.found, finding.next.unwrap())
        };
        assert_eq!(told(0).0, "not one sample came");
        let (found, next) = told(180);
        assert_eq!(found, "not one sample could be read, of 180 frames that came damaged");
        assert!(next.contains("cable") && !next.contains("reset"), "{next}");
    }

    #[test]
    fn a_rate_is_right_to_two_percent() {
        let is_ok = |rate_hz: f64| Signal { rate_hz, ..Signal::default() }.sampling(&settings()).ok;
        assert_eq!([985.0, 1015.0, 975.0, 1025.0].map(is_ok), [true, true, false, false]);
    }
}
