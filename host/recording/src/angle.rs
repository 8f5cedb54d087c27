//! From the numbers of a file to angles of a pendulum that hangs at 0: unit, wraps, zero, and whether that can be.
//!
//! Whatever is assumed or changed is noted; what would be wrong is refused with the option that cures it.

use super::circle::Circle;
use super::error::Fault;
use super::limits::LARGEST_UNSTATED_RAD;
use super::options::ReadOptions;
use super::plausible::{self, Scale, Swings};
use super::ticks;
use super::told::Told;
use super::units::AngleUnit;
use super::whole_turns;
use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

/// Angles of unstated unit beyond this leave a note: more than half a turn is rare.
const NOTED_UNSTATED_RAD: f64 = 3.3;

/// A middle of the swings further off than this is no error of the sensor's zero, rad (20°).
const FAR_OFF_RAD: f64 = 0.35;

/// So near to a quarter or half turn it is measured from the horizontal or from upright, rad (12°).
const NEAR_QUARTER_RAD: f64 = 0.2;

/// A lever on a stiff spring swings with a constant period too, but not as far as this, rad (69°).
const SPRING_RAD: f64 = 1.2;

/// Angles that seem this much larger than read as degrees are radians, 57 times; magnets make them seem a few times.
const RADIANS_AS_DEGREES: f64 = 20.0;

/// Larger angles in degrees are no radians of a pendulum.
const SMALL_DEG: f64 = PI;

/// What the numbers of a file need to become angles.
pub(super) struct Angles<'a> {
    pub(super) times_s: &'a [f64],
    /// Our own files say what they are.
    pub(super) is_ours: bool,
    pub(super) options: &'a ReadOptions,
    /// The columns, for messages.
    pub(super) told: Told,
    pub(super) notes: &'a mut Vec<String>,
}

