//! Where and how an effect acts: on the torque, beside the pendulum, or on the reading.

use crate::formula::Formula;
use crate::limits::{MAX_VALUES, MEMORY, SENSOR_MEMORY};
use crate::motion::Motion;

/// Torque in N·m at an instant, positive counter-clockwise.
pub type Torque<R> = fn(&Motion<R>, &[R; MAX_VALUES]) -> R;

/// From the instants before and after a step and the memory before it: the memory after it.
pub type Advance<R> = fn(&Motion<R>, &Motion<R>, &[R; MEMORY], &[R; MAX_VALUES]) -> [R; MEMORY];

/// Where and how an effect acts.
#[derive(Clone, Copy)]
pub enum Action<R> {
    /// Part of the base model: [`crate::model`] calls its functions directly, because they run in every step.
    Base,
    /// A torque that is there at rest too (a spring, a magnet). Stiction has to hold against it.
    Drive(Torque<R>),
    /// A torque that opposes sliding. At rest stiction takes its place.
    Friction(Torque<R>),
    /// A torque with a memory of its own.
    State(Memory<R>),
    /// Something that swings with the pendulum, integrated beside it.
    Support(Support<R>),
    /// What the sensor makes of the angle.
    Sensor(Sensor<R>),
    /// A torque that somebody typed; not in the list of all.
    Formula(&'static Formula),
    /// A free curve of the speed; not in the list of all.
    Curve,
}

/// An effect with an added state. It brings its own exact or implicit update, because a stiff one would diverge under
/// the fixed Runge–Kutta step.
#[derive(Clone, Copy)]
pub struct Memory<R> {
    /// The memory of a pendulum that was held still at this instant.
    pub start: fn(&Motion<R>, &[R; MAX_VALUES]) -> [R; MEMORY],
    /// Torque in N·m at an instant, given the memory of the last accepted step; acts at rest too.
    pub torque: fn(&Motion<R>, &[R; MEMORY], &[R; MAX_VALUES]) -> R,
    /// The memory after a step from the first instant to the second; the sliding direction did not change in between.
    pub advance: Advance<R>,
}

/// A degree of freedom of its own, which the Runge–Kutta step takes with the pendulum's. It moves while the bearing sticks
/// too.
#[derive(Clone, Copy)]
pub struct Support<R> {
    /// The memory at the first instant that is known.
    pub start: fn(&Motion<R>, &[R; MAX_VALUES]) -> [R; MEMORY],
    /// What it does at an instant.
    pub shake: fn(&Motion<R>, &[R; MEMORY], &[R; MAX_VALUES]) -> Shake<R>,
}

/// What a support does to a pendulum, and what becomes of itself.
#[derive(Clone, Copy)]
pub struct Shake<R> {
    /// Torque in N·m on a pendulum that turns evenly; acts at rest too.
    pub torque_nm: R,
    /// The pendulum's inertia as a share of what it is in a bearing that is held.
    pub share_held: R,
    /// How fast the memory changes, its unit/s.
    pub rate: [R; MEMORY],
}

/// An effect on the measurement.
#[derive(Clone, Copy)]
pub struct Sensor<R> {
    /// The memory on a pendulum that was held still at this instant, given the reading of what lies before it.
    pub start: fn(R, &Motion<R>, &[R; MAX_VALUES]) -> [R; SENSOR_MEMORY],
    /// Takes the reading of what lies before it (the true angle for the first), gives its own, in rad.
    pub read: fn(R, &Motion<R>, &mut [R; SENSOR_MEMORY], &[R; MAX_VALUES]) -> R,
}
