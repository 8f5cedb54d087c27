//! The nominal swing with its transition: how a small change of the state lives on, for all columns at once.
//!
//! δx' = A(t)·δx + B(t) has the same A for every quantity that δx is the derivative by, so the 2 × 2 transition of a
//! step is found once ([`super::smooth`]); a column adds its own torque at the two places of Gauss and Legendre's rule.
//! Where sliding begins or ends the step is cut, and the model runs with two derivatives ([`crate::dual`]): the
//! transition of a piece holds the jump δx⁺ = δx⁻ + (f⁻ − f⁺)·δt at its end.

use super::smooth::{Changes, Point, Way};
use crate::dual::Dual;
use crate::karnopp::Contact;
use crate::model::{MAX_CUTS, Model, SensorState, State};
use crate::motion::{Motion, Pendulum};
use crate::parameters::{Parameters, base};
use crate::real::Real;
use heapless::Vec;

/// A number with its derivatives by angle and velocity at the beginning of a piece.
type Local<R> = Dual<R, 2>;

/// A 2 × 2 matrix, by rows.
type Matrix<R> = [[R; 2]; 2];

/// Where in a piece torques are looked at, as shares of it: the two-point rule of fourth order (M. Abramowitz,
/// I. A. Stegun, Handbook of Mathematical Functions (NBS, 1964), table 25.4).
const PLACES: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// A sensor that remembers, such as one with play, is led to the start of a window from so many places, so many
/// seconds apart.
const N_APPROACH: usize = 32;
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

/// A pendulum that swings by the model.
pub struct Swing<R: 'static> {
    plain: Model<R>,
    model: Model<Local<R>>,
    state: State<R>,
    sensor: SensorState<Local<R>>,
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

impl<R: Real<Mask = bool>> Swing<R> {
    /// By a model with these parameters; it hangs still.
    #[inline(never)]
    pub fn new(parameters: &Parameters<R>) -> Self {
        let value =
            |id, index: usize| parameters.values(id).and_then(|values| values.get(index)).copied().unwrap_or(R::zero());
        let (plain, model) = (Model::new(parameters), Model::new(&parameters.map(Local::constant)));
        let state = plain.release(R::zero(), R::zero());
        Self {
            sensor: model.sensor_at_rest(&constant(&state)),
            state,
            plain,
            model,
            pendulum: parameters.pendulum,
            inverse_inertia: R::one() / parameters.pendulum.pivot_inertia_kg_m2(),
            gravity_nm: parameters.pendulum.gravity_torque_nm(),
            viscous: value(base::VISCOUS, 0),
            stiction_nm: value(base::STICTION, 0),
            velocity_band: value(base::STICTION, 1),
            arriving: R::zero(),
            entered: [R::zero(); 2],
        }
    }

    /// Begins anew at an angle (rad) and a velocity (rad/s), so long after the release, a sensor in its stride.
    pub fn start(&mut self, angle_rad: R, velocity_rad_s: R, time_s: R) {
        self.state = self.plain.release(angle_rad, velocity_rad_s);
        self.state.time_s = time_s;
        if self.model.has_plain_sensor() {
            return;
        }
        let approach = self.backwards();
        for (index, before) in approach.iter().rev().enumerate() {
            let before = self.shifted(before);
            if index == 0 {
                self.sensor = self.model.sensor_at_rest(&before);
            }
            self.arriving = self.model.read(&before, &mut self.sensor).value;
        }
    }

    /// How fast the reading changes where it began, given the reading there, rad/s.
    pub fn rate(&self, reading_rad: R) -> R {
        if self.model.has_plain_sensor() {
            return self.state.velocity_rad_s;
        }
        (reading_rad - self.arriving) / R::of(APPROACH_S)
    }

    /// How it came to where it is, for sensors that remember.
    pub fn approach(&self) -> Vec<Motion<R>, N_APPROACH> {
        let slide = self.state.contact.slide;
        self.backwards().iter().rev().map(|before| self.motion_of(before, slide)).collect()
    }

    /// Where it was before, the latest first: the same equations with time running back, until it turned.
    fn backwards(&self) -> Vec<State<R>, N_APPROACH> {
        let mut states = Vec::new();
        let mut state = self.state;
        let slide = state.contact.slide;
        while !states.is_full() {
            self.plain.step(&mut state, R::of(-APPROACH_S));
            if !self.velocity_band.lt(slide * state.velocity_rad_s) {
                break;
            }
            state.contact.slide = slide;
            let _ = states.push(state);
        }
        if states.is_empty() {
            let _ = states.push(self.state);
        }
        states
    }

    /// Where it is.
    pub fn motion(&self) -> Motion<R> {
        self.motion_of(&self.state, self.state.contact.slide)
    }

    /// 1 / (m·l² + I).
    pub fn inverse_inertia(&self) -> R {
        self.inverse_inertia
    }

    /// The reading in rad, and how it changes when the whole swing is shifted. Call it at each sample in turn.
    pub fn read(&mut self) -> (R, R) {
        let reading = self.model.read(&self.shifted(&self.state), &mut self.sensor);
        (reading.value, reading.slopes[0])
    }

