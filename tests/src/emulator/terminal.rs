//! A board whose link is a pseudo terminal and whose time runs on, with a pendulum that lives here.

use super::{Chip, Process};
use crate::plant::{Plant, Scenario};
use serde_json::Value;
use std::io::{Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

/// A running board; it ends with this value.
pub struct Terminal {
    process: Option<Process>,
    port: String,
    news: Arc<Mutex<Vec<Value>>>,
    threads: Vec<JoinHandle<()>>,
    _folder: tempfile::TempDir,
}

impl Terminal {
    /// Powers a board with a pendulum.
    pub fn start(chip: &Chip, scenario: Scenario) -> Result<Self, String> {
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let socket = folder.path().join("pendulum");
        let listener = UnixListener::bind(&socket).map_err(|error| error.to_string())?;
        let input = if scenario.edges_per_turn.is_some() { "--encoder" } else { "--wiper" };
        let pendulum = std::thread::spawn(move || {
            if let Ok((line, _)) = listener.accept() {
                let _ = swing(line, Plant::new(scenario));
            }
        });
        let mut process = Process::start(chip, &["--terminal", input, &socket.to_string_lossy()])?;
        let port = loop {
            if let Some(port) = process.hear()?["terminal"].as_str() {
                break port.to_owned();
            }
        };
        let news = Arc::new(Mutex::new(Vec::new()));
        let (kept, lines) = (Arc::clone(&news), std::mem::replace(&mut process.lines, std::sync::mpsc::channel().1));
        let listener = std::thread::spawn(move || {
            for line in lines {
                kept.lock().map(|mut kept| kept.push(line)).unwrap_or(());
            }
        });
        Ok(Self { process: Some(process), port, news, threads: vec![pendulum, listener], _folder: folder })
    }

    /// For `--port`.
    pub fn port(&self) -> &str {
        &self.port
    }

    /// Tells the emulator to do something; see `tests/emulator/control.py`.
    pub fn say(&mut self, command: &Value) -> Result<(), String> {
        self.process.as_mut().map_or(Ok(()), |process| process.say(command))
    }

    /// What happened so far: resets, erases, failures.
    pub fn events(&self) -> Vec<Value> {
        self.news.lock().map(|news| news.clone()).unwrap_or_default()
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        drop(self.process.take());
        self.threads.drain(..).for_each(|thread| thread.join().unwrap_or(()));
    }
}

/// A byte says how many codes are wanted.
fn swing(mut line: UnixStream, mut plant: Plant) -> std::io::Result<()> {
    let mut wanted = [0];
    loop {
        line.read_exact(&mut wanted)?;
        let bytes: Vec<u8> = (0..wanted[0]).flat_map(|_| plant.next_code().0.to_le_bytes()).collect();
        line.write_all(&bytes)?;
    }
}
