//! The nominal swing with its transition: how a small change of the state lives on, for all columns at once.
//!
//! δx' = A(t)·δx + B(t) has the same A for every quantity that δx is the derivative by, so the 2 × 2 transition of a
//! step is found once ([`super::smooth`]); a column adds its own torque at the two places of Gauss and Legendre's rule.
//! Where sliding begins or ends the step is cut: the transition of a piece holds the jump δx⁺ = δx⁻ + (f⁻ − f⁺)·δt at
//! its end. There are no dual numbers here, because a second model of them would not fit a board's flash.

use super::smooth::{Changes, Point, Way, cubic};
use crate::karnopp::Contact;
use crate::model::{MAX_CUTS, Model, SensorState, State};
use crate::motion::{Motion, Pendulum};
use crate::parameters::{Parameters, base};
use crate::real::Real;
use heapless::Vec;

/// A 2 × 2 matrix, by rows.
type Matrix<R> = [[R; 2]; 2];

/// Where in a piece torques are looked at, as shares of it: the two-point rule of fourth order (M. Abramowitz,
/// I. A. Stegun, Handbook of Mathematical Functions (NBS, 1964), table 25.4).
const PLACES: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// A sensor that remembers, such as one with play, is led to the start of a window from so many places. Half and twice were
/// not tried.
const N_APPROACH: usize = 32;

/// They lie so many seconds apart, so that the first one is 0.13 s before the window. Half and twice were not tried.
const APPROACH_S: f64 = 4e-3;

/// A part of a step in which the contact stays the same until its end.
pub struct Piece<R> {
    /// Its length, s.
    pub seconds: R,
    /// Change of angle and velocity after it by those before it.
    pub whole: Matrix<R>,
    /// Where torques act: each place stands for half of the piece.
    pub places: [Place<R>; 2],
    /// Where it begins and ends, for laws with a memory.
    pub ends: [Motion<R>; 2],
    /// 1 where it moves, 0 at rest.
    pub moves: R,
    /// 1 where friction laws act, 0 at rest and where stiction takes their place.
    pub rubs: R,
    /// What one rad/s more velocity band adds at the end, and by friction at its edge in N·m on the way.
    pub by_band: ([R; 2], R),
}

/// An instant within a piece.
pub struct Place<R> {
    /// Change of angle and velocity after the piece by a velocity gained here.
    pub from_here: [R; 2],
    /// As springs and magnets see it.
    pub drive: Motion<R>,
    /// As friction sees it: in the band, where it took hold.
    pub friction: Motion<R>,
    /// Acceleration, rad/s².
    pub acceleration: R,
}

/// Added laws and sensors are derived by differences over so many rad to either side. By the formulas: half of it doubles
/// what `f32` rounds, 2e-5 of gravity's share; twice of it makes a detent of 24 steps a turn 1.5e-3 softer instead of 4e-4 …
const NEAR_RAD: f64 = 2e-3;

/// … and over so many rad/s. Half and twice were not tried.
const NEAR_RAD_S: f64 = 1e-2;

/// A pendulum that swings by the model.
pub struct Swing<R: 'static> {
    model: Model<R>,
    state: State<R>,
    /// The sensor of the swing, and of one that is turned by [`NEAR_RAD`] as a whole.
    sensors: [SensorState<R>; 2],
    pendulum: Pendulum<R>,
    inverse_inertia: R,
    gravity_nm: R,
    viscous: R,
    stiction_nm: R,
    velocity_band: R,
    /// The last reading before a start, rad.
    arriving: R,
    /// Where the present band was entered: angle and time.
    entered: [R; 2],
}

/// How the pendulum came to where it is.
pub struct Approach<R> {
    /// Angle, velocity and time, the latest first.
    places: Vec<[R; 3], N_APPROACH>,
    direction: R,
    pendulum: Pendulum<R>,
}

