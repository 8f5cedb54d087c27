//! Numbers that no pendulum has, through simulation, observer, rig, fit, comparison and diagnosis: a refusal or a finite
//! answer, and no long wait for it.

#[path = "../../shared/tests/physics_reference/mod.rs"]
mod physics_reference;

use host::compare::measurement::Measurement;
use host::compare::{self, compare};
use host::diagnose::diagnose;
use host::fit::identify::{self, Method, fit};
use host::recording::segment::SegmentOptions;
use host::recording::{AngleUnit, ReadOptions, read, read_bytes};
use host::swing::{Swing, SwingError};
use physics_reference::Reference;
use shared::effect::Effect;
use shared::model::Model;
use shared::motion::Pendulum;
use shared::observer::Observer;
use shared::parameters::Parameters;
use shared::rig::{HIGHEST_BANDWIDTH_RAD_S, HIGHEST_RATE_HZ, LOWEST_RATE_HZ, Outcome, Rig};
use shared::sensor::{Encoder, Potentiometer};
use shared::units::{Code, Radian};
use shared::wire::{Answer, Command, Frame, Settings, StoreState, Stream};
use std::f64::consts::PI;
use std::time::Instant;
use tests::HANG;
use tests::program::host;

const FULL_SCALE: u16 = 4095;

/// No number, numbers at the ends of what `f64` and `f32` hold, and between.
const STRANGE: [f64; 19] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    5e-324,
    1e-310,
    f64::MIN_POSITIVE,
    1e-45,
    1e-40,
    1.2e-38,
    1e-12,
    1e-6,
    -1.0,
    1e3,
    1e6,
    1e30,
    3.4e38,
    f64::MAX,
];

/// The paper's pendulum with one number of it, or of one effect added to it, replaced by each of the strange ones.
fn strange_parameters() -> Vec<Parameters<f64>> {
    let mut all = Vec::new();
    for value in STRANGE {
        let places: [fn(&mut Pendulum<f64>) -> &mut f64; 4] =
            [|p| &mut p.mass_kg, |p| &mut p.length_m, |p| &mut p.inertia_kg_m2, |p| &mut p.gravity_m_s2];
        for place in places {
            let mut parameters = Parameters::paper();
            *place(&mut parameters.pendulum) = value;
            all.push(parameters);
        }
        for effect in Effect::<f64>::ALL {
            for index in 0..effect.parameters.len() {
                let mut values: Vec<f64> = effect.parameters.iter().map(|parameter| parameter.start).collect();
                values[index] = value;
                let mut parameters = Parameters::paper();
                parameters.set(effect.id, &values).unwrap();
                all.push(parameters);
            }
        }
    }
    all
}

/// Beyond its range a value may feed energy in without end, as friction that pushes does.
fn is_within_ranges(parameters: &Parameters<f64>) -> bool {
    Effect::<f64>::ALL.iter().all(|effect| {
        let values = parameters.values(effect.id).unwrap_or(&[]);
        effect.parameters.iter().zip(values).all(|(p, value)| (p.low..=p.high).contains(value))
    })
}

#[test]
fn any_parameters_within_their_ranges_give_a_finite_swing() {
    let mut n_accepted = 0;
    for parameters in strange_parameters() {
        if parameters.check().is_err() || !is_within_ranges(&parameters) {
            continue;
        }
        n_accepted += 1;
        for (angle_rad, velocity_rad_s, dt_s) in
            [(1.5, 0.0, 1e-3), (PI, 0.0, 1e-3), (0.0, 60.0, 1e-3), (1.0, 0.0, 0.01)]
        {
            let model = Model::new(&parameters);
            let mut state = model.release(angle_rad, velocity_rad_s);
            let mut sensor = model.sensor_at_rest(&state);
            for k in 0..1000 {
                model.step(&mut state, dt_s);
                let numbers = [state.angle_rad, state.velocity_rad_s, model.read(&state, &mut sensor)];
                assert!(numbers.iter().all(|x| x.is_finite()), "step {k} of {dt_s} s: {numbers:?} of {parameters:?}");
            }
        }
    }
    println!("{n_accepted} sets accepted");
    assert!(n_accepted > 100);
}

