//! One long thing after the other: a worker thread, and what it is doing for everybody to see.

use crate::error::Failure;
use crate::fit::tally::Tally;
use serde::Serialize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// More than so many waiting jobs are clicks in vain.
const MOST_WAITING: usize = 3;

/// What jobs are done for.
pub(super) trait Client: Send + Sync + Sized + 'static {
    /// Its queue.
    fn jobs(&self) -> &Jobs<Self>;

    /// Something changed.
    fn tell(&self);

    /// A job failed.
    fn fail(&self, failure: Failure);
}

/// Something that takes a while.
type Work<C> = Box<dyn FnOnce(&Arc<C>, &Progress) -> Result<(), Failure> + Send>;

/// The job that is done once nothing else is waiting.
type Look<C> = fn(&Arc<C>, &Progress) -> Result<(), Failure>;

struct Job<C> {
    name: String,
    work: Work<C>,
}

/// The worker's queue and what it is doing.
pub(super) struct Jobs<C> {
    sender: Sender<Job<C>>,
    receiver: Mutex<Option<Receiver<Job<C>>>>,
    n_waiting: AtomicUsize,
    look_wanted: AtomicBool,
    now: Mutex<Option<Arc<Progress>>>,
}

/// How far a job is.
pub(super) struct Progress {
    name: String,
    began: Instant,
    words: Mutex<(String, Option<f64>)>,
    /// Simulated swings so far.
    pub(super) count: Tally,
}

/// The same for the page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct JobView {
    name: String,
    words: String,
    share: Option<f64>,
    seconds: f64,
    simulations: usize,
}

impl Progress {
    fn new(name: String) -> Self {
        let words = Mutex::new((String::new(), None));
        Self { name, began: Instant::now(), words, count: Tally::default() }
    }

    /// What is being done, and which share of the whole that is, if anybody knows.
    pub(super) fn say(&self, words: &str, share: Option<f64>) {
        *self.words.lock().unwrap_or_else(PoisonError::into_inner) = (words.to_owned(), share);
    }

    fn view(&self) -> JobView {
        let (words, share) = self.words.lock().unwrap_or_else(PoisonError::into_inner).clone();
        JobView {
            name: self.name.clone(),
            words,
            share,
            seconds: self.began.elapsed().as_secs_f64(),
            simulations: self.count.simulations(),
        }
    }
}

impl<C: Client> Jobs<C> {
    pub(super) fn new() -> Self {
        let (sender, receiver) = channel();
        Self {
            sender,
            receiver: Mutex::new(Some(receiver)),
            n_waiting: AtomicUsize::new(0),
            look_wanted: AtomicBool::new(false),
            now: Mutex::new(None),
        }
    }

    /// Starts the worker; it ends with the program.
    pub(super) fn begin(&self, app: &Arc<C>, look: Look<C>) {
        let receiver = self.receiver.lock().unwrap_or_else(PoisonError::into_inner).take();
        let app = app.clone();
        if let Some(receiver) = receiver {
            std::thread::spawn(move || receiver.into_iter().for_each(|job| app.jobs().carry_out(&app, job, look)));
        }
    }

    /// Puts something in line.
    ///
    /// # Errors
    /// Too much is waiting already.
    pub(super) fn ask(
        &self,
        name: &str,
        work: impl FnOnce(&Arc<C>, &Progress) -> Result<(), Failure> + Send + 'static,
    ) -> Result<(), Failure> {
        if self.n_waiting.fetch_add(1, Ordering::SeqCst) >= MOST_WAITING {
            self.n_waiting.fetch_sub(1, Ordering::SeqCst);
            let what = format!("{MOST_WAITING} things are waiting to be done already");
            return Err(Failure::wrong_use(what).next("wait until the bar at the top is gone"));
        }
        let _ = self.sender.send(Job { name: name.to_owned(), work: Box::new(work) });
        Ok(())
    }

    /// The comparison is to be made anew, once nothing else is waiting.
    pub(super) fn ask_for_a_look(&self) {
        if !self.look_wanted.swap(true, Ordering::SeqCst) {
            self.n_waiting.fetch_add(1, Ordering::SeqCst);
            let _ = self.sender.send(Job { name: "comparing".to_owned(), work: Box::new(|_, _| Ok(())) });
        }
    }

    /// Is something else waiting?
    pub(super) fn is_pressed(&self) -> bool {
        self.n_waiting.load(Ordering::SeqCst) > 0
    }

    /// What is being done.
    pub(super) fn now(&self) -> Option<JobView> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map(|progress| progress.view())
    }

    fn carry_out(&self, app: &Arc<C>, job: Job<C>, look: Look<C>) {
        self.n_waiting.fetch_sub(1, Ordering::SeqCst);
        self.watched(app, job.name, job.work);
        while !self.is_pressed() && self.look_wanted.swap(false, Ordering::SeqCst) {
            self.watched(app, "comparing".to_owned(), Box::new(look));
        }
    }

    fn watched(&self, app: &Arc<C>, name: String, work: Work<C>) {
        let progress = Arc::new(Progress::new(name));
        *self.now.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress.clone());
        app.tell();
        let name = &progress.name;
        let result = catch_unwind(AssertUnwindSafe(|| work(app, &progress))).unwrap_or_else(|_| {
            let next = "this is a mistake in the program: please report it with your recordings";
            Err(Failure::failed(format!("{name} ended unexpectedly")).next(next))
        });
        *self.now.lock().unwrap_or_else(PoisonError::into_inner) = None;
        log::debug!("{name} took {:.2?}", progress.began.elapsed());
        match result {
            Ok(()) => app.tell(),
            Err(failure) => app.fail(failure),
        }
    }
}
