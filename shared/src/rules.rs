//! What a fit or a diagnosis has to know of an effect besides its law.

/// How an effect is found and claimed, where that differs from all others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Only several releases tell it from laws of speed or angle: within one swing the amplitude falls as time goes by.
    pub needs_several_releases: bool,
    /// It depends on how far from the pivot the mass is, which swings alone do not tell.
    pub needs_geometry: bool,
    /// It is of a sensor that reads angles: an error that depends on where its scale stands, or play that has a width.
    pub needs_angles: bool,
    /// Which of its parameters is the angle, in rad, at which its torque vanishes. One that lies nowhere on the way
    /// makes it a constant torque, and no finding.
    pub relaxes_at: Option<u8>,
    /// Which of its parameters must lie within its range: at an end of it, it stands for another law, as a detent of few notches a
    /// turn does for a spring or for a constant torque.
    pub must_lie_within: Option<u8>,
    /// Its only parameter, in rad, is free for each swing in every fit, added to the readings: it is claimed by that
    /// value, never tried.
    pub is_free_offset: bool,
    /// It shifts the swings nearly as an offset of the readings does, and stands against it where one shows.
    pub resembles_offset: bool,
    /// Its only parameter is the relative error of the sensor's gain, which a calibration measures.
    pub is_calibrated: bool,
    /// Which of its parameters, at which value, makes it the effect that it generalises: an exponent.
    pub special_case_at: Option<(u8, f64)>,
    /// Which of its parameters is a share of which other one: its torque is linear in their product, not in the share.
    pub share_of: Option<(u8, u8)>,
    /// It is tried only in place of the effect that it generalises, from the numbers of that one; its first parameters
    /// are the same. Nothing suggests it alone, so that no first look has to know it.
    pub follows_special_case: bool,
    /// Only pictures have it. On a rig with another sensor it would stand for a law of friction, so that a diagnosis
    /// offers it to whoever has pictures, where nothing else explains the swings, and never claims it.
    pub is_of_pictures: bool,
    /// No first look tries it, because a board has no room for it or can't tell it; a diagnosis does.
    pub is_left_to_diagnosis: bool,
    /// So many of its starts, the last ones, are left to the diagnosis for the same reason.
    pub n_starts_left_to_diagnosis: u8,
    /// How its torque is spread along the way: a fit finds it only from nearby, so that a diagnosis begins it as closely as the
    /// swings are wide.
    pub pattern: Option<Pattern>,
    /// Symbols of numbers that its law had under another id; a model file that still has them is refused with what they
    /// meant.
    pub former: Option<Former>,
}

/// A torque that depends on the angle, by which of its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// So many periods a turn.
    Periods(u8),
    /// At one place: its angle and its half width, rad.
    Place(u8, u8),
}

/// Numbers that an effect no longer has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Former {
    /// Their symbols.
    pub symbols: &'static [&'static str],
    /// What they meant.
    pub meaning: &'static str,
}

impl Rules {
    /// None: most effects are tried, fitted and claimed by their gain alone.
    pub const NONE: Self = Self {
        needs_several_releases: false,
        needs_geometry: false,
        needs_angles: false,
        relaxes_at: None,
        must_lie_within: None,
        is_free_offset: false,
        resembles_offset: false,
        is_calibrated: false,
        special_case_at: None,
        share_of: None,
        follows_special_case: false,
        is_of_pictures: false,
        is_left_to_diagnosis: false,
        n_starts_left_to_diagnosis: 0,
        pattern: None,
        former: None,
    };
}
