//! Live points, gathered into messages for the page: at most [`MESSAGES_PER_S`] a second.

use super::rate::{LOST_RAD, Rate};
use axum::extract::ws::Utf8Bytes;
use serde::Serialize;
use shared::wire::Live;
use std::time::{Duration, Instant};

/// A screen is drawn no more often than this.
const MESSAGES_PER_S: u32 = 20;

/// Points of one message at most, whatever the rig sends.
const MOST_POINTS: usize = 2000;

/// Columns of points since the last message.
#[derive(Default, Serialize)]
pub(super) struct Points {
    #[serde(skip)]
    rate_hz: f64,
    #[serde(skip)]
    sent: Option<Instant>,
    #[serde(skip)]
    slope: Rate,
    #[serde(rename = "type")]
    kind: &'static str,
    /// Seconds since the rig was switched on.
    t: Vec<f64>,
    measured: Vec<f32>,
    observed: Vec<f32>,
    /// By the measured angle.
    rate: Vec<f32>,
    /// The observer's; none where it does not follow the pendulum, because a hand holds it.
    velocity: Vec<Option<f32>>,
    innovation: Vec<f32>,
    friction: Vec<f32>,
}

impl Points {
    pub(super) fn new(rate_hz: f32) -> Self {
        Self { rate_hz: f64::from(rate_hz), kind: "live", ..Self::default() }
    }

    /// Takes a frame; gives a message when one is due.
    pub(super) fn take(&mut self, live: &Live) -> Option<Utf8Bytes> {
        for (k, point) in live.points.iter().enumerate() {
            let sample = live.first_sample + k as u64 * u64::from(live.every);
            let time_s = sample as f64 / self.rate_hz;
            self.t.push(time_s);
            self.rate.push(self.slope.take(time_s, point.filtered_rad));
            self.measured.push(point.filtered_rad);
            self.observed.push(point.angle_rad);
            self.velocity.push(Some(point.velocity_rad_s).filter(|_| point.innovation_rad.abs() < LOST_RAD));
            self.innovation.push(point.innovation_rad);
            self.friction.push(point.friction_nm);
        }
        let is_due = self.sent.is_none_or(|sent| sent.elapsed() >= Duration::from_secs(1) / MESSAGES_PER_S);
        (is_due || self.t.len() >= MOST_POINTS).then(|| self.message())
    }

    fn message(&mut self) -> Utf8Bytes {
        self.sent = Some(Instant::now());
        let text = serde_json::to_string(&self).unwrap_or_default();
        self.t.clear();
        self.velocity.clear();
        for column in [&mut self.measured, &mut self.observed, &mut self.rate, &mut self.innovation, &mut self.friction]
        {
            column.clear();
        }
        text.into()
    }
}
