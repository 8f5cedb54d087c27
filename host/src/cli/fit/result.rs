//! The result of a fit: one object for programs, a screen of tables and sentences for a person.

use super::Options;
use crate::cli::table::{table, wrapped};
use crate::cli::{evidence, output};
use crate::fit::identify::{Fit, Identified, Verdict};
use crate::fit::quality::{Responses, predicted};
use crate::geometry::{PER_GRAVITY, about_the_pivot, is_unknown, unit_of};
use crate::number::{count, noises, significant, with_spread};
use crate::operations::fit::{After, Check, Outcome};
use crate::operations::json::all_named;
use crate::operations::watch::is_simulated;
use crate::recording::Measured;
use crate::rigfile::USUAL_NAME;
use crate::swing::Swing;
use crate::verdict::{Left, far_below, is_far_below_noise};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Correlations beyond this are worth a sentence.
const STRONG_CORRELATION: f64 = 0.9;

/// The strongest few are enough to read; `--json` has all.
const MOST_CORRELATIONS: usize = 3;

/// An error on held-out swings up to so many times that on the fitted ones is as good.
const AS_GOOD: f64 = 1.1;

/// Everything there is to tell.
pub(super) struct Shown<'a> {
    pub(super) outcome: &'a Outcome,
    pub(super) swings: &'a [Swing],
    pub(super) done: &'a Done,
}

/// What became of the model before it is shown.
#[derive(Default)]
pub(super) struct Done {
    /// Where it was written.
    pub(super) model: Option<PathBuf>,
    /// Where it was drawn.
    pub(super) drawing: Option<PathBuf>,
    /// The rig has it.
    pub(super) is_pushed: bool,
    /// How the rig took it.
    pub(super) check: Option<Check>,
}

/// Prints it on stdout.
pub(super) fn show(options: &Options, recordings: &[PathBuf], shown: &Shown) {
    if options.json {
        output::json(
            "fit",
            &shown.outcome.fields(
                &all_named(shown.swings),
                shown.swings,
                options.method.into(),
                shown.done.check.as_ref(),
            ),
        );
    } else {
        if let Some(found) = &shown.outcome.discovery {
            output::result(&format!("{}\n", evidence::in_words(found)));
        }
        output::result(&in_words(options, recordings, shown));
    }
}

fn in_words(options: &Options, recordings: &[PathBuf], shown: &Shown) -> String {
    let fit = &shown.outcome.fit;
    let parts = [
        opening(options, shown),
        parameters(fit),
        lowered(&shown.outcome.stages, fit),
        sentences(shown).iter().map(|sentence| wrapped(sentence, 0)).collect::<Vec<_>>().join("\n"),
        fit.warnings.iter().map(|note| wrapped(&format!("note: {note}"), 6)).collect::<Vec<_>>().join("\n"),
        ending(options, recordings, shown),
    ];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n\n")
}

fn opening(options: &Options, shown: &Shown) -> String {
    let (fit, swings) = (&shown.outcome.fit, shown.swings);
    let what = match swings {
        [swing] => format!("{}, {:.1} s of it", swing.name, swing.duration_s()),
        _ => format!("{} swings, {:.1} s together", swings.len(), swings.iter().map(Swing::duration_s).sum::<f64>()),
    };
    let method = options.method.words().replace(", ", ", then ");
    let how = format!("{what}, by {method}: {} simulated swings in {:.1} s", fit.n_simulations, fit.seconds);
    output::heading(&wrapped(&how, 0))
}

fn parameters(fit: &Fit) -> String {
    let verdict = |found: &Identified| match found.verdict {
        Verdict::Identified => "identified",
        Verdict::Weak => "weak",
        Verdict::Not => "not identified",
    };
    let pendulum = &fit.parameters.pendulum;
    let row = |found: &Identified| {
        let unit = unit_of(found.unit, pendulum).into_owned();
        let [symbol, name, verdict] = [found.symbol, found.name, verdict(found)].map(str::to_owned);
        vec![symbol, with_spread(found.value, found.std), unit, name, verdict]
    };
    let shown = table(["", "value", "unit", "what", "verdict"], fit.identified.iter().map(row).collect(), 5);
    if !is_unknown(pendulum) {
        return shown;
    }
    format!("{shown}\n{}", wrapped(&format!("{PER_GRAVITY} {}", about_the_pivot(pendulum)), 0))
}

