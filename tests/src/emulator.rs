//! The boards' own images in `tests/emulator`: virtual time, which passes only when a test lets it.
//!
//! [`Emulated`] talks to the firmware byte by byte and attacks what is around it; [`Terminal`] has the link as a pseudo
//! terminal and a swinging pendulum, for the program `host`.

mod rig;
pub mod stream;
mod terminal;

pub use terminal::Terminal;

use crate::HANG;
use crate::image::{Board, firmware, workspace};
use crate::python::python;
use serde_json::{Value, json};
use shared::wire::{Deframer, Frame};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Of the Nucleo's serial port.
const BAUD: u32 = 921_600;

/// What may be different from chip to chip.
#[derive(Clone, Debug)]
pub struct Chip {
    /// Which board.
    pub board: Board,
    /// Cycles an instruction takes: 1.5 with all caches on and warm, 4 at worst.
    pub cpi: f64,
    /// The longest erase and program times of the data sheet instead of the typical ones.
    pub worst_flash: bool,
    /// The processor runs on while the flash works, as from its instruction cache, and nothing interrupts it then.
    pub flash_beside: bool,
    /// Sectors that the option bytes protect against writing.
    pub protected: &'static [u32],
    /// The level of protection against reading that the option bytes give: 0, 1 or 2.
    pub read_protection: u8,
    /// The watchdog's oscillator: 17 000 to 47 000 Hz.
    pub lsi_hz: u32,
    /// The crystal, or the Nucleo's clock from outside, is there.
    pub crystal: bool,
    /// The bootloader jumps to the program, instead of a reset.
    pub left_by_bootloader: bool,
    /// The chip's unique id, 96 bits.
    pub unique_id: Option<[u8; 12]>,
    /// Number and revision that the chip gives for itself, of another revision than the usual one.
    pub device_id: Option<u32>,
    /// Seed of what memory holds at power-up.
    pub seed: u64,
}

impl Chip {
    /// A typical one.
    pub fn of(board: Board) -> Self {
        Self {
            board,
            cpi: 2.0,
            worst_flash: false,
            flash_beside: false,
            protected: &[],
            read_protection: 0,
            lsi_hz: 32_000,
            crystal: true,
            left_by_bootloader: false,
            unique_id: None,
            device_id: None,
            seed: 1,
        }
    }

    /// The one that leaves the firmware least time: slow code, slow flash, a fast watchdog.
    pub fn worst(board: Board) -> Self {
        Self { cpi: 4.0, worst_flash: true, lsi_hz: 47_000, ..Self::of(board) }
    }
}

/// The image that the tests run: the variable `BOARD_IMAGES` names a folder with others, such as a release's.
fn image(board: Board) -> Result<PathBuf, String> {
    match std::env::var_os("BOARD_IMAGES") {
        Some(folder) => Ok(PathBuf::from(folder).join(format!("{}.elf", name(board)))),
        None => built(board),
    }
}

/// Cargo is asked once for each board.
fn built(board: Board) -> Result<PathBuf, String> {
    static BUILT: Mutex<Vec<(Board, PathBuf)>> = Mutex::new(Vec::new());
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, image)) = built.iter().find(|(known, _)| *known == board) {
        return Ok(image.clone());
    }
    let image = firmware(board)?;
    built.push((board, image.clone()));
    Ok(image)
}

/// The Python that has what the emulator in this folder needs; looked for once.
fn interpreter(folder: &Path) -> Result<&'static Path, String> {
    static FOUND: OnceLock<PathBuf> = OnceLock::new();
    let packages = std::fs::read_to_string(folder.join("requirements.txt")).map_err(|error| error.to_string())?;
    Ok(FOUND.get_or_init(|| python(&packages.split_whitespace().collect::<Vec<&str>>())))
}

fn name(board: Board) -> &'static str {
    board.feature().trim_start_matches("board-")
}

/// The emulator's process and its lines.
struct Process {
    child: Child,
    input: ChildStdin,
    lines: Receiver<Value>,
}

