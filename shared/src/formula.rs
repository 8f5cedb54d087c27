//! A custom formula: a torque that somebody typed, as a small program that board and PC both run.
//!
//! The PC reads the text ([`Formula`] carries it along) and makes postfix code of it, one byte an instruction. Before
//! a program is accepted, here as on the board, it is run once with the stack's height in place of numbers; behind
//! that point nothing can fail. Constants have 32 bits everywhere, so that both sides mean the same law.
//!
//! What the formula gives at standstill acts at rest too, like a spring. What motion adds to it opposes or drives
//! sliding only, like friction. Where it gives no number it counts as zero, and it never exceeds
//! [`MOST_TIMES_GRAVITY`] times m·g·l: a law that ran away must not take the observer with it.

use crate::limits::MAX_VALUES;
use crate::motion::Motion;
use crate::real::Real;
use heapless::Vec;

/// The most instructions of a program.
pub const MAX_CODE: usize = 48;

/// The most constants of a program.
pub const MAX_CONSTANTS: usize = 8;

/// The most numbers that wait for their operator; a power of two.
pub const STACK: usize = 8;

/// The most bytes of a formula's text.
pub const MAX_TEXT: usize = 120;

/// Head, code, constants of 32 bits, text.
pub const MAX_BYTES: usize = HEAD + MAX_CODE + 4 * MAX_CONSTANTS + MAX_TEXT;

/// The torque is cut at so many times m·g·l.
pub const MOST_TIMES_GRAVITY: f64 = 100.0;

/// Bytes before the code: lengths of code and constants, number of parameters with two flags.
const HEAD: usize = 3;

/// Flag: at standstill there is no torque, so all of it is friction.
const NOTHING_AT_REST: u8 = 0x10;

/// Flag: motion changes nothing, so all of it is there at rest.
const NOTHING_BY_MOTION: u8 = 0x20;

/// The number of parameters without the flags.
const COUNT: u8 = 0x0f;

/// Instructions: the kind in the upper four bits, which of them in the lower four.
pub mod code {
    /// Push θ.
    pub const THETA: u8 = 0x00;
    /// Push ω.
    pub const OMEGA: u8 = 0x01;
    /// Push the direction of sliding, sgn ω.
    pub const DIRECTION: u8 = 0x02;
    /// Push the force on the bearing along the rod.
    pub const LOAD: u8 = 0x03;
    /// Push the seconds since the release.
    pub const TIME: u8 = 0x04;
    /// Push a parameter: plus its position.
    pub const PARAMETER: u8 = 0x10;
    /// Push a constant: plus its position.
    pub const CONSTANT: u8 = 0x20;
    /// A whole power, by multiplication: plus the exponent, 2 … 15.
    pub const WHOLE_POWER: u8 = 0x30;
    /// The sum of two.
    pub const ADD: u8 = 0x40;
    /// The second last minus the last.
    pub const SUBTRACT: u8 = 0x41;
    /// The product of two.
    pub const MULTIPLY: u8 = 0x42;
    /// The second last by the last.
    pub const DIVIDE: u8 = 0x43;
    /// The second last, not negative, to the power of the last.
    pub const POWER: u8 = 0x44;
    /// The opposite.
    pub const NEGATE: u8 = 0x50;
    /// The absolute value.
    pub const ABS: u8 = 0x51;
    /// −1, 0 or +1.
    pub const SIGN: u8 = 0x52;
    /// The sine.
    pub const SINE: u8 = 0x53;
    /// The cosine.
    pub const COSINE: u8 = 0x54;
    /// The exponential.
    pub const EXP: u8 = 0x55;
    /// The square root; of no negative number.
    pub const ROOT: u8 = 0x56;
}

/// A program that passed its check, with its text.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Formula(Vec<u8, MAX_BYTES>);

