//! From the numbers of a gyroscope or tachometer to angular velocities in rad/s.
//!
//! They stay velocities: bias and scale of the sensor are numbers of the fit, which integrated rates would hide. Of
//! several axes the one counts that moves most. Whatever is assumed is noted; what would be wrong is refused.

use super::error::Fault;
use super::limits::FASTEST_MARGIN;
use super::options::ReadOptions;
use super::plausible::{Scale, Swings};
use super::told::Told;
use super::units::{AngleUnit, RateUnit};

/// An axis that moves by more than this share of the liveliest one says that the sensor is tilted against the shaft.
const TILTED_SHARE: f64 = 0.1;

/// What the numbers of a file need to become rates.
pub(super) struct Rates<'a> {
    pub(super) times_s: &'a [f64],
    /// Our own files say what they are.
    pub(super) is_ours: bool,
    pub(super) options: &'a ReadOptions,
    /// Of the columns, for notes.
    pub(super) names: Vec<String>,
    /// The same for advice.
    pub(super) told: Vec<Told>,
    pub(super) notes: &'a mut Vec<String>,
}

impl Rates<'_> {
    /// From one column or several axes, all with the same unit.
    pub(super) fn of_columns(mut self, columns: &[Vec<f64>], unit: Option<RateUnit>) -> Result<Vec<f64>, Fault> {
        let liveliest = self.liveliest(columns);
        let rad_per_s = unit.unwrap_or(RateUnit::RADIANS_PER_SECOND).rad_per_s();
        let zero = self.options.zero.unwrap_or(0.0);
        let rates: Vec<f64> = columns[liveliest].iter().map(|rate| (rate - zero) * rad_per_s).collect();
        if self.is_ours {
            return Ok(rates);
        }
        self.notes.push(format!(
            "column {} is an angular velocity: fitted as such, with bias and scale of the sensor",
            self.names[liveliest]
        ));
        if unit.is_none() {
            self.notes.push(format!(
                "the unit of the rate is not stated: read as rad/s; if it is degrees a second say --columns {}",
                self.told[liveliest].rate(":deg/s")
            ));
        }
        self.judge(&rates, unit, self.told[liveliest])?;
        Ok(rates)
    }

    fn liveliest(&mut self, columns: &[Vec<f64>]) -> usize {
        let scatters: Vec<f64> = columns.iter().map(|column| scatter(column)).collect();
        let order = |a: &usize, b: &usize| scatters[*a].total_cmp(&scatters[*b]);
        let liveliest = (0..columns.len()).max_by(order).unwrap_or(0);
        let second = (0..columns.len()).filter(|idx| *idx != liveliest).max_by(order);
        if let Some(second) = second {
            let share = scatters[second] / scatters[liveliest].max(f64::MIN_POSITIVE);
            let percent = 100.0 * share;
            let names = (&self.names[liveliest], &self.names[second]);
            self.notes.push(format!("of {} axes {} moves most and is taken", columns.len(), names.0));
            if share > TILTED_SHARE {
                self.notes.push(format!(
                    "doubtful: {} moves {percent:.0} % as much as {}: the sensor is tilted against the shaft, or turns with \
                     it; lay one axis along the shaft",
                    names.1, names.0
                ));
            }
        }
        liveliest
    }

    /// By period, speed, and how the period grows with the amplitude; what the user told is only doubted.
    fn judge(&mut self, rates: &[f64], unit: Option<RateUnit>, told: Told) -> Result<(), Fault> {
        let Some(swings) = Swings::of(self.times_s, rates) else { return Ok(()) };
        swings.judge_period(told, self.options)?;
        let largest = swings.largest_rad;
        let fastest = 2.0 * swings.small_rad_s();
        let is_degrees = unit.is_some_and(|unit| unit.angle == AngleUnit::Degrees);
        let scale = swings.in_angles().scale();
        // The file says so, and no other unit would show this growth.
        let is_stated = unit.is_some() && matches!(scale, Scale::TooLarge { may_be_none: false, .. });
        let fault = match scale {
            _ if largest > FASTEST_MARGIN * fastest => Fault::too_fast(largest, fastest, told),
            Scale::TooLarge { predicted_percent, found_percent, .. } => {
                Fault::too_even(largest, (predicted_percent, found_percent), unit.is_some(), told)
            }
            Scale::TooSmall { factor } if is_degrees => {
                Fault::NotDegreesPerSecond { unit: "degrees a second", largest_rad_s: largest, factor, told }
            }
            _ => return Ok(()),
        };
        let is_told = self.options.angle_unit.is_some()
            || self
                .options
                .columns
                .as_ref()
                .is_some_and(|columns| columns.rate.as_ref().is_some_and(|r| r.1.is_some()));
        if is_told || is_stated {
            self.notes.push(format!("doubtful: {fault}"));
            return Ok(());
        }
        Err(fault)
    }
}

/// Root mean square distance from the mean.
fn scatter(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n).sqrt()
}
