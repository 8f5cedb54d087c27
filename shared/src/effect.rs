//! Physical effects: what may act on the pendulum or on its measurement. One file an effect, one list of all.
//!
//! An effect is data plus functions. The fit, the diagnosis, the commands, the page, the firmware, the documents and
//! the tests loop over [`Effect::ALL`]; none of them names an effect. To add one, write its file and its line in the
//! list below.

use crate::formula::Formula;
use crate::motion::Motion;
use crate::real::Real;

/// A text for people: nobody reads on the board, and all of them would take 1 kB of its flash.
#[cfg(not(target_os = "none"))]
macro_rules! prose {
    ($text:literal) => {
        $text
    };
}
#[cfg(target_os = "none")]
macro_rules! prose {
    ($text:literal) => {
        ""
    };
}

/// Makes each name a file of this folder and an entry of [`Effect::ALL`].
macro_rules! effects {
    ($($name:ident,)*) => {
        $(pub mod $name;)*

        /// How many effects there are.
        const N_EFFECTS: usize = [$(stringify!($name)),*].len();

        const fn all<R: Real>() -> [Effect<R>; N_EFFECTS] {
            [$($name::effect()),*]
        }
    };
}

// Every effect there is. Those on the sensor stand in the order in which they act, from the shaft to the wire.
effects! {
    viscous,
    coulomb,
    stiction,
    quadratic_drag,
    power_law_drag,
    stribeck,
    general_stribeck,
    load_dependent_coulomb,
    gear_load,
    asymmetric_coulomb,
    angle_dependent_friction,
    eddy_brake,
    general_brake,
    drifting_friction,
    general_drift,
    torsional_spring,
    general_spring,
    detent,
    pivot_compliance,
    resonant_support,
    presliding,
    general_presliding,
    backlash,
    rolling_shutter,
    sensor_nonlinearity,
    sensor_gain,
    angle_offset,
    sensor_lag,
    zero_drift,
}

/// The most parameters an effect may have.
pub const MAX_VALUES: usize = 4;

/// How many numbers an effect may remember between steps.
pub const MEMORY: usize = 2;

/// How many numbers a sensor effect may remember between readings.
pub const SENSOR_MEMORY: usize = 3;

/// The effect that a user types as a formula ([`crate::formula`]); a model has at most one.
pub const CUSTOM_FORMULA_ID: u16 = 1000;

/// Its name.
pub const CUSTOM_FORMULA_NAME: &str = "custom";

/// Friction as a free curve of the speed ([`crate::curve`]), whose knots stand beside the parameters.
pub const CURVE_ID: u16 = 1001;

/// Its name.
pub const CURVE_NAME: &str = "friction-curve";

/// One adjustable number of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// The symbol of the literature, e.g. `Mc`.
    pub symbol: &'static str,
    /// SI unit, `1` if it has none.
    pub unit: &'static str,
    /// Smallest value with a physical meaning.
    pub low: f64,
    /// Largest value to be expected on a rig of this size.
    pub high: f64,
    /// The value at which the effect is absent, or a usual one where the strength is another parameter.
    pub start: f64,
    /// What it says, in one phrase.
    pub meaning: &'static str,
}

/// Torque in N·m at an instant, positive counter-clockwise.
pub type Torque<R> = fn(&Motion<R>, &[R; MAX_VALUES]) -> R;

/// From the instants before and after a step and the memory before it: the memory after it.
pub type Advance<R> = fn(&Motion<R>, &Motion<R>, &[R; MEMORY], &[R; MAX_VALUES]) -> [R; MEMORY];

