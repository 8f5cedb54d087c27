//! What no effect of the list explains: a search through small formulas for the torque that is left.
//!
//! A formula is a strength times a law of speed, a law of angle, or both: powers of |ω|, sgn ω, sines and cosines of
//! nθ, powers of |θ|, bumps. Each is judged by the score test over all parameters ([`crate::fit::prediction`]), as the effects
//! of the list are: a torque map would have to be averaged over bins and would not let friction and inertia answer.
//! First the laws of speed and of angle alone, then the best laws of speed times those of angle; the best few are fitted
//! with their exponents, widths and places free. Every number and every factor counts against a formula.

use super::models::excess;
use super::physical::is_sound;
use crate::cores::on_all_cores;
use crate::fit::descent::Tolerance;
use crate::fit::fitted::Fitted;
use crate::fit::prediction::{Prediction, predictions};
use crate::fit::problem::Problem;
use crate::fit::refine::Band;
use crate::formula::{self, read};
use crate::swing::Window;
use shared::effect::{Effect, MAX_VALUES};

/// Laws of speed that are combined with laws of angle.
const COMBINED: usize = 3;

/// Formulas that are fitted in earnest.
const FITTED: usize = 5;

/// Formulas offered, at most.
pub(super) const OFFERED: usize = 3;

/// A formula that removes less of the excess than this share is not worth a word.
const WORTH_A_WORD: f64 = 0.25;

/// The strength is sought up to this share of m·g·l, at middle speed and angle.
const STRONGEST: f64 = 0.1;

/// A factor of a formula with its own numbers.
#[derive(Clone, Copy, Debug)]
struct Law {
    /// As it is typed.
    typed: &'static str,
    /// As it is said; numbers in braces.
    said: &'static str,
    /// Its numbers: symbol, ends of the range.
    numbers: &'static [(&'static str, f64, f64)],
    /// Where the search begins.
    starts: &'static [&'static [f64]],
    /// How long it is, in factors.
    length: usize,
}

const fn law(
    typed: &'static str,
    said: &'static str,
    numbers: &'static [(&'static str, f64, f64)],
    starts: &'static [&'static [f64]],
    length: usize,
) -> Law {
    Law { typed, said, numbers, starts, length }
}

const NO_NUMBER: &[&[f64]] = &[&[]];

/// Laws of speed; all but the last oppose or drive the motion.
const OF_SPEED: [Law; 5] = [
    law("sgn(omega)", "sgn ω", &[], NO_NUMBER, 1),
    law("omega", "ω", &[], NO_NUMBER, 1),
    law("abs(omega)^p*sgn(omega)", "|ω|^{p}·sgn ω", &[("p", 0.2, 6.0)], &[&[0.5], &[1.5], &[2.0], &[3.0], &[4.0]], 2),
    law("exp(-(omega/a)^2)*sgn(omega)", "exp(-(ω/{a})²)·sgn ω", &[("a", 0.02, 12.0)], &[&[0.2], &[0.8], &[2.5]], 2),
    law("omega^2", "ω²", &[], NO_NUMBER, 1),
];

/// Laws of angle.
const OF_ANGLE: [Law; 5] = [
    law("sin(n*theta)", "sin({n}·θ)", &[("n", 0.3, 24.0)], &[&[1.0], &[2.0], &[4.0], &[8.0]], 1),
    law("cos(n*theta)", "cos({n}·θ)", &[("n", 0.3, 24.0)], &[&[1.0], &[2.0], &[4.0], &[8.0]], 1),
    law("abs(theta)^n", "|θ|^{n}", &[("n", 0.3, 6.0)], &[&[1.0], &[2.0], &[4.0]], 1),
    law("theta*abs(theta)^n", "θ·|θ|^{n}", &[("n", 0.3, 6.0)], &[&[1.0], &[2.0]], 2),
    law(
        "exp(-((abs(theta)-c)/b)^2)",
        "exp(-((|θ|-{c})/{b})²)",
        &[("c", 0.0, 3.0), ("b", 0.02, 2.0)],
        &[&[0.0, 0.2], &[0.35, 0.1], &[0.7, 0.2], &[1.1, 0.2]],
        2,
    ),
];

/// A formula that was tried.
#[derive(Clone, Debug)]
struct Guess {
    laws: Vec<Law>,
    effect: &'static Effect<f64>,
}

/// A formula that was fitted.
#[derive(Clone, Debug)]
pub struct Found {
    guess: Guess,
    /// The law as it is said, with its numbers: `3.1e-5·|ω|^2.3·sgn ω`.
    pub words: String,
    /// The law as `--effect` takes it.
    pub typed: String,
    /// The fitted model.
    pub model: Fitted,
    /// Factors and numbers, which count against it.
    pub length: usize,
}