impl Formula {
    /// Puts a program together; `None` unless it fits and passes the check of [`Formula::from_bytes`].
    pub fn new(code: &[u8], constants: &[f32], n_parameters: usize, text: &str) -> Option<Self> {
        if code.len() > MAX_CODE || constants.len() > MAX_CONSTANTS || n_parameters > MAX_VALUES {
            return None;
        }
        let mut bytes = Vec::<u8, MAX_BYTES>::new();
        let counted = n_parameters as u8 | flags(code);
        bytes.extend_from_slice(&[code.len() as u8, constants.len() as u8, counted]).ok()?;
        bytes.extend_from_slice(code).ok()?;
        constants.iter().try_for_each(|constant| bytes.extend_from_slice(&constant.to_le_bytes())).ok()?;
        bytes.extend_from_slice(text.as_bytes()).ok()?;
        Self::from_bytes(&bytes)
    }

    /// Takes what [`Formula::bytes`] gave: `None` where lengths, instructions, the stack's height or a constant make
    /// no program.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let [n_code, n_constants, n_parameters, rest @ ..] = bytes else { return None };
        let (n_code, n_constants) = (usize::from(*n_code), usize::from(*n_constants));
        let n_parameters = n_parameters & COUNT;
        let fits = n_code <= MAX_CODE && n_constants <= MAX_CONSTANTS && usize::from(n_parameters) <= MAX_VALUES;
        let (code, rest) = rest.split_at_checked(n_code).filter(|_| fits)?;
        let (constants, _) = rest.split_at_checked(4 * n_constants)?;
        let finite = numbers(constants).all(f32::is_finite);
        let sound = finite && is_sound(code, n_constants as u8, n_parameters);
        if sound { Vec::from_slice(bytes).ok().map(Self) } else { None }
    }

    /// For flash and messages, at most [`MAX_BYTES`].
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// The instructions.
    pub fn code(&self) -> &[u8] {
        self.parts().0
    }

    /// How many parameters it has.
    pub fn n_parameters(&self) -> usize {
        usize::from(self.counted() & COUNT)
    }

    /// What was typed.
    pub fn text(&self) -> &str {
        core::str::from_utf8(self.parts().2).unwrap_or("")
    }

    fn counted(&self) -> u8 {
        self.0.get(2).copied().unwrap_or(0)
    }

    /// Code, constants, text; they passed the check.
    fn parts(&self) -> (&[u8], &[u8], &[u8]) {
        let [n_code, n_constants, _, rest @ ..] = self.0.as_slice() else { return (&[], &[], &[]) };
        let (code, rest) = rest.split_at_checked(usize::from(*n_code)).unwrap_or((&[], &[]));
        let (constants, text) = rest.split_at_checked(4 * usize::from(*n_constants)).unwrap_or((&[], &[]));
        (code, constants, text)
    }
}

fn numbers(bytes: &[u8]) -> impl Iterator<Item = f32> {
    bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes))
}

/// Are all instructions known, does every one find its numbers, and is one number left at the end?
fn is_sound(code: &[u8], n_constants: u8, n_parameters: u8) -> bool {
    let mut height = 0;
    for instruction in code {
        let which = instruction & 15;
        let (known, takes) = match instruction >> 4 {
            0 => (which <= code::TIME, 0),
            1 => (which < n_parameters, 0),
            2 => (which < n_constants, 0),
            3 => (which >= 2, 1),
            4 => (which <= code::POWER & 15, 2),
            5 => (which <= code::ROOT & 15, 1),
            _ => (false, 0),
        };
        if !known || height < takes || height - takes >= STACK {
            return false;
        }
        height = height - takes + 1;
    }
    height == 1
}

/// What can be said of a law without running it; half the work is saved where one part is nothing.
fn flags(code: &[u8]) -> u8 {
    let moves = |instruction: &u8| matches!(*instruction, code::OMEGA | code::DIRECTION | code::LOAD);
    let by_motion = if code.iter().any(moves) { 0 } else { NOTHING_BY_MOTION };
    if is_zero_at_rest(code) { by_motion | NOTHING_AT_REST } else { by_motion }
}