/// Where and how an effect acts.
#[derive(Clone, Copy)]
pub enum Action<R> {
    /// Part of the base model: [`crate::model`] calls its functions directly, because they run in every step.
    Base,
    /// A torque that is there at rest too (a spring, a magnet). Stiction has to hold against it.
    Drive(Torque<R>),
    /// A torque that opposes sliding. At rest stiction takes its place.
    Friction(Torque<R>),
    /// A torque with a memory of its own.
    State(Memory<R>),
    /// Something that swings with the pendulum, integrated beside it.
    Support(Support<R>),
    /// What the sensor makes of the angle.
    Sensor(Sensor<R>),
    /// A torque that somebody typed; not in the list of all.
    Formula(&'static Formula),
    /// A free curve of the speed; not in the list of all.
    Curve,
}

/// An effect with an added state. It brings its own exact or implicit update, because a stiff one would diverge under
/// the fixed Runge–Kutta step.
#[derive(Clone, Copy)]
pub struct Memory<R> {
    /// The memory of a pendulum that was held still at this instant.
    pub start: fn(&Motion<R>, &[R; MAX_VALUES]) -> [R; MEMORY],
    /// Torque in N·m at an instant, given the memory of the last accepted step; acts at rest too.
    pub torque: fn(&Motion<R>, &[R; MEMORY], &[R; MAX_VALUES]) -> R,
    /// The memory after a step from the first instant to the second; the sliding direction did not change in between.
    pub advance: Advance<R>,
}

/// A degree of freedom of its own, which the Runge–Kutta step takes with the pendulum's. It moves while the bearing sticks
/// too.
#[derive(Clone, Copy)]
pub struct Support<R> {
    /// The memory at the first instant that is known.
    pub start: fn(&Motion<R>, &[R; MAX_VALUES]) -> [R; MEMORY],
    /// What it does at an instant.
    pub shake: fn(&Motion<R>, &[R; MEMORY], &[R; MAX_VALUES]) -> Shake<R>,
}

/// What a support does to a pendulum, and what becomes of itself.
#[derive(Clone, Copy)]
pub struct Shake<R> {
    /// Torque in N·m on a pendulum that turns evenly; acts at rest too.
    pub torque_nm: R,
    /// The pendulum's inertia as a share of what it is in a bearing that is held.
    pub share_held: R,
    /// How fast the memory changes, its unit/s.
    pub rate: [R; MEMORY],
}

/// An effect on the measurement.
#[derive(Clone, Copy)]
pub struct Sensor<R> {
    /// The memory on a pendulum that was held still at this instant, given the reading of what lies before it.
    pub start: fn(R, &Motion<R>, &[R; MAX_VALUES]) -> [R; SENSOR_MEMORY],
    /// Takes the reading of what lies before it (the true angle for the first), gives its own, in rad.
    pub read: fn(R, &Motion<R>, &mut [R; SENSOR_MEMORY], &[R; MAX_VALUES]) -> R,
}

/// Effects that are hard to tell apart, because they do much the same to a swing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Torque that opposes the motion, the more the faster.
    Speed,
    /// Dry friction, alike at most speeds.
    Dry,
    /// Friction that differs from angle to angle.
    Angle,
    /// Friction that changes as time goes by.
    Time,
    /// A torque that the angle alone decides.
    Spring,
    /// Bearing or support that gives way before it slides.
    Give,
    /// What the sensor makes of the angle.
    Reading,
    /// A torque that somebody typed.
    Typed,
}

impl Family {
    /// What its members have in common.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Speed => prose!("friction that grows with speed"),
            Self::Dry => prose!("dry friction of another kind than Coulomb's"),
            Self::Angle => prose!("friction that depends on the angle"),
            Self::Time => prose!("friction that changes with time"),
            Self::Spring => prose!("a torque that depends on the angle alone"),
            Self::Give => prose!("a bearing or support that gives"),
            Self::Reading => prose!("a reading that is not the angle itself"),
            Self::Typed => prose!("a torque that was typed"),
        }
    }
}