impl Angles<'_> {
    /// From a column of angles; with its name where that says so.
    pub(super) fn of_column(
        mut self,
        name: Option<&str>,
        angles: &[f64],
        unit: Option<AngleUnit>,
    ) -> Result<Vec<f64>, Fault> {
        let zero = self.options.zero.unwrap_or(0.0);
        let in_unit = |angles: &[f64], unit: Option<AngleUnit>| -> Vec<f64> {
            let factor = unit.unwrap_or(AngleUnit::Radians).radians();
            angles.iter().map(|angle| (angle - zero) * factor).collect()
        };
        if self.is_ours {
            return Ok(in_unit(angles, unit));
        }
        let angles = self.unwound(angles);
        let unit = if unit.is_none() { self.judge_unstated_unit(name, &angles, zero)? } else { unit };
        let mut angles_rad = in_unit(&angles, unit);
        self.unwrap(&mut angles_rad);
        self.take_off_whole_turns(&mut angles_rad);
        let swings = self.swings(&angles_rad);
        if let Some(swings) = &swings {
            swings.judge_period(self.told, self.options)?;
            self.judge_unit(swings, unit)?;
            // Where the counts or volts of a sensor are 0 is no direction.
            let quarter = (!matches!(unit, Some(AngleUnit::Of(_)))).then_some("it is measured from the horizontal");
            self.set_zero(swings, quarter, &mut angles_rad);
        }
        Ok(angles_rad)
    }

    /// From a point on the pendulum; where its pivot is, if that is known without the user.
    pub(super) fn of_point(mut self, x: &[f64], y: &[f64], pivot: Option<[f64; 2]>) -> Result<Vec<f64>, Fault> {
        let within = self.within();
        let circle = Circle::through(&x[within.clone()], &y[within], self.options.pivot.or(pivot))?;
        let mut angles_rad = circle.angles_rad(x, y);
        plausible::unwrap(&mut angles_rad);
        let zero_rad = self.options.zero.unwrap_or(0.0).to_radians();
        angles_rad.iter_mut().for_each(|angle| *angle -= zero_rad);
        let swings = self.swings(&angles_rad);
        self.notes.push(match &swings {
            Some(swings) => circle.unless_period_tells(swings.small_period_s()).in_words(),
            None => circle.in_words(),
        });
        if let Some(swings) = swings {
            swings.judge_period(self.told, self.options)?;
            self.set_zero(&swings, Some("the picture is turned"), &mut angles_rad);
        }
        Ok(angles_rad)
    }

    /// How it swings where the user asks, or in the whole recording where that is too little.
    fn swings(&self, angles_rad: &[f64]) -> Option<Swings> {
        let within = self.within();
        let asked = Swings::of(&self.times_s[within.clone()], &angles_rad[within]);
        asked.or_else(|| Swings::of(self.times_s, angles_rad))
    }

    /// The samples that the user asks for; all of them where there are none.
    fn within(&self) -> Range<usize> {
        let [from_s, to_s] = self.options.within_s;
        let start = from_s.map_or(0, |from_s| self.times_s.partition_point(|time_s| *time_s < from_s));
        let end = to_s.map_or(self.times_s.len(), |to_s| self.times_s.partition_point(|time_s| *time_s <= to_s));
        if start < end { start..end } else { 0..self.times_s.len() }
    }

    /// Counts of an encoder that go on where they begin anew.
    fn unwound<'b>(&mut self, angles: &'b [f64]) -> Cow<'b, [f64]> {
        let mut counts = angles.to_vec();
        let Some((n, bits)) = ticks::unwind(&mut counts) else { return Cow::Borrowed(angles) };
        self.notes.push(format!("the angles are counts of {bits} bits that begin anew {n} times: they go on there"));
        Cow::Owned(counts)
    }

    /// What a unit that is not stated must be, if anything.
    fn judge_unstated_unit(
        &mut self,
        name: Option<&str>,
        angles: &[f64],
        zero: f64,
    ) -> Result<Option<AngleUnit>, Fault> {
        let largest = angles.iter().fold(0.0_f64, |largest, angle| largest.max((angle - zero).abs()));
        if largest > LARGEST_UNSTATED_RAD {
            if self.are_turns_away(angles) {
                return Ok(Some(AngleUnit::Radians));
            }
            let mut in_degrees: Vec<f64> = angles.iter().map(|angle| angle.to_radians()).collect();
            plausible::unwrap(&mut in_degrees);
            let swings = Swings::of(self.times_s, &in_degrees);
            let may_be = |swings: &Swings| matches!(swings.scale(), Scale::Right | Scale::Unknown);
            let evidence = match (&swings, name) {
                (Some(swings), _) if swings.is_pendulum() => {
                    "the period grows with them as it does for degrees".to_owned()
                }
                (Some(swings), Some(name)) if may_be(swings) && Self::may_be_degrees(angles) => {
                    format!("{name} is called an angle, whose unit is not stated")
                }
                _ => return Err(Fault::LooksLikeDegrees { largest, told: self.told }),
            };
            self.notes.push(format!("angles reach {largest:.1}, and {evidence}: read as degrees"));
            return Ok(Some(AngleUnit::Degrees));
        }
        if largest > NOTED_UNSTATED_RAD {
            self.notes.push(format!("angles reach {largest:.2}, read as radians; if they are degrees say --degrees"));
        }
        Ok(None)
    }

    /// Do all of them lie within a turn of degrees, and are they no whole numbers, as counts and steps would be?
    fn may_be_degrees(angles: &[f64]) -> bool {
        angles.iter().all(|angle| angle.abs() <= 360.0) && angles.iter().any(|angle| angle.fract() != 0.0)
    }

    /// Are these radians of a pendulum that hangs some turns from 0, or from upright? Its swings stay within a turn about there, and
    /// their period grows with them as that of a pendulum does.
    fn are_turns_away(&self, angles: &[f64]) -> bool {
        Swings::of(self.times_s, angles).is_some_and(|swings| {
            let halves = swings.middle_rad / PI;
            let is_whole = (halves - halves.round()).abs() * PI < NEAR_QUARTER_RAD;
            is_whole && swings.largest_rad < LARGEST_UNSTATED_RAD && swings.is_pendulum()
        })
    }

    fn unwrap(&mut self, angles_rad: &mut [f64]) {
        let n_wraps = plausible::unwrap(angles_rad);
        if n_wraps > 0 {
            self.notes
                .push(format!("the angle wraps around {n_wraps} times: full turns added so that it goes on evenly"));
        }
    }

    fn take_off_whole_turns(&mut self, angles_rad: &mut [f64]) {
        let n_runs = whole_turns::take_off(self.times_s, angles_rad);
        if n_runs > 0 {
            let behind = if n_runs == 1 { "a hole".to_owned() } else { format!("{n_runs} holes") };
            self.notes
                .push(format!("behind {behind} in the rows it hangs whole turns away: these are taken off there"));
        }
    }

    /// By how the period grows with the amplitude; what the user told is only doubted.
    fn judge_unit(&mut self, swings: &Swings, unit: Option<AngleUnit>) -> Result<(), Fault> {
        let is_told = self.options.angle_unit.is_some()
            || self
                .options
                .columns
                .as_ref()
                .is_some_and(|columns| columns.angle.as_ref().is_some_and(|(_, unit)| unit.is_some()));
        let scale = swings.scale();
        // The file says so, and no other unit would show this growth.
        let is_stated = unit.is_some() && matches!(scale, Scale::TooLarge { may_be_none: false, .. });
        let fault = match scale {
            Scale::TooLarge { predicted_percent, found_percent, .. } => {
                Fault::NotRadians { largest_rad: swings.largest_rad, predicted_percent, found_percent, told: self.told }
            }
            Scale::TooSmall { factor } if unit == Some(AngleUnit::Degrees) && factor > RADIANS_AS_DEGREES => {
                Fault::NotDegrees { unit: "degrees", largest_rad: swings.largest_rad, factor }
            }
            // What is too small is asked of the free swing alone, once that is found.
            Scale::Unknown | Scale::TooSmall { .. } if unit.is_none() => {
                let largest = swings.largest_rad;
                self.notes.push(format!(
                    "the unit of the angle is not stated: read as radians, up to {largest:.3}; if they are degrees say --degrees"
                ));
                return Ok(());
            }
            Scale::Unknown if unit == Some(AngleUnit::Degrees) && !is_told => {
                let largest = swings.largest_rad.to_degrees();
                if largest < SMALL_DEG && swings.may_be_larger(1_f64.to_degrees()) {
                    self.notes.push(format!(
                        "doubtful: degrees, as the file says, up to {largest:.2}, but the period grows as for radians; if they are, \
                         say --radians"
                    ));
                }
                return Ok(());
            }
            _ => return Ok(()),
        };
        let may_be_spring = swings.largest_rad < SPRING_RAD && unit.is_none();
        if is_told || is_stated {
            let or = match fault {
                Fault::NotRadians { .. } => {
                    ", or does a spring swing it and no gravity, as in a torsion pendulum, which can't be fitted"
                }
                _ => "",
            };
            self.notes.push(format!("doubtful: {}; is it an angle, and in that unit{or}?", fault.evidence()));
            return Ok(());
        }
        if may_be_spring {
            self.notes.push(format!("doubtful: {fault}"));
            return Ok(());
        }
        Err(fault)
    }

    /// Where it hangs is 0: angles from the horizontal (which is said in these words, if 0 is a direction) or from upright are
    /// turned, whole turns taken off, and the middle of the swings where it is nothing of that.
    fn set_zero(&mut self, swings: &Swings, quarter: Option<&str>, angles_rad: &mut [f64]) {
        let middle_rad = swings.middle_rad;
        // What swings about 0 passes it, however small.
        if middle_rad.abs() < FAR_OFF_RAD.min(swings.largest_rad) {
            return;
        }
        let middle_deg = middle_rad.to_degrees();
        let is_near = |rad: f64| rad != 0.0 && (middle_rad - rad).abs() < NEAR_QUARTER_RAD;
        let [turns_rad, quarters_rad] = [TAU, FRAC_PI_2].map(|unit_rad| (middle_rad / unit_rad).round() * unit_rad);
        if self.options.zero.is_some() && !is_near(turns_rad) {
            self.notes.push(format!(
                "doubtful: with --zero it swings about {middle_rad:.3} rad ({middle_deg:.1}°), but should hang at 0"
            ));
            return;
        }
        let is_quarter = is_near(quarters_rad) && (quarter.is_some() || is_near(turns_rad));
        let off_rad = if is_quarter { quarters_rad } else { middle_rad };
        angles_rad.iter_mut().for_each(|angle| *angle -= off_rad);
        let from = match (quarters_rad / FRAC_PI_2).rem_euclid(4.0) as u8 {
            0 => "whole turns",
            2 => "it is measured from upright",
            _ => quarter.unwrap_or_default(),
        };
        self.notes.push(match is_quarter {
            true => format!("it swings about {middle_deg:.1}°: {from}, {:.0}° taken off", off_rad.to_degrees()),
            false if middle_rad.abs() > TAU => format!(
                "doubtful: it swings about {middle_rad:.1} rad ({middle_deg:.0}°), more than a whole turn away and no number of half \
                 turns, and that is taken off; are these angles, and no accelerations, volts or counts? --zero says what the \
                 sensor reads where it hangs"
            ),
            false => format!(
                "it swings about {middle_rad:.3} rad ({middle_deg:.1}°), which is taken off: it must hang at 0; --zero says \
                 better what the sensor reads there"
            ),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::measured::Measured;

    fn found(of: impl FnOnce(Angles<'_>) -> Vec<f64>) -> (Vec<f64>, Vec<String>) {
        let times_s: Vec<f64> = (0..400).map(|idx| 0.01 * f64::from(idx)).collect();
        let (options, mut notes) = (ReadOptions::default(), Vec::new());
        let told = Told { time: Some(0), reading: 1, measured: Measured::Angle };
        let angles = of(Angles { times_s: &times_s, is_ours: false, options: &options, told, notes: &mut notes });
        (angles, notes)
    }

    #[test]
    fn a_point_that_swings_two_below_its_pivot_gives_its_angles() {
        let truth: Vec<f64> = (0..400).map(|idx| 0.8 * (0.06 * f64::from(idx)).cos()).collect();
        let x: Vec<f64> = truth.iter().map(|angle| 3.0 + 2.0 * angle.sin()).collect();
        let y: Vec<f64> = truth.iter().map(|angle| 5.0 - 2.0 * angle.cos()).collect();
        let (angles, notes) = found(|angles| angles.of_point(&x, &y, None).unwrap());
        assert_eq!(angles.len(), truth.len());
        assert!(angles.iter().zip(&truth).all(|(found, angle)| (found - angle).abs() < 1e-6));
        assert!(notes[0].contains("pivot at (3.0000, 5.0000), radius 2.0000"), "{notes:?}");
    }

    #[test]
    fn degrees_have_a_direction_and_counts_of_a_sensor_have_none() {
        let about_175: Vec<f64> = (0..400).map(|idx| 175.0 + 40.0 * (0.06 * f64::from(idx)).cos()).collect();
        for (unit, left_deg, said) in
            [(AngleUnit::Degrees, -5.0, "upright"), (AngleUnit::Of(1_f64.to_radians()), 0.0, "--zero")]
        {
            let (angles, notes) = found(|angles| angles.of_column(None, &about_175, Some(unit)).unwrap());
            let middle_deg = (angles.iter().fold(f64::MAX, |a, b| a.min(*b)) + 40_f64.to_radians()).to_degrees();
            assert!((middle_deg - left_deg).abs() < 2.0 && notes[0].contains(said), "{middle_deg} {notes:?}");
        }
    }

    /// Fifteen swings from 0.6, and readings that scatter by a hundredth of it: too little for a refusal.
    fn fifteen_swings(torque: impl Fn(f64) -> f64) -> Vec<f64> {
        let (mut angle, mut velocity, mut noise) = (0.6_f64, 0.0_f64, crate::random::Noise::new(1));
        let mut readings = Vec::new();
        for step_idx in 0..15_000 {
            if step_idx % 25 == 0 {
                readings.push(angle + 5e-3 * noise.normal());
            }
            velocity -= 1e-3 * (39.5 * torque(angle) + 0.2 * velocity);
            angle += 1e-3 * velocity;
        }
        readings
    }

    /// What is said of readings every 25 ms, whose unit the file says.
    fn said_of(readings: &[f64], unit: AngleUnit) -> Vec<String> {
        let times_s: Vec<f64> = (0..readings.len()).map(|idx| 0.025 * idx as f64).collect();
        let (options, mut notes) = (ReadOptions::default(), Vec::new());
        let told = Told { time: Some(0), reading: 1, measured: Measured::Angle };
        let angles = Angles { times_s: &times_s, is_ours: false, options: &options, told, notes: &mut notes };
        angles.of_column(None, readings, Some(unit)).unwrap();
        notes
    }

    #[test]
    fn a_torsion_pendulum_is_told_to_be_perhaps_one_though_the_file_says_radians() {
        let far = |torque: fn(f64) -> f64| -> Vec<f64> {
            fifteen_swings(|angle| torque(4.0 * angle) / 4.0).iter().map(|angle| 4.0 * angle).collect()
        };
        let said = said_of(&far(|angle| angle - angle.powi(3) / 60.0), AngleUnit::Radians);
        assert!(said[0].starts_with("doubtful") && said[0].contains("a torsion pendulum"), "{said:?}");
        assert_eq!(said_of(&far(f64::sin), AngleUnit::Radians), Vec::<String>::new());
    }

    #[test]
    fn radians_under_the_name_of_degrees_are_doubted_and_degrees_are_not() {
        let said = |readings: &[f64]| said_of(readings, AngleUnit::Degrees);
        let in_radians = said(&fifteen_swings(f64::sin));
        assert!(in_radians.len() == 1 && in_radians[0].contains("--radians"), "{in_radians:?}");
        let half_a_degree = fifteen_swings(|angle| angle);
        let of_34_degrees: Vec<f64> = fifteen_swings(f64::sin).iter().map(|angle| angle.to_degrees()).collect();
        assert_eq!([said(&half_a_degree), said(&of_34_degrees)], [Vec::<String>::new(), Vec::new()]);
    }

    #[test]
    fn counts_of_sixteen_bits_go_on_where_they_begin_anew() {
        let truth: Vec<f64> = (0..400).map(|idx| (1000.0 * (0.06 * f64::from(idx)).cos()).round()).collect();
        let counts: Vec<f64> = truth.iter().map(|count| count.rem_euclid(65_536.0)).collect();
        let (unwound, notes) = found(|mut angles| angles.unwound(&counts).into_owned());
        assert_eq!(unwound, truth);
        assert!(notes[0].contains("16 bits"), "{notes:?}");
    }
}
