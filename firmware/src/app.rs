//! The application: three loops around one [`Rig`], joined in one task.
//!
//! Samples flow board → rig → queue, frames flow queue → link, and commands link → rig. Only the sending loop ever
//! waits for the link, so a slow or absent PC never holds up sampling.

use crate::frame_queue::{Encoded, FrameQueue};
use crate::ports::{Board, FULL_SCALE, Sampler, System};
use crate::store::Store;
use core::cell::{Cell, RefCell};
use embassy_futures::join::join3;
use embassy_futures::select::select;
use embassy_futures::yield_now;
use embedded_io_async::{Read, Write};
use embedded_storage_async::nor_flash::NorFlash;
use shared::rig::{Finished, Outcome, Request, Rig};
use shared::wire::{Answer, Command, Deframer, Frame, Health, Refusal, Stream};

/// A restart waits at most this long for its answer to leave …
const FAREWELL_MS: u32 = 200;

/// … and then this long for the last bytes to pass the link's own buffers.
const LAST_BYTES_MS: u32 = 50;

/// What the loops share. They run in one task, so no borrow is ever held while another loop runs.
struct Shared<Y> {
    rig: RefCell<Rig>,
    system: RefCell<Y>,
    queue: FrameQueue,
    most_points_per_s: f32,
    /// A rate that the sampler has not been told yet.
    new_rate_hz: Cell<Option<f32>>,
    /// The flash is being written, or was since the last samples: what is missing now was announced.
    saving: Cell<bool>,
    saved: Cell<bool>,
}

/// Runs the rig on a board, for ever.
pub async fn run<S: Sampler, R: Read, W: Write, F: NorFlash, Y: System>(board: Board<S, R, W, F, Y>) -> ! {
    let mut store = Store::new(board.flash, board.store);
    let rig = start(board.name, board.most_points_per_s, &mut store, board.system).await;
    join3(rig.sample(board.sampler), rig.send(board.sender), rig.listen(board.receiver, store)).await.0
}

async fn start<F: NorFlash, Y: System>(
    name: &str,
    most_points_per_s: f32,
    store: &mut Store<F>,
    mut system: Y,
) -> Shared<Y> {
    let mut rig = Rig::new(name, FULL_SCALE, store.load().await);
    let store_state = rig.health().store;
    *rig.health() = Health { store: store_state, ..system.since_power_up() };
    Shared {
        new_rate_hz: Cell::new(Some(rig.settings().rate_hz)),
        rig: RefCell::new(rig),
        system: RefCell::new(system),
        queue: FrameQueue::new(),
        most_points_per_s,
        saving: Cell::new(false),
        saved: Cell::new(false),
    }
}

impl<Y: System> Shared<Y> {
    async fn sample(&self, mut sampler: impl Sampler) -> ! {
        loop {
            if let Some(rate_hz) = self.new_rate_hz.take() {
                sampler.set_rate(rate_hz);
            }
            let batch = sampler.next().await;
            self.take_batch(&batch.codes, batch.lost);
            yield_now().await;
        }
    }

    fn take_batch(&self, codes: &[shared::units::Code], lost: u32) {
        let announced = self.saved.take() | self.saving.get();
        let mut rig = self.rig.borrow_mut();
        if lost > 0 {
            rig.on_samples_lost(lost, !announced);
        }
        let mut n_dropped = 0;
        for code in codes {
            rig.on_sample(*code, |frame| n_dropped += self.queue.push(&frame));
        }
        (0..n_dropped).for_each(|_| rig.on_frame_dropped());
        if !codes.is_empty() {
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

    async fn listen<F: NorFlash>(&self, mut receiver: impl Read, mut store: Store<F>) -> ! {
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

    async fn obey<F: NorFlash>(&self, frame: Frame, store: &mut Store<F>) {
        match frame {
            // Whoever says hello has no use for what was meant for the listener before.
            Frame::Hello(_) => self.queue.clear(),
            Frame::Command(_, Command::Statistics) => {
                self.system.borrow_mut().measure(self.rig.borrow_mut().health());
            }
            Frame::Command(number, Command::Bootloader) if !Y::HAS_BOOTLOADER => return self.refuse(number),
            Frame::Command(number, Command::Start(stream)) if self.is_too_much(stream) => return self.refuse(number),
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
    }

    /// More live points than the link can carry would only be dropped.
    fn is_too_much(&self, stream: Stream) -> bool {
        let rate_hz = self.rig.borrow().settings().rate_hz;
        stream.live_every > 0 && rate_hz > self.most_points_per_s * f32::from(stream.live_every)
    }

    fn refuse(&self, number: u16) {
        self.answer(&Frame::Answer(number, Answer::Refused(Refusal::NotHere)));
    }

    fn answer(&self, frame: &Frame) {
        let n_dropped = self.queue.push(frame);
        (0..n_dropped).for_each(|_| self.rig.borrow_mut().on_frame_dropped());
    }

    async fn carry_out<F: NorFlash>(&self, request: Request, store: &mut Store<F>) -> Finished {
        match request {
            Request::Save(stored) => {
                self.saving.set(true);
                let outcome = store.save(&stored).await;
                self.saving.set(false);
                self.saved.set(true);
                outcome.map_or_else(Finished::Failed, |()| Finished::Done)
            }
            Request::Load => match store.load().await {
                Ok(stored) => {
                    self.new_rate_hz.set(Some(stored.settings.rate_hz));
                    Finished::Loaded(stored)
                }
                Err(_) => Finished::Failed(Refusal::NothingStored),
            },
            Request::SetRate(rate_hz) => {
                self.new_rate_hz.set(Some(rate_hz));
                Finished::Done
            }
            Request::Reset => self.system.borrow_mut().reset(),
            Request::Bootloader => self.system.borrow_mut().bootloader(),
        }
    }
}