/// A physical effect.
#[derive(Clone, Copy)]
pub struct Effect<R: 'static> {
    /// Stored in flash, rig files and recordings; never reused.
    pub id: u16,
    /// kebab-case.
    pub name: &'static str,
    /// One sentence for a student.
    pub summary: &'static str,
    /// The law in the symbols of `parameters`.
    pub formula: &'static str,
    /// Where the law comes from.
    pub source: &'static str,
    /// The experiment that shows it best.
    pub experiment: &'static str,
    /// Its numbers, at most [`MAX_VALUES`].
    pub parameters: &'static [Parameter],
    /// Points from which a fit begins, the first of them at every parameter's `start`. The strength is zero where the
    /// law is linear in it, what the law is not linear in is spread over its range: step the strength first, then all.
    pub starts: &'static [[f64; MAX_VALUES]],
    /// Which others it is hard to tell from.
    pub family: Family,
    /// The simpler effect of which this one is the wider form; the simpler one wins unless it is clearly worse.
    pub generalises: Option<&'static str>,
    /// Does its torque change within a few degrees? Then the fit takes shorter steps.
    pub is_fine: bool,
    /// What else a fit or a diagnosis has to know of it.
    pub rules: Rules,
    /// Where and how it acts.
    pub action: Action<R>,
}

/// How an effect is found and claimed, where that differs from all others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Only several releases tell it from laws of speed or angle: within one swing the amplitude falls as time goes by.
    pub needs_several_releases: bool,
    /// Which of its parameters is the angle, in rad, at which its torque vanishes. One that lies nowhere on the way
    /// makes it a constant torque, and no finding.
    pub relaxes_at: Option<u8>,
    /// Its only parameter, in rad, is free for each swing in every fit, added to the readings: it is claimed by that
    /// value, never tried.
    pub is_free_offset: bool,
    /// It shifts the swings nearly as an offset of the readings does, and stands against it where one shows.
    pub resembles_offset: bool,
    /// Its only parameter is the relative error of the sensor's gain, which a calibration measures.
    pub is_calibrated: bool,
    /// Which of its parameters, at which value, makes it the effect that it generalises: an exponent.
    pub special_case_at: Option<(u8, f64)>,
    /// It is tried only in place of the effect that it generalises, from the numbers of that one; its first parameters
    /// are the same. Nothing suggests it alone, so that no first look has to know it.
    pub follows_special_case: bool,
    /// Only pictures have it. On a rig with another sensor it would stand for a law of friction, so that a diagnosis
    /// offers it to whoever has pictures, where nothing else explains the swings, and never claims it.
    pub is_of_pictures: bool,
    /// No first look tries it, because a board has no room for it or can't tell it; a diagnosis does.
    pub is_left_to_diagnosis: bool,
}

impl Rules {
    /// None: most effects are tried, fitted and claimed by their gain alone.
    pub const NONE: Self = Self {
        needs_several_releases: false,
        relaxes_at: None,
        is_free_offset: false,
        resembles_offset: false,
        is_calibrated: false,
        special_case_at: None,
        follows_special_case: false,
        is_of_pictures: false,
        is_left_to_diagnosis: false,
    };
}

impl<R> core::fmt::Debug for Effect<R> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.name)
    }
}

/// The same id and the same law.
impl<R> PartialEq for Effect<R> {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id && self.formula == other.formula
    }
}

impl<R> Eq for Effect<R> {}

impl<R: Real> Effect<R> {
    /// Every effect there is. Those on the sensor stand in the order in which they act, from the shaft to the wire.
    pub const ALL: &'static [Effect<R>] = &without_prose_on_the_board(all());

    /// Index in [`Effect::ALL`] of the effect with this id.
    pub fn index_of(id: u16) -> Option<usize> {
        Self::ALL.iter().position(|effect| effect.id == id)
    }

