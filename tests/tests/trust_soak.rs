//! Days of virtual time at 1 kHz through the rig and its link: no sample is lost, the time base does not drift, and no
//! buffer grows.

use host::link::{Port, Session};
use host::sim::{Scenario, SimulatedRig};
use shared::wire::{Frame, Stream};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Virtual seconds; `SOAK_S=86400` is a day and takes a minute.
const SECONDS: u64 = 3600;

const RATE_HZ: u64 = 1000;

/// The rig itself as a port, which notes the longest queue it ever had.
struct Watched {
    rig: SimulatedRig,
    longest: Arc<AtomicUsize>,
}

impl Port for Watched {
    fn name(&self) -> &str {
        "soak"
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let n_bytes = self.rig.read(buffer, timeout);
        self.longest.fetch_max(n_bytes + self.rig.output().len(), Ordering::Relaxed);
        Ok(n_bytes)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.rig.receive(bytes);
        Ok(())
    }

    fn elapsed(&self) -> Duration {
        Duration::from_secs_f64(self.rig.elapsed_s())
    }
}

#[test]
fn every_sample_of_a_long_time_arrives_once_and_in_order() {
    let seconds: u64 = std::env::var("SOAK_S").map_or(SECONDS, |seconds| seconds.parse().unwrap());
    let longest = Arc::new(AtomicUsize::new(0));
    let rig = SimulatedRig::new(Scenario::by_name("plain").unwrap(), 1);
    let mut session = Session::open(Box::new(Watched { rig, longest: Arc::clone(&longest) })).unwrap();
    let before = session.statistics().unwrap();
    session.start(Stream { raw: true, live_every: 10 }).unwrap();
    let (mut first, mut next, mut n_live) = (None, 0, 0_u64);
    while next < first.unwrap_or(0) + seconds * RATE_HZ {
        match session.receive(Duration::from_secs(1)).unwrap() {
            Some(Frame::Samples(samples)) => {
                assert_eq!(samples.first_sample, *first.get_or_insert(samples.first_sample).max(&mut next));
                next = samples.first_sample + samples.codes.len() as u64;
            }
            Some(Frame::Live(live)) => n_live += live.points.len() as u64,
            other => panic!("{other:?} after {next} samples"),
        }
    }
    let drift_s = session.elapsed().as_secs_f64() - next as f64 / RATE_HZ as f64;
    let tally = session.tally().clone();
    session.stop().unwrap();
    let after = session.statistics().unwrap();
    println!(
        "{seconds} s: {next} samples, {n_live} live points, longest queue {longest:?} bytes, drift {drift_s:.3} s"
    );
    assert_eq!((tally.frames_lost, tally.samples_lost, tally.frames_damaged), (0, 0, 0));
    assert!(after.samples - before.samples >= seconds * RATE_HZ);
    assert_eq!((after.overruns, after.dropped_frames, after.bad_frames), (0, 0, before.bad_frames));
    assert!(n_live.abs_diff(seconds * RATE_HZ / 10) < 100);
    // Adding up milliseconds rounds by less than this in a day.
    assert!(drift_s.abs() < 0.05, "{drift_s}");
    assert!(longest.load(Ordering::Relaxed) < 4096);
}