/// Every number that the rig sends.
fn assert_finite(frame: &Frame, what: &dyn std::fmt::Debug) {
    let Frame::Live(live) = frame else { return };
    for p in &live.points {
        let all = [p.filtered_rad, p.angle_rad, p.velocity_rad_s, p.innovation_rad, p.friction_nm];
        assert!(all.iter().all(|x| x.is_finite()), "{p:?} with {what:?}");
    }
}

/// Samples of a swing, a still pendulum and a lost wire.
fn exercise(rig: &mut Rig, what: &dyn std::fmt::Debug) {
    rig.on_frame(Frame::Command(1, Command::Start(Stream { raw: true, live_every: 1 })));
    for k in 0..600_u32 {
        let swing = 2048.0 + 900.0 * (8e-3 * f64::from(k)).cos();
        let code = if (300..320).contains(&k) { 0 } else { swing as u16 };
        rig.on_sample(Code(code), |frame| assert_finite(&frame, what));
    }
    rig.on_samples_lost(u32::MAX, true, |frame| assert_finite(&frame, what));
    rig.on_sample(Code(2048), |frame| assert_finite(&frame, what));
    let statistics = rig.on_frame(Frame::Command(2, Command::Statistics));
    let Outcome::Send(Frame::Answer(2, Answer::Statistics(statistics))) = statistics else { panic!() };
    assert!(statistics.innovation_rms_rad.is_finite(), "{statistics:?} with {what:?}");
}

#[test]
fn the_rig_refuses_strange_parameters_or_goes_on_with_finite_numbers() {
    let mut rig = Rig::new("strange", FULL_SCALE, Err(StoreState::Empty));
    let (mut n_done, mut n_refused) = (0, 0);
    for parameters in strange_parameters() {
        let parameters = parameters.map(|value| value as f32);
        match rig.on_frame(Frame::Command(9, Command::SetParameters((&parameters).into()))) {
            Outcome::Send(Frame::Answer(9, Answer::Done)) => {
                n_done += 1;
                exercise(&mut rig, &parameters);
            }
            Outcome::Send(Frame::Answer(9, Answer::Refused(_))) => n_refused += 1,
            other => panic!("{other:?}"),
        }
    }
    println!("{n_done} sets taken, {n_refused} refused");
    assert!(n_done > 100 && n_refused > 100);
    // Whatever was before, good parameters are followed at once.
    let good = Parameters::paper().map(|value| value as f32);
    rig.on_frame(Frame::Command(9, Command::SetParameters((&good).into())));
    exercise(&mut rig, &"good parameters");
}

#[test]
fn the_rig_refuses_strange_settings_or_goes_on_with_finite_numbers() {
    let mut rig = Rig::new("strange", FULL_SCALE, Err(StoreState::Empty));
    let usual = *rig.settings();
    let nominal = Potentiometer::nominal(FULL_SCALE);
    let changes: [fn(Settings, Potentiometer, f32) -> Settings; 7] = [
        |s, _, rate_hz| Settings { rate_hz, ..s },
        |s, _, cutoff_hz| Settings { cutoff_hz, ..s },
        |s, _, bandwidth_rad_s| Settings { bandwidth_rad_s, ..s },
        |s, nominal, zero_code| s.with_sensor(Potentiometer { zero_code, ..nominal }.into()),
        |s, nominal, radian_per_code| s.with_sensor(Potentiometer { radian_per_code, ..nominal }.into()),
        |s, _, zero_code| s.with_sensor(Encoder { zero_code, ..Encoder::new(4096) }.into()),
        |s, _, counts| s.with_sensor(Encoder::new(counts as i32).into()),
    ];
    for value in STRANGE.iter().chain(&[100.0, 1e4, 4500.0, 449.0]).map(|value| *value as f32) {
        for change in changes {
            let settings = change(usual, nominal, value);
            rig.on_frame(Frame::Command(1, Command::SetSettings(settings)));
            exercise(&mut rig, &settings);
            rig.on_frame(Frame::Command(2, Command::CalibrateGain(Radian(value))));
            exercise(&mut rig, &settings);
        }
    }
}