/// Runs a program with "surely zero" in place of numbers, the pendulum standing still.
fn is_zero_at_rest(code: &[u8]) -> bool {
    let mut zeros = Vec::<bool, MAX_CODE>::new();
    for instruction in code {
        let result = match instruction >> 4 {
            0 => matches!(*instruction, code::OMEGA | code::DIRECTION),
            1 | 2 => false,
            4 => {
                let (last, before) = (zeros.pop() == Some(true), zeros.pop() == Some(true));
                match *instruction {
                    code::ADD | code::SUBTRACT => before && last,
                    code::MULTIPLY => before || last,
                    code::DIVIDE => before && !last,
                    _ => false,
                }
            }
            _ => {
                let keeps_zero = !matches!(*instruction, code::COSINE | code::EXP);
                zeros.pop() == Some(true) && keeps_zero
            }
        };
        let _ = zeros.push(result);
    }
    zeros.last() == Some(&true)
}

/// A formula ready to run in a number type.
#[derive(Clone, Debug)]
pub struct Program<R> {
    flags: u8,
    code: Vec<u8, MAX_CODE>,
    constants: [R; MAX_CONSTANTS],
}

impl<R: Real> Program<R> {
    /// Unpacks a formula.
    pub fn new(formula: &Formula) -> Self {
        let (code, bytes, _) = formula.parts();
        let mut constants = [R::zero(); MAX_CONSTANTS];
        for (slot, constant) in constants.iter_mut().zip(numbers(bytes)) {
            *slot = R::of(f64::from(constant));
        }
        // A formula is no longer than the longest program.
        Self { flags: formula.counted(), code: Vec::from_slice(code).unwrap_or_default(), constants }
    }

    /// The torque that acts at rest too, N·m: what the formula gives here at standstill.
    pub fn drive_nm(&self, motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
        if self.flags & NOTHING_AT_REST != 0 {
            return R::zero();
        }
        self.torque_nm(&Motion { velocity_rad_s: R::zero(), direction: R::zero(), ..*motion }, values)
    }

    /// The torque of sliding, N·m: what motion adds.
    pub fn friction_nm(&self, motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
        if self.flags & NOTHING_BY_MOTION != 0 {
            return R::zero();
        }
        self.torque_nm(motion, values) - self.drive_nm(motion, values)
    }

    /// The whole torque, N·m: a number, bounded.
    #[inline(never)]
    pub fn torque_nm(&self, motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
        let most = R::of(MOST_TIMES_GRAVITY) * motion.pendulum.gravity_torque_nm();
        let torque = self.raw_nm(motion, values);
        R::select(torque.is_number(), torque.min(most).max(-most), R::zero())
    }

    /// What the formula gives, be it a number or not.
    #[inline(always)]
    pub fn raw_nm(&self, motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
        let mut stack = [R::zero(); STACK];
        let mut height = 0_usize;
        for instruction in &self.code {
            let which = usize::from(instruction & 15);
            let last = stack[height.wrapping_sub(1) % STACK];
            let (takes, result) = match instruction >> 4 {
                0 => (0, variable(*instruction, motion)),
                1 => (0, values[which % MAX_VALUES]),
                2 => (0, self.constants[which % MAX_CONSTANTS]),
                3 => (1, (1..which).fold(last, |power, _| power * last)),
                4 => (2, of_two(*instruction, stack[height.wrapping_sub(2) % STACK], last)),
                _ => (1, of_one(*instruction, last)),
            };
            height = height.wrapping_sub(takes);
            stack[height % STACK] = result;
            height = height.wrapping_add(1);
        }
        stack[0]
    }
}

fn variable<R: Real>(instruction: u8, motion: &Motion<R>) -> R {
    match instruction {
        code::THETA => motion.angle_rad,
        code::OMEGA => motion.velocity_rad_s,
        code::DIRECTION => motion.direction,
        code::LOAD => motion.load_n(),
        _ => motion.time_s,
    }
}

