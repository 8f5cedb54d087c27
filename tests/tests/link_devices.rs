//! The program and a device on a pseudo terminal: the rig itself, strangers, pulled cables, Ctrl-C.
#![cfg(target_os = "linux")]

use host::rigfile::RigFile;
use shared::wire::{self, Answer, Frame, Hello, MAX_FRAME, Samples, Settings};
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tests::HANG;
use tests::device::Device;
use tests::program::{PATIENT, Run, host, impatient_host, path};

/// Seconds of the rig's clock: in the middle of the first swing.
const MID_SWING_S: f64 = 12.0;

/// Rows of a recording, header included, that hold a good part of the swing.
const SOME_ROWS: usize = 3000;

#[track_caller]
fn check_stranger(device: &Device, words: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    impatient_host(folder.path(), &format!("statistics --port {}", device.port)).failed(1, words);
}

/// The program in the background, recording.
struct Recording {
    child: Child,
    heard: String,
}

impl Recording {
    fn start(folder: &Path, device: &Device) -> Self {
        Self::start_with(folder, device, &[])
    }

    fn start_with(folder: &Path, device: &Device, more: &[&str]) -> Self {
        let child = Command::new(path())
            .args(["record", "--port", &device.port, "-o", "swing.csv"])
            .args(more)
            .current_dir(folder)
            .env(PATIENT.0, PATIENT.1)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        Self { child, heard: String::new() }
    }

    /// Waits until the program says this.
    fn wait_for(&mut self, words: &str) {
        let stderr = self.child.stderr.as_mut().unwrap();
        let mut byte = [0];
        let mut bytes = Vec::new();
        while !String::from_utf8_lossy(&bytes).contains(words) {
            assert!(stderr.read(&mut byte).unwrap() > 0, "it ended: {}", String::from_utf8_lossy(&bytes));
            bytes.push(byte[0]);
        }
        self.heard += &String::from_utf8_lossy(&bytes);
    }

    fn interrupt(&self) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    }

    fn end(self) -> Run {
        let output = self.child.wait_with_output().unwrap();
        Run {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: self.heard + &String::from_utf8(output.stderr).unwrap(),
        }
    }
}

fn n_rows(folder: &Path) -> usize {
    std::fs::read_to_string(folder.join("swing.csv")).map_or(0, |text| text.lines().count())
}

/// Waits until some seconds of the swing have come to the disk.
fn wait_for_rows(folder: &Path) {
    let began = Instant::now();
    while n_rows(folder) <= SOME_ROWS {
        assert!(began.elapsed() < HANG, "{} rows", n_rows(folder));
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_rig_on_a_serial_port_is_recorded_without_loss() {
    let folder = tempfile::tempdir().unwrap();
    let device = Device::rig("plain");
    let run = host(folder.path(), &format!("record --port {} -o swing.csv --limit 20", device.port));
    assert!(run.succeeded().contains("none lost"), "{run:?}");
    assert!(n_rows(folder.path()) > 20_000);
}

#[test]
fn a_fit_with_the_geometry_that_boards_begin_with_says_so_and_needs_nobody_at_the_second_swing() {
    let folder = tempfile::tempdir().unwrap();
    let mut n_streams = 0;
    // Beside the second stream nobody lifts the pendulum.
    let device = Device::rig_that_says("plain", move |frame| match frame {
        Frame::Samples(samples) => {
            n_streams += usize::from(samples.sequence == 0);
            let hangs = |code: &u16| if n_streams > 1 { 2048 + (code & 1) } else { *code };
            let codes = samples.codes.iter().map(hangs).collect();
            vec![Frame::Samples(Samples { codes, ..samples })]
        }
        frame => vec![frame],
    });
    let fit = format!("fit --port {} --method least-squares --wait 10 -o own.toml", device.port);
    let run = host(folder.path(), &fit);
    assert!(run.succeeded().contains("has the new model, in its flash too"), "{run:?}");
    assert!(run.stdout.contains("note: mass and length are those of the paper's pendulum"), "{run:?}");
    assert!(run.stderr.contains("the second swing was not made"), "{run:?}");
    let said_before = run.stderr.split("waiting until").next().unwrap();
    assert!(said_before.contains("host init --mass"), "{run:?}");
}

#[test]
fn a_model_of_another_sensor_that_lies_here_is_told_before_it_is_used() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "calibrate --port sim:encoder").succeeded();
    let device = Device::rig("plain");
    let run = host(folder.path(), &format!("fit --port {} --method least-squares --no-push", device.port));
    let words = ["the model is that of rig.toml", "kind encoder", "kind potentiometer", "--rig"];
    assert!(words.iter().all(|word| run.stderr.contains(word)), "{run:?}");
    assert!(!run.stderr.contains("paper's pendulum"), "{run:?}");
}