#[test]
fn an_observer_recovers_from_any_angle_and_any_gap() {
    for value in STRANGE.map(|value| value as f32) {
        let mut observer = Observer::new(&Parameters::paper().map(|value| value as f32), 3.0);
        observer.on_measurement(1.0, 1e-3);
        observer.on_measurement(value, 1e-3);
        observer.on_gap(value);
        // Within a second.
        for _ in 0..1000 {
            observer.on_measurement(0.5, 1e-3);
        }
        let estimate = observer.on_measurement(0.5, 1e-3);
        assert!(estimate.innovation_rad.abs() < 0.5 && estimate.velocity_rad_s.abs() < 20.0, "{value}: {estimate:?}");
        assert!(observer.innovation_rms_rad().is_finite(), "{value}");
        // Once the pendulum swings, the observer is where it is: e⁻¹⁸ of its error is left after six seconds.
        let mut pendulum = Reference::release(&Parameters::paper(), None, 0.5, 0.0);
        let mut off_rad = f64::INFINITY;
        for _ in 0..6000 {
            pendulum.advance(1e-3);
            let estimate = observer.on_measurement(pendulum.angle_rad as f32, 1e-3);
            off_rad = (f64::from(estimate.angle_rad) - pendulum.angle_rad).abs();
        }
        assert!(off_rad < 1e-3, "{value}: still {off_rad} rad beside the pendulum");
    }
}

/// A thrown pendulum at the slowest and the fastest rate, and between them; continuous gains would diverge at 50 Hz from
/// 41 rad/s on, at 100 Hz from 83.
#[test]
fn an_observer_finds_the_pendulum_at_every_rate_and_bandwidth_that_a_rig_accepts() {
    for rate_hz in [LOWEST_RATE_HZ, 100.0, 1000.0, HIGHEST_RATE_HZ] {
        for bandwidth_rad_s in [3.0, 40.0, 86.0, HIGHEST_BANDWIDTH_RAD_S] {
            let mut observer = Observer::new(&Parameters::paper().map(|value| value as f32), bandwidth_rad_s);
            let mut pendulum = Reference::release(&Parameters::paper(), None, 0.5, 3.0);
            // e⁻¹⁸ of what it does not know is left after these; most of a second more where samples are scarce.
            let n_samples = (rate_hz * (18.0 / bandwidth_rad_s + 1.0)) as usize;
            for _ in 0..n_samples {
                observer.on_measurement(pendulum.angle_rad as f32, 1.0 / rate_hz);
                pendulum.advance(1.0 / f64::from(rate_hz));
            }
            let estimate = observer.on_measurement(pendulum.angle_rad as f32, 1.0 / rate_hz);
            let off_rad = (f64::from(estimate.angle_rad) - pendulum.angle_rad).abs();
            assert!(off_rad < 1e-3, "{off_rad} rad beside the pendulum at {rate_hz} Hz and {bandwidth_rad_s} rad/s");
        }
    }
}

/// Samples a second of what follows, and their number.
const RATE_HZ: f64 = 50.0;
const N_SAMPLES: u32 = 300;

fn samples(angle_rad: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    (0..N_SAMPLES).map(|k| f64::from(k) / RATE_HZ).map(|time_s| (time_s, angle_rad(time_s))).collect()
}

/// Held for a second, then let go or thrown.
fn simulated(parameters: &Parameters<f64>, angle_rad: f64, velocity_rad_s: f64) -> Vec<(f64, f64)> {
    let model = Model::new(parameters);
    let mut state = model.release(angle_rad, velocity_rad_s);
    let mut angles = vec![angle_rad; RATE_HZ as usize];
    for _ in 0..N_SAMPLES {
        angles.push(state.angle_rad);
        (0..20).for_each(|_| model.step(&mut state, 1e-3));
    }
    samples(|time_s| angles[(RATE_HZ * time_s).round() as usize])
}

/// What a pendulum may look like: held at 1 for a second, then swinging, with a little noise.
fn swing(time_s: f64) -> f64 {
    let since_s = (time_s - 1.0).max(0.0);
    (-0.3 * since_s).exp() * (6.5 * since_s).cos() + 1e-3 * (1e4 * time_s).sin()
}