    /// The state as of a pendulum whose whole swing is shifted.
    fn shifted(&self, state: &State<R>) -> State<Local<R>> {
        let mut state = constant(state);
        state.angle_rad = Local::variable(state.angle_rad.value, 0);
        state
    }

    /// Swings on for so many seconds and tells each piece of it.
    pub fn advance(&mut self, seconds: R, tell: &mut dyn FnMut(&Piece<R>)) {
        let mut end = self.state;
        self.plain.step(&mut end, seconds);
        let slides = self.state.contact.slide;
        if R::zero().lt(slides * end.contact.slide) {
            tell(&self.smooth_piece(&end, seconds));
            self.state = end;
        } else {
            self.advance_in_pieces(seconds, tell);
        }
    }

    #[inline(never)]
    fn advance_in_pieces(&mut self, seconds: R, tell: &mut dyn FnMut(&Piece<R>)) {
        let mut left_s = seconds;
        for _ in 0..MAX_CUTS {
            let before = seeded(&self.state);
            let mut end = before;
            let left = self.model.step_to_change(&mut end, Local::constant(left_s));
            let piece = self.piece(&before, &end, left, left_s - left.value);
            tell(&piece);
            if in_band(&end.contact) && !in_band(&before.contact) {
                self.entered = [end.angle_rad.value, end.time_s.value];
            }
            self.state = values(&end);
            left_s = left.value;
            if !R::zero().lt(left_s) {
                return;
            }
        }
    }

    /// A step that slides on to `end`.
    fn smooth_piece(&self, end: &State<R>, seconds: R) -> Piece<R> {
        let half = R::of(0.5);
        let before = self.state;
        let at = |angle_rad: R, velocity_rad_s: R, share: R| {
            let mut state = before;
            (state.angle_rad, state.velocity_rad_s) = (angle_rad, velocity_rad_s);
            state.time_s = before.time_s + share * seconds;
            state
        };
        let ends = [before, at(end.angle_rad, end.velocity_rad_s, R::one())];
        let [first, last] = ends.map(|state| self.changes(&state));
        let point = |state: &State<R>, (acceleration, _): (R, [R; 2])| Point {
            angle_rad: state.angle_rad,
            velocity_rad_s: state.velocity_rad_s,
            acceleration,
        };
        let way = Way { from: point(&ends[0], first), to: point(&ends[1], last), seconds };
        let (angle, velocity) = way.at(half);
        let changes = Changes([first.1, self.changes(&at(angle, velocity, half)).1, last.1]);
        let columns =
            [[R::one(), R::zero()], [R::zero(), R::one()]].map(|unit| changes.carry(R::zero(), seconds, unit));
        let slide = before.contact.slide;
        let place = |share: R| {
            let (angle, velocity) = way.at(share);
            let here = at(angle, velocity, share);
            let drive = self.motion_of(&here, slide);
            Place {
                from_here: changes.carry(share, seconds, [R::zero(), R::one()]),
                drive,
                friction: drive,
                acceleration: self.plain_acceleration(&here),
            }
        };
        Piece {
            seconds,
            whole: [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]],
            places: PLACES.map(|share| place(R::of(share))),
            ends: [self.motion_of(&before, slide), self.motion_of(end, slide)],
            moves: R::one(),
            rubs: R::one(),
            by_band: ([R::zero(); 2], R::zero()),
        }
    }

    /// The acceleration in a state, rad/s², and how it changes by angle and velocity.
    fn changes(&self, state: &State<R>) -> (R, [R; 2]) {
        if self.plain.is_plain() {
            let by_angle = -self.gravity_nm * state.angle_rad.cos() * self.inverse_inertia;
            return (self.plain_acceleration(state), [by_angle, -self.viscous * self.inverse_inertia]);
        }
        let state = seeded(state);
        let torque_nm =
            self.model.friction_torque_nm(&state) - Local::constant(self.gravity_nm) * state.angle_rad.sin();
        let acceleration = torque_nm * Local::constant(self.inverse_inertia);
        (acceleration.value, acceleration.slopes)
    }

    fn plain_acceleration(&self, state: &State<R>) -> R {
        (self.plain.friction_torque_nm(state) - self.gravity_nm * state.angle_rad.sin()) * self.inverse_inertia
    }

    fn piece(&self, before: &State<Local<R>>, end: &State<Local<R>>, left: Local<R>, seconds: R) -> Piece<R> {
        let contact = &before.contact;
        let slide = contact.slide.value;
        let whole = at_fixed_time(end, left, self.acceleration(end));
        let rubs = self.rubs(contact);
        Piece {
            seconds,
            whole,
            places: PLACES.map(|share| self.place(before, &whole, R::of(share) * seconds)),
            ends: [self.motion_of(&values(before), slide), self.motion_of(&values(end), slide)],
            moves: slide.abs() + contact.push.value.abs(),
            rubs,
            by_band: self.by_band(before, end, rubs),
        }
    }

    fn place(&self, before: &State<Local<R>>, whole: &Matrix<R>, seconds: R) -> Place<R> {
        let mut here = *before;
        self.model.step(&mut here, Local::constant(seconds));
        here.contact = before.contact;
        let drive = self.motion_of(&values(&here), before.contact.slide.value);
        Place {
            from_here: by_velocity(whole, &slopes(&here)),
            drive,
            friction: self.as_friction_sees_it(&before.contact, &drive),
            acceleration: self.acceleration(&here),
        }
    }

    fn rubs(&self, contact: &Contact<Local<R>>) -> R {
        let is_friction = in_band(contact) && self.stiction_nm.lt(contact.level_nm.value);
        if is_friction { R::one() } else { contact.slide.value.abs() }
    }

    /// In the band friction holds with what it had at the edge, where that is more than stiction.
    fn as_friction_sees_it(&self, contact: &Contact<Local<R>>, motion: &Motion<R>) -> Motion<R> {
        if !in_band(contact) {
            return *motion;
        }
        let ([angle_rad, time_s], push) = (self.entered, contact.push.value);
        Motion { angle_rad, velocity_rad_s: push * self.velocity_band, direction: push, time_s, ..*motion }
    }

    /// How the width of the band acts: where its edge is crossed, and by the friction at its edge.
    fn by_band(&self, before: &State<Local<R>>, end: &State<Local<R>>, rubs: R) -> ([R; 2], R) {
        let (push, slide) = (before.contact.push.value, before.contact.slide.value);
        let drag = -push * self.viscous * rubs;
        let edge = if in_band(&before.contact) { end.contact.slide.value } else { slide };
        let stays = !R::zero().lt((end.contact.slide.value - slide).abs());
        if stays || !R::zero().lt(edge.abs()) {
            return ([R::zero(); 2], drag);
        }
        let mut arriving = stripped(end);
        arriving.contact = before.contact;
        arriving.velocity_rad_s = Local::constant(edge * self.velocity_band);
        let arrives = self.acceleration(&arriving);
        if !R::zero().lt(self.velocity_band) {
            return ([R::zero(), self.by_narrow_band(slide, end, arrives)], drag);
        }
        let later = edge / arrives;
        if end.contact.is_resting() {
            return ([arriving.velocity_rad_s.value * later, R::zero()], drag);
        }
        ([R::zero(), (arrives - self.acceleration(end)) * later], drag)
    }

    /// A reversal without a band: what a narrow one would change. Between its edges the stop level acts.
    fn by_narrow_band(&self, slide: R, end: &State<Local<R>>, arrives: R) -> R {
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

    fn acceleration(&self, state: &State<Local<R>>) -> R {
        if state.contact.is_resting() { R::zero() } else { self.plain_acceleration(&values(state)) }
    }

    fn motion_of(&self, state: &State<R>, direction: R) -> Motion<R> {
        let State { angle_rad, velocity_rad_s, time_s, .. } = *state;
        Motion { angle_rad, velocity_rad_s, direction, time_s, pendulum: self.pendulum }
    }
}