#[test]
fn the_doctor_names_settings_that_nobody_can_compute_with_and_a_pendulum_that_hangs_off_zero() {
    let folder = tempfile::tempdir().unwrap();
    let device = Device::rig_that_says("plain", |frame| match frame {
        Frame::Answer(number, Answer::Settings(settings)) => {
            vec![Frame::Answer(number, Answer::Settings(Settings { rate_hz: f32::NAN, ..settings }))]
        }
        frame => vec![frame],
    });
    let run = host(folder.path(), &format!("doctor --port {}", device.port));
    assert!(
        run.succeeded().contains("look here  settings       the rig says that its sampling rate is NaN Hz"),
        "{run:?}"
    );
    host(folder.path(), &format!("record --port {} -o swing.csv", device.port)).failed(1, &["expected 50 to 10000 Hz"]);

    let off = Device::rig_that_says("plain", |frame| match frame {
        Frame::Samples(samples) => {
            let codes = samples.codes.iter().map(|code| code + 200).collect();
            vec![Frame::Samples(Samples { codes, ..samples })]
        }
        frame => vec![frame],
    });
    let run = host(folder.path(), &format!("doctor --port {}", off.port));
    assert!(run.succeeded().contains("look here  zero           the pendulum hangs at 0.2"), "{run:?}");
}

#[test]
fn what_is_pushed_over_a_serial_port_is_pulled_back() {
    let folder = tempfile::tempdir().unwrap();
    let device = Device::rig("plain");
    host(folder.path(), "init --mass 0.2 --length 0.3 --inertia 0.004").succeeded();
    host(folder.path(), &format!("push --port {}", device.port)).succeeded();
    let pulled = host(folder.path(), &format!("pull --port {} -o pulled.toml", device.port));
    let is_inertia = |line: &str| line.split_whitespace().take(3).eq(["I", "0.004", "kg·m²"]);
    assert!(pulled.succeeded().lines().any(is_inertia), "{pulled:?}");
}

#[test]
fn undo_brings_back_what_the_rig_had_and_once_more_takes_that_back() {
    let folder = tempfile::tempdir().unwrap();
    let device = Device::rig("plain");
    let on_the_rig = || {
        let run = host(folder.path(), &format!("pull --port {} -o pulled.toml --force --json", device.port));
        let pulled: serde_json::Value = serde_json::from_str(run.succeeded()).unwrap();
        pulled["parameters"].clone()
    };
    let undo = format!("undo --port {}", device.port);
    host(folder.path(), &undo).failed(1, &["nothing was pushed to simulated-rig", "host push"]);
    let first = on_the_rig();
    host(folder.path(), "init --mass 0.2 --length 0.3 --inertia 0.004 -o other.toml").succeeded();
    let push = format!("push --port {} --rig other.toml", device.port);
    host(folder.path(), &push).succeeded();
    // What is there already changes nothing, and is no step to go back to.
    host(folder.path(), &push).succeeded();
    let second = on_the_rig();
    assert_ne!(first, second);
    let undone = host(folder.path(), &undo);
    assert!(undone.succeeded().contains("has again what it had before"), "{undone:?}");
    assert_eq!(on_the_rig(), first);
    host(folder.path(), &undo).succeeded();
    assert_eq!(on_the_rig(), second);
}

