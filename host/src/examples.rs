//! A swing of the paper's pendulum, its fit, its diagnosis and its comparison, for tests of what is told of them.

use crate::compare::measurement::Measurement;
use crate::compare::{self, Comparison, compare};
use crate::diagnose::{self, Diagnosis, Holding, Standing};
use crate::fit::identify::{self, Fit, Method, Options};
use crate::random::Noise;
use crate::swing::Swing;
use shared::model::Model;
use shared::parameters::Parameters;
use std::sync::LazyLock;

/// Eight seconds at 100 Hz, with noise of a milliradian.
pub(crate) fn swing() -> Swing {
    let (model, mut noise) = (Model::new(&Parameters::paper()), Noise::new(3));
    let mut state = model.release(1.2, 0.0);
    let times_s: Vec<f64> = (0..800).map(|i| f64::from(i) / 100.0).collect();
    let mut angles_rad = Vec::new();
    for _ in &times_s {
        angles_rad.push(state.angle_rad + 1e-3 * noise.normal());
        (0..5).for_each(|_| model.step(&mut state, 2e-3));
    }
    Swing::new("swing.csv", &times_s, &angles_rad, 1e-3)
}

/// What a fit finds in it.
pub(crate) fn fit() -> Fit {
    static FIT: LazyLock<Fit> = LazyLock::new(|| {
        let options = Options { method: Method::LeastSquares, ranges: Vec::new() };
        identify::fit(&[swing()], &[], &Parameters::paper(), &options, &|_| {}).unwrap()
    });
    FIT.clone()
}

/// What a diagnosis says of it: nothing is missing.
pub(crate) fn diagnosis() -> Diagnosis {
    static DIAGNOSIS: LazyLock<Diagnosis> = LazyLock::new(|| diagnose::diagnose(&[swing()], &[], &Parameters::paper()));
    DIAGNOSIS.clone()
}

/// The swing compared with the model that it is of.
pub(crate) fn comparison() -> Comparison {
    let measurement = Measurement::of_swing(swing());
    compare(&Parameters::paper(), &[measurement], &[], &compare::Options::default()).unwrap()
}

/// A claim that got so far, with its chance without two windows.
pub(crate) fn claim(standing: Standing, p_without_two: Option<f64>) -> Holding {
    let (effect, windows, rmse, parts) = ("quadratic-drag", 14, 2e-3, Vec::new());
    Holding {
        effect,
        standing,
        windows,
        rmse,
        beside: Vec::new(),
        p: Some(1e-3),
        p_without_two,
        value: None,
        std: None,
        parts,
    }
}
