//! The application: three loops around one [`Rig`], joined in one task.
//!
//! Samples flow board → rig → queue, frames flow queue → link, and commands link → rig. Only the sending loop ever
//! waits for the link, so a slow or absent PC never holds up sampling.

use crate::frame_queue::{Encoded, FrameQueue};
use crate::ports::{Batch, Board, FULL_SCALE, Sampler, System};
use crate::store::{Pause, Store};
use core::cell::{Cell, RefCell};
use core::marker::PhantomData;
use embassy_futures::join::join3;
use embassy_futures::select::{Either, select};
use embassy_futures::yield_now;
use embedded_io_async::{Read, Write};
use embedded_storage_async::nor_flash::NorFlash;
use shared::bank::keeper::Keeper;
use shared::bank::order::Order;
use shared::rig::{Finished, Outcome, Request, Rig, Stored};
use shared::sensor::Sensor;
use shared::wire::{Answer, Chip, Command, Cycles, Deframer, Frame, Health, Refusal, StoreState, Stream};

/// A restart waits at most this long for its answer to leave …
const FAREWELL_MS: u32 = 200;

/// … and then this long for the last bytes to pass the link's own buffers.
const LAST_BYTES_MS: u32 = 50;

/// After an erase samples come again within so long, even at 50 Hz; then the watchdog has been fed, too.
const AFTER_ERASE_MS: u32 = 50;

/// The light blinks so often while something is named, Hz.
const BLINKS_HZ: f32 = 2.0;

/// Sampling goes on between two erases.
struct Sampling<Y>(PhantomData<Y>);

impl<Y: System> Pause for Sampling<Y> {
    async fn pause() {
        Y::pause(AFTER_ERASE_MS).await;
    }
}

/// What a board's sampler can do.
#[derive(Clone, Copy)]
struct Input {
    nearest_rate: fn(f32) -> f32,
    can_read: fn(&Sensor) -> bool,
}

impl Input {
    fn of<S: Sampler>() -> Self {
        Self { nearest_rate: S::nearest_rate, can_read: S::can_read }
    }

    /// Gives what was stored, which may be another board's, the rate that this board makes of it. False if it has no
    /// input for its sensor.
    fn takes(self, stored: &mut Stored) -> bool {
        stored.settings = stored.settings.at_rate((self.nearest_rate)(stored.settings.rate_hz));
        (self.can_read)(&stored.settings.sensor)
    }
}

/// What the loops share. They run in one task, so no borrow is ever held while another loop runs.
struct Shared<Y> {
    rig: RefCell<Rig>,
    system: RefCell<Y>,
    queue: FrameQueue,
    most_points_per_s: f32,
    input: Input,
    /// Sensor and rate that the sampler has not been told yet.
    new_sampling: Cell<Option<(Sensor, f32)>>,
    /// The flash is being written, or was since the last samples: what is missing now was announced.
    saving: Cell<bool>,
    saved: Cell<bool>,
    stages: RefCell<Stages>,
    keeper: RefCell<Keeper>,
    /// [`Rig::n_models`] of the model that was looked at last.
    n_models: Cell<u32>,
    /// Somebody records, and looks wait.
    is_recorded: Cell<bool>,
    /// Samples since the light was last switched.
    unswitched: Cell<u32>,
    is_lit: Cell<bool>,
}

/// What the stages of the work took.
#[derive(Clone, Copy, Default)]
struct Stages {
    sample: Cycles,
    observer: Cycles,
    frame: Cycles,
    save: Cycles,
}

/// Runs the rig on a board, for ever.
pub async fn run<S: Sampler, R: Read, W: Write, F: NorFlash, Y: System>(board: Board<S, R, W, F, Y>) -> ! {
    let mut store = Store::pausing(board.flash, board.store);
    let mut system = board.system;
    let loaded = load(&mut store, &mut system).await;
    let rig = start(board.name, board.most_points_per_s, Input::of::<S>(), loaded, system);
    join3(rig.sample(board.sampler), rig.send(board.sender), rig.listen(board.receiver, store)).await.0
}

