//! What a split by angle and speed says, for a person.

use super::of_state::{IS_LAW, IS_NONE, Kind, OfPictures, OfState, removes_as_much};

impl OfState {
    /// With what explains it if the readings come from pictures.
    pub(super) fn with_pictures(mut self, found: Option<OfPictures>) -> Self {
        if let Some(OfPictures { effect, rmse }) = &found {
            self.words += &format!(
                " If the readings come from pictures, {effect} explains it: {:.2} mrad are left with it, about the \
                 noise. Take it with host improve … --add {effect} -o rig.toml",
                1e3 * rmse
            );
        }
        self.of_pictures = found;
        self
    }

    pub(super) fn in_words(&self) -> String {
        let left = if self.beside_curve { "what the friction curve leaves" } else { "what is left" };
        let [torque, reading] = [self.torque_removes, self.reading_removes].map(in_percent);
        let removes = format!(
            "a free torque of angle and speed would remove {torque} of {left}, on parts of the swings that it was not \
             fitted to"
        );
        let said = match self.kind {
            Kind::Law => format!("A law of the motion is missing: {removes}."),
            Kind::LawOrScale => format!(
                "A law of the motion is missing, or the scale of the sensor or the camera is not even: {removes}; in its \
                 place an error of the readings would remove {reading}. Either does it alone, and these swings can't \
                 tell which."
            ),
            Kind::Elsewhere => self.elsewhere(left),
            Kind::Undecided => format!("Whether a law of the motion is missing can't be told: {removes}."),
        };
        said + &self.of_clock() + self.doubt_of_time()
    }

    /// A clock that goes wrong alike in each release, where it explains as much as a law does, or what no law explains. Of 17 pairs
    /// of simulated releases whose clock warms up it removes 0.93 and more; of seven laws beyond the list 0.88 at most, and
    /// less than a torque of angle and speed does.
    fn of_clock(&self) -> String {
        let Some(share) = self.clock_removes else { return String::new() };
        match self.kind {
            Kind::Elsewhere if share >= IS_NONE => {
                format!(" A clock that goes wrong alike in each release would remove {}.", in_percent(share))
            }
            Kind::Law | Kind::LawOrScale | Kind::Undecided
                if share >= IS_LAW.min(self.torque_removes) && removes_as_much(share, self.torque_removes) =>
            {
                format!(
                    " So would a clock that goes wrong alike in each release, by {}: compare the logger's clock with another one \
                 before you look for a law.",
                    in_percent(share)
                )
            }
            _ => String::new(),
        }
    }

    /// What was found and what remains: of a law that a coarse grid can't show nothing is said.
    fn elsewhere(&self, left: &str) -> String {
        let between = if self.releases > 1 { " or from release to release" } else { "" };
        let ([angle_rad, speed_rad_s], blocks) = (self.widths, self.blocks);
        let torque = in_percent(self.torque_removes);
        let mut words = format!(
            "A torque that is smooth in angle and speed removes {torque} of {left}, where of {blocks} blocks of the swings every \
             third was left out in turn. There remain clock, camera, sensor, play, a support that moves, what changes in \
             time{between}, and a law that is narrower than {angle_rad:.2} rad or {speed_rad_s:.2} rad/s."
        );
        if self.reading_removes >= IS_NONE {
            words += &format!(
                " An error of the readings that depends on angle and direction would remove {}: look at the sensor and \
                 its play first.",
                in_percent(self.reading_removes)
            );
        }
        if !self.rest_is_seen {
            words += " Or it is noise that neighbouring readings share, as a filter or hum makes it: let the pendulum \
                      hang still at the end of a recording, which tells its size.";
        }
        words
    }

    fn doubt_of_time(&self) -> &'static str {
        match self.kind {
            Kind::Elsewhere => "",
            _ if self.time_differs => "",
            _ if self.releases == 1 => {
                " One release can't tell state from time: what changes while it swings would look the same. Record a \
                 second one from two thirds of the angle."
            }
            _ => {
                " These releases can't tell state from time: what changes while they swing would look the same. Record \
                 one from two thirds of the angle of another."
            }
        }
    }
}

/// Shares beyond all or nothing are chance.
fn in_percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share.clamp(0.0, 1.0))
}