fn in_band<R: Real<Mask = bool>>(contact: &Contact<Local<R>>) -> bool {
    contact.is_in_band()
}

/// The same state, its derivatives forgotten.
fn stripped<R: Real>(state: &State<Local<R>>) -> State<Local<R>> {
    constant(&values(state))
}

fn values<R: Real>(state: &State<Local<R>>) -> State<R> {
    State::from_numbers(&state.numbers().map(|number| number.value))
}

fn constant<R: Real>(state: &State<R>) -> State<Local<R>> {
    State::from_numbers(&state.numbers().map(Local::constant))
}

/// The same state as the beginning of a piece.
fn seeded<R: Real<Mask = bool>>(state: &State<R>) -> State<Local<R>> {
    let mut state = constant(state);
    state.angle_rad = Local::variable(state.angle_rad.value, 0);
    if !state.contact.is_resting() {
        state.velocity_rad_s = Local::variable(state.velocity_rad_s.value, 1);
    }
    state
}

fn slopes<R: Copy>(state: &State<Local<R>>) -> Matrix<R> {
    [state.angle_rad.slopes, state.velocity_rad_s.slopes]
}

/// The end's derivatives at the same time for all, where it comes earlier for some: what is left of the step says by
/// how much.
fn at_fixed_time<R: Real>(end: &State<Local<R>>, left: Local<R>, acceleration: R) -> Matrix<R> {
    let [angle, velocity] = slopes(end);
    let speed = end.velocity_rad_s.value;
    [
        core::array::from_fn(|i| angle[i] + speed * left.slopes[i]),
        core::array::from_fn(|i| velocity[i] + acceleration * left.slopes[i]),
    ]
}

/// The second column of `whole`·`here`⁻¹; zero at rest, where no velocity is gained.
fn by_velocity<R: Real<Mask = bool>>(whole: &Matrix<R>, here: &Matrix<R>) -> [R; 2] {
    let determinant = here[0][0] * here[1][1] - here[0][1] * here[1][0];
    if !R::zero().lt(determinant.abs()) {
        return [R::zero(); 2];
    }
    let [angle, velocity] = [-here[0][1] / determinant, here[0][0] / determinant];
    whole.map(|row| row[0] * angle + row[1] * velocity)
}