/// Never inlined: what it builds on the stack would stay on that of the tasks, which is the deepest.
#[inline(never)]
fn start<Y: System>(
    name: &str,
    most_points_per_s: f32,
    input: Input,
    mut loaded: Result<Stored, StoreState>,
    mut system: Y,
) -> Shared<Y> {
    if let Ok(stored) = &mut loaded
        && !input.takes(stored)
    {
        loaded = Err(StoreState::OtherVersion);
    }
    let mut rig = Rig::new(name, FULL_SCALE, loaded);
    let store_state = rig.health().store;
    *rig.health() = Health { store: store_state, ..system.since_power_up() };
    let settings = *rig.settings();
    Shared {
        new_sampling: Cell::new(Some((rig.settings().sensor, rig.settings().rate_hz))),
        keeper: RefCell::new(Keeper::new(settings.rate_hz, settings.sensor)),
        n_models: Cell::new(rig.n_models()),
        is_recorded: Cell::new(false),
        unswitched: Cell::new(0),
        is_lit: Cell::new(false),
        rig: RefCell::new(rig),
        system: RefCell::new(system),
        queue: FrameQueue::new(),
        most_points_per_s,
        input,
        saving: Cell::new(false),
        saved: Cell::new(false),
        stages: RefCell::new(Stages::default()),
    }
}

/// Reading damaged flash, and repairing what a power cut left, takes longer than the watchdog waits; there are no
/// samples yet that would feed it.
async fn load<F: NorFlash, Y: System>(store: &mut Store<F, Sampling<Y>>, system: &mut Y) -> Result<Stored, StoreState> {
    let feed = async {
        loop {
            system.feed_watchdog();
            yield_now().await;
        }
    };
    match select(store.load(), feed).await {
        Either::First(loaded) => loaded,
        Either::Second(never) => never,
    }
}

impl<Y: System> Shared<Y> {
    async fn sample(&self, mut sampler: impl Sampler) -> ! {
        loop {
            if let Some((sensor, rate_hz)) = self.new_sampling.take() {
                sampler.start(&sensor, rate_hz);
            }
            let batch = sampler.next().await;
            if self.new_sampling.get().is_some() {
                // It began before what is in use now, and would be taken for a measurement of that.
                continue;
            }
            self.take_batch(&batch);
            self.watch(&batch);
            yield_now().await;
        }
    }

    /// Keeps releases, orders a look when one has ended, and blinks while something is named. Never inlined, like what
    /// it calls: a task's stack holds all that is, however seldom it runs.
    #[inline(never)]
    fn watch(&self, batch: &Batch) {
        if self.has_ended(batch) {
            self.order_look();
        }
        self.blink(batch.codes.len() as u32);
    }

    fn has_ended(&self, batch: &Batch) -> bool {
        let (mut keeper, system) = (self.keeper.borrow_mut(), self.system.borrow());
        let tape = system.spare().tape();
        let mut has_ended = batch.lost > 0 && keeper.miss(tape);
        for code in &batch.codes {
            has_ended |= keeper.take(*code, tape);
        }
        has_ended
    }

    #[inline(never)]
    fn order_look(&self) {
        let (keeper, rig, system) = (self.keeper.borrow(), self.rig.borrow(), self.system.borrow());
        let releases = keeper.releases(system.spare().tape());
        if !releases.is_empty() {
            let (interval_s, radian_per_step) = (keeper.interval_s(), keeper.radian_per_step());
            system.spare().order(Order { parameters: rig.parameters().clone(), radian_per_step, interval_s, releases });
        }
    }

