//! The firmware in QEMU, with a simulated pendulum on its second serial port and a terminal on its first.
//!
//! The pendulum is the clock: one code is one sample. Codes come in blocks, which the firmware acknowledges, so that neither
//! runs away from the other and no wall-clock time enters a result.

mod counter;
mod writes;

use crate::HANG;
use crate::plant::{Plant, Scenario};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::unix::fs::FileExt;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The emulator.
pub const QEMU: &str = "qemu-system-arm";

/// The machine that the firmware's `board-qemu` is written for.
pub const MACHINE: &str = "netduinoplus2";

/// Samples a second of every scenario here.
const RATE_HZ: f64 = 1000.0;

/// The file of the codes, in QEMU's folder.
const CODES: &str = "codes";

/// Codes of a block, which has a place in that file.
const BLOCK: u64 = 16;
const PLACES: u64 = 8;

/// Samples on their way at most, not yet acknowledged.
pub const WINDOW: u64 = PLACES * BLOCK;

/// What the firmware sends on the pendulum's line when it starts, and what it is answered; every other byte of it
/// acknowledges a block.
const STARTS: u8 = 0;
const BEGINS: u8 = 0x80;

/// A running emulator. It ends with this value.
pub struct Qemu {
    shared: Arc<Shared>,
    port: String,
    directory: PathBuf,
    log: Arc<Mutex<Vec<u8>>>,
    plant: Option<JoinHandle<()>>,
    _turn: MutexGuard<'static, ()>,
}

/// One machine at a time in a test program: QEMU wants a core, its pendulum another.
static TURN: Mutex<()> = Mutex::new(());

struct Shared {
    process: Mutex<Child>,
    stop: AtomicBool,
    /// No more samples than these are sent in all.
    allowed: AtomicU64,
    n_starts: AtomicU64,
    n_samples: AtomicU64,
    n_swings: AtomicU64,
    next_scenario: Mutex<Option<Scenario>>,
}

/// Looks at a running emulator from elsewhere.
#[derive(Clone)]
pub struct Gauge(Arc<Shared>);

impl Gauge {
    /// The rig's own clock, s: samples sent over the sampling rate.
    pub fn seconds(&self) -> f64 {
        self.0.n_samples.load(Ordering::Relaxed) as f64 / RATE_HZ
    }

    /// Lets so many more samples pass from now on, and no others: the rig's clock then runs only as it is listened to.
    pub fn let_pass(&self, n_samples: u64) {
        self.0.allowed.store(self.0.n_samples.load(Ordering::Relaxed) + n_samples, Ordering::Relaxed);
    }

    /// How often the firmware has started. What it said on the link before its last start is there to be read.
    pub fn n_starts(&self) -> u64 {
        self.0.n_starts.load(Ordering::Acquire)
    }
}

impl Qemu {
    /// Starts `image` (from [`crate::image::firmware`]) with a pendulum in `scenario`.
    pub fn start(image: &Path, scenario: Scenario) -> Result<Self, String> {
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let directory = own_directory()?;
        let socket = directory.join("plant");
        let codes = File::create(directory.join(CODES)).map_err(|error| error.to_string())?;
        let chardev = format!("socket,id=plant,path={},server=on,wait=on", socket.display());
        let mut process = command()
            .current_dir(&directory)
            .args(["-chardev", "pty,id=link", "-serial", "chardev:link"])
            .args(["-chardev", &chardev, "-serial", "chardev:plant"])
            .args(["-semihosting-config", "enable=on,target=native,arg=image"])
            .args(["-gdb", &format!("unix:{},server=on,wait=off", debugger(&directory).display()), "-kernel"])
            .arg(image)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(missing)?;
        let log = Arc::default();
        let port = match terminal_of(&mut process, &log) {
            Ok(port) => port,
            Err(reason) => {
                end(&mut process);
                return Err(reason);
            }
        };
        let line = connect(&socket).inspect_err(|_| end(&mut process))?;
        let shared = Arc::new(Shared {
            process: Mutex::new(process),
            stop: AtomicBool::new(false),
            allowed: AtomicU64::new(u64::MAX),
            n_starts: AtomicU64::new(0),
            n_samples: AtomicU64::new(0),
            n_swings: AtomicU64::new(0),
            next_scenario: Mutex::new(None),
        });
        let feeder = Arc::clone(&shared);
        let plant = std::thread::spawn(move || feeder.feed(Plant::new(scenario), line, &codes));
        Ok(Self { shared, port, directory, log, plant: Some(plant), _turn: turn })
    }

    /// The terminal that is the board's serial port, for `--port`.
    pub fn port(&self) -> &str {
        &self.port
    }

    /// What the firmware logged so far, as defmt encodes it.
    pub fn log(&self) -> Vec<u8> {
        self.log.lock().map(|log| log.clone()).unwrap_or_default()
    }

    /// Samples sent so far.
    pub fn n_samples(&self) -> u64 {
        self.shared.n_samples.load(Ordering::Relaxed)
    }

    /// Swings begun so far.
    pub fn n_swings(&self) -> u64 {
        self.shared.n_swings.load(Ordering::Relaxed)
    }

