//! The columns of a file as `--columns` tells them, for messages: what they advise holds for the very file.

use shared::measured::Measured;

/// Where time and readings were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Told {
    /// `None` where a rate tells the time.
    pub(super) time: Option<usize>,
    /// Of angles or rates.
    pub(super) reading: usize,
    /// Which of both they are.
    pub(super) measured: Measured,
}

impl Told {
    /// `t=0,theta=1` with a unit behind each: `:ms`, `:deg`.
    pub(super) fn angle(self, time_unit: &str, unit: &str) -> String {
        format!("{}theta={}{unit}", self.before(time_unit), self.reading)
    }

    /// `t=0,rate=1:deg/s`
    pub(super) fn rate(self, unit: &str) -> String {
        format!("{}rate={}{unit}", self.before(""), self.reading)
    }

    /// `t=0:ms,theta=1`, or `rate=1`: the columns as they were found, with the unit of the time.
    pub(super) fn with_time(self, unit: &str) -> String {
        let name = if self.measured == Measured::Rate { "rate" } else { "theta" };
        format!("{}{name}={}", self.before(unit), self.reading)
    }

    /// What follows of a period that no pendulum has, where somebody said the unit of the time, and where nobody did.
    pub(super) fn explains_period(self, is_told: bool) -> String {
        if is_told {
            return "with the time that was told a spring or a wire swings it and no gravity, as in a torsion pendulum, which \
                    can't be fitted, or this column is not its angle"
                .to_owned();
        }
        let how = self.time.map_or("--rate".to_owned(), |_| format!("--columns {}", self.with_time(":ms")));
        format!("the unit of the time is not what it seems: say it, {how} (s, ms, us, ns, min, day)")
    }

    fn before(self, time_unit: &str) -> String {
        self.time.map_or(String::new(), |idx| format!("t={idx}{time_unit},"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_told_as_the_option_takes_them() {
        let told = Told { time: Some(2), reading: 0, measured: Measured::Angle };
        assert_eq!(told.angle(":ms", ":deg"), "t=2:ms,theta=0:deg");
        assert_eq!(told.rate(":deg/s"), "t=2,rate=0:deg/s");
        assert_eq!(Told { time: None, ..told }.angle("", ""), "theta=0");
        assert_eq!(told.with_time(":ms"), "t=2:ms,theta=0");
        assert_eq!(Told { measured: Measured::Rate, ..told }.with_time(":ms"), "t=2:ms,rate=0");
    }
}