/// Times and angles of pendulums that are none, or hardly.
fn strange_motions() -> Vec<(&'static str, Vec<(f64, f64)>)> {
    let mut stuck = Parameters::paper();
    stuck.set_friction(0.0, 0.3, 0.4, 0.05);
    assert!(stuck.pendulum.gravity_torque_nm() < 0.3);
    let stretched = |factor: f64| samples(swing).into_iter().map(|(t, angle)| (t * factor, angle)).collect();
    // A column that never moves is not even read; one step of a converter is.
    let still = |angle: f64| samples(move |t| if t < 3.0 { angle } else { angle + 1e-3 });
    vec![
        ("a swing", samples(swing)),
        ("hanging", still(0.0)),
        ("held", still(1.0)),
        ("upright", still(PI)),
        ("falling from upright", simulated(&Parameters::paper(), PI - 0.02, 0.0)),
        ("spinning over the top", simulated(&Parameters::paper(), 0.0, 40.0)),
        ("friction beyond gravity", simulated(&stuck, 1.5, -8.0)),
        ("as large as numbers go", samples(|t| 1e300 * swing(t))),
        ("large", samples(|t| 1e4 * swing(t))),
        ("as small as numbers go", samples(|t| 1e-310 * swing(t))),
        ("growing", samples(|t| 1e-3 * (0.8 * t).exp() * (6.5 * t).cos())),
        ("to and fro", samples(|t| if ((RATE_HZ * t).round() as u32).is_multiple_of(2) { 1.0 } else { -1.0 })),
        ("one jump", samples(|t| if t < 4.0 { 1.0 } else { 0.0 })),
        ("in nanoseconds", stretched(1e-9)),
        ("in milliseconds", stretched(1e3)),
        ("in ages", stretched(1e12)),
    ]
}

/// Pendulums for them.
fn rigs() -> Vec<(&'static str, Parameters<f64>)> {
    let with = |change: fn(&mut Parameters<f64>)| {
        let mut parameters = Parameters::paper();
        change(&mut parameters);
        assert!(parameters.check().is_ok());
        parameters
    };
    vec![
        ("the paper's", Parameters::paper()),
        ("a point mass", with(|p| p.pendulum.inertia_kg_m2 = 0.0)),
        ("friction beyond gravity", with(|p| p.set_friction(0.0, 0.3, 0.4, 0.05))),
        ("a huge band", with(|p| p.set_friction(5e-4, 7e-4, 1e-3, 300.0))),
    ]
}

/// What the library makes of them. What it refuses to read is left out; where it finds no swing, the motion is taken as
/// it is, as if somebody had insisted.
fn measurements() -> Vec<(&'static str, Measurement)> {
    let mut all = Vec::new();
    for (name, samples) in strange_motions() {
        let rows: String = samples.iter().map(|(time_s, angle_rad)| format!("{time_s:e},{angle_rad:e}\n")).collect();
        let options = ReadOptions { angle_unit: Some(AngleUnit::Radians), ..ReadOptions::default() };
        let recording = match read_bytes(name, format!("t,theta\n{rows}").as_bytes(), &options) {
            Ok(recording) => recording,
            Err(error) => {
                println!("{error}");
                continue;
            }
        };
        let measurement = Measurement::from_recording(name, &recording, &SegmentOptions::default());
        let insisted = |error: SwingError| {
            println!("{name}: {error}");
            let swing = Swing::new(name, recording.times_s(), recording.angles_rad(), 1e-3);
            (swing.duration_s() < 1e3).then(|| Measurement::of_swing(swing))
        };
        all.extend(measurement.map_or_else(insisted, Some).map(|measurement| (name, measurement)));
    }
    assert!(all.len() >= 5, "{}", all.len());
    all
}

fn within_patience<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let began = Instant::now();
    let result = work();
    println!("{what}: {:.1?}", began.elapsed());
    assert!(began.elapsed() < HANG, "{what} took {:?}", began.elapsed());
    result
}

