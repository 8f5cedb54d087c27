//! After a fault of the link, however it came, samples flow and commands are answered within a second.

use host::link::{Port, Session};
use host::sim::{Scenario, SimulatedRig};
use shared::wire::{self, Command, Frame, MAX_FRAME, Samples, Stream};
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::io;
use std::rc::Rc;
use std::time::Duration;
use tests::chance::Chance;

/// Simulated seconds.
const WITHIN_S: f64 = 1.0;

const N_RUNS: u64 = 300;

/// The rig goes on when its cable is pulled.
type Rig = Rc<RefCell<SimulatedRig>>;

fn rig(seed: u64) -> Rig {
    Rc::new(RefCell::new(SimulatedRig::new(Scenario::by_name("plain").unwrap(), seed)))
}

/// What happens to bytes towards the PC while the fault lasts.
#[derive(Clone, Copy, Debug)]
enum Fault {
    Lost,
    Delayed,
    Garbled,
    BuriedInNoise,
}

impl Fault {
    const ALL: [Self; 4] = [Self::Lost, Self::Delayed, Self::Garbled, Self::BuriedInNoise];
}

/// A cable with a fault until some moment.
struct Cable {
    rig: Rig,
    fault: Fault,
    until_s: Rc<Cell<f64>>,
    /// It is pulled at this moment.
    pulled_s: f64,
    /// Longest piece that one read gives.
    piece: usize,
    chance: Chance,
    delayed: VecDeque<u8>,
    arriving: VecDeque<u8>,
}

impl Cable {
    fn new(rig: &Rig) -> Self {
        let never = f64::INFINITY;
        Self {
            rig: Rc::clone(rig),
            fault: Fault::Lost,
            until_s: Rc::default(),
            pulled_s: never,
            piece: 4096,
            chance: Chance::new(1),
            delayed: VecDeque::new(),
            arriving: VecDeque::new(),
        }
    }

    fn now_s(&self) -> f64 {
        self.rig.borrow().elapsed_s()
    }

    fn is_bad(&self) -> bool {
        self.now_s() < self.until_s.get()
    }

    fn carry(&mut self) {
        let bytes: Vec<u8> = self.rig.borrow_mut().output().drain(..).collect();
        if !self.is_bad() {
            self.arriving.append(&mut self.delayed);
            self.arriving.extend(bytes);
            return;
        }
        let mut noise = || self.chance.within(0.0..256.0) as u8;
        match self.fault {
            Fault::Lost => {}
            Fault::Delayed => self.delayed.extend(bytes),
            Fault::Garbled => self.arriving.extend(bytes.iter().map(|byte| byte ^ noise())),
            Fault::BuriedInNoise => self.arriving.extend(bytes.iter().flat_map(|byte| [noise(), *byte, noise()])),
        }
    }
}

impl Port for Cable {
    fn name(&self) -> &str {
        "cable"
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let until_s = self.now_s() + timeout.as_secs_f64();
        self.carry();
        while self.arriving.is_empty() && self.now_s() < until_s {
            self.rig.borrow_mut().sample();
            self.carry();
        }
        if self.now_s() > self.pulled_s {
            return Err(io::Error::other("unplugged"));
        }
        let n_bytes = self.arriving.len().min(buffer.len()).min(self.piece);
        self.arriving.drain(..n_bytes).zip(buffer).for_each(|(byte, slot)| *slot = byte);
        Ok(n_bytes)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let n_arriving = if self.is_bad() { self.chance.within(0.0..bytes.len() as f64) as usize } else { bytes.len() };
        self.rig.borrow_mut().receive(&bytes[..n_arriving]);
        Ok(())
    }

    fn elapsed(&self) -> Duration {
        Duration::from_secs_f64(self.now_s())
    }
}

/// The next samples of a stream.
fn next_samples(session: &mut Session) -> Samples {
    loop {
        match session.receive(Duration::from_secs(10)).unwrap() {
            Some(Frame::Samples(samples)) => return samples,
            Some(_) => {}
            None => panic!("nothing came for ten seconds"),
        }
    }
}