    /// Hangs another pendulum (or the same, for the same swing again) on the rig, at rest.
    pub fn set_scenario(&self, scenario: Scenario) {
        if let Ok(mut next) = self.shared.next_scenario.lock() {
            *next = Some(scenario);
        }
    }

    /// Its clock and starts.
    pub fn gauge(&self) -> Gauge {
        Gauge(Arc::clone(&self.shared))
    }

    /// Holds the pendulum's samples back, or lets them go on; up to [`WINDOW`] are still on their way.
    pub fn hold(&self, holds: bool) {
        self.shared.allowed.store(if holds { 0 } else { u64::MAX }, Ordering::Relaxed);
    }

    /// Makes the processor go on at another address, as a wild pointer would.
    pub fn jump_to(&self, address: u32) -> Result<(), String> {
        let mut line = connect(&debugger(&self.directory))?;
        jump(&mut line, address)?;
        ask(&mut line, "D").map(drop)
    }

    /// Has it ended by itself?
    pub fn has_ended(&self) -> bool {
        self.shared.process.lock().is_ok_and(|mut process| !matches!(process.try_wait(), Ok(None)))
    }
}

impl Drop for Qemu {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        if let Ok(mut process) = self.shared.process.lock() {
            end(&mut process);
        }
        if let Some(plant) = self.plant.take() {
            let _ = plant.join();
        }
        let _ = std::fs::remove_dir_all(&self.directory);
    }
}

impl Shared {
    /// Sends blocks of samples while the firmware acknowledges them. None is sent before it has started, and what was on
    /// its way when it starts again counts as lost.
    fn feed(&self, mut plant: Plant, mut line: UnixStream, codes: &File) {
        let mut blocks = Blocks { in_flight: PLACES, next_place: 0 };
        while !self.stop.load(Ordering::Relaxed) {
            if let Some(scenario) = self.next_scenario.lock().ok().and_then(|mut next| next.take()) {
                plant = Plant::new(scenario);
            }
            while blocks.in_flight < PLACES {
                let n_allowed =
                    self.allowed.load(Ordering::Relaxed).saturating_sub(self.n_samples.load(Ordering::Relaxed));
                let block: Vec<u16> = (0..n_allowed.min(BLOCK)).map(|_| plant.next_code().0).collect();
                if block.is_empty() {
                    break;
                }
                if blocks.send(&block, codes, &mut line).is_err() {
                    return;
                }
                self.n_samples.fetch_add(block.len() as u64, Ordering::Relaxed);
                self.n_swings.store(u64::from(plant.n_swings()), Ordering::Relaxed);
            }

            let mut said = [0; 64];
            let n_said = line.read(&mut said).unwrap_or(0);
            for reply in &said[..n_said] {
                if *reply != STARTS {
                    blocks.in_flight = blocks.in_flight.saturating_sub(1);
                    continue;
                }
                blocks.in_flight = 0;
                self.n_starts.fetch_add(1, Ordering::Release);
                if line.write_all(&[BEGINS]).is_err() {
                    return;
                }
            }
        }
    }
}

/// What is on its way to the firmware.
struct Blocks {
    in_flight: u64,
    /// Where in the file the next one stands.
    next_place: u64,
}

impl Blocks {
    /// First the codes, two bytes each, low byte first; then 0pppnnnn on the line, their place and how many they are beyond
    /// one.
    fn send(&mut self, block: &[u16], codes: &File, line: &mut UnixStream) -> io::Result<()> {
        let bytes: Vec<u8> = block.iter().flat_map(|code| code.to_le_bytes()).collect();
        codes.write_all_at(&bytes, self.next_place * 2 * BLOCK)?;
        line.write_all(&[(self.next_place as u8) << 4 | (block.len() - 1) as u8])?;
        self.next_place = (self.next_place + 1) % PLACES;
        self.in_flight += 1;
        Ok(())
    }
}

/// The emulator with what every run needs: no window, no console, files and exit code by semihosting.
pub fn command() -> Command {
    let mut command = Command::new(QEMU);
    command.args(["-M", MACHINE, "-display", "none", "-monitor", "none"]).stdin(Stdio::null());
    command
}

/// What to do when the emulator cannot be started.
pub fn missing(error: std::io::Error) -> String {
    format!("could not start {QEMU}: {error}. Install it, for example with: apt install qemu-system-arm")
}

/// Runs an image that ends by itself in `directory`, where it finds its files; gives what it printed. `icount` makes
/// time count instructions, so that two runs are the same.
pub fn run(image: &Path, directory: &Path, icount: Option<&str>) -> Result<String, String> {
    let icount = icount.into_iter().flat_map(|setting| ["-icount", setting]);
    let mut process = command()
        .current_dir(directory)
        .args(["-serial", "null", "-semihosting-config", "enable=on,target=native,arg=image"])
        .args(icount)
        .arg("-kernel")
        .arg(image)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(missing)?;
    let output = collect(process.stdout.take());
    let errors = collect(process.stderr.take());
    let started = Instant::now();
    let status = loop {
        match process.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) if started.elapsed() < HANG => std::thread::sleep(Duration::from_millis(5)),
            _ => {
                end(&mut process);
                return Err(format!("{} did not end within {HANG:?}", image.display()));
            }
        }
    };
    let text = output.join().unwrap_or_default() + &errors.join().unwrap_or_default();
    if status.success() { Ok(text) } else { Err(format!("{} failed ({status}):\n{text}", image.display())) }
}