    /// A model that was changed is looked at anew; releases that were measured otherwise are forgotten.
    #[inline(never)]
    fn notice_changes(&self) {
        let (n_models, settings) = (self.rig.borrow().n_models(), *self.rig.borrow().settings());
        let is_measured_alike = self.keeper.borrow().is_for(settings.rate_hz, &settings.sensor);
        if is_measured_alike && self.n_models.get() == n_models {
            return;
        }
        self.n_models.set(n_models);
        self.system.borrow().spare().forget();
        if is_measured_alike {
            self.order_look();
        } else {
            *self.keeper.borrow_mut() = Keeper::new(settings.rate_hz, settings.sensor);
        }
    }

    /// Looks wait while somebody records.
    fn notice_recording(&self) {
        let is_recorded = self.rig.borrow().is_streaming();
        if self.is_recorded.replace(is_recorded) != is_recorded {
            self.system.borrow().spare().hold(is_recorded);
        }
    }

    fn blink(&self, n_samples: u32) {
        let names = self.system.borrow().spare().names();
        let n = self.unswitched.get() + n_samples;
        self.unswitched.set(n);
        let half = self.rig.borrow().settings().rate_hz / (2.0 * BLINKS_HZ);
        if n as f32 >= half || (self.is_lit.get() && !names) {
            self.is_lit.set(names && !self.is_lit.get());
            self.unswitched.set(0);
            self.system.borrow_mut().light(self.is_lit.get());
        }
    }

    fn take_batch(&self, batch: &Batch) {
        let announced = self.saved.take() | self.saving.get();
        let mut rig = self.rig.borrow_mut();
        let mut stages = self.stages.borrow_mut();
        let mut n_dropped = 0;
        if batch.lost > 0 {
            rig.on_samples_lost(batch.lost, !announced, |frame| n_dropped += self.queue.push(&frame));
        }
        for code in &batch.codes {
            let began = Y::cycles();
            let mut framing = 0;
            rig.on_sample(*code, |frame| {
                let began = Y::cycles();
                n_dropped += self.queue.push(&frame);
                let took = Y::cycles().wrapping_sub(began);
                stages.frame.took(took);
                framing += took;
            });
            stages.sample.took(batch.cycles / batch.codes.len() as u32);
            stages.observer.took(Y::cycles().wrapping_sub(began).saturating_sub(framing));
        }
        (0..n_dropped).for_each(|_| rig.on_frame_dropped());
        if !batch.codes.is_empty() {
            self.system.borrow_mut().feed_watchdog();
        }
    }

    async fn send(&self, mut sender: impl Write) -> ! {
        let mut encoded = Encoded::new();
        loop {
            self.queue.take(&mut encoded).await;
            // A link that went away takes the frame with it; the next frame begins anew.
            if sender.write_all(&encoded).await.is_ok() {
                let _ = sender.flush().await;
            }
        }
    }

    async fn listen<F: NorFlash>(&self, mut receiver: impl Read, mut store: Store<F, Sampling<Y>>) -> ! {
        let mut deframer = Deframer::new();
        let mut bytes = [0; 64];
        loop {
            // A receiver that reports an error has recovered by the next call; the frame it hurt fails its check sum.
            let n_bytes = receiver.read(&mut bytes).await.unwrap_or(0);
            for byte in &bytes[..n_bytes] {
                match deframer.push_at_rig(*byte) {
                    Some(Ok(frame)) => self.obey(frame, &mut store).await,
                    Some(Err(_)) => self.rig.borrow_mut().on_bad_frame(),
                    None => {}
                }
            }
            yield_now().await;
        }
    }