fn lowered(stages: &[After], fit: &Fit) -> String {
    let row = |after: &After| {
        let Responses { mse_angle, mse_velocity, positive_peaks, negative_peaks, zero_crossings } = after.responses;
        let counts = [positive_peaks, negative_peaks, zero_crossings].map(count);
        let squares = [mse_angle, mse_velocity].map(|value| significant(value, 4));
        std::iter::once(after.stage.to_owned()).chain(squares).chain(counts).collect()
    };
    let header = ["after", "mseA (rad²)", "mseV (rad²/s²)", "ePM", "eNM", "eZC"];
    let shown = table(header, stages.iter().map(row).collect(), 1);
    match fit.stages.last().and_then(|stage| stage.r_squared_predicted) {
        Some(share) => {
            let n_designs = fit.stages.len();
            format!("{shown}\n({n_designs} designs; the last surface of mseA predicts {})", predicted(share, 1))
        }
        None => shown,
    }
}

fn sentences(shown: &Shown) -> Vec<String> {
    let fit = &shown.outcome.fit;
    let unit = shown.swings.first().map_or(Measured::Angle, |swing| swing.measured).milli_unit();
    let has_no_noise = shown.swings.iter().all(Swing::has_no_noise);
    let mut sentences = vec![error_against_noise(fit, unit, has_no_noise)];
    sentences.extend(fit.held_out_rmse_rad.map(|rmse_rad| held_out(rmse_rad, fit, unit)));
    sentences.extend(shown.done.check.as_ref().map(innovation));
    sentences.extend(strong_correlations(fit));
    sentences
}

fn error_against_noise(fit: &Fit, unit: &str, has_no_noise: bool) -> String {
    let ratio = fit.rmse_rad / fit.noise_rad;
    let meaning = match fit.left {
        _ if is_far_below_noise(ratio) => format!("far below the noise, {}", far_below(has_no_noise)),
        Left::Noise => "the model explains all but the noise".to_owned(),
        Left::Nearly => "the model explains nearly all but the noise".to_owned(),
        Left::Missing => format!("that is {} times the noise, so the model does not explain everything", noises(ratio)),
    };
    let [error, noise] = [fit.rmse_rad, fit.noise_rad].map(|rms| match 1e3 * rms {
        little if little < 5e-4 => "below 0.001".to_owned(),
        rms => format!("{rms:.3}"),
    });
    format!("Error {error} {unit} rms, noise {noise} {unit} rms: {meaning}.")
}

fn held_out(rmse_rad: f64, fit: &Fit, unit: &str) -> String {
    let ratio = rmse_rad / fit.rmse_rad;
    let meaning = if ratio <= AS_GOOD {
        "as good as on what was fitted".to_owned()
    } else {
        format!("{ratio:.2} times that of what was fitted")
    };
    format!("Error on what was held out {:.3} {unit} rms: {meaning}.", 1e3 * rmse_rad)
}

fn innovation(check: &Check) -> String {
    let (before, after) = (check.innovation_before_rad, check.innovation_after_rad);
    let meaning = if after < before {
        format!("{:.1} times smaller", before / after)
    } else {
        "no smaller; the old parameters were as good".to_owned()
    };
    format!(
        "Innovation of the rig's observer on a second swing: {:.3} mrad with the old parameters, {:.3} mrad with the new: {meaning}.",
        1e3 * before,
        1e3 * after
    )
}

