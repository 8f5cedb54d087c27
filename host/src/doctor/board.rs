//! What the board says of itself.

use super::Finding;
use crate::link::Session;
use shared::wire::{Chip, Clock, PROTOCOL, ResetCause, Statistics, StoreState};

pub(super) fn greeting(session: &Session) -> Finding {
    let [major, minor, patch] = session.rig().version;
    let name = &session.rig().name;
    Finding::ok("rig", format!("{name}, firmware {major}.{minor}.{patch}, protocol {PROTOCOL}"))
}

pub(super) fn effects(session: &Session) -> Finding {
    match (session.tells_its_effects(), session.knows_the_same_effects()) {
        (false, _) => Finding::ok("effects", "the firmware does not tell which it knows"),
        (true, true) => Finding::ok("effects", "program and firmware know the same"),
        (true, false) => {
            Finding::look("effects", "program and firmware know different ones", "update the older of the two")
        }
    }
}

pub(super) fn health(statistics: &Statistics) -> Vec<Finding> {
    vec![restarts(statistics), losses(statistics), store(statistics.health.store)]
}

/// Which chip it is, what it runs on, and how much of its time a sample takes.
pub(super) fn chip(chip: &Chip, rate_hz: f32) -> Vec<Finding> {
    let mut findings = Vec::new();
    let serial = if chip.serial.is_empty() { "without a number" } else { chip.serial.as_str() };
    match chip.clock {
        Clock::Unknown => {}
        Clock::Crystal => findings.push(Finding::ok("chip", format!("{serial}, on its crystal"))),
        Clock::Internal => findings.push(Finding::look(
            "chip",
            format!("{serial}, on its own oscillator: every time and rate is off by up to 1 % at 25 °C, 4 % from -10 to 85 °C"),
            "the clock from outside does not come: on a Nucleo check the solder bridges of MCO (SB16, SB50)",
        )),
    }
    if chip.clock_hz > 0 && chip.observer.count > 0 {
        let share = |cycles: f32| 100.0 * cycles * rate_hz / chip.clock_hz as f32;
        let mean = chip.sample.mean + chip.observer.mean;
        let worst = chip.sample.worst.saturating_add(chip.observer.worst) as f32;
        let found = format!(
            "{mean:.0} cycles a sample, {:.1} % of its time; at most {worst:.0}, {:.1} %",
            share(mean),
            share(worst)
        );
        let too_slow = (share(mean) > 50.0).then_some("lower the sampling rate, or push a model with fewer effects");
        findings.push(Finding::of("speed", found, too_slow));
        findings.push(Finding::ok("cycles", stages(chip)));
    }
    findings
}

/// Of each stage that has run.
fn stages(chip: &Chip) -> String {
    let all =
        [("a sample", chip.sample), ("the observer", chip.observer), ("a frame", chip.frame), ("a save", chip.save)];
    let measured = all.into_iter().filter(|(_, cycles)| cycles.count > 0);
    let told = measured.map(|(what, cycles)| format!("{what} {:.0}, at most {}", cycles.mean, cycles.worst));
    told.collect::<Vec<String>>().join("; ")
}

fn restarts(statistics: &Statistics) -> Finding {
    let health = &statistics.health;
    let found = match health.last_fault.as_str() {
        "" => format!("{} since power came on", health.resets),
        fault => format!("{} since power came on, last fault: {fault}", health.resets),
    };
    let by_itself = !matches!(health.cause, ResetCause::Power | ResetCause::Asked);
    let next = "the firmware restarted by itself; report the fault with what was done before it";
    Finding::of("restarts", found, by_itself.then_some(next))
}

fn losses(statistics: &Statistics) -> Finding {
    let Statistics { samples, overruns, dropped_frames, bad_frames, .. } = statistics;
    let found = format!(
        "of {samples} samples {overruns} lost; {dropped_frames} frames not taken by the PC, {bad_frames} bad ones received"
    );
    let complaint = if *overruns > 0 {
        Some("the processor is too slow for this rate: lower the sampling rate")
    } else if *dropped_frames > 0 {
        Some("a program had stopped reading; if it goes on, use another port or cable, without a hub")
    } else {
        None
    };
    Finding::of("losses", found, complaint)
}

fn store(state: StoreState) -> Finding {
    let push = "`host fit --port` finds a model for this rig, `host push` sends one that you have";
    match state {
        StoreState::Loaded => Finding::ok("flash", "holds a model and a calibration"),
        StoreState::Empty => Finding::look("flash", "holds no model: the paper's pendulum is in use", push),
        StoreState::OtherVersion => Finding::look("flash", "written by another firmware, not in use", push),
        StoreState::Damaged => Finding::look("flash", "damaged: the paper's pendulum is in use", push),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::wire::{Cycles, Health};

    #[test]
    fn a_board_that_has_less_than_half_of_its_time_left_is_too_slow() {
        let speed = |observer: f32| {
            let cycles = |mean: f32| Cycles { count: 1, mean, worst: 2 * mean as u32 };
            let chip =
                Chip { clock_hz: 1_000_000, sample: cycles(100.0), observer: cycles(observer), ..Chip::default() };
            super::chip(&chip, 1000.0).into_iter().find(|finding| finding.what == "speed").unwrap()
        };
        assert_eq!(speed(300.0).found, "400 cycles a sample, 40.0 % of its time; at most 800, 80.0 %");
        assert!(speed(300.0).ok && !speed(500.0).ok);
    }

    #[test]
    fn a_restart_that_nobody_asked_for_is_worth_a_look() {
        let is_ok = |cause: ResetCause| {
            let health = Health { cause, ..Health::default() };
            restarts(&Statistics { health, ..Statistics::default() }).ok
        };
        let causes =
            [ResetCause::Power, ResetCause::Asked, ResetCause::Watchdog, ResetCause::Panic, ResetCause::HardFault];
        assert_eq!(causes.map(is_ok), [true, true, false, false, false]);
    }
}
