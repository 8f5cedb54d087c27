//! A conversation with one rig.

use super::hello::{Heard, OWN_NAME, is_of_rig, version};
use super::previous::state_folder;
use super::recent::Recent;
use super::{LinkError, Port, Tally, patient};
use shared::curve::Knot;
use shared::wire::{self, Answer, Command, Deframer, Frame, Hello, MAX_FRAME, Refusal, Stream};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A rig that has just started needs a moment; after so long it is none.
const HELLO_PATIENCE: Duration = Duration::from_secs(4);

/// The greeting is repeated this often.
const HELLO_EVERY: Duration = Duration::from_millis(500);

/// Commands may be repeated: none of them does harm when carried out twice.
const N_ATTEMPTS: u32 = 6;

/// How long an answer may take before it is asked for again; a late one still counts.
const ANSWER_PATIENCE: Duration = Duration::from_millis(500);

/// Erasing a flash sector stops the rig for up to a second or two. Flash wears: it is asked again only when the
/// command or its answer is known to be lost, or after so long.
const FLASH_PATIENCE: Duration = Duration::from_secs(15);
const FLASH_ANSWER_PATIENCE: Duration = Duration::from_secs(5);

/// Firmware from before a question never answers it.
const N_ATTEMPTS_IF_NEW: u32 = 2;

/// Of a rig that does not say which effects it knows (docs/protocol.md).
const UNTOLD_CATALOGUE: u32 = 0;

/// A rig that was greeted and understood.
pub struct Session {
    port: Box<dyn Port>,
    deframer: Deframer,
    unread: VecDeque<u8>,
    /// Stream frames, and greetings, that came while an answer was awaited.
    waiting: VecDeque<Frame>,
    tally: Tally,
    recent: Recent,
    rig: Hello,
    next_number: u16,
    streaming: bool,
    /// Where what rigs had before is kept, if anywhere.
    pub(super) state: Option<PathBuf>,
}

impl Session {
    /// Greets whoever is behind the port until it answers.
    ///
    /// # Errors
    /// Nothing, a stranger or another protocol there (told within seconds), or the port is gone.
    pub fn open(port: Box<dyn Port>) -> Result<Self, LinkError> {
        let mut session = Self {
            port,
            deframer: Deframer::new(),
            unread: VecDeque::new(),
            waiting: VecDeque::new(),
            tally: Tally::default(),
            recent: Recent::default(),
            rig: Hello::new(OWN_NAME),
            next_number: 1,
            streaming: false,
            state: state_folder(),
        };
        // A lone delimiter ends whatever an earlier program left unfinished.
        session.write(&[0])?;
        session.greet()?;
        session.tally = Tally::default();
        Ok(session)
    }

    /// From now on what the rig had before is kept in this folder, or nowhere.
    #[must_use]
    pub fn keeping_in(mut self, folder: Option<&Path>) -> Self {
        self.state = folder.map(Path::to_owned);
        self
    }

    fn greet(&mut self) -> Result<(), LinkError> {
        let own = Frame::Hello(Hello::new(OWN_NAME));
        let mut heard = Heard::default();
        let give_up = self.port.elapsed() + patient(HELLO_PATIENCE);
        while self.port.elapsed() < give_up {
            self.send(&own)?;
            let again = self.port.elapsed() + HELLO_EVERY;
            while let Some(frame) = self.next_frame(again, Some(&mut heard))? {
                let Frame::Hello(hello) = frame else { continue };
                match heard.judge(self.port.name(), &hello) {
                    None => {}
                    Some(Err(error)) => return Err(error),
                    Some(Ok(())) => {
                        self.rig = hello;
                        return Ok(());
                    }
                }
            }
        }
        Err(heard.verdict(self.port.name(), patient(HELLO_PATIENCE).as_secs()))
    }

    /// The port's name.
    pub fn port(&self) -> &str {
        self.port.name()
    }