    /// The effect with this id.
    pub fn by_id(id: u16) -> Option<&'static Effect<R>> {
        Self::index_of(id).map(|index| &Self::ALL[index])
    }

    /// The effect with this name.
    pub fn by_name(name: &str) -> Option<&'static Effect<R>> {
        Self::ALL.iter().find(|effect| effect.name == name)
    }

    /// The effects with a rule, such as `|rules| rules.is_calibrated`.
    pub fn with(rule: impl Fn(&Rules) -> bool) -> impl Iterator<Item = &'static Effect<R>> {
        Self::ALL.iter().filter(move |effect| rule(&effect.rules))
    }

    /// Those that may be missing from the base model, in their usual form: none that only follows its special case, and
    /// none that only pictures have.
    pub fn usual() -> impl Iterator<Item = &'static Effect<R>> {
        let is_usual =
            |Rules { follows_special_case, is_of_pictures, .. }: &Rules| !(*follows_special_case || *is_of_pictures);
        Self::ALL.iter().filter(move |effect| !effect.is_base() && is_usual(&effect.rules))
    }

    /// Does a first look try it?
    pub const fn is_for_first_look(&self) -> bool {
        let Rules { is_free_offset, follows_special_case, is_of_pictures, is_left_to_diagnosis, .. } = self.rules;
        !(self.is_base() || is_free_offset || follows_special_case || is_of_pictures || is_left_to_diagnosis)
    }

    /// The law that is tried in its place where it leaves more than the noise; none on the board, where nothing is tried.
    pub fn wider_form(&self) -> Option<&'static Effect<R>> {
        Self::with(|rules| rules.follows_special_case).find(|wide| wide.generalises == Some(self.name))
    }

    /// Part of the base model (viscous, Coulomb, stiction)?
    pub const fn is_base(&self) -> bool {
        matches!(self.action, Action::Base)
    }
}

/// Nobody reads there; every effect's texts would take 300 bytes of its flash.
const fn without_prose_on_the_board<R: Real, const N: usize>(mut all: [Effect<R>; N]) -> [Effect<R>; N] {
    let mut i = 0;
    while cfg!(target_os = "none") && i < N {
        (all[i].summary, all[i].formula, all[i].source, all[i].experiment) = ("", "", "", "");
        all[i].generalises = None;
        i += 1;
    }
    all
}

/// e^(−x) where q is 0, and (1 + q·x)₊^(−1/q) where not: q = 1 is a hyperbola, q = −1 a straight line that ends.
/// C. Tsallis, J. Stat. Phys. 52 (1988) 479.
fn q_exponential<R: Real>(x: R, q: R) -> R {
    let small = q * x;
    let is_small = small.abs().lt(R::of(1e-3));
    // ln(1 + s)/s to thirteen digits.
    let series = R::one() - small * (R::of(0.5) - small * (R::of(1.0 / 3.0) - small * R::of(0.25)));
    let whole = (R::one() + small).max(R::of(NEARLY_NOTHING)).ln() / R::select(is_small, R::one(), q);
    (-R::select(is_small, x * series, whole)).exp()
}

/// Its logarithm exists in single precision too.
const NEARLY_NOTHING: f64 = 1e-30;

