//! The main job, with the real firmware: `host fit --port` records a swing, finds the model, writes it to the rig;
//! it is still there after a restart, and the rig's own innovation says that it fits.

use shared::parameters::Parameters;
use shared::wire::{Answer, Command, StoreState};
use std::time::{Duration, Instant};
use tests::image::{Board, firmware};
use tests::innovation;
use tests::link::Link;
use tests::plant::Scenario;
use tests::program::path;
use tests::qemu::Qemu;

const LIMIT: Duration = Duration::from_secs(300);

fn parameters(link: &mut Link) -> Parameters<f32> {
    match link.ask(Command::GetParameters).unwrap() {
        Answer::Parameters(parameters) => parameters,
        other => panic!("asked for parameters, got {other:?}"),
    }
}

#[test]
fn host_fit_makes_the_rig_follow_its_pendulum_and_a_restart_keeps_that() {
    let image = firmware(Board::Qemu).unwrap();
    let scenario = Scenario::default();
    let qemu = Qemu::start(&image, scenario.clone(), LIMIT).unwrap();
    let folder = tempfile::tempdir().unwrap();

    let (before, old) = {
        let mut link = Link::open(qemu.port()).unwrap();
        link.hello().unwrap();
        (innovation::of_the_next_swing(&mut link).unwrap(), parameters(&mut link))
    };

    let started = Instant::now();
    let run = assert_cmd::Command::new(path())
        .args(["fit", "--port", qemu.port(), "-o", "rig.toml"])
        .current_dir(folder.path())
        .timeout(LIMIT)
        .output()
        .unwrap();
    let said = [run.stderr, run.stdout].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    println!("{said}{:.0?}", started.elapsed());
    assert!(run.status.success(), "{said}");

    let mut link = Link::open(qemu.port()).unwrap();
    link.hello().unwrap();
    let fitted = parameters(&mut link);
    assert_ne!(fitted, old);
    let truth = scenario.parameters.pendulum.pivot_inertia_kg_m2();
    let found = f64::from(fitted.pendulum.pivot_inertia_kg_m2());
    assert!((found / truth - 1.0).abs() < 2e-3, "inertia about the pivot: {found} instead of {truth}");

    link.ask(Command::Reset).unwrap();
    std::thread::sleep(Duration::from_millis(500));
    link.hello().unwrap();
    assert_eq!(link.statistics().unwrap().health.store, StoreState::Loaded);
    assert_eq!(parameters(&mut link), fitted);

    let after = innovation::of_the_next_swing(&mut link).unwrap();
    println!("innovation {before:.2e} rad before, {after:.2e} after, noise {:.2e}", scenario.noise_rad);
    assert!(before >= 3.0 * scenario.noise_rad && after <= 1.3 * scenario.noise_rad);
}