impl<R: Real> Approach<R> {
    /// As a sensor saw it, the earliest first.
    pub fn motions(&self) -> impl Iterator<Item = Motion<R>> {
        let (direction, pendulum) = (self.direction, self.pendulum);
        self.places.iter().rev().map(move |[angle_rad, velocity_rad_s, time_s]| Motion {
            angle_rad: *angle_rad,
            velocity_rad_s: *velocity_rad_s,
            direction,
            time_s: *time_s,
            pendulum,
        })
    }
}

impl<R: Copy> Swing<R> {
    /// By no model yet, given zero.
    pub const fn empty(zero: R) -> Self {
        Self {
            model: Model::empty(zero),
            state: State::all(zero),
            sensors: [SensorState::all(zero); 2],
            pendulum: Pendulum::all(zero),
            inverse_inertia: zero,
            gravity_nm: zero,
            viscous: zero,
            stiction_nm: zero,
            velocity_band: zero,
            arriving: zero,
            entered: [zero; 2],
        }
    }
}

impl<R: Real<Mask = bool>> Swing<R> {
    /// By a model with these parameters; it hangs still.
    #[inline(never)]
    pub fn renew(&mut self, parameters: &Parameters<R>) {
        let value =
            |id, index: usize| parameters.values(id).and_then(|values| values.get(index)).copied().unwrap_or(R::zero());
        self.model.renew(parameters);
        self.state = self.model.release(R::zero(), R::zero());
        self.sensors = [self.model.sensor_at_rest(&self.state); 2];
        self.pendulum = parameters.pendulum;
        self.inverse_inertia = R::one() / parameters.pendulum.pivot_inertia_kg_m2();
        self.gravity_nm = parameters.pendulum.gravity_torque_nm();
        self.viscous = value(base::VISCOUS, 0);
        self.stiction_nm = value(base::STICTION, 0);
        self.velocity_band = value(base::STICTION, 1);
        (self.arriving, self.entered) = (R::zero(), [R::zero(); 2]);
    }

    /// Begins anew at an angle (rad) and a velocity (rad/s), so long after the release, a sensor in its stride.
    #[inline(never)]
    pub fn start(&mut self, angle_rad: R, velocity_rad_s: R, time_s: R) {
        self.state = self.model.release(angle_rad, velocity_rad_s);
        self.state.time_s = time_s;
        if self.model.has_plain_sensor() {
            return;
        }
        let mut here = self.state;
        for (index, place) in self.approach().places.iter().rev().enumerate() {
            [here.angle_rad, here.velocity_rad_s, here.time_s] = *place;
            if index == 0 {
                self.sensors = [here, turned(&here)].map(|state| self.model.sensor_at_rest(&state));
            }
            self.arriving = self.sense(&here).0;
        }
    }

    /// How fast the reading changes where it began, given the reading there, rad/s.
    pub fn rate(&self, reading_rad: R) -> R {
        if self.model.has_plain_sensor() {
            return self.state.velocity_rad_s;
        }
        (reading_rad - self.arriving) / R::of(APPROACH_S)
    }

    /// How it came to where it is, for sensors that remember: the same equations with time running back, until it
    /// turned.
    #[inline(never)]
    pub fn approach(&self) -> Approach<R> {
        let mut places = Vec::new();
        let mut state = self.state;
        let slide = state.contact.slide;
        let place = |state: &State<R>| [state.angle_rad, state.velocity_rad_s, state.time_s];
        while !places.is_full() {
            self.model.step(&mut state, R::of(-APPROACH_S));
            if !self.velocity_band.lt(slide * state.velocity_rad_s) {
                break;
            }
            state.contact.slide = slide;
            let _ = places.push(place(&state));
        }
        if places.is_empty() {
            let _ = places.push(place(&self.state));
        }
        Approach { places, direction: slide, pendulum: self.pendulum }
    }

    /// Where it is.
    pub fn motion(&self) -> Motion<R> {
        self.motion_of(&self.state, self.state.contact.slide)
    }

    /// 1 / (m·l² + I).
    pub fn inverse_inertia(&self) -> R {
        self.inverse_inertia
    }

