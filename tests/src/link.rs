//! The PC's side of the wire, for tests that talk to a board themselves.

use crate::HANG;
use shared::wire::{Answer, Command, Deframer, Frame, Hello, MAX_FRAME, Statistics, encode};
use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};

/// A hello is repeated after this time: the board may be starting. So are other questions while it restarts.
const AGAIN: Duration = Duration::from_millis(500);

/// What [`Link::receive`] waits for.
const SOON: Duration = Duration::from_millis(50);

/// An open port.
pub struct Link {
    port: Box<dyn serialport::SerialPort>,
    deframer: Deframer,
    unread: VecDeque<u8>,
    number: u16,
    /// Samples and live points that came in between.
    pub frames: Vec<Frame>,
    /// Bytes that were no frame.
    pub n_bad: usize,
}

impl Link {
    /// Opens a port and says nothing yet.
    pub fn open(port: &str) -> Result<Self, String> {
        let port = serialport::new(port, 921_600)
            .timeout(Duration::from_millis(20))
            .open()
            .map_err(|error| format!("could not open {port}: {error}"))?;
        Ok(Self { port, deframer: Deframer::new(), unread: VecDeque::new(), number: 0, frames: Vec::new(), n_bad: 0 })
    }

    /// Opens a session: hello, repeated until it is answered.
    pub fn hello(&mut self) -> Result<Hello, String> {
        self.hello_as(Hello::new("test"))
    }

    /// Opens a session as somebody else.
    pub fn hello_as(&mut self, hello: Hello) -> Result<Hello, String> {
        let started = Instant::now();
        while started.elapsed() < HANG {
            self.send_bytes(&[0])?;
            self.send(&Frame::Hello(hello.clone()))?;
            let asked = Instant::now();
            while asked.elapsed() < AGAIN {
                if let Some(Frame::Hello(hello)) = self.receive()? {
                    return Ok(hello);
                }
            }
        }
        Err("no answer to hello".into())
    }

    /// Sends bytes as they are.
    pub fn send_bytes(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.port.write_all(bytes).map_err(|error| format!("could not write: {error}"))
    }

    /// Sends a frame.
    pub fn send(&mut self, frame: &Frame) -> Result<(), String> {
        let mut buffer = [0; MAX_FRAME];
        let bytes = encode(frame, &mut buffer).map_err(|error| error.to_string())?.to_vec();
        self.send_bytes(&bytes)
    }

    /// Asks and waits for the answer; what streams in between is kept in `frames`.
    pub fn ask(&mut self, command: Command) -> Result<Answer, String> {
        self.number = self.number.wrapping_add(1);
        let what = format!("{command:?}");
        self.send(&Frame::Command(self.number, command))?;
        let asked = Instant::now();
        while asked.elapsed() < HANG {
            match self.receive()? {
                Some(Frame::Answer(number, answer)) if number == self.number => return Ok(answer),
                Some(frame @ (Frame::Samples(_) | Frame::Live(_))) => self.frames.push(frame),
                _ => {}
            }
        }
        Err(format!("no answer to {what}"))
    }

    /// The counters.
    pub fn statistics(&mut self) -> Result<Statistics, String> {
        match self.ask(Command::Statistics)? {
            Answer::Statistics(statistics) => Ok(statistics),
            other => Err(format!("asked for statistics, got {other:?}")),
        }
    }

    /// Greets the rig again once it has restarted, so many times since power-up.
    pub fn hello_after_restart(&mut self, resets: u16) -> Result<Statistics, String> {
        let started = Instant::now();
        while started.elapsed() < HANG {
            // Whoever answers may be about to restart.
            self.hello()?;
            self.number = self.number.wrapping_add(1);
            self.send(&Frame::Command(self.number, Command::Statistics))?;
            let asked = Instant::now();
            while asked.elapsed() < AGAIN {
                match self.receive()? {
                    Some(Frame::Answer(number, Answer::Statistics(statistics)))
                        if number == self.number && statistics.health.resets >= resets =>
                    {
                        return Ok(statistics);
                    }
                    _ => {}
                }
            }
        }
        Err(format!("no {resets}. restart"))
    }

    /// Collects streamed frames until `enough` says so.
    pub fn collect(&mut self, mut enough: impl FnMut(&[Frame]) -> bool) -> Result<(), String> {
        let started = Instant::now();
        while !enough(&self.frames) {
            if started.elapsed() > HANG {
                return Err(format!("only {} frames within {HANG:?}", self.frames.len()));
            }
            if let Some(frame @ (Frame::Samples(_) | Frame::Live(_))) = self.receive()? {
                self.frames.push(frame);
            }
        }
        Ok(())
    }

    /// The next frame, if one comes soon.
    pub fn receive(&mut self) -> Result<Option<Frame>, String> {
        let started = Instant::now();
        while started.elapsed() < SOON {
            while let Some(byte) = self.unread.pop_front() {
                match self.deframer.push(byte) {
                    Some(Ok(frame)) => return Ok(Some(frame)),
                    Some(Err(_)) => self.n_bad += 1,
                    None => {}
                }
            }
            let mut bytes = [0; 1024];
            match self.port.read(&mut bytes) {
                Ok(n_bytes) => self.unread.extend(&bytes[..n_bytes]),
                Err(error) if error.kind() == ErrorKind::TimedOut => {}
                Err(error) => return Err(format!("could not read: {error}")),
            }
        }
        Ok(None)
    }
}