/// The best few formulas on top of a fitted model, the best first; `score` is the criterion of a model, `weight` what a
/// factor costs there. They are sought on decimated swings and finished on all samples.
pub fn formulas(problem: &Problem, model: &Fitted, score: impl Fn(&Fitted) -> f64, weight: f64) -> Vec<Found> {
    let decimated = problem.decimated();
    let rough = problem.on(&decimated);
    let seen = model.evaluated(&rough);
    let rank = |found: &Found| rank(score(&found.model), weight, found.length);
    let mut found = promising(&rough, &seen, weight);
    found.iter_mut().for_each(|found| found.model = found.model.evaluated(problem));
    found.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
    found.dedup_by(|a, b| a.guess.effect == b.guess.effect);
    found.truncate(OFFERED);
    let finished = |found: &Found| {
        let general = found.finished(problem);
        let special = special_case(&rough, &seen, &general).map(|special| special.finished(problem));
        std::iter::once(general).chain(special).collect::<Vec<Found>>()
    };
    let mut found: Vec<Found> = on_all_cores(&found, finished).into_iter().flatten().collect();
    found.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
    found
}

/// Formulas that predict most beyond what their length costs, fitted.
fn promising(problem: &Problem, model: &Fitted, weight: f64) -> Vec<Found> {
    let alone = |laws: &[Law]| laws.iter().filter_map(|law| guess(problem, vec![*law], NO_NUMBER[0])).collect();
    let (of_speed, of_angle): (Vec<Guess>, Vec<Guess>) = (alone(&OF_SPEED), alone(&OF_ANGLE));
    let first = judged(problem, model, &[of_speed, of_angle].concat());
    let combined = combined(problem, &first);
    let mut all = [first, judged(problem, model, &combined)].concat();
    let unit = price_rad2(problem, model, weight);
    let worth = |(guess, prediction): &(Guess, Prediction)| prediction.reduction - unit * guess.length() as f64;
    all.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    all.truncate(FITTED);
    on_all_cores(&all, |(guess, prediction)| fitted(problem, model, guess, prediction)).into_iter().flatten().collect()
}

/// What a factor has to take off the squares for its `weight`: noise, or where the model leaves more, what it leaves.
fn price_rad2(problem: &Problem, model: &Fitted, weight: f64) -> f64 {
    weight * problem.noise_rad().powi(2).max(model.cost / problem.n_samples(Window::Whole) as f64)
}

/// A model's criterion with the length of its formula, the lower the better.
fn rank(criterion: f64, weight: f64, length: usize) -> f64 {
    criterion + weight * length as f64
}

/// The best prediction of each guess that has one.
fn judged(problem: &Problem, model: &Fitted, guesses: &[Guess]) -> Vec<(Guess, Prediction)> {
    let effects: Vec<&'static Effect<f64>> = guesses.iter().map(|guess| guess.effect).collect();
    let predictions = predictions(problem, model, &effects);
    let best = |guess: &Guess| {
        let prediction =
            predictions.iter().find(|prediction| prediction.effect == guess.effect && prediction.reduction > 0.0)?;
        Some((guess.clone(), prediction.clone()))
    };
    guesses.iter().filter_map(best).collect()
}

/// The best laws of speed times every law of angle.
fn combined(problem: &Problem, judged: &[(Guess, Prediction)]) -> Vec<Guess> {
    let is_of_speed = |guess: &Guess| OF_SPEED.iter().any(|law| law.typed == guess.laws[0].typed);
    let mut of_speed: Vec<&(Guess, Prediction)> = judged.iter().filter(|(guess, _)| is_of_speed(guess)).collect();
    of_speed.sort_by(|a, b| b.1.reduction.total_cmp(&a.1.reduction));
    let product = |(guess, prediction): &(Guess, Prediction), angle: &Law| {
        let n_own = guess.laws[0].numbers.len();
        let own = &prediction.model.point().values[prediction.model.unknowns.len() - n_own..].to_vec();
        self::guess(problem, vec![guess.laws[0], *angle], own)
    };
    let of_speed = of_speed.into_iter().take(COMBINED);
    of_speed.flat_map(|speed| OF_ANGLE.iter().filter_map(move |angle| product(speed, angle))).collect()
}