    /// The reading in rad, and how it changes when the whole swing is turned. Call it at each sample in turn.
    pub fn read(&mut self) -> (R, R) {
        if self.model.has_plain_sensor() {
            return (self.state.angle_rad, R::one());
        }
        let here = self.state;
        self.sense(&here)
    }

    #[inline(never)]
    fn sense(&mut self, here: &State<R>) -> (R, R) {
        let [own, of_turned] = &mut self.sensors;
        let reading = self.model.read(here, own);
        let of_turned = self.model.read(&turned(here), of_turned);
        (reading, (of_turned - reading) / R::of(NEAR_RAD))
    }

    /// Tells what the sensor reads on the way of so many intervals from a motion to here, at the end of each but the
    /// last one, and at which share of the way.
    pub fn read_between(&mut self, from: &Motion<R>, n: usize, interval_s: R, tell: &mut dyn FnMut(R, R)) {
        let mut between = self.state;
        let (angles, speeds) = ([from.angle_rad, between.angle_rad], [from.velocity_rad_s, between.velocity_rad_s]);
        let one = R::one() / R::of(n as f64);
        let (seconds, mut share) = (interval_s / one, R::zero());
        for _ in 1..n {
            share = share + one;
            between.angle_rad = cubic(angles, speeds, seconds, share);
            if self.model.has_plain_sensor() {
                tell(share, between.angle_rad);
                continue;
            }
            between.velocity_rad_s = speeds[0] + share * (speeds[1] - speeds[0]);
            between.time_s = from.time_s + share * seconds;
            tell(share, self.sense(&between).0);
        }
    }

    /// Does the direction change within so many seconds, or has it just done so?
    pub fn is_near_turn(&self, seconds: R) -> bool {
        let State { velocity_rad_s, .. } = self.state;
        let change = self.acceleration(&self.state).abs() * seconds;
        velocity_rad_s.abs().lt(change + change)
    }

    /// Swings on for so many seconds and tells each piece of it.
    pub fn advance(&mut self, seconds: R, tell: &mut dyn FnMut(&Piece<R>)) {
        let mut end = self.state;
        self.model.step(&mut end, seconds);
        if R::zero().lt(self.state.contact.slide * end.contact.slide) {
            tell(&self.piece(&end, &end, seconds));
            self.state = end;
        } else {
            self.advance_in_pieces(seconds, tell);
        }
    }

    #[inline(never)]
    fn advance_in_pieces(&mut self, seconds: R, tell: &mut dyn FnMut(&Piece<R>)) {
        let mut left_s = seconds;
        for _ in 0..MAX_CUTS {
            let mut end = self.state;
            let next_s = self.model.step_to_change(&mut end, left_s);
            let piece_s = left_s - next_s;
            tell(&self.piece(&self.model.unchanged(&self.state, piece_s), &end, piece_s));
            if in_band(&end.contact) && !in_band(&self.state.contact) {
                self.entered = [end.angle_rad, end.time_s];
            }
            (self.state, left_s) = (end, next_s);
            if !R::zero().lt(left_s) {
                return;
            }
        }
    }

