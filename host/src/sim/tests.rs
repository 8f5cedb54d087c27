use super::*;
use crate::link::Session;
use shared::wire::{Frame, Stream};

const RAW: Stream = Stream { raw: true, live_every: 0 };

fn session(name: &str) -> Session {
    crate::link::connect(name).unwrap().keeping_in(None)
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

/// Listens to a release until it is small, and asks what the rig found.
fn found(session: &mut Session) -> Option<shared::wire::Suspects> {
    session.start(RAW).unwrap();
    codes(session, 40_000);
    session.stop().unwrap();
    session.suspects().unwrap()
}

#[test]
fn a_rig_that_looks_by_itself_names_what_its_model_lacks_and_nothing_once_it_has_it() {
    let mut session = session("sim:mystery-1");
    let names =
        |said: &shared::wire::Suspects| said.suspects.first().filter(|_| said.names()).map(|first| first.effect);
    let first = found(&mut session).unwrap();
    assert_eq!((names(&first), first.n_looks, first.n_releases), (Some(10), 1, 1), "{first:?}");
    session.push(&Scenario::by_name("mystery-1").unwrap().true_parameters()).unwrap();
    // The release that is there is judged anew.
    let then = session.suspects().unwrap().unwrap();
    assert_eq!((names(&then), then.n_looks, then.n_releases), (None, 2, 1), "{then:?}");
    assert_eq!(then.reason, Some(shared::bank::findings::Reason::NothingMissing));
}

#[test]
fn old_firmware_does_not_look() {
    assert_eq!(found(&mut session("sim:old-firmware")), None);
}
