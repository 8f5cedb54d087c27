//! The long things: reading, comparing, fitting, searching, changing the model.

use super::app::App;
use super::jobs::Progress;
use super::recordings::{self, Loaded};
use super::releases::Releases;
use super::state::{Named, Numbers, State};
use super::view::names_of_effects;
use crate::compare::follow::{Followed, follow};
use crate::compare::measurement::Measurement;
use crate::compare::verdict::Answer;
use crate::compare::{self, Comparison, compare};
use crate::diagnose::{Wishes, diagnose_counted};
use crate::error::Failure;
use crate::fit::identify::{self, Fit, Method};
use crate::fit::tally::Tally;
use crate::fit::windows::windows_s;
use crate::improve::{Bench, Change, Step};
use crate::operations::given::{doubts, doubts_of_held_out};
use crate::rigfile::{RigFile, Source};
use crate::swing::{Swing, kind, one_kind};
use rayon::prelude::*;
use shared::parameters::Parameters;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What a job needs of the state, taken once at its beginning.
struct Data {
    model: RigFile,
    numbers: Numbers,
    recordings: Vec<Arc<Loaded>>,
    swings: Vec<Swing>,
    held_out: Vec<Swing>,
}

impl Data {
    fn of(app: &App) -> Result<Self, Failure> {
        let (model, recordings) = app.read(|state| (state.model.clone(), state.recordings.clone()));
        let no_model =
            || Failure::wrong_use("there is no model yet").next("give mass, length and inertia, or a rig.toml");
        let swings = |held_out: bool| {
            let wanted = recordings.iter().filter(|recording| recording.held_out == held_out);
            wanted.map(|recording| recording.measurement.swing.clone()).collect::<Vec<Swing>>()
        };
        let Named { file, numbers, .. } = model.ok_or_else(no_model)?;
        let data = Self { model: file, numbers, swings: swings(false), held_out: swings(true), recordings };
        if data.swings.is_empty() {
            let next = "load one, record one, or let one of the list take part again";
            return Err(Failure::wrong_use("there is no recording to work with").next(next));
        }
        Ok(data)
    }

    /// Can these be recordings of this pendulum, and of one, all of one kind? Doubts are shown, and kept with
    /// the swings.
    fn check(&mut self, app: &App) -> Result<(), Failure> {
        let next = "take one kind out of the list";
        one_kind(self.swings.iter().chain(&self.held_out)).map_err(|error| Failure::failed(error).next(next))?;
        let next = "correct it under “Change mass, length, inertia”";
        let mut doubts = doubts(self.model.parameters(), &mut self.swings).map_err(|failure| failure.next(next))?;
        doubts.extend(doubts_of_held_out(self.model.parameters(), &self.swings, &self.held_out));
        if app.read(|state| self.is_current(state) && state.doubts != doubts) {
            app.change(|state| state.doubts = doubts);
        }
        Ok(())
    }

    fn parameters(&self) -> &Parameters<f64> {
        self.model.parameters()
    }

    fn bench<'a>(&'a self, count: &'a Tally) -> Bench<'a> {
        let tolerances = self.model.known().tolerances;
        Bench { swings: &self.swings, held_out: &self.held_out, tolerances, count }
    }

    fn measurements(&self, held_out: bool) -> Vec<Measurement> {
        let wanted = self.recordings.iter().filter(|recording| recording.held_out == held_out);
        wanted.map(|recording| recording.measurement.clone()).collect()
    }

    fn source(&self, method: &str) -> Source {
        let fitted = self.recordings.iter().filter(|recording| !recording.held_out);
        let names: Vec<PathBuf> = fitted.map(|recording| PathBuf::from(&recording.name)).collect();
        Source::new(method, &names).of(kind(&self.swings))
    }

    /// What a model is called that was fitted to these recordings.
    fn fitted(&self) -> Numbers {
        let fitted = self.recordings.iter().filter(|recording| !recording.held_out);
        Numbers::FittedTo(fitted.map(|recording| recording.id).collect())
    }

