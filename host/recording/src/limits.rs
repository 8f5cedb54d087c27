//! What a recording may be at most and at least, and what its own format is called: errors name these too.

/// Fewer samples than this cannot show a swing: refused when read.
pub const MIN_SAMPLES: usize = 16;

/// The model's sine serves angles up to here: 1,500 turns.
pub(super) const LARGEST_RAD: f64 = 1e4;

/// More samples than a day's at 200 Hz, or ten hours' at 480 Hz, are not one swing.
pub const MOST_SAMPLES: usize = 17_280_000;

/// What must be in memory as a whole (archives, MATLAB files, UTF-16) has at most so many bytes.
pub(super) const MOST_BYTES_WHOLE: u64 = 256 << 20;

/// Angles of unstated unit beyond this are refused: a pendulum that only swings stays within a turn (2π), with margin.
pub(super) const LARGEST_UNSTATED_RAD: f64 = 7.0;

/// Steps of unstated unit beyond this are refused: at 2 Hz a laboratory pendulum cannot be followed.
pub(super) const LONGEST_STEP_S: f64 = 0.5;

/// What covers less than this share of the liveliest column hardly moves: the arm of a rotary pendulum that its motor
/// holds moves by 0.1 to 0.25 % of what the pendulum does. With half of it the softer one would be asked for; with twice
/// of it what shows a hundredth of a swing would be at rest.
pub(super) const HARDLY: f64 = 0.005;

/// The name in the `format` line.
pub const FORMAT_NAME: &str = "pendulum-recording";

/// The version this program writes, and the highest it reads.
pub const FORMAT_VERSION: u32 = 1;

/// A fall from upright ends with twice the angular frequency of small swings. The swings that are recorded may all be
/// large and so slow that the frequency seems less than half of it.
pub(super) const FASTEST_MARGIN: f64 = 3.0;
