//! The main job, with the real firmware: `host fit --port` records a swing, finds the model, writes it to the rig;
//! it is still there after a restart, and the rig's own innovation says that it fits. With something hidden in the
//! pendulum, `--discover` finds that too, and the observer on the board runs it.

use host::fit::curve::KnownCurve;
use host::rigfile::{RigFile, Source};
use shared::curve::Curve;
use shared::effect::Effect;
use shared::parameters::{Parameters, base};
use shared::wire::{Answer, Command, StoreState};
use tests::image::{Board, firmware};
use tests::innovation;
use tests::link::Link;
use tests::plant::Scenario;
use tests::program::host_with;
use tests::qemu::Qemu;

/// What the rig believed, and the root mean square of its innovation (rad), before and after `host fit`.
struct Fitted {
    before: (Parameters<f32>, f64),
    after: (Parameters<f32>, f64),
}

fn parameters(link: &mut Link) -> Parameters<f32> {
    match link.ask(Command::GetParameters).unwrap() {
        Answer::Parameters(numbers) => numbers.into(),
        other => panic!("asked for parameters, got {other:?}"),
    }
}

/// A pendulum with more friction than the paper's: its swings end sooner, and four of them are waited for.
fn brisk() -> Scenario {
    let mut scenario = Scenario { swing_s: 28.0, ..Scenario::default() };
    scenario.parameters.set_friction(5.4e-4, 2e-3, 2.2e-3, 0.055);
    scenario
}

/// Runs the board with a pendulum, fits, restarts the board, and looks at the next swing.
fn fitted(scenario: &Scenario, options: &[&str]) -> Fitted {
    let image = firmware(Board::Qemu).unwrap();
    let qemu = Qemu::start(&image, scenario.clone()).unwrap();
    let folder = tempfile::tempdir().unwrap();

    let before = {
        let mut link = Link::open(qemu.port()).unwrap();
        link.hello().unwrap();
        let innovation_rad = innovation::of_the_next_swing(&mut link).unwrap();
        (parameters(&mut link), innovation_rad)
    };

    let run = host_with(folder.path(), &[&["fit", "--port", qemu.port(), "-o", "rig.toml"], options].concat());
    println!("{}{}", run.stderr, run.stdout);
    run.succeeded();

    let mut link = Link::open(qemu.port()).unwrap();
    link.hello().unwrap();
    let pushed = parameters(&mut link);
    link.ask(Command::Reset).unwrap();
    assert_eq!(link.hello_after_restart(1).unwrap().health.store, StoreState::Loaded);
    assert_eq!(parameters(&mut link), pushed);

    let innovation_rad = innovation::of_the_next_swing(&mut link).unwrap();
    println!("innovation {:.2e} rad before, {innovation_rad:.2e} after, noise {:.2e}", before.1, scenario.noise_rad);
    Fitted { before, after: (pushed, innovation_rad) }
}

#[test]
fn host_fit_makes_the_rig_follow_its_pendulum_and_a_restart_keeps_that() {
    let scenario = brisk();
    let Fitted { before, after } = fitted(&scenario, &[]);
    assert_ne!(after.0, before.0);
    let truth = scenario.parameters.pendulum.pivot_inertia_kg_m2();
    let found = f64::from(after.0.pendulum.pivot_inertia_kg_m2());
    assert!((found / truth - 1.0).abs() < 2e-3, "inertia about the pivot: {found} instead of {truth}");
    assert!(before.1 >= 3.0 * scenario.noise_rad && after.1 <= 1.3 * scenario.noise_rad);
}

#[test]
fn a_hidden_drag_is_found_and_the_observer_on_the_board_runs_it() {
    let drag = Effect::<f64>::by_name("quadratic-drag").unwrap();
    let mut scenario = Scenario { release_rad: 1.4, ..brisk() };
    scenario.parameters.set(drag.id, &[1.5e-4]).unwrap();
    let Fitted { before, after } = fitted(&scenario, &["--discover"]);
    let added: Vec<u16> =
        after.0.effects.iter().map(|effect| effect.id).filter(|id| before.0.values(*id).is_none()).collect();
    assert_eq!(added, [drag.id], "ids of the effects that were added");
    assert!(before.1 >= 3.0 * scenario.noise_rad && after.1 <= 1.3 * scenario.noise_rad);
}

/// The friction of a pendulum with drag as a curve: through what acts at some speeds, in N·m at rad/s.
fn as_curve(scenario: &Scenario, drag: f64) -> RigFile {
    let speeds: Vec<f32> = (0..16).map(|k| 0.75 * k as f32).collect();
    let friction = |id: u16| scenario.parameters.values(id).unwrap()[0];
    let torque = |v: f64| friction(base::COULOMB) + friction(base::VISCOUS) * v + drag * v * v;
    let torques: Vec<f64> = speeds.iter().map(|speed| torque(f64::from(*speed))).collect();
    let curve = KnownCurve { curve: Curve::new(&speeds, &torques).unwrap(), stds: Vec::new() };
    let mut parameters = scenario.parameters.clone();
    parameters.effects.retain(|effect| effect.id == base::STICTION);
    let mut file = RigFile::of_rig(&parameters.map(|value| value as f32), &Source::read_from("test")).unwrap();
    file.set_curve(&curve, &Source::read_from("test")).unwrap();
    file
}

#[test]
fn a_friction_curve_that_is_pushed_is_run_by_the_observer_on_the_board() {
    let (drag, size) = (Effect::<f64>::by_name("quadratic-drag").unwrap(), 1.5e-4);
    let mut scenario = Scenario { release_rad: 1.4, rest_s: 0.5, lift_s: 0.5, hold_s: 0.5, swing_s: 12.0, ..brisk() };
    scenario.parameters.set(drag.id, &[size]).unwrap();
    let qemu = Qemu::start(&firmware(Board::Qemu).unwrap(), scenario.clone()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    as_curve(&scenario, size).save(&folder.path().join("rig.toml")).unwrap();

    host_with(folder.path(), &["push", "--port", qemu.port()]).succeeded();
    let mut link = Link::open(qemu.port()).unwrap();
    link.hello().unwrap();
    link.ask(Command::Reset).unwrap();
    assert_eq!(link.hello_after_restart(1).unwrap().health.store, StoreState::Loaded);
    let innovation_rad = innovation::of_the_next_swing(&mut link).unwrap();
    println!("innovation {innovation_rad:.2e} rad, noise {:.2e}", scenario.noise_rad);
    assert!(innovation_rad <= 1.3 * scenario.noise_rad);
}
