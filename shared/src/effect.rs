//! Physical effects: what may act on the pendulum or on its measurement. One file an effect, one list of all.
//!
//! An effect is data plus functions. The fit, the diagnosis, the commands, the page, the firmware, the documents and
//! the tests loop over [`Effect::ALL`]; none of them names an effect. To add one, write its file and its line in the
//! list below.

pub use crate::action::{Action, Advance, Memory, Sensor, Shake, Support, Torque};
pub use crate::limits::{MAX_VALUES, MEMORY, SENSOR_MEMORY};
pub use crate::rules::{Former, Pattern, Rules};

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
    shear_thinning,
    general_thinning,
    stribeck,
    general_stribeck,
    load_dependent_coulomb,
    gear_load,
    general_gear_load,
    asymmetric_coulomb,
    asymmetric_viscous,
    angle_dependent_friction,
    eddy_brake,
    general_brake,
    drifting_friction,
    general_drift,
    torsional_spring,
    general_spring,
    detent,
    pivot_compliance,
    string_stretch,
    resonant_support,
    presliding,
    general_presliding,
    backlash,
    rolling_shutter,
    eccentric_sensor,
    misaligned_sensor,
    sensor_nonlinearity,
    sensor_gain,
    angle_offset,
    sensor_lag,
    zero_drift,
}

/// The effect that a user types as a formula ([`crate::formula`]); a model has at most one.
pub const CUSTOM_FORMULA_ID: u16 = 1000;

/// Its name.
pub const CUSTOM_FORMULA_NAME: &str = "custom";

/// Friction as a free curve of the speed ([`crate::curve`]), whose knots stand beside the parameters.
pub const CURVE_ID: u16 = 1001;

/// Its name.
pub const CURVE_NAME: &str = "friction-curve";

/// Ids of laws that are no more, in flash and recordings of earlier versions.
const FORMER_IDS: [u16; 2] = [19, 23];

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

    /// Its starts that a first look tries.
    pub fn first_look_starts(&self) -> &'static [[f64; MAX_VALUES]] {
        &self.starts[..self.starts.len().saturating_sub(usize::from(self.rules.n_starts_left_to_diagnosis))]
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
        (all[i].generalises, all[i].rules.former) = (None, None);
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
        assert!(all[i].id != FORMER_IDS[0] && all[i].id != FORMER_IDS[1], "this id was another law's");
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
mod tests;
#[cfg(test)]
pub(crate) mod tests_support;