fn strong_correlations(fit: &Fit) -> Vec<String> {
    let found = &fit.identified;
    let pairs = (0..found.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
    let size = |(j, i): &(usize, usize)| fit.correlations[*j][*i].map_or(0.0, f64::abs);
    let mut strong: Vec<(usize, usize)> = pairs.filter(|pair| size(pair) > STRONG_CORRELATION).collect();
    strong.sort_by(|a, b| size(b).total_cmp(&size(a)));
    strong.truncate(MOST_CORRELATIONS);
    let sentence = |(j, i): (usize, usize)| {
        let (correlation, [a, b]) = (fit.correlations[j][i].unwrap_or(0.0), [found[j].symbol, found[i].symbol]);
        let alike = if correlation < 0.0 { "more of one and less of the other" } else { "more of both" };
        format!(
            "{a} and {b} are hard to tell apart (correlation {}): {alike} gives nearly the same swing.",
            not_one(correlation)
        )
    };
    strong.into_iter().map(sentence).collect()
}

/// Two digits, but none that is not one is told as one.
fn not_one(correlation: f64) -> String {
    match correlation {
        almost if almost >= NEXT_TO_ONE => format!("beyond {NEXT_TO_ONE}"),
        almost if almost <= -NEXT_TO_ONE => format!("beyond -{NEXT_TO_ONE}"),
        correlation => format!("{correlation:.2}"),
    }
}

/// Two digits make one of what is beyond it.
const NEXT_TO_ONE: f64 = 0.995;

fn physics_is_missing(fit: &Fit) -> bool {
    fit.left == Left::Missing
}

/// What was saved where, and what to do next.
fn ending(options: &Options, recordings: &[PathBuf], shown: &Shown) -> String {
    let mut lines = Vec::new();
    let name = |path: &Path| path.display().to_string();
    if options.port.is_some() {
        let checked = shown.done.check.as_ref().map(|check| check.recording.clone());
        let all = recordings.iter().map(|path| name(path)).chain(checked);
        lines.push(format!("recorded   {}", all.collect::<Vec<_>>().join(", ")));
    }
    lines.extend(shown.done.model.as_deref().map(|path| format!("model      {}", name(path))));
    lines.extend(shown.done.drawing.as_deref().map(|path| format!("drawing    {}", name(path))));
    if let Some(port) = &options.port {
        // Of a push that failed the error says what is known.
        let state = match (shown.done.is_pushed, options.no_push) {
            (true, _) => Some("has the new model, in its flash too"),
            (false, true) => Some("was left as it is"),
            (false, false) => None,
        };
        lines.extend(state.map(|state| format!("rig        {port} {state}")));
    }
    let (why, command) = next(options, recordings, shown);
    lines.push(format!("next       {command}\n           {why}"));
    lines.join("\n")
}

/// The next command to try, and what it is good for.
fn next(options: &Options, recordings: &[PathBuf], shown: &Shown) -> (Cow<'static, str>, String) {
    // Of a rig's own recordings nothing has to be said.
    let names = format!("{}{}", output::recordings(recordings), options.reading.words());
    let rig = options.rig.as_deref().map_or(String::new(), |path| format!(" --rig {}", output::file(path)));
    let file = kept_in(options.rig.as_deref());
    let is_pushed = shown.done.is_pushed;
    let is_unasked = physics_is_missing(&shown.outcome.fit) && !options.discover;
    if !Swing::driven(shown.swings).is_empty() {
        return swings_freely(options.port.as_deref());
    }
    let is_doubtful = shown.outcome.fit.hardly_follows;
    match (&options.port, &shown.done.model) {
        (_, Some(path)) if is_doubtful => {
            ("shows where the model fails".into(), format!("host compare {names} --rig {}", output::file(path)))
        }
        (None, None) if is_doubtful => shows_the_swing(options.plot.is_some(), &names, &rig, &file),
        (Some(port), None) if is_pushed && is_unasked => names_what_is_missing(port, &rig, &names, Path::new("")),
        (Some(port), None) if is_pushed => keeps_the_model(port, &rig, options.discover, Path::new("")),
        (_, None) if physics_is_missing(&shown.outcome.fit) => {
            ("names the effect that is missing".into(), format!("host diagnose {names}{rig}"))
        }
        (_, None) => ("keeps the model in a file".into(), format!("host fit {names}{rig} -o {file}")),
        (_, Some(path)) if physics_is_missing(&shown.outcome.fit) => {
            ("names the effect that is missing".into(), format!("host diagnose {names} --rig {}", output::file(path)))
        }
        (port, Some(path)) if !is_pushed => {
            let port = port.as_deref().unwrap_or("PORT");
            ("gives the model to the rig".into(), format!("host push --rig {} --port {port}", output::file(path)))
        }
        (_, Some(path)) => {
            let command = format!("host fit {names} --rig {} --plot fit.svg", output::file(path));
            ("draws measured against model".into(), command)
        }
    }
}

/// The model file that the fit begins with is the one that gets better.
fn kept_in(rig: Option<&Path>) -> String {
    rig.map_or_else(|| USUAL_NAME.to_owned(), output::file)
}

/// A rig has the model, but its swings ask for more than that has.
fn names_what_is_missing(port: &str, rig: &str, names: &str, folder: &Path) -> (Cow<'static, str>, String) {
    let file = unused_model(folder);
    if is_simulated(port) {
        let why = "names the effect that is missing, adds it and keeps the model in a file";
        (why.into(), format!("host fit --port {port}{rig} --discover -o {file}"))
    } else {
        let why = format!("keeps the model in a file; then host diagnose {names} --rig {file} names what is missing");
        (why.into(), format!("host pull --port {port} -o {file}"))
    }
}

/// Whether it is a swing at all is seen by whoever looks at it.
fn shows_the_swing(is_drawn: bool, names: &str, rig: &str, file: &str) -> (Cow<'static, str>, String) {
    if is_drawn {
        return ("keeps the model, for host compare".into(), format!("host fit {names}{rig} -o {file}"));
    }
    ("draws measured against model, to see what was recorded".into(), format!("host fit {names}{rig} --plot fit.svg"))
}

/// What nothing can be learned from has to be recorded anew.
fn swings_freely(port: Option<&str>) -> (Cow<'static, str>, String) {
    let port = port.unwrap_or("PORT");
    ("records a pendulum that swings freely".into(), format!("host record --port {port} -o free.csv"))
}

/// A simulated rig has forgotten the model when it is asked the next time; a real one is asked for it.
fn keeps_the_model(port: &str, rig: &str, discover: bool, folder: &Path) -> (Cow<'static, str>, String) {
    let file = unused_model(folder);
    if is_simulated(port) {
        let discover = if discover { " --discover" } else { "" };
        let again = format!("host fit --port {port}{rig}{discover} -o {file}");
        ("does the same and keeps the model in a file: a simulated rig begins anew with each command".into(), again)
    } else {
        ("keeps the model in a file".into(), format!("host pull --port {port} -o {file}"))
    }
}

/// The usual name of a model, or one like it that no file has yet: advice must not cost a good model.
fn unused_model(folder: &Path) -> String {
    let numbered = (2..).map(|number| format!("{MODEL_STEM}-{number}.toml"));
    let mut names = std::iter::once(USUAL_NAME.to_owned()).chain(numbered);
    names.find(|name| !folder.join(name).exists()).unwrap_or_default()
}

/// [`USUAL_NAME`] without its ending.
const MODEL_STEM: &str = "rig";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples::fit;
    use crate::rigfile::RigFile;

    #[test]
    fn an_error_is_told_by_what_it_is_beside_the_noise() {
        let told = |rmse_rad: f64, left: Left| {
            error_against_noise(&Fit { rmse_rad, noise_rad: 1e-3, left, ..fit() }, "mrad", false)
        };
        assert!(told(0.6e-3, Left::Noise).contains("far below the noise, which was therefore estimated too large"));
        let simulated = error_against_noise(&Fit { rmse_rad: 1e-9, noise_rad: 2e-5, ..fit() }, "mrad", true);
        assert_eq!(
            simulated,
            "Error below 0.001 mrad rms, noise 0.020 mrad rms: far below the noise, which is what a model is simulated to: \
             the readings have no noise of their own."
        );
        assert_eq!(
            told(1e-3, Left::Noise),
            "Error 1.000 mrad rms, noise 1.000 mrad rms: the model explains all but the noise."
        );
        assert!(told(2.5e-3, Left::Missing).contains("that is 2.50 times the noise"));
    }

    #[test]
    fn held_out_swings_are_measured_by_the_fitted_ones() {
        let told = |rmse_rad: f64| held_out(rmse_rad, &Fit { rmse_rad: 1e-3, ..fit() }, "mrad");
        assert_eq!(told(1.05e-3), "Error on what was held out 1.050 mrad rms: as good as on what was fitted.");
        assert_eq!(told(2e-3), "Error on what was held out 2.000 mrad rms: 2.00 times that of what was fitted.");
    }

    #[test]
    fn the_strongest_correlations_are_told_first() {
        let mut fit = fit();
        let symbols: Vec<&str> = fit.identified.iter().map(|found| found.symbol).collect();
        let n = symbols.len();
        fit.correlations = vec![vec![None; n]; n];
        for (i, j, correlation) in [(0, 1, 0.91), (0, 2, -0.99), (1, 2, 0.95), (0, 3, 0.93), (1, 3, 0.8)] {
            (fit.correlations[i][j], fit.correlations[j][i]) = (Some(correlation), Some(correlation));
        }
        let told = strong_correlations(&fit);
        assert_eq!(told.len(), 3);
        let [a, b, c] = [symbols[0], symbols[1], symbols[2]];
        let less =
            format!("{a} and {c} are hard to tell apart (correlation -0.99): more of one and less of the other gives");
        assert!(told[0].starts_with(&less), "{told:?}");
        let more = format!("{b} and {c} are hard to tell apart (correlation 0.95): more of both gives");
        assert!(told[1].starts_with(&more) && told[2].contains("0.93"), "{told:?}");
        assert_eq!([0.9949, 0.996, -0.9999].map(not_one), ["0.99", "beyond 0.995", "beyond -0.995"]);
    }

    #[test]
    fn advice_to_keep_a_model_works_on_a_simulated_rig_and_replaces_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let advised = |port, discover| keeps_the_model(port, "", discover, folder.path()).1;
        assert_eq!(advised("COM3", false), "host pull --port COM3 -o rig.toml");
        assert_eq!(advised("sim:mystery-1", true), "host fit --port sim:mystery-1 --discover -o rig.toml");
        std::fs::write(folder.path().join("rig.toml"), "a good model").unwrap();
        assert_eq!(advised("COM3", false), "host pull --port COM3 -o rig-2.toml");
        assert_eq!(advised("sim", false), "host fit --port sim -o rig-2.toml");
    }

    #[test]
    fn where_physics_is_missing_the_next_step_names_it() {
        let folder = tempfile::tempdir().unwrap();
        let advised = |port| names_what_is_missing(port, "", "swing.csv", folder.path());
        assert_eq!(advised("sim:drag").1, "host fit --port sim:drag --discover -o rig.toml");
        let (why, command) = advised("COM3");
        assert_eq!(command, "host pull --port COM3 -o rig.toml");
        assert!(why.contains("then host diagnose swing.csv --rig rig.toml names what is missing"), "{why}");
    }

    #[test]
    fn where_the_model_hardly_follows_the_next_step_is_to_look() {
        let advised = |is_drawn| shows_the_swing(is_drawn, "swing.csv", " --rig my.toml", "my.toml").1;
        assert_eq!(advised(false), "host fit swing.csv --rig my.toml --plot fit.svg");
        assert_eq!(advised(true), "host fit swing.csv --rig my.toml -o my.toml");
        assert_eq!([kept_in(None), kept_in(Some(Path::new("my.toml")))], ["rig.toml", "my.toml"]);
    }

    #[test]
    fn without_a_geometry_the_number_that_the_period_tells_is_said() {
        let mut fit = fit();
        assert!(!parameters(&fit).contains("For a period"), "{}", parameters(&fit));
        fit.parameters.pendulum = RigFile::normalised(9.81).unwrap().parameters().pendulum;
        fit.parameters.pendulum.inertia_kg_m2 = 0.02;
        let told = parameters(&fit).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(told.contains("(m·l² + I)/(m·g·l) = (T/2π)² = 0.020102 s²: the I above and 1.02e-4 s²"), "{told}");
    }

    #[test]
    fn a_driven_pendulum_is_recorded_anew_and_not_diagnosed() {
        assert_eq!(swings_freely(None).1, "host record --port PORT -o free.csv");
    }
}
