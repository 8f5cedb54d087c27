//! Conversations with the firmware in virtual time.

use super::Emulated;
use shared::wire::{Answer, Command, Frame, Hello, MAX_FRAME, Statistics, Stream, encode};

/// An answer that takes longer than this does not come, s.
const PATIENCE_S: f64 = 12.0;

/// Time passes in such slices until an answer is there, s.
const SLICE_S: f64 = 5e-3;

/// A hello is repeated after this time: the board may be starting.
const AGAIN_S: f64 = 0.5;

impl Emulated {
    /// Waits until something has come.
    fn wait<T>(&mut self, limit_s: f64, mut found: impl FnMut(&Frame) -> Option<T>) -> Option<T> {
        let end_s = self.now_s + limit_s;
        let mut n_seen = self.frames.len();
        while self.now_s < end_s {
            self.run(SLICE_S);
            while n_seen < self.frames.len() {
                if let Some(answer) = found(&self.frames[n_seen]) {
                    self.frames.remove(n_seen);
                    self.times_s.remove(n_seen);
                    return Some(answer);
                }
                n_seen += 1;
            }
        }
        None
    }

    /// Sends a frame; time stands still.
    #[track_caller]
    pub fn send(&mut self, frame: &Frame) {
        let mut buffer = [0; MAX_FRAME];
        let bytes = encode(frame, &mut buffer).expect("a frame of ours fits").to_vec();
        self.run_and_send(0.0, &bytes);
    }

    /// Opens a session, once the board has started; gives what it says of itself.
    #[track_caller]
    pub fn hello(&mut self) -> Hello {
        self.hello_within(PATIENCE_S).unwrap_or_else(|| panic!("no answer to hello; {:?}", self.last_events()))
    }

    /// Opens a session if the board answers in time.
    pub fn hello_within(&mut self, limit_s: f64) -> Option<Hello> {
        let end_s = self.now_s + limit_s;
        while self.now_s < end_s {
            self.run_and_send(0.0, &[0]);
            self.send(&Frame::Hello(Hello::new("test")));
            let answer = self.wait(AGAIN_S.min(limit_s), |frame| match frame {
                Frame::Hello(hello) => Some(hello.clone()),
                _ => None,
            });
            if answer.is_some() {
                return answer;
            }
        }
        None
    }

    /// Asks, and waits for the answer; gives it and how long it took in s.
    #[track_caller]
    pub fn ask_timed(&mut self, command: Command) -> (Answer, f64) {
        let what = format!("{command:?}");
        self.number = self.number.wrapping_add(1);
        let (asked, began_s) = (self.number, self.now_s);
        self.send(&Frame::Command(asked, command));
        let answer = self.wait(PATIENCE_S, |frame| match frame {
            Frame::Answer(number, answer) if *number == asked => Some(answer.clone()),
            _ => None,
        });
        let answer = answer.unwrap_or_else(|| panic!("no answer to {what}; {:?}", self.last_events()));
        (answer, self.now_s - began_s)
    }

    /// Asks, and waits for the answer.
    #[track_caller]
    pub fn ask(&mut self, command: Command) -> Answer {
        self.ask_timed(command).0
    }

    /// Asks for something that has to be done.
    #[track_caller]
    pub fn order(&mut self, command: Command) {
        let what = format!("{command:?}");
        assert_eq!(self.ask(command), Answer::Done, "{what}");
    }

    /// The counters.
    #[track_caller]
    pub fn statistics(&mut self) -> Statistics {
        match self.ask(Command::Statistics) {
            Answer::Statistics(statistics) => statistics,
            other => panic!("asked for statistics, got {other:?}"),
        }
    }

    /// Every sample from now on, and a live point every so many.
    #[track_caller]
    pub fn stream(&mut self, live_every: u16) {
        self.order(Command::Start(Stream { raw: true, live_every }));
        self.forget();
    }

    /// Forgets what has come.
    pub fn forget(&mut self) {
        self.frames.clear();
        self.times_s.clear();
    }
}