    /// Does the state still have the recordings that this began with?
    fn is_current(&self, state: &State) -> bool {
        let same = |(a, b): (&Arc<Loaded>, &Arc<Loaded>)| Arc::ptr_eq(a, b);
        self.recordings.len() == state.recordings.len() && self.recordings.iter().zip(&state.recordings).all(same)
    }
}

/// The recordings of the command line.
pub(super) fn read_first(app: &Arc<App>, progress: &Progress) -> Result<(), Failure> {
    let paths = &app.settings.recordings;
    progress.say(&format!("reading {} recordings", paths.len()), None);
    let read: Vec<Result<Vec<Loaded>, Failure>> =
        paths.par_iter().map(|path| recordings::of_file(path, &app.settings)).collect();
    let mut failed = None;
    app.change(|state| {
        for loaded in read {
            failed = loaded.and_then(|loaded| state.add(loaded, None)).err().or(failed.take());
        }
    });
    app.jobs.ask_for_a_look();
    failed.map_or(Ok(()), Err)
}

/// The model beside its recordings: first the curves, then the verdict. A model that is still a guess, or that comes
/// from elsewhere and does not fit, is fitted first.
pub(super) fn look(app: &Arc<App>, progress: &Progress) -> Result<(), Failure> {
    app.change(begin_look);
    compare_all(app, progress).inspect_err(|failure| app.change(|state| state.not_compared = Some(failure.clone())))
}

/// Why the last comparison failed need not be true of this one.
fn begin_look(state: &mut State) {
    let last = state.not_compared.take();
    if last.is_some() && last == state.failure {
        state.failure = None;
    }
}

fn compare_all(app: &Arc<App>, progress: &Progress) -> Result<(), Failure> {
    let Ok(mut data) = Data::of(app) else {
        app.change(forget_comparison);
        return Ok(());
    };
    data.check(app)?;
    let mut data = if data.model.is_fresh() { first_fit(app, data, progress)? } else { data };
    show_curves(app, &data, progress);
    if app.jobs.is_pressed() {
        app.jobs.ask_for_a_look();
        return Ok(());
    }
    let mut comparison = compared(&data, progress)?;
    if comparison.answer == Answer::NumbersDoNotFit && data.numbers != Numbers::Typed {
        data = first_fit(app, data, progress)?;
        show_curves(app, &data, progress);
        comparison = compared(&data, progress)?;
    }
    app.change(|state| {
        if data.is_current(state) {
            state.comparison = Some(Arc::new(comparison));
            state.drawing += 1;
        }
    });
    get_ready(app, &data, progress);
    Ok(())
}

fn show_curves(app: &App, data: &Data, progress: &Progress) {
    if app.read(|state| state.runs.len() != state.recordings.len()) {
        progress.say("letting the model run beside each recording", Some(0.3));
        let runs = runs(data, data.parameters());
        app.change(|state| show_runs(state, data, runs));
    }
}

/// Numbers that were just fitted to these recordings are not questioned.
fn compared(data: &Data, progress: &Progress) -> Result<Comparison, Failure> {
    progress.say("looking where the model fails", Some(0.5));
    let (measurements, held_out) = (data.measurements(false), data.measurements(true));
    let options = compare::Options { fit_first: false, question_numbers: data.numbers != data.fitted() };
    compare(data.model.known(), &measurements, &held_out, &options).map_err(Failure::failed)
}

fn forget_comparison(state: &mut State) {
    state.comparison = None;
    state.runs.clear();
    state.drawing += 1;
}

/// A model whose numbers are not those of the recordings takes over theirs.
fn first_fit(app: &Arc<App>, data: Data, progress: &Progress) -> Result<Data, Failure> {
    progress.say("first fit: friction and inertia are not those of these recordings yet", Some(0.1));
    let (trial, step) = data.bench(&progress.count).fitted(data.parameters());
    let mut model = data.model.clone();
    model.adopt(&trial.parameters, &step.values, &data.source("least squares"))?;
    app.change(|state| {
        if let Some(named) = state.model.as_mut().filter(|named| named.file.parameters() == data.parameters()) {
            named.file = model.clone();
            named.origin = "fitted to the recordings".to_owned();
            named.numbers = data.fitted();
        }
        if data.is_current(state) {
            state.trial = Some(trial);
            state.staircase = vec![step];
        }
        state.runs.clear();
    });
    Ok(Data { model, numbers: data.fitted(), ..data })
}