impl Process {
    fn start(chip: &Chip, more: &[&str]) -> Result<Self, String> {
        let folder = workspace().join("tests/emulator");
        let mut command = Command::new(interpreter(&folder)?);
        command.arg("-B").arg(&folder).arg(name(chip.board)).arg(image(chip.board)?);
        command.args(["--cpi", &chip.cpi.to_string(), "--lsi-hz", &chip.lsi_hz.to_string()]);
        command.args(["--seed", &chip.seed.to_string()]).args(more);
        command.args(["--read-protection", &chip.read_protection.to_string()]);
        if !chip.protected.is_empty() {
            command.arg("--protect").args(chip.protected.iter().map(ToString::to_string));
        }
        if let Some(id) = chip.device_id {
            command.args(["--device-id", &id.to_string()]);
        }
        if let Some(id) = chip.unique_id {
            command.args(["--unique-id", &hex(&id)]);
        }
        for (wanted, option) in [
            (chip.worst_flash, "--worst-flash"),
            (chip.flash_beside, "--flash-beside"),
            (!chip.crystal, "--no-crystal"),
            (chip.left_by_bootloader, "--leave"),
        ] {
            command.args(wanted.then_some(option));
        }
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| format!("could not start the emulator: {error}"))?;
        let input = child.stdin.take().ok_or("no standard input")?;
        let output = child.stdout.take().ok_or("no standard output")?;
        let (said, lines) = channel();
        std::thread::spawn(move || {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                if said.send(serde_json::from_str(&line).unwrap_or(Value::String(line))).is_err() {
                    return;
                }
            }
        });
        Ok(Self { child, input, lines })
    }

    fn say(&mut self, command: &Value) -> Result<(), String> {
        writeln!(self.input, "{command}").map_err(|error| format!("the emulator is gone: {error}"))
    }

    /// The next line; an error tells what the firmware did that no model knows.
    fn hear(&mut self) -> Result<Value, String> {
        let line = self.lines.recv_timeout(HANG).map_err(|error| format!("the emulator says nothing: {error}"))?;
        if line["event"] == "failure" { Err(format!("at {} s: {}", line["at_s"], line["reason"])) } else { Ok(line) }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A board whose time stands still between commands.
pub struct Emulated {
    process: Process,
    /// Virtual time.
    pub now_s: f64,
    /// What happened: resets, erases, faults, news from USB, each with its time.
    pub events: Vec<Value>,
    deframer: Deframer,
    /// Frames that came and were not asked for.
    pub frames: Vec<Frame>,
    /// Times of `frames`, to the slice of time in which they came.
    pub times_s: Vec<f64>,
    /// Frames that were none.
    pub n_bad: usize,
    number: u16,
}

impl Emulated {
    /// Powers a board whose potentiometer shows a code that counts milliseconds.
    #[track_caller]
    pub fn new(chip: &Chip) -> Self {
        Self::with(chip, &["--wiper", "ramp"])
    }

    /// Powers a board whose encoder turns by a count each millisecond.
    #[track_caller]
    pub fn turning(chip: &Chip) -> Self {
        Self::with(chip, &["--wiper", "still", "--encoder", "ramp"])
    }

    /// Powers a board whose pendulum is lifted and let go every 12 s, and swings for 8 of them.
    #[track_caller]
    pub fn swinging(chip: &Chip) -> Self {
        Self::with(chip, &["--wiper", "swing"])
    }

    #[track_caller]
    fn with(chip: &Chip, more: &[&str]) -> Self {
        let process = Process::start(chip, more).unwrap();
        Self {
            process,
            now_s: 0.0,
            events: Vec::new(),
            deframer: Deframer::new(),
            frames: Vec::new(),
            times_s: Vec::new(),
            n_bad: 0,
            number: 0,
        }
    }

    /// A command of `tests/emulator/control.py`; gives its reply.
    #[track_caller]
    pub fn obey(&mut self, what: &str, arguments: Value) -> Value {
        self.try_to(what, arguments).unwrap_or_else(|reason| panic!("{what}: {reason}; {:?}", self.last_events()))
    }

    /// A command that the emulator has to end the run for; gives the reason.
    #[track_caller]
    pub fn ends_with(&mut self, what: &str, arguments: Value) -> String {
        self.try_to(what, arguments).expect_err("the run goes on")
    }

    fn try_to(&mut self, what: &str, mut arguments: Value) -> Result<Value, String> {
        arguments["do"] = json!(what);
        self.process.say(&arguments)?;
        loop {
            let mut line = self.process.hear()?;
            if line.get("reply").is_some() {
                self.now_s = line["now_s"].as_f64().unwrap_or(self.now_s);
                return Ok(line["reply"].take());
            }
            self.events.push(line);
        }
    }

    /// Lets virtual time pass; what the PC gets meanwhile is in `frames`.
    #[track_caller]
    pub fn run(&mut self, seconds: f64) {
        self.run_and_send(seconds, &[]);
    }

    /// The PC sends bytes, and time passes.
    #[track_caller]
    pub fn run_and_send(&mut self, seconds: f64, bytes: &[u8]) {
        self.run_and_send_at(BAUD, seconds, bytes);
    }

    /// The PC sends bytes with another speed of its serial port, and time passes.
    #[track_caller]
    pub fn run_and_send_at(&mut self, baud: u32, seconds: f64, bytes: &[u8]) {
        let reply = self.obey("run", json!({ "s": seconds, "send": hex(bytes), "baud": baud }));
        for byte in from_hex(reply["received"].as_str().unwrap_or_default()) {
            match self.deframer.push(byte) {
                Some(Ok(frame)) => {
                    self.frames.push(frame);
                    self.times_s.push(self.now_s);
                }
                Some(Err(_)) => self.n_bad += 1,
                None => {}
            }
        }
    }

    /// Something happens to the USB cable or at its other end; see `usb` in `tests/emulator/control.py`.
    #[track_caller]
    pub fn usb(&mut self, what: &str) {
        self.obey("usb", json!({ "what": what }));
    }

    /// The board's counters, such as `resets` or `longest_unfed_s`.
    #[track_caller]
    pub fn look(&mut self, counter: &str) -> f64 {
        self.obey("look", json!({}))[counter].as_f64().unwrap_or_else(|| panic!("no counter {counter}"))
    }

    /// What happened of one kind.
    pub fn events_of(&self, kind: &str) -> impl DoubleEndedIterator<Item = &Value> {
        self.events.iter().filter(move |event| event["event"] == kind)
    }

    fn last_events(&self) -> &[Value] {
        &self.events[self.events.len().saturating_sub(12)..]
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Bytes of a reply.
pub fn from_hex(text: &str) -> Vec<u8> {
    let digit = |byte: u8| (byte as char).to_digit(16).unwrap_or(0) as u8;
    text.as_bytes().as_chunks().0.iter().map(|[high, low]| digit(*high) << 4 | digit(*low)).collect()
}