#[test]
fn fits_of_strange_recordings_end_with_an_error_or_finite_numbers() {
    let (mut n_errors, mut n_fits) = (0, 0);
    for (name, measurement) in measurements() {
        for (rig_name, rig) in rigs() {
            // Surfaces take seconds.
            let is_papers = rig == Parameters::paper();
            let methods: &[Method] =
                if is_papers { &[Method::LeastSquares, Method::Rsm] } else { &[Method::LeastSquares] };
            for method in methods.iter().copied() {
                let what = format!("{method:?} of {name} with {rig_name}");
                let options = identify::Options { method, ranges: Vec::new() };
                let swings = std::slice::from_ref(&measurement.swing);
                let fit = match within_patience(&what, || fit(swings, &[], &rig, &options, &|_| {})) {
                    Ok(fit) => fit,
                    Err(error) => {
                        println!("{what}: {error}");
                        n_errors += 1;
                        continue;
                    }
                };
                n_fits += 1;
                assert!(fit.rmse_rad.is_finite(), "{what}: {}", fit.rmse_rad);
                assert!(fit.parameters.check().is_ok(), "{what}: {:?}", fit.parameters);
                for found in &fit.identified {
                    let spread = found.std.is_none_or(f64::is_finite);
                    assert!(found.value.is_finite() && spread, "{what}: {found:?}");
                }
            }
        }
    }
    println!("{n_fits} fits, {n_errors} errors");
    assert!(n_fits > 0 && n_errors > 0);
}

#[test]
fn comparisons_with_strange_recordings_have_finite_numbers() {
    for (name, measurement) in measurements() {
        for (rig_name, rig) in rigs() {
            let what = format!("{name} with {rig_name}");
            let compared = within_patience(&what, || {
                compare(&rig, std::slice::from_ref(&measurement), &[], &compare::Options::default()).unwrap()
            });
            let totals = &compared.totals;
            let all = [totals.explained, totals.nrmse_fit, totals.residual_rad, totals.noise_rad, totals.ratio];
            assert!(all.iter().all(|x| x.is_finite()), "{what}: {totals:?}");
            assert!(!compared.verdict.is_empty(), "{what}");
        }
    }
}

/// `host simulate` with numbers of an effect far beyond what is usual, up to where they are refused.
#[test]
fn a_simulation_without_a_finite_swing_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let simulate =
        |options: &str| host(folder.path(), &format!("simulate --force -o swing.csv --seconds 10 {options}"));
    host(folder.path(), "init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252").succeeded();
    for good in ["--with Mc=0.3", "--with DV=300", "--with I=0", "--start 3.14159", "--start -3.1", "--with Mw=5"] {
        simulate(good).succeeded();
        assert!(read(&folder.path().join("swing.csv"), &ReadOptions::default()).is_ok(), "{good}");
    }
    simulate("--with rw=-0.19 --exact").failed(1, &["runs away", "next"]);
    let beyond = ["--with l=1e-310", "--with m=1e30", "--start 1e3", "--start -1e308"];
    for refused in ["--with Mw=NaN", "--with m=inf", "--with Mw=1e9", "--start NaN"].into_iter().chain(beyond) {
        let run = simulate(refused);
        assert_eq!(run.code, 2, "{refused}: {run:#?}");
        assert!(run.stderr.contains("next") || run.stderr.contains("--help"), "{refused}: {run:#?}");
    }
    host(folder.path(), "init --mass 100 --length 2 --inertia 300 -o large.toml").succeeded();
    let floating = "init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252 --gravity 1e-9 -o floating.toml";
    host(folder.path(), floating).failed(2, &["gravity", "next"]);
}

#[test]
fn diagnoses_of_strange_recordings_have_finite_numbers() {
    // Each takes seconds.
    let chosen = ["a swing", "held", "falling from upright", "spinning over the top", "one jump"];
    let measurements: Vec<_> = measurements().into_iter().filter(|(name, _)| chosen.contains(name)).collect();
    assert_eq!(measurements.len(), chosen.len(), "one of {chosen:?} is not even read");
    for (name, measurement) in measurements {
        let swings = std::slice::from_ref(&measurement.swing);
        let diagnosis = within_patience(name, || diagnose(swings, &[], &Parameters::paper()));
        let all = [diagnosis.rmse_before, diagnosis.rmse_after, diagnosis.noise];
        assert!(all.iter().all(|x| x.is_finite()), "{name}: {all:?}");
    }
}