    /// Who answered.
    pub fn rig(&self) -> &Hello {
        &self.rig
    }

    /// Name and firmware version, as people write them.
    pub fn firmware(&self) -> String {
        format!("{} {}", self.rig.name, version(&self.rig))
    }

    /// The version of its firmware, such as `0.1.0`.
    pub fn version(&self) -> String {
        version(&self.rig)
    }

    /// Does the rig say which effects it knows?
    pub fn tells_its_effects(&self) -> bool {
        self.rig.catalogue != UNTOLD_CATALOGUE
    }

    /// Do rig and program know the same effects, as far as the rig tells?
    pub fn knows_the_same_effects(&self) -> bool {
        !self.tells_its_effects() || self.rig.catalogue == wire::catalogue_hash()
    }

    /// Time since the port was opened, by its own clock.
    pub fn elapsed(&self) -> Duration {
        self.port.elapsed()
    }

    /// What the present stream lost.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Asks for something and waits for the answer, asking again if none comes.
    ///
    /// # Errors
    /// No answer, a refusal, or the port is gone.
    pub fn ask(&mut self, command: &Command) -> Result<Answer, LinkError> {
        let number = self.new_number();
        let frame = Frame::Command(number, command.clone());
        log::debug!("asking the rig to {}", words(command));
        let is_slow = matches!(command, Command::Save | Command::Load);
        let is_new = matches!(command, Command::Chip | Command::Suspects);
        let n_attempts = if is_new { N_ATTEMPTS_IF_NEW } else { N_ATTEMPTS };
        let give_up =
            self.port.elapsed() + patient(if is_slow { FLASH_PATIENCE } else { n_attempts * ANSWER_PATIENCE });
        let mut n_times = 0;
        while self.port.elapsed() < give_up {
            if n_times > 0 {
                // Ends what the link may have left of the one before, or this one would be lost with it.
                self.write(&[0])?;
            }
            n_times += 1;
            self.send(&frame)?;
            let answer = if is_slow { self.slow_answer(number)? } else { self.quick_answer(number)? };
            match answer {
                None => log::debug!("no answer"),
                Some(Answer::Refused(refusal)) => {
                    return Err(LinkError::Refused { command: words(command), refusal });
                }
                Some(answer) => return Ok(answer),
            }
        }
        let port = self.port.name().to_owned();
        Err(LinkError::NoAnswer { port, command: words(command), n_times })
    }

    /// Tells the rig to do something that has no answer but "done".
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn tell(&mut self, command: &Command) -> Result<(), LinkError> {
        match self.ask(command)? {
            Answer::Done => Ok(()),
            _ => Err(LinkError::WrongAnswer { command: words(command) }),
        }
    }

    /// Sends the law of a custom effect, or nothing to ask for it; gives the one that the rig then holds.
    ///
    /// # Errors
    /// As [`Session::ask`]; firmware without formulas refuses.
    pub fn exchange_formula(&mut self, bytes: &[u8]) -> Result<Vec<u8>, LinkError> {
        let frame = Frame::CustomFormula(bytes.iter().copied().collect());
        let held = self.exchange(&frame, "exchange a custom formula", |frame| match frame {
            Frame::CustomFormula(held) => Some(held.to_vec()),
            _ => None,
        });
        match held {
            Err(LinkError::Refused { refusal: Refusal::NotHere, .. }) => Err(LinkError::NoFormulas),
            held => held,
        }
    }

    /// Sends the knots of a friction curve, or nothing to ask for them; gives those that the rig then holds.
    ///
    /// # Errors
    /// As [`Session::ask`]; firmware without curves does not answer.
    pub fn exchange_curve(&mut self, knots: &[Knot]) -> Result<Vec<Knot>, LinkError> {
        let frame = Frame::FrictionCurve(knots.iter().copied().collect());
        let held = self.exchange(&frame, "exchange a friction curve", |frame| match frame {
            Frame::FrictionCurve(held) => Some(held.to_vec()),
            _ => None,
        });
        match held {
            Err(LinkError::NoAnswer { .. } | LinkError::Refused { refusal: Refusal::NotHere, .. }) => {
                Err(LinkError::NoCurves)
            }
            held => held,
        }
    }