    async fn obey<F: NorFlash>(&self, frame: Frame, store: &mut Store<F, Sampling<Y>>) {
        match frame {
            // Whoever says hello has no use for what was meant for the listener before.
            Frame::Hello(_) => self.queue.clear(),
            Frame::Command(_, Command::Statistics) => {
                self.system.borrow_mut().measure(self.rig.borrow_mut().health());
            }
            Frame::Command(_, Command::Chip) => *self.rig.borrow_mut().chip() = self.chip(),
            Frame::Command(number, Command::Bootloader) if !Y::HAS_BOOTLOADER => {
                return self.refuse(number, Refusal::NotHere);
            }
            Frame::Command(number, Command::Start(stream)) if self.is_too_much(stream) => {
                return self.refuse(number, Refusal::NotHere);
            }
            Frame::Command(number, Command::SetSettings(settings)) if !(self.input.can_read)(&settings.sensor) => {
                return self.refuse(number, Refusal::NoSuchSensor);
            }
            _ => {}
        }
        let outcome = self.rig.borrow_mut().on_frame(frame);
        match outcome {
            Outcome::Nothing => {}
            Outcome::Send(frame) => self.answer(&frame),
            Outcome::SendThenDo(frame, request) => {
                self.answer(&frame);
                select(self.queue.drained(), Y::pause(FAREWELL_MS)).await;
                Y::pause(LAST_BYTES_MS).await;
                self.carry_out(request, store).await;
            }
            Outcome::Do(number, request) => {
                let finished = self.carry_out(request, store).await;
                let frame = self.rig.borrow_mut().finished(number, finished);
                self.answer(&frame);
            }
        }
        self.notice_changes();
        self.notice_recording();
    }

    fn chip(&self) -> Chip {
        let Stages { sample, observer, frame, save } = *self.stages.borrow();
        Chip { sample, observer, frame, save, ..self.system.borrow().chip() }
    }

    /// More live points than the link can carry would only be dropped.
    fn is_too_much(&self, stream: Stream) -> bool {
        let rate_hz = self.rig.borrow().settings().rate_hz;
        stream.live_every > 0 && rate_hz > self.most_points_per_s * f32::from(stream.live_every)
    }

    fn refuse(&self, number: u16, why: Refusal) {
        self.answer(&Frame::Answer(number, Answer::Refused(why)));
    }

    fn answer(&self, frame: &Frame) {
        let n_dropped = self.queue.push(frame);
        (0..n_dropped).for_each(|_| self.rig.borrow_mut().on_frame_dropped());
    }

    async fn carry_out<F: NorFlash>(&self, request: Request, store: &mut Store<F, Sampling<Y>>) -> Finished {
        match request {
            Request::Save if !self.system.borrow().can_save() => Finished::Failed(Refusal::Supply),
            Request::Save => {
                let stored = self.rig.borrow().stored();
                let began = Y::cycles();
                self.saving.set(true);
                let outcome = store.save(&stored).await;
                self.saving.set(false);
                self.saved.set(true);
                self.stages.borrow_mut().save.took(Y::cycles().wrapping_sub(began));
                match outcome {
                    Ok(()) => Finished::Done,
                    Err(_) if !self.system.borrow().can_save() => Finished::Failed(Refusal::Supply),
                    Err(refusal) => Finished::Failed(refusal),
                }
            }
            Request::Load => {
                let Ok(mut stored) = store.load().await else { return Finished::Failed(Refusal::NothingStored) };
                if !self.input.takes(&mut stored) {
                    return Finished::Failed(Refusal::NoSuchSensor);
                }
                self.new_sampling.set(Some((stored.settings.sensor, stored.settings.rate_hz)));
                Finished::Loaded(stored)
            }
            Request::SetRate(rate_hz) => {
                let rate_hz = (self.input.nearest_rate)(rate_hz);
                self.new_sampling.set(Some((self.rig.borrow().settings().sensor, rate_hz)));
                Finished::Sampling(rate_hz)
            }
            Request::Suspects => {
                let system = self.system.borrow();
                system.spare().hold(false);
                Finished::Suspects(system.spare().found())
            }
            Request::Reset => self.system.borrow_mut().reset(),
            Request::Bootloader => self.system.borrow_mut().bootloader(),
        }
    }
}