    /// A piece that arrives where it does with the contact it began with, and then goes on from `end`.
    #[inline(never)]
    fn piece(&self, arriving: &State<R>, end: &State<R>, seconds: R) -> Piece<R> {
        let before = &self.state;
        let (first, last) = (self.place(before, R::zero()), self.place(arriving, seconds));
        let way = Way { from: first, to: last, seconds };
        let changes = Changes([
            self.changes(first, R::zero()),
            self.changes(self.along(&way, R::of(0.5)), R::of(0.5) * seconds),
            self.changes(last, seconds),
        ]);
        let Contact { slide, push, .. } = before.contact;
        let moves = slide.abs() + push.abs();
        let jump = self.jump(&last, end);
        let goes_on = |carried: [R; 2]| {
            jump.as_ref().map_or(carried, |jump| jump.map(|row| row[0] * carried[0] + row[1] * carried[1]))
        };
        let columns = [[R::one(), R::zero()], [R::zero(), moves]].map(|unit| goes_on(changes.carry(seconds, unit)));
        let place = |share: R| {
            let here = self.along(&way, share);
            let drive = self.motion_at(here, share * seconds);
            Place {
                from_here: goes_on(changes.carry_velocity(share, seconds).map(|gained| moves * gained)),
                drive,
                friction: self.as_friction_sees_it(&before.contact, &drive),
                acceleration: here.acceleration,
            }
        };
        let rubs = self.rubs(&before.contact);
        Piece {
            seconds,
            whole: [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]],
            places: [place(R::of(PLACES[0])), place(R::of(PLACES[1]))],
            ends: [self.motion_at(first, R::zero()), self.motion_of(end, slide)],
            moves,
            rubs,
            by_band: self.by_band(&last, end, rubs),
        }
    }

    /// A state as a point of the piece that begins here, so many seconds on.
    fn place(&self, state: &State<R>, later_s: R) -> Point<R> {
        let (angle_rad, velocity_rad_s) = (state.angle_rad, state.velocity_rad_s);
        Point { angle_rad, velocity_rad_s, acceleration: self.acceleration_at(angle_rad, velocity_rad_s, later_s) }
    }

    /// A share of the way on.
    fn along(&self, way: &Way<R>, share: R) -> Point<R> {
        let (angle_rad, velocity_rad_s) = way.at(share);
        let acceleration = self.acceleration_at(angle_rad, velocity_rad_s, share * way.seconds);
        Point { angle_rad, velocity_rad_s, acceleration }
    }

    /// rad/s², in the contact of here, so many seconds on.
    fn acceleration_at(&self, angle_rad: R, velocity_rad_s: R, later_s: R) -> R {
        let time_s = self.state.time_s + later_s;
        self.model.acceleration_rad_s2(&self.state, angle_rad, velocity_rad_s, time_s)
    }

    /// How the acceleration changes by angle and velocity, in the contact of here.
    fn changes(&self, at: Point<R>, later_s: R) -> [R; 2] {
        let contact = &self.state.contact;
        if self.model.is_plain() {
            let slides = contact.slide.abs();
            let moves = slides + contact.push.abs();
            let by_angle = -moves * self.gravity_nm * at.angle_rad.cos() * self.inverse_inertia;
            return [by_angle, -slides * self.viscous * self.inverse_inertia];
        }
        self.changes_with_added(at, later_s)
    }

    #[inline(never)]
    fn changes_with_added(&self, at: Point<R>, later_s: R) -> [R; 2] {
        let (zero, near) = (R::zero(), [NEAR_RAD, NEAR_RAD_S].map(R::of));
        let beside =
            |angle: R, velocity: R| self.acceleration_at(at.angle_rad + angle, at.velocity_rad_s + velocity, later_s);
        [
            (beside(near[0], zero) - beside(-near[0], zero)) / (near[0] + near[0]),
            (beside(zero, near[1]) - beside(zero, -near[1])) / (near[1] + near[1]),
        ]
    }

    /// What becomes of a small change where the contact does; `None` where it stays the same. What arrives later by δt
    /// has gone on for so much less.
    fn jump(&self, arriving: &Point<R>, end: &State<R>) -> Option<Matrix<R>> {
        let (before, after) = (&self.state.contact, &end.contact);
        let is_same = !R::zero().lt((before.slide - after.slide).abs() + (before.push - after.push).abs());
        if is_same || before.is_resting() {
            return None;
        }
        let (zero, one) = (R::zero(), R::one());
        if in_band(before) && after.is_resting() {
            // Where friction takes hold of a creeping pendulum is a place, wherever it came from.
            return Some([[zero; 2]; 2]);
        }
        let arrives = arriving.acceleration;
        if !zero.lt(arrives.abs()) {
            return None;
        }
        let later = -one / arrives;
        let slower = arriving.velocity_rad_s - end.velocity_rad_s;
        Some([[one, slower * later], [zero, one + (arrives - self.acceleration(end)) * later]])
    }

    fn rubs(&self, contact: &Contact<R>) -> R {
        let is_friction = in_band(contact) && self.stiction_nm.lt(contact.level_nm);
        if is_friction { R::one() } else { contact.slide.abs() }
    }

    /// In the band friction holds with what it had at the edge, where that is more than stiction.
    fn as_friction_sees_it(&self, contact: &Contact<R>, motion: &Motion<R>) -> Motion<R> {
        if !in_band(contact) {
            return *motion;
        }
        let ([angle_rad, time_s], push) = (self.entered, contact.push);
        Motion { angle_rad, velocity_rad_s: push * self.velocity_band, direction: push, time_s, ..*motion }
    }

    /// How the width of the band acts: where its edge is crossed, and by the friction at its edge.
    fn by_band(&self, arriving: &Point<R>, end: &State<R>, rubs: R) -> ([R; 2], R) {
        let Contact { slide, push, .. } = self.state.contact;
        let drag = -push * self.viscous * rubs;
        let edge = if in_band(&self.state.contact) { end.contact.slide } else { slide };
        let stays = !R::zero().lt((end.contact.slide - slide).abs());
        if stays || !R::zero().lt(edge.abs()) {
            return ([R::zero(); 2], drag);
        }
        let velocity_rad_s = edge * self.velocity_band;
        let time_s = end.time_s;
        let arrives = self.model.acceleration_rad_s2(&self.state, arriving.angle_rad, velocity_rad_s, time_s);
        if !R::zero().lt(self.velocity_band) {
            return ([R::zero(), self.by_narrow_band(slide, end, arrives)], drag);
        }
        let later = edge / arrives;
        if end.contact.is_resting() {
            return ([velocity_rad_s * later, R::zero()], drag);
        }
        ([R::zero(), (arrives - self.acceleration(end)) * later], drag)
    }

    /// A reversal without a band: what a narrow one would change. Between its edges the stop level acts.
    fn by_narrow_band(&self, slide: R, end: &State<R>, arrives: R) -> R {
        if end.contact.is_resting() {
            return R::zero();
        }
        let leaves = self.acceleration(end);
        let friction_nm = R::of(0.5) * (leaves - arrives).abs() / self.inverse_inertia;
        let level_nm = self.stiction_nm.max(friction_nm);
        let creeps = leaves + slide * (level_nm - friction_nm) * self.inverse_inertia;
        if !(creeps * slide).lt(R::zero()) {
            return R::zero();
        }
        slide * ((arrives - creeps) / arrives - (creeps - leaves) / creeps)
    }

    /// rad/s².
    fn acceleration(&self, state: &State<R>) -> R {
        self.model.acceleration_rad_s2(state, state.angle_rad, state.velocity_rad_s, state.time_s)
    }

    fn motion_of(&self, state: &State<R>, direction: R) -> Motion<R> {
        let State { angle_rad, velocity_rad_s, time_s, .. } = *state;
        Motion { angle_rad, velocity_rad_s, direction, time_s, pendulum: self.pendulum }
    }

    fn motion_at(&self, at: Point<R>, later_s: R) -> Motion<R> {
        let Point { angle_rad, velocity_rad_s, .. } = at;
        let (direction, time_s) = (self.state.contact.slide, self.state.time_s + later_s);
        Motion { angle_rad, velocity_rad_s, direction, time_s, pendulum: self.pendulum }
    }
}

fn in_band<R: Real<Mask = bool>>(contact: &Contact<R>) -> bool {
    contact.is_in_band()
}

/// The same with the whole swing turned a little.
fn turned<R: Real>(state: &State<R>) -> State<R> {
    let mut turned = *state;
    turned.angle_rad = turned.angle_rad + R::of(NEAR_RAD);
    turned
}
