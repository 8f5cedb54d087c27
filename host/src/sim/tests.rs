use super::*;
use crate::link::Session;
use shared::wire::{Frame, Stream};

const RAW: Stream = Stream { raw: true, live_every: 0 };

fn session(name: &str) -> Session {
    crate::link::connect(name).unwrap()
}

fn codes(session: &mut Session, n_codes: usize) -> Vec<u16> {
    let mut codes = Vec::new();
    while codes.len() < n_codes {
        if let Some(Frame::Samples(samples)) = session.receive(Duration::from_secs(1)).unwrap() {
            codes.extend(&samples.codes);
        }
    }
    codes
}

#[test]
fn two_runs_give_the_same_codes_and_lose_none() {
    let run = || {
        let mut session = session("sim");
        session.start(RAW).unwrap();
        let codes = codes(&mut session, 10_000);
        assert_eq!((session.tally().frames_lost, session.tally().samples_lost), (0, 0));
        codes
    };
    assert_eq!(run(), run());
}

#[test]
fn the_next_recording_starts_on_the_other_side() {
    let mut session = session("sim");
    let held_at = |session: &mut Session| {
        session.start(RAW).unwrap();
        let code = codes(session, 3400)[3390];
        session.stop().unwrap();
        code
    };
    assert!(held_at(&mut session) > 2048 + 1000);
    assert!(held_at(&mut session) < 2048 - 700);
}

#[test]
fn what_is_pushed_is_kept_through_a_restart() {
    let mut session = session("sim");
    let mut parameters = shared::parameters::Parameters::paper();
    parameters.set(10, &[1e-4]).unwrap();
    session.push(&parameters).unwrap();
    session.tell(&Command::Reset).unwrap();
    assert_eq!(session.parameters().unwrap(), parameters.map(|value| value as f32));
    assert_eq!(session.statistics().unwrap().health.store, StoreState::Loaded);
}

#[test]
fn the_rig_believes_something_else_than_the_truth() {
    let believed = session("sim").parameters().unwrap();
    let truth = Scenario::by_name(Scenario::PLAIN).unwrap().true_parameters().map(|value| value as f32);
    assert_ne!(believed.pendulum.inertia_kg_m2, truth.pendulum.inertia_kg_m2);
    assert_ne!(believed.values(1), truth.values(1));
}

#[test]
fn an_effect_the_rig_does_not_know_is_refused_in_words() {
    let mut parameters = shared::parameters::Parameters::paper();
    parameters.set(999, &[1.0]).unwrap();
    let error = session("sim").push(&parameters).unwrap_err();
    assert!(error.to_string().contains("no effect with the id 999"), "{error}");
}

#[test]
fn an_unknown_scenario_is_answered_with_the_list() {
    let Err(error) = crate::link::open("sim:nonsense") else { panic!("opened") };
    assert!(error.to_string().contains("nonsense; there are plain, drag"), "{error}");
}