    /// Sends a law, or a question for it, and waits for the one that the rig then holds.
    fn exchange<T>(
        &mut self,
        law: &Frame,
        command: &'static str,
        held: impl Fn(&Frame) -> Option<T>,
    ) -> Result<T, LinkError> {
        let give_up = self.port.elapsed() + patient(N_ATTEMPTS * ANSWER_PATIENCE);
        let mut n_times = 0;
        while self.port.elapsed() < give_up {
            if n_times > 0 {
                // Ends what the link may have left of the one before.
                self.write(&[0])?;
            }
            n_times += 1;
            self.send(law)?;
            let deadline = self.port.elapsed() + ANSWER_PATIENCE;
            while let Some(frame) = self.next_frame(deadline, None)? {
                if let Some(held) = held(&frame) {
                    return Ok(held);
                }
                match frame {
                    Frame::Answer(0, Answer::Refused(refusal)) => return Err(LinkError::Refused { command, refusal }),
                    frame => self.put_by(frame),
                }
            }
        }
        Err(LinkError::NoAnswer { port: self.port.name().to_owned(), command, n_times })
    }

    /// Starts a stream.
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn start(&mut self, stream: Stream) -> Result<(), LinkError> {
        self.tally = Tally::default();
        self.recent = Recent::default();
        self.waiting.clear();
        self.streaming = true;
        self.tell(&Command::Start(stream))?;
        // A rig answers in order: greetings until now were asked for when the session was opened.
        self.waiting.retain(|frame| !matches!(frame, Frame::Hello(_)));
        Ok(())
    }

    /// Ends the stream; what is still on its way is dropped.
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn stop(&mut self) -> Result<(), LinkError> {
        self.tell(&Command::Stop)?;
        self.streaming = false;
        self.waiting.clear();
        Ok(())
    }

    /// The next frame of the stream; `None` if none came in time.
    ///
    /// # Errors
    /// The port is gone, or the rig greets: it was started anew, and its stream with it.
    pub fn receive(&mut self, timeout: Duration) -> Result<Option<Frame>, LinkError> {
        let deadline = self.port.elapsed() + timeout;
        while let Some(frame) = self.next_of_stream(deadline)? {
            match frame {
                Frame::Samples(_) | Frame::Live(_) => return Ok(Some(frame)),
                Frame::Hello(hello) if self.streaming && is_of_rig(&hello) => {
                    return Err(LinkError::Restarted { port: self.port.name().to_owned() });
                }
                _ => {}
            }
        }
        Ok(None)
    }

    fn next_of_stream(&mut self, deadline: Duration) -> Result<Option<Frame>, LinkError> {
        match self.waiting.pop_front() {
            Some(frame) => Ok(Some(frame)),
            None => self.next_frame(deadline, None),
        }
    }

    /// Keeps what belongs to the stream until somebody asks for it.
    fn put_by(&mut self, frame: Frame) {
        if self.streaming && matches!(frame, Frame::Samples(_) | Frame::Live(_) | Frame::Hello(_)) {
            self.waiting.push_back(frame);
        }
    }

    fn new_number(&mut self) -> u16 {
        let number = self.next_number;
        self.next_number = self.next_number.wrapping_add(1);
        number
    }

    fn quick_answer(&mut self, number: u16) -> Result<Option<Answer>, LinkError> {
        Ok(self.answer(&[number], ANSWER_PATIENCE)?.map(|(_, answer)| answer))
    }