fn of_two<R: Real>(instruction: u8, a: R, b: R) -> R {
    match instruction {
        code::ADD => a + b,
        code::SUBTRACT => a - b,
        code::MULTIPLY => a * b,
        code::DIVIDE => a / b,
        // A negative number has no power that is not whole; libm's would have some.
        _ => R::select(a.lt(R::zero()), R::of(f64::NAN), a.abs().powf(b)),
    }
}

fn of_one<R: Real>(instruction: u8, a: R) -> R {
    match instruction {
        code::NEGATE => -a,
        code::ABS => a.abs(),
        code::SIGN => a.sign(),
        code::SINE => a.sin(),
        code::COSINE => a.cos(),
        code::EXP => a.exp(),
        _ => a.sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::tests_support::motion_at;

    /// −k·ω·|ω|^p
    const DRAG: [u8; 7] =
        [code::PARAMETER, code::NEGATE, code::OMEGA, code::MULTIPLY, code::OMEGA, code::ABS, code::PARAMETER + 1];

    fn drag() -> Formula {
        let code = [&DRAG[..], &[code::POWER, code::MULTIPLY]].concat();
        Formula::new(&code, &[], 2, "torque = -k * omega * abs(omega)^p; k in 0..1; p in 0..3").unwrap()
    }

    #[test]
    fn a_program_computes_its_law() {
        let program = Program::<f64>::new(&drag());
        let torque = program.torque_nm(&motion_at(0.3, -2.0, 0.0), &[1e-4, 1.5, 0.0, 0.0]);
        assert!((torque - 1e-4 * libm::pow(2.0, 2.5)).abs() < 1e-18, "{torque}");
    }

    #[test]
    fn each_constant_has_its_place() {
        let code = [code::CONSTANT, code::CONSTANT + 1, code::DIVIDE, code::THETA, code::MULTIPLY];
        let program = Program::<f64>::new(&Formula::new(&code, &[3.0, 8.0], 0, "").unwrap());
        assert_eq!(program.torque_nm(&motion_at(0.4, 0.0, 0.0), &[0.0; 4]), 3.0 / 8.0 * 0.4);
    }

    /// −(k·θ + c·ω): a spring that acts at rest too, and friction that does not.
    #[test]
    fn what_acts_at_standstill_drives_and_what_motion_adds_is_friction() {
        let spring = [code::PARAMETER, code::THETA, code::MULTIPLY];
        let drag = [code::PARAMETER + 1, code::OMEGA, code::MULTIPLY];
        let code = [&spring[..], &drag, &[code::ADD, code::NEGATE]].concat();
        let program = Program::<f64>::new(&Formula::new(&code, &[], 2, "").unwrap());
        let (motion, values) = (motion_at(0.3, -2.0, 0.0), [1e-3, 1e-4, 0.0, 0.0]);
        assert!((program.drive_nm(&motion, &values) + 3e-4).abs() < 1e-18);
        assert!((program.friction_nm(&motion, &values) - 2e-4).abs() < 1e-18);
    }

    #[test]
    fn bytes_come_back_with_their_text() {
        let formula = drag();
        assert_eq!(Formula::from_bytes(formula.bytes()), Some(formula.clone()));
        assert!(formula.text().starts_with("torque = -k"));
        assert_eq!(formula.n_parameters(), 2);
    }

    #[test]
    fn what_is_no_program_is_refused() {
        let refused = |code: &[u8], constants: &[f32], n_parameters| {
            assert_eq!(Formula::new(code, constants, n_parameters, ""), None, "{code:x?}");
        };
        refused(&[], &[], 0);
        refused(&[code::THETA, code::THETA], &[], 0);
        refused(&[code::ADD], &[], 0);
        refused(&[code::THETA, code::ADD], &[], 0);
        refused(&[code::PARAMETER], &[], 0);
        refused(&[code::CONSTANT + 1], &[1.0], 0);
        refused(&[code::CONSTANT], &[f32::NAN], 0);
        refused(&[code::CONSTANT], &[f32::INFINITY], 0);
        refused(&[code::THETA, code::WHOLE_POWER + 1], &[], 0);
        refused(&[code::THETA, code::THETA, code::POWER + 1], &[], 0);
        refused(&[code::THETA, code::ROOT + 1], &[], 0);
        refused(&[0xff], &[], 0);
        refused(&[code::THETA; MAX_CODE + 1], &[], 0);
        let too_high = [[code::THETA; STACK + 1].as_slice(), &[code::ADD; STACK]].concat();
        refused(&too_high, &[], 0);
        let as_high_as_can_be = [[code::THETA; STACK].as_slice(), &[code::ADD; STACK - 1]].concat();
        assert!(Formula::new(&as_high_as_can_be, &[], 0, "").is_some());
    }

    #[test]
    fn what_is_there_at_standstill_drives_and_the_rest_is_friction() {
        // −θ − sgn ω
        let code = [code::THETA, code::NEGATE, code::DIRECTION, code::SUBTRACT];
        let program = Program::<f64>::new(&Formula::new(&code, &[], 0, "").unwrap());
        let motion = motion_at(0.2, 3.0, 0.0);
        assert_eq!((program.drive_nm(&motion, &[0.0; 4]), program.friction_nm(&motion, &[0.0; 4])), (-0.2, -1.0));
    }

    #[test]
    fn what_a_law_lacks_is_known_before_it_runs() {
        use code::{ADD, COSINE, DIRECTION, LOAD, MULTIPLY, OMEGA, THETA};
        let cases: [(&[u8], u8); 5] = [
            (&[THETA], NOTHING_BY_MOTION),
            (&[OMEGA, THETA, MULTIPLY], NOTHING_AT_REST),
            (&[LOAD, DIRECTION, MULTIPLY], NOTHING_AT_REST),
            (&[OMEGA, COSINE, THETA, MULTIPLY], 0),
            (&[OMEGA, THETA, ADD], 0),
        ];
        cases.iter().for_each(|(law, expected)| assert_eq!(flags(law), *expected, "{law:x?}"));
    }

    #[test]
    fn no_division_and_no_overflow_leaves_the_bounds() {
        let laws: [&[u8]; 4] = [
            &[code::OMEGA, code::THETA, code::DIVIDE],
            &[code::OMEGA, code::OMEGA, code::DIVIDE],
            &[code::OMEGA, code::WHOLE_POWER + 15, code::WHOLE_POWER + 15, code::WHOLE_POWER + 15],
            &[code::OMEGA, code::OMEGA, code::POWER],
        ];
        let most = MOST_TIMES_GRAVITY * motion_at(0.0, 0.0, 0.0).pendulum.gravity_torque_nm();
        for law in laws {
            let program = Program::<f64>::new(&Formula::new(law, &[], 0, "").unwrap());
            for velocity in [0.0, 1e9, -1e9, -0.5, f64::INFINITY, f64::NAN] {
                let torque = program.torque_nm(&motion_at(0.0, velocity, 0.0), &[0.0; 4]);
                assert!(torque.abs() <= most, "{law:x?} at {velocity}: {torque}");
            }
        }
    }

    proptest::proptest! {
        #[test]
        fn any_bytes_are_refused_or_run(bytes: std::vec::Vec<u8>, angle: f64, velocity: f64) {
            if let Some(formula) = Formula::from_bytes(&bytes) {
                let program = Program::<f64>::new(&formula);
                let torque = program.torque_nm(&motion_at(angle, velocity, 1.0), &[1.0, -2.0, 0.5, 1e9]);
                proptest::prop_assert!(torque.is_finite());
            }
        }
    }
}