/// Fits the model as it is while nobody waits, so that an added effect need not wait for that.
fn get_ready(app: &Arc<App>, data: &Data, progress: &Progress) {
    if app.jobs.is_pressed() || app.read(|state| state.trial.is_some()) {
        return;
    }
    progress.say("getting ready for changes", Some(0.8));
    let (trial, step) = data.bench(&progress.count).fitted(data.parameters());
    app.change(|state| {
        if data.is_current(state) && state.trial.is_none() {
            state.trial = Some(trial);
            // A fit of this page stands there already, with the steps that led to it.
            if state.staircase.is_empty() {
                state.staircase = vec![step];
            }
        }
    });
}

/// Lets a model run beside every recording.
fn runs(data: &Data, parameters: &Parameters<f64>) -> HashMap<u32, Arc<Followed>> {
    let of = |recording: &Arc<Loaded>| (recording.id, Arc::new(follow(&recording.measurement.swing, parameters)));
    data.recordings.par_iter().map(of).collect()
}

fn show_runs(state: &mut State, data: &Data, runs: HashMap<u32, Arc<Followed>>) {
    if data.is_current(state) {
        state.runs = runs;
        state.comparison = None;
        state.drawing += 1;
    }
}

/// Adds and removes effects, one after the other; the staircase grows by a step each.
pub(super) fn change_model(changes: Vec<Change>) -> impl FnOnce(&Arc<App>, &Progress) -> Result<(), Failure> {
    move |app, progress| {
        let data = Data::of(app)?;
        app.change(State::remember);
        let result = changes.iter().try_for_each(|change| change_once(app, &data, *change, progress));
        if result.is_err() {
            app.change(State::undo)?;
        }
        app.jobs.ask_for_a_look();
        result
    }
}

fn change_once(app: &Arc<App>, data: &Data, change: Change, progress: &Progress) -> Result<(), Failure> {
    let bench = data.bench(&progress.count);
    let known = app.read(|state| state.trial.clone().zip(state.staircase.last().cloned()));
    let (before, _) = known.unwrap_or_else(|| {
        progress.say("fitting the model as it is", Some(0.1));
        let (trial, step) = bench.fitted(data.parameters());
        app.change(|state| state.staircase = vec![step.clone()]);
        (trial, step)
    });
    let words = match change {
        Change::Add(effect) => format!("refitting with {}", effect.name),
        Change::Remove(effect) => format!("refitting without {}", effect.name),
    };
    progress.say(&words, Some(0.4));
    let hint = "choose another effect from the list";
    let (trial, step) = bench.changed(&before, change).map_err(|error| Failure::failed(error).next(hint))?;
    let mut model = app.read(|state| state.model.clone()).map_or(data.model.clone(), |named| named.file);
    model.adopt(&trial.parameters, &step.values, &data.source("least squares, effects added"))?;
    progress.say("letting the model run beside each recording", Some(0.9));
    let runs = runs(data, &trial.parameters);
    app.change(|state| {
        let origin = "changed on this page".to_owned();
        state.model = Some(Named { file: model, origin, numbers: data.fitted() });
        if data.is_current(state) {
            state.trial = Some(trial);
            state.staircase.push(step);
        }
        show_runs(state, data, runs);
    });
    Ok(())
}

/// Fits the model, changed or as it is, to what the live view has listened to and all other recordings.
pub(super) fn take_over(app: &Arc<App>, change: Option<Change>, progress: &Progress) -> Result<(), Failure> {
    take_releases_in(app)?;
    match change {
        Some(change) => change_model(vec![change])(app, progress),
        None => refit(app, progress),
    }
}