fn collect(stream: Option<impl Read + Send + 'static>) -> JoinHandle<String> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut stream) = stream {
            let _ = stream.read_to_end(&mut bytes);
        }
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// Ends this one process, by its id.
fn end(process: &mut Child) {
    let _ = process.kill();
    let _ = process.wait();
}

/// QEMU says which terminal it opened, on one stream or the other. After that line, its standard output is the
/// firmware's log.
fn terminal_of(process: &mut Child, log: &Arc<Mutex<Vec<u8>>>) -> Result<String, String> {
    let (said, lines) = std::sync::mpsc::channel();
    let (output, errors) = (process.stdout.take(), process.stderr.take());
    let output_log = Arc::clone(log);
    let output_said = said.clone();
    std::thread::spawn(move || {
        let Some(mut output) = output.map(BufReader::new) else { return };
        let mut line = String::new();
        while !line.contains("/dev/") {
            line.clear();
            match output.read_line(&mut line) {
                Ok(n_bytes) if n_bytes > 0 => output_said.send(line.clone()).unwrap_or(()),
                _ => return,
            }
        }
        keep(output, &output_log);
    });
    std::thread::spawn(move || {
        let lines = errors.map(BufReader::new).into_iter().flat_map(|errors| errors.lines().map_while(Result::ok));
        for line in lines {
            let _ = said.send(line);
        }
    });
    let mut all = String::new();
    while let Ok(line) = lines.recv_timeout(HANG) {
        if let Some(port) = line.split_whitespace().find(|word| word.starts_with("/dev/")) {
            return Ok(port.to_owned());
        }
        all += &line;
    }
    Err(format!("{QEMU} opened no terminal; it said: {all}"))
}

fn keep(mut stream: impl Read, log: &Mutex<Vec<u8>>) {
    let mut bytes = [0; 256];
    while let Ok(n_bytes @ 1..) = stream.read(&mut bytes) {
        if let Ok(mut log) = log.lock() {
            log.extend_from_slice(&bytes[..n_bytes]);
        }
    }
}

fn connect(socket: &Path) -> Result<UnixStream, String> {
    let started = Instant::now();
    loop {
        match UnixStream::connect(socket) {
            Ok(stream) => {
                // A short wait for acknowledgements, so that stopping is noticed.
                stream.set_read_timeout(Some(Duration::from_millis(50))).map_err(|error| error.to_string())?;
                return Ok(stream);
            }
            Err(_) if started.elapsed() < HANG => std::thread::sleep(Duration::from_millis(10)),
            Err(error) => return Err(format!("could not connect to {QEMU} at {}: {error}", socket.display())),
        }
    }
}

/// Sets the program counter (register 15). QEMU takes single registers only from those who have asked for their
/// description.
fn jump(line: &mut UnixStream, address: u32) -> Result<(), String> {
    ask(line, "qXfer:features:read:target.xml:0,ff")?;
    must(line, &format!("Pf={:08x}", address.swap_bytes()))
}

/// What the debugger has to agree to.
fn must(line: &mut UnixStream, request: &str) -> Result<(), String> {
    let reply = ask(line, request)?;
    if reply.contains("$OK") { Ok(()) } else { Err(format!("the debugger answered {reply} to {request}")) }
}

fn ask(line: &mut UnixStream, request: &str) -> Result<String, String> {
    ask_debugger(line, request).map_err(|error| format!("{request}: {error}"))
}

/// One packet of GDB's remote protocol and its answer; news of the processor's halt (`T`) may come before it.
fn ask_debugger(line: &mut UnixStream, request: &str) -> std::io::Result<String> {
    let sum = request.bytes().fold(0_u8, u8::wrapping_add);
    write!(line, "${request}#{sum:02x}")?;
    let mut reply = String::new();
    let asked = Instant::now();
    let answered =
        |reply: &str| reply.split('$').skip(1).any(|packet| packet.contains('#') && !packet.starts_with('T'));
    while !answered(&reply) && asked.elapsed() < HANG {
        let mut bytes = [0; 512];
        match line.read(&mut bytes) {
            Ok(n_bytes) => reply += &String::from_utf8_lossy(&bytes[..n_bytes]),
            Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => {}
            Err(error) => return Err(error),
        }
    }
    line.write_all(b"+")?;
    Ok(reply)
}

fn debugger(directory: &Path) -> PathBuf {
    directory.join("gdb")
}

/// A directory of this run alone. Paths of sockets must be short, so it is in the system's temporary directory.
fn own_directory() -> Result<PathBuf, String> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let name = format!("pendulum-qemu-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let directory = std::env::temp_dir().join(name);
    std::fs::create_dir_all(&directory).map_err(|error| format!("could not make {}: {error}", directory.display()))?;
    Ok(directory)
}