/// A session on a cable that is bad from now on, until a moment.
fn streaming(seed: u64) -> (Session, f64) {
    let rig = rig(seed);
    let mut chance = Chance::new(seed);
    let fault = Fault::ALL[seed as usize % Fault::ALL.len()];
    let (good_s, bad_s) = (chance.within(0.1..0.2), chance.within(0.0..2.0));
    let until_s = Rc::default();
    let cable = Cable { fault, until_s: Rc::clone(&until_s), chance, ..Cable::new(&rig) };
    let mut session = Session::open(Box::new(cable)).unwrap();
    session.start(Stream { raw: true, live_every: 10 }).unwrap();
    let began_s = session.elapsed().as_secs_f64();
    while session.elapsed().as_secs_f64() < began_s + good_s {
        next_samples(&mut session);
    }
    until_s.set(session.elapsed().as_secs_f64() + bad_s);
    (session, until_s.get())
}

#[test]
fn samples_flow_within_a_second_after_any_fault() {
    let mut worst_s = 0.0_f64;
    for seed in 0..N_RUNS {
        let (mut session, until_s) = streaming(seed);
        while session.elapsed().as_secs_f64() <= until_s {
            next_samples(&mut session);
        }
        // From here on nothing may be missing.
        let mut next = next_samples(&mut session).first_sample;
        let took_s = session.elapsed().as_secs_f64() - until_s;
        assert!(took_s < WITHIN_S, "seed {seed}: {took_s} s");
        worst_s = worst_s.max(took_s);
        for _ in 0..20 {
            let samples = next_samples(&mut session);
            assert_eq!(samples.first_sample, next + 16, "seed {seed}");
            next = samples.first_sample;
        }
    }
    println!("{N_RUNS} faults, samples again after {:.0} ms at most", 1e3 * worst_s);
}

#[test]
fn a_command_is_answered_within_a_second_after_any_fault() {
    let mut worst_s = 0.0_f64;
    for seed in 0..N_RUNS {
        for command in [Command::Statistics, Command::Save] {
            let (mut session, until_s) = streaming(seed);
            session.ask(&command).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
            let took_s = session.elapsed().as_secs_f64() - until_s;
            assert!(took_s < WITHIN_S, "seed {seed}: {command:?} took {took_s} s");
            worst_s = worst_s.max(took_s);
        }
    }
    println!("{N_RUNS} faults, an answer after {:.0} ms at most", 1e3 * worst_s);
}

#[test]
fn a_new_session_streams_within_a_second_after_the_cable_was_pulled_or_the_rig_restarted() {
    for seed in 0..N_RUNS {
        let rig = rig(seed);
        let mut chance = Chance::new(seed);
        let pulled_s = chance.within(0.1..2.0);
        let cable = Cable { pulled_s, piece: 1 + chance.within(0.0..60.0) as usize, ..Cable::new(&rig) };
        let mut session = Session::open(Box::new(cable)).unwrap();
        session.start(Stream { raw: true, live_every: 4 }).unwrap();
        while session.receive(Duration::from_secs(1)).is_ok() {}
        drop(session);
        // What the program was saying when the cable went.
        let mut buffer = [0; MAX_FRAME];
        let command = if seed.is_multiple_of(2) { Command::Reset } else { Command::GetParameters };
        let said = wire::encode(&Frame::Command(7, command), &mut buffer).unwrap();
        let n_said = if seed.is_multiple_of(3) { said.len() } else { chance.within(0.0..said.len() as f64) as usize };
        rig.borrow_mut().receive(&said[..n_said]);

        let plugged_s = rig.borrow().elapsed_s();
        let mut session = Session::open(Box::new(Cable::new(&rig))).unwrap();
        session.start(Stream { raw: true, live_every: 0 }).unwrap();
        next_samples(&mut session);
        let took_s = session.elapsed().as_secs_f64() - plugged_s;
        assert!(took_s < WITHIN_S, "seed {seed}: {took_s} s");
        assert_eq!(session.tally().samples_lost, 0, "seed {seed}");
    }
}

#[test]
fn frames_are_understood_however_they_are_split() {
    let frames = |piece: usize| {
        let mut session = Session::open(Box::new(Cable { piece, ..Cable::new(&rig(1)) })).unwrap();
        session.start(Stream { raw: true, live_every: 10 }).unwrap();
        let frames: Vec<Frame> =
            (0..20).map(|_| session.receive(Duration::from_secs(1)).unwrap().expect("a frame")).collect();
        assert_eq!((session.tally().frames_lost, session.tally().frames_damaged), (0, 0), "pieces of {piece}");
        frames
    };
    let whole = frames(4096);
    for piece in 1..=MAX_FRAME {
        assert_eq!(frames(piece), whole, "pieces of {piece}");
    }
}