    /// The answer to a command that may take seconds. Now and then the rig is asked for something quick: it answers in
    /// order, so if that answer comes first, the command or its own answer was lost.
    fn slow_answer(&mut self, number: u16) -> Result<Option<Answer>, LinkError> {
        let give_up = self.port.elapsed() + patient(FLASH_ANSWER_PATIENCE);
        let probe = self.new_number();
        while self.port.elapsed() < give_up {
            match self.answer(&[number, probe], ANSWER_PATIENCE)? {
                Some((of, answer)) => return Ok((of == number).then_some(answer)),
                None => {
                    self.write(&[0])?;
                    self.send(&Frame::Command(probe, Command::GetSettings))?;
                }
            }
        }
        Ok(None)
    }

    /// The first answer to one of these commands, with the command's number.
    fn answer(&mut self, numbers: &[u16], patience: Duration) -> Result<Option<(u16, Answer)>, LinkError> {
        let deadline = self.port.elapsed() + patience;
        while let Some(frame) = self.next_frame(deadline, None)? {
            match frame {
                Frame::Answer(of, answer) if numbers.contains(&of) => return Ok(Some((of, answer))),
                frame => self.put_by(frame),
            }
        }
        Ok(None)
    }

    /// The next good frame, counted; damaged ones are counted and passed over.
    fn next_frame(&mut self, deadline: Duration, mut heard: Option<&mut Heard>) -> Result<Option<Frame>, LinkError> {
        loop {
            while let Some(byte) = self.unread.pop_front() {
                match self.deframer.push(byte) {
                    None => {}
                    Some(Err(error)) => {
                        log::debug!("passing over a damaged frame: {error:?}");
                        self.tally.frames_damaged += 1;
                    }
                    Some(Ok(frame)) if self.recent.is_repeated(&frame) => {
                        log::debug!("passing over a frame that came once more");
                        self.tally.frames_repeated += 1;
                    }
                    Some(Ok(frame)) => {
                        log::trace!("heard {frame:?}");
                        self.tally.count(&frame);
                        return Ok(Some(frame));
                    }
                }
            }
            let left = deadline.saturating_sub(self.port.elapsed());
            if left.is_zero() {
                return Ok(None);
            }
            let mut buffer = [0; 4096];
            let n_bytes = self.port.read(&mut buffer, left).map_err(|source| self.lost(source))?;
            self.unread.extend(&buffer[..n_bytes]);
            if let Some(heard) = heard.as_deref_mut() {
                heard.take(&buffer[..n_bytes]);
            }
        }
    }

    fn send(&mut self, frame: &Frame) -> Result<(), LinkError> {
        let mut buffer = [0; MAX_FRAME];
        let bytes = wire::encode(frame, &mut buffer).expect("every frame fits the longest");
        self.write(bytes)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.port.write(bytes).map_err(|source| self.lost(source))
    }

    fn lost(&self, source: std::io::Error) -> LinkError {
        LinkError::Lost { port: self.port.name().to_owned(), source }
    }
}

/// A rig that nobody listens to should be quiet.
impl Drop for Session {
    fn drop(&mut self) {
        if self.streaming {
            let number = self.next_number;
            let _ = self.send(&Frame::Command(number, Command::Stop));
        }
    }
}

/// The command in the words of "the rig refused to …".
fn words(command: &Command) -> &'static str {
    match command {
        Command::Start(_) => "start sending",
        Command::Stop => "stop sending",
        Command::GetParameters => "give its parameters",
        Command::SetParameters(_) => "use these parameters",
        Command::Save => "save to flash",
        Command::Load => "load from flash",
        Command::Defaults => "use its defaults",
        Command::GetSettings => "give its settings",
        Command::SetSettings(_) => "use these settings",
        Command::ZeroHere => "set its zero",
        Command::CalibrateGain(_) => "calibrate its gain",
        Command::Statistics => "give its statistics",
        Command::Reset => "restart",
        Command::Bootloader => "start its bootloader",
        Command::Chip => "describe its chip",
        Command::Suspects => "say what it found missing",
    }
}