/// The product of laws as an effect; `first` are the numbers that the first law is known to want.
fn guess(problem: &Problem, laws: Vec<Law>, first: &[f64]) -> Option<Guess> {
    let typed: Vec<&str> = laws.iter().map(|law| law.typed).collect();
    let most = STRONGEST * problem.template.pendulum.gravity_torque_nm();
    let numbers = laws.iter().flat_map(|law| law.numbers);
    let ranges = numbers.map(|(symbol, low, high)| format!("; {symbol} in {low}..{high}")).collect::<String>();
    let text = |unit: &str| format!("-k*{}; k in -{most:.0e}..{most:.0e}{unit}{ranges}", typed.join("*"));
    // The longest have no room for the unit.
    let effect = [text(" N·m"), text("")].iter().find_map(|text| read(text).ok())?;
    let last = laws.last()?;
    let starts = last.starts.iter().map(|own| {
        let all: Vec<f64> = [0.0].iter().chain(first).chain(*own).copied().collect();
        std::array::from_fn(|i| all.get(i).copied().unwrap_or(0.0))
    });
    let starts: Vec<[f64; MAX_VALUES]> = starts.collect();
    let effect = Box::leak(Box::new(Effect { starts: Vec::leak(starts), ..*effect }));
    Some(Guess { laws, effect })
}

impl Guess {
    /// Factors and numbers.
    fn length(&self) -> usize {
        self.laws.iter().map(|law| law.length + law.numbers.len()).sum()
    }

    /// As `--effect` takes it, with ranges around the numbers found.
    fn typed(&self, values: &[f64]) -> String {
        let laws: Vec<&str> = self.laws.iter().map(|law| law.typed).collect();
        let range = |value: f64, factors: (f64, f64)| {
            let (a, b) = (value * factors.0, value * factors.1);
            format!("{}..{}", short(a.min(b)), short(a.max(b)))
        };
        let numbers = self.laws.iter().flat_map(|law| law.numbers).zip(&values[1..]);
        let ranges: String =
            numbers.map(|((symbol, ..), value)| format!("; {symbol} in {}", range(*value, AROUND))).collect();
        let typed = |unit: &str| format!("-k*{}; k in {}{unit}{ranges}", laws.join("*"), range(values[0], (0.0, 2.0)));
        [typed(" N·m"), typed("")]
            .into_iter()
            .find(|text| formula::check(text).is_ok())
            .unwrap_or(self.effect.formula.to_owned())
    }

    /// With numbers, as a person would write it.
    fn words(&self, values: &[f64]) -> String {
        let said: Vec<&str> = self.laws.iter().map(|law| law.said).collect();
        let mut words = format!("{}·{}", short(-values[0]), said.join("·"));
        let numbers = self.laws.iter().flat_map(|law| law.numbers);
        for ((symbol, ..), value) in numbers.zip(&values[1..]) {
            words = words.replace(&format!("{{{symbol}}}"), &short(*value));
        }
        words
    }
}

/// Ends of the range around a number that was found, as shares of it.
const AROUND: (f64, f64) = (0.5, 1.5);

/// Two digits.
fn short(value: f64) -> String {
    let plain = (0.01..100.0).contains(&value.abs());
    let rounded: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    if plain { format!("{rounded}") } else { format!("{value:.1e}") }
}

/// A formula fitted in earnest, if it explains more than a little.
fn fitted(problem: &Problem, before: &Fitted, guess: &Guess, prediction: &Prediction) -> Option<Found> {
    let found = found(problem, guess, &prediction.fitted(problem))?;
    is_worth_a_word(problem, before, &found.model).then_some(found)
}

fn found(problem: &Problem, guess: &Guess, start: &Fitted) -> Option<Found> {
    let model = start.refined(problem, Band::Held, Tolerance::LONG);
    let values = model.parameters.values(guess.effect.id)?;
    let (words, typed) = (guess.words(values), guess.typed(values));
    Some(Found { guess: guess.clone(), words, typed, length: guess.length(), model })
}

impl Found {
    /// With Ms searched and every number at its last digit.
    fn finished(&self, problem: &Problem) -> Self {
        let model = self.model.refined(problem, Band::Level, Tolerance::JUDGE);
        let values = model.parameters.values(self.guess.effect.id).unwrap_or_default();
        let (words, typed) = (self.guess.words(values), self.guess.typed(values));
        Self { words, typed, model, ..self.clone() }
    }
}

/// The same with ω in place of a power of it whose exponent came out near 1.
fn special_case(problem: &Problem, before: &Fitted, general: &Found) -> Option<Found> {
    let (guess, general) = (&general.guess, &general.model);
    let values = general.parameters.values(guess.effect.id)?;
    let is_power = guess.laws[0].typed == OF_SPEED[POWER].typed;
    if !is_power || (values[1] - 1.0).abs() > NEARLY_LINEAR {
        return None;
    }
    let laws = [&[OF_SPEED[LINEAR]], &guess.laws[1..]].concat();
    let linear = self::guess(problem, laws, &[])?;
    let values = [&values[..1], &values[2..]].concat();
    // Everything else goes on from where it was with the exponent.
    let at_general = general.without(guess.effect.id);
    let Fitted { effects, unknowns, .. } = before.clone();
    let start = Fitted { effects, unknowns, ..at_general }.with(linear.effect, &values)?;
    let start = start.refined(problem, Band::Held, Tolerance::SCREEN);
    found(problem, &linear, &start)
}