/// Ids are unique, not reserved, and no effect has too many parameters: checked when the crate is compiled.
const _: () = {
    let all = Effect::<f64>::ALL;
    let mut i = 0;
    while i < all.len() {
        assert!(all[i].id != CUSTOM_FORMULA_ID && all[i].id != CURVE_ID, "this id is reserved");
        assert!(all[i].parameters.len() <= MAX_VALUES, "an effect has too many parameters");
        let mut j = i + 1;
        while j < all.len() {
            assert!(all[i].id != all[j].id, "two effects share an id");
            j += 1;
        }
        i += 1;
    }
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_explains_itself() {
        for effect in Effect::<f64>::ALL {
            assert!(effect.name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'));
            for text in [effect.summary, effect.formula, effect.source, effect.experiment] {
                assert!(text.len() > 5, "{}: a text is missing", effect.name);
            }
            for p in effect.parameters {
                assert!(p.low < p.high && (p.low..=p.high).contains(&p.start), "{} {}", effect.name, p.symbol);
            }
        }
    }

    #[test]
    fn fits_start_inside_the_ranges_and_first_where_the_parameters_say() {
        for effect in Effect::<f64>::ALL {
            assert!(!effect.starts.is_empty(), "{}", effect.name);
            for (i, p) in effect.parameters.iter().enumerate() {
                assert_eq!(effect.starts[0][i], p.start, "{} {}", effect.name, p.symbol);
                assert!(effect.starts.iter().all(|start| (p.low..=p.high).contains(&start[i])), "{}", effect.name);
            }
        }
    }

    #[test]
    fn rules_speak_of_parameters_that_the_effect_has() {
        for effect in Effect::<f64>::ALL {
            let Rules { relaxes_at, is_free_offset, is_calibrated, .. } = effect.rules;
            let relaxes_at = relaxes_at.map(|index| effect.parameters[usize::from(index)].unit);
            assert!(relaxes_at.is_none_or(|unit| unit == "rad"), "{}", effect.name);
            assert!(!(is_free_offset || is_calibrated) || effect.parameters.len() == 1, "{}", effect.name);
        }
        assert_eq!(Effect::<f64>::with(|rules| rules.is_free_offset).count(), 1, "a reading has one offset");
        assert_eq!(Effect::<f64>::with(|rules| rules.is_calibrated).count(), 1, "a sensor has one gain");
    }

    #[test]
    fn what_an_effect_generalises_exists_and_has_fewer_parameters() {
        for effect in Effect::<f64>::ALL {
            if let Some(simpler) = effect.generalises {
                let simpler = Effect::<f64>::by_name(simpler).unwrap();
                assert!(simpler.parameters.len() < effect.parameters.len(), "{}", effect.name);
            }
        }
    }

    #[test]
    fn a_law_that_follows_its_special_case_has_the_same_numbers_first_under_symbols_of_its_own() {
        for effect in Effect::<f64>::with(|rules| rules.follows_special_case) {
            let simpler = Effect::<f64>::by_name(effect.generalises.unwrap()).unwrap();
            let same = effect.parameters.iter().zip(simpler.parameters).all(|(a, b)| a.unit == b.unit);
            assert!(same && effect.rules.special_case_at.is_some(), "{}", effect.name);
            let all = || Effect::<f64>::ALL.iter().flat_map(|effect| effect.parameters);
            let is_own = |p: &Parameter| all().filter(|other| other.symbol == p.symbol).count() == 1;
            assert!(effect.parameters.iter().all(is_own), "{}", effect.name);
        }
    }

    #[test]
    fn names_find_their_effects_on_both_number_types() {
        for effect in Effect::<f32>::ALL {
            assert_eq!(Effect::<f64>::by_name(effect.name).unwrap().id, effect.id);
            assert_eq!(Effect::<f64>::by_id(effect.id).unwrap().name, effect.name);
        }
    }
}

/// Calls an effect's function at one instant, for the tests of the effects.
#[cfg(test)]
pub(crate) mod tests_support {
    use super::*;
    use crate::motion::Pendulum;

    pub(crate) fn motion_at(angle_rad: f64, velocity_rad_s: f64, time_s: f64) -> Motion<f64> {
        let pendulum = Pendulum { mass_kg: 0.15, length_m: 0.16, inertia_kg_m2: 2.7e-3, gravity_m_s2: 9.81 };
        Motion { angle_rad, velocity_rad_s, direction: velocity_rad_s.sign(), time_s, pendulum }
    }

    fn padded(values: &[f64]) -> [f64; MAX_VALUES] {
        core::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0))
    }

    pub(crate) fn torque_at(effect: &Effect<f64>, angle_rad: f64, velocity_rad_s: f64, values: &[f64]) -> f64 {
        torque_at_time(effect, angle_rad, velocity_rad_s, 0.0, values)
    }

    pub(crate) fn torque_at_time(
        effect: &Effect<f64>,
        angle_rad: f64,
        velocity_rad_s: f64,
        time_s: f64,
        values: &[f64],
    ) -> f64 {
        let motion = motion_at(angle_rad, velocity_rad_s, time_s);
        match effect.action {
            Action::Drive(torque) | Action::Friction(torque) => torque(&motion, &padded(values)),
            _ => panic!("{} has no torque of this instant alone", effect.name),
        }
    }

    pub(crate) fn reading_at(effect: &Effect<f64>, angle_rad: f64, velocity_rad_s: f64, values: &[f64]) -> f64 {
        let (motion, values) = (motion_at(angle_rad, velocity_rad_s, 0.0), padded(values));
        match effect.action {
            Action::Sensor(sensor) => {
                (sensor.read)(angle_rad, &motion, &mut (sensor.start)(angle_rad, &motion, &values), &values)
            }
            _ => panic!("{} is not a sensor effect", effect.name),
        }
    }
}