/// The releases that the live view has listened to come into the list; those that can't be fitted to do not, unless
/// there is nothing else.
fn take_releases_in(app: &Arc<App>) -> Result<(), Failure> {
    let releases = app.with_releases(Releases::hand_over);
    let port = app.read(|state| state.rig.port.clone());
    let mut fault = None;
    for release in releases {
        let taken = release.file().and_then(|file| recordings::of_release(file, &app.settings));
        match taken {
            Ok(loaded) => drop(app.change(|state| state.add(recordings::of_port(loaded, port.as_deref()), None))?),
            Err(failure) => fault = Some(failure),
        }
    }
    let is_empty = app.read(|state| state.recordings.is_empty());
    fault.filter(|_| is_empty).map_or(Ok(()), Err)
}

fn refit(app: &Arc<App>, progress: &Progress) -> Result<(), Failure> {
    let mut data = Data::of(app)?;
    data.check(app)?;
    app.change(State::remember);
    first_fit(app, data, progress)?;
    app.jobs.ask_for_a_look();
    Ok(())
}

/// Another model.
pub(super) fn set_model(app: &App, model: RigFile, origin: &str, numbers: Numbers) {
    app.change(|state| {
        state.remember();
        if numbers == Numbers::Foreign {
            state.model_port = None;
        }
        state.model = Some(Named { file: model, origin: origin.to_owned(), numbers });
        state.data_changed();
        forget_comparison(state);
    });
    app.jobs.ask_for_a_look();
}

/// Takes the last change back.
pub(super) fn undo(app: &App) -> Result<(), Failure> {
    let seen = app.change(|state| {
        let same = state.undo()?;
        if !same {
            forget_comparison(state);
        }
        Ok::<bool, Failure>(same && state.comparison.is_some())
    })?;
    if !seen {
        app.jobs.ask_for_a_look();
    }
    Ok(())
}

/// Which effect is missing?
pub(super) fn find_missing(app: &Arc<App>, progress: &Progress) -> Result<(), Failure> {
    let mut data = Data::of(app)?;
    data.check(app)?;
    progress.say("fitting the base model, then every effect", None);
    let wishes = Wishes { formulas: true, ..Wishes::default() };
    let found = diagnose_counted(&data.swings, &data.held_out, data.model.known(), wishes, &progress.count);
    app.change(|state| {
        if data.is_current(state) {
            state.diagnosis = Some(Arc::new(found));
            state.diagnosed = names_of_effects(data.parameters());
        }
    });
    Ok(())
}

/// The whole identification with its response surfaces.
pub(super) fn identify(app: &Arc<App>, progress: &Progress) -> Result<(), Failure> {
    let mut data = Data::of(app)?;
    data.check(app)?;
    let n_windows = windows_s(&data.swings).count() + 1;
    let n_steps = (n_windows + 3) as f64;
    let n_done = AtomicUsize::new(0);
    let options = identify::Options { method: Method::Both, ranges: Vec::new() };
    let fit = identify::fit(&data.swings, &data.held_out, data.model.known(), &options, &|step| {
        let share = n_done.fetch_add(1, Ordering::Relaxed) as f64 / n_steps;
        progress.say(&step.to_string(), Some(share.min(1.0)));
    });
    let fit = fit.map_err(Failure::failed)?;
    let mut model = data.model.clone();
    model.adopt_fit(&fit, &data.source("response surfaces, least squares"))?;
    let step = step_of(&fit);
    let runs = runs(&data, &fit.parameters);
    app.change(|state| {
        state.remember();
        let origin = "fitted on this page".to_owned();
        state.model = Some(Named { file: model, origin, numbers: data.fitted() });
        if data.is_current(state) {
            state.trial = None;
            state.staircase.push(step);
        }
        state.fit = Some(Arc::new(fit));
        show_runs(state, &data, runs);
    });
    app.jobs.ask_for_a_look();
    Ok(())
}

fn step_of(fit: &Fit) -> Step {
    Step {
        words: "fit".to_owned(),
        rmse: fit.rmse_rad,
        held_out: fit.held_out_rmse_rad,
        carries: None,
        noise: fit.noise_rad,
        values: Vec::new(),
        parameters: fit.parameters.clone(),
    }
}