/// A model file of a pendulum with friction as a curve of the speed.
fn write_curve(folder: &Path) {
    let curve = "speed = [0, 0.4, 1.5, 3, 6]\ntorque = [9e-3, 6e-3, 8e-3, 7e-3, 1.2e-2]\n";
    host(folder, "init --mass 0.2 --length 0.3 --inertia 0.004 -o curve.toml").succeeded();
    let path = folder.join("curve.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let is_replaced = |line: &str| line.starts_with("Mw =") || line.starts_with("Mc =");
    let kept = |line: &str| if is_replaced(line) { format!("{} = 0.0", &line[..2]) } else { line.to_owned() };
    let text: Vec<String> = text.lines().map(kept).collect();
    std::fs::write(path, format!("{}\n[effect.friction-curve]\n{curve}", text.join("\n"))).unwrap();
}

#[test]
fn a_friction_curve_is_pushed_pulled_and_brought_back() {
    let folder = tempfile::tempdir().unwrap();
    write_curve(folder.path());
    let device = Device::rig("plain");
    let on_the_rig = || {
        host(folder.path(), &format!("pull --port {} -o pulled.toml --force", device.port)).succeeded();
        RigFile::load(&folder.path().join("pulled.toml")).unwrap().parameters().clone()
    };
    let before = on_the_rig();
    host(folder.path(), &format!("push --port {} --rig curve.toml", device.port)).succeeded();
    let curve = RigFile::load(&folder.path().join("curve.toml")).unwrap().parameters().curve.clone();
    assert_eq!(on_the_rig().curve, curve.clone());
    // What was pulled says the same to the rig, and then its numbers are brought back as they were.
    host(folder.path(), &format!("push --port {} --rig pulled.toml", device.port)).succeeded();
    host(folder.path(), &format!("undo --port {}", device.port)).succeeded();
    assert_eq!(on_the_rig(), before);
    host(folder.path(), &format!("undo --port {}", device.port)).succeeded();
    assert_eq!(on_the_rig().curve, curve);
}

#[test]
fn firmware_from_before_friction_curves_is_named_and_keeps_what_it_has() {
    let folder = tempfile::tempdir().unwrap();
    write_curve(folder.path());
    let device = Device::rig_that_knows("plain", |frame| !matches!(frame, Frame::FrictionCurve(_)));
    let push = impatient_host(folder.path(), &format!("push --port {} --rig curve.toml", device.port));
    push.failed(1, &["can't run a friction curve", "update the firmware", "--remove friction-curve"]);
    host(folder.path(), &format!("pull --port {} -o pulled.toml", device.port)).succeeded();
    let kept = RigFile::load(&folder.path().join("pulled.toml")).unwrap();
    assert!(kept.parameters().curve.is_none() && kept.parameters().check().is_ok());
}

#[test]
fn a_port_in_use_is_told_with_its_user() {
    let folder = tempfile::tempdir().unwrap();
    let device = Device::rig("plain");
    let mut first = Recording::start(folder.path(), &device);
    first.wait_for("waiting until");
    let second = host(folder.path(), &format!("statistics --port {}", device.port));
    second.failed(1, &["is in use", "host (process", "close the other program"]);
    first.interrupt();
    first.end();
}

#[test]
fn a_silent_device() {
    check_stranger(&Device::new(|_| Vec::new()), &["not one byte", "reset button"]);
}

#[test]
fn a_babbling_device() {
    let device = Device::new(|_| b"temp=21.5 C\r\n".to_vec());
    check_stranger(&device, &["not a pendulum rig", "temp=21.5", "another device"]);
}

#[test]
fn a_device_that_sends_nothing_but_zeros() {
    check_stranger(&Device::new(|_| vec![0; 64]), &["not a pendulum rig", "00 00"]);
}

#[test]
fn a_device_that_sends_everything_back() {
    check_stranger(&Device::new(<[u8]>::to_vec), &["sends back what it is sent"]);
}

#[test]
fn a_rig_of_another_protocol() {
    let device = Device::new(|received| {
        let mut buffer = [0; MAX_FRAME];
        let hello = Hello { protocol: 77, version: [7, 7, 0], ..Hello::new("feather-f405") };
        let answer = wire::encode(&Frame::Hello(hello), &mut buffer).unwrap();
        if received.is_empty() { Vec::new() } else { answer.to_vec() }
    });
    check_stranger(&device, &["feather-f405", "firmware 7.7.0", "protocol 77", "update this program"]);
}

#[test]
fn firmware_that_knows_no_other_sensor_is_named() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "calibrate --port sim:encoder").succeeded();
    // It finds no meaning in the bytes of another sensor, and does not answer.
    let is_known = |frame: &Frame| match frame {
        Frame::Command(_, wire::Command::SetSettings(settings)) => settings.sensor.protocol() == wire::PROTOCOL,
        _ => true,
    };
    let device = Device::rig_that_knows("plain", is_known);
    let run = impatient_host(folder.path(), &format!("push --calibration --port {}", device.port));
    run.failed(1, &["simulated-rig", "knows no sensor of kind encoder", "update the rig's firmware"]);
}

#[test]
fn a_cable_pulled_while_recording_keeps_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let device = Device::rig_until("plain", MID_SWING_S);
    let mut recording = Recording::start(folder.path(), &device);
    recording.wait_for("released");
    wait_for_rows(folder.path());
    device.unplug();
    recording.end().failed(1, &["connection", "broke", "are kept in swing.csv", "check the cable"]);
    assert!(n_rows(folder.path()) > SOME_ROWS, "{} rows", n_rows(folder.path()));
}

#[test]
fn a_rig_that_falls_silent_keeps_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let device = Device::rig_until("plain", MID_SWING_S);
    let run = impatient_host(folder.path(), &format!("record --port {} -o swing.csv", device.port));
    run.failed(1, &["stopped sending samples", "are kept in swing.csv"]);
    assert!(n_rows(folder.path()) > SOME_ROWS);
}

#[test]
fn ctrl_c_while_recording_keeps_a_usable_file() {
    let folder = tempfile::tempdir().unwrap();
    let device = Device::rig_until("plain", MID_SWING_S);
    let mut recording = Recording::start(folder.path(), &device);
    recording.wait_for("released");
    wait_for_rows(folder.path());
    recording.interrupt();
    let run = recording.end();
    run.succeeded();
    assert!(run.stderr.contains("stopped before") && run.stderr.contains("usable"), "{run:?}");
    assert!(n_rows(folder.path()) > SOME_ROWS);
}

#[test]
fn ctrl_c_before_the_release_is_a_failure_and_costs_no_older_recording() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("swing.csv"), "precious").unwrap();
    // It hangs still for a second before it is lifted, but is not let go.
    let device = Device::rig_until("plain", 1.5);
    let mut recording = Recording::start_with(folder.path(), &device, &["--force"]);
    recording.wait_for("still: lift it");
    recording.interrupt();
    recording.end().failed(130, &["stopped before", "next:"]);
    assert_eq!(std::fs::read_to_string(folder.path().join("swing.csv")).unwrap(), "precious");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