fn is_worth_a_word(problem: &Problem, before: &Fitted, model: &Fitted) -> bool {
    let left = excess(problem, model) / excess(problem, before);
    is_sound(problem, model) && left < 1.0 - WORTH_A_WORD
}

/// Places in [`OF_SPEED`].
const LINEAR: usize = 1;
const POWER: usize = 2;

/// An exponent this near to 1 may be 1.
const NEARLY_LINEAR: f64 = 0.3;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{rig, with_drag};
    use crate::fit::identify::problem_of;
    use crate::fit::problem::Point;
    use crate::fit::start;
    use crate::fit::tally::Tally;
    use shared::parameters::Parameters;

    #[test]
    fn every_combination_is_a_formula_that_fits_the_rig() {
        let count = Tally::default();
        let problem = problem_of(&[], &Parameters::paper(), &count);
        for speed in OF_SPEED {
            for angle in OF_ANGLE {
                let own = speed.starts[0];
                let guess = guess(&problem, vec![speed, angle], own);
                let guess = guess.unwrap_or_else(|| panic!("{} {}", speed.typed, angle.typed));
                assert_eq!(guess.effect.starts.len(), angle.starts.len());
                assert_eq!(guess.effect.parameters.len(), 1 + speed.numbers.len() + angle.numbers.len());
            }
        }
    }

    #[test]
    fn formulas_are_said_with_their_numbers() {
        let count = Tally::default();
        let problem = problem_of(&[], &Parameters::paper(), &count);
        let drag = guess(&problem, vec![OF_SPEED[2]], &[]).unwrap();
        assert_eq!(drag.words(&[3.14e-5, 2.31]), "-3.1e-5·|ω|^2.3·sgn ω");
    }

    #[test]
    fn a_formula_is_as_long_as_its_factors_and_numbers() {
        let count = Tally::default();
        let problem = problem_of(&[], &Parameters::paper(), &count);
        let length = |laws: Vec<Law>| guess(&problem, laws, &[2.0]).unwrap().length();
        // ω; |ω|^p·sgn ω: two factors, one number; the same times a bump: two factors and two numbers more.
        assert_eq!(length(vec![OF_SPEED[LINEAR]]), 1);
        assert_eq!(length(vec![OF_SPEED[POWER]]), 3);
        assert_eq!(length(vec![OF_SPEED[POWER], OF_ANGLE[4]]), 7);
    }

    #[test]
    fn laws_of_speed_are_combined_with_all_laws_of_angle() {
        let count = Tally::default();
        let problem = problem_of(&[], &Parameters::paper(), &count);
        let model = Fitted::at(&problem, &Point { values: problem.template_values(), starts: Vec::new() });
        let judged = |law: Law, reduction: f64| {
            let guess = guess(&problem, vec![law], &[]).unwrap();
            let start = guess.effect.starts[0];
            let model = model.with(guess.effect, &start).unwrap();
            (guess.clone(), Prediction { effect: guess.effect, start, reduction, at_start: model.clone(), model })
        };
        let all = [judged(OF_ANGLE[0], 9.0), judged(OF_SPEED[LINEAR], 1.0), judged(OF_SPEED[POWER], 2.0)];
        let found = combined(&problem, &all);
        let typed: Vec<[&str; 2]> = found.iter().map(|guess| [guess.laws[0].typed, guess.laws[1].typed]).collect();
        let expected = [POWER, LINEAR].into_iter().flat_map(|k| OF_ANGLE.map(|angle| [OF_SPEED[k].typed, angle.typed]));
        assert_eq!(typed, expected.collect::<Vec<_>>());
    }

    #[test]
    fn a_factor_costs_squares_of_the_noise_or_of_what_is_left() {
        let (swings, count) = (with_drag(), Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        let model = |rms_rad: f64| {
            let point = Point { values: problem.template_values(), starts: start::starts(&swings) };
            Fitted { cost: rms_rad.powi(2) * swings[0].len() as f64, ..Fitted::at(&problem, &point) }
        };
        let price = |rms_rad: f64| price_rad2(&problem, &model(rms_rad), 7.0).sqrt();
        assert!((price(1e-5) / (7f64.sqrt() * swings[0].noise_rad) - 1.0).abs() < 1e-9);
        assert!((price(1e-2) / (7f64.sqrt() * 1e-2) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_longer_formula_has_to_be_better_by_its_weight() {
        assert!(rank(100.0, 7.0, 3) < rank(100.0, 7.0, 4));
        assert!(rank(100.0, 7.0, 3) < rank(94.0, 7.0, 4) && rank(92.0, 7.0, 4) < rank(100.0, 7.0, 3));
        // Below zero too, where a product would turn the order.
        assert!(rank(-100.0, 7.0, 3) < rank(-106.0, 7.0, 4));
    }
}
