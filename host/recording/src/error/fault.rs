//! What is wrong with the content of a recording.

use super::growth::growth_in_words;
use super::no_angle::NoAngle;
use crate::columns::ColumnsError;
use crate::limits::{
    FORMAT_NAME, FORMAT_VERSION, LARGEST_RAD, LARGEST_UNSTATED_RAD, LONGEST_STEP_S, MIN_SAMPLES, MOST_SAMPLES,
};
use crate::number::significant;
use crate::told::Told;
use crate::units;
use thiserror::Error;

/// More rows of one time are no clock of few digits, which has some dozens in a tick.
const CLOCK_STOPS: usize = 50;

/// That the origin may be the pivot.
fn origin_in_words(off_percent: Option<f64>) -> String {
    off_percent.map_or(String::new(), |off| {
        format!(
            "; if it is the origin of x and y, from which all points are equally far within {off:.1} %, say --pivot 0,0"
        )
    })
}

fn cure_of_repeats(n_rows: usize, has_digits: bool) -> &'static str {
    match has_digits {
        _ if n_rows > CLOCK_STOPS => "its clock stopped: leave those rows out",
        true => "it was read before it went on: leave out the second of two such rows",
        false => "export more digits of the time",
    }
}

/// What is wrong with the content of a recording.
#[derive(Debug, Error)]
pub enum Fault {
    /// No such file.
    #[error("there is no such file; check the path")]
    Missing,
    /// A folder was named.
    #[error("this is a directory; name a CSV file inside it")]
    Directory,
    /// The system refused.
    #[error("the system refused to read it ({0}); check the permissions")]
    Unreadable(#[source] std::io::Error),
    /// Zero bytes or only white space.
    #[error("the file is empty; expected rows of time and angle")]
    Empty,
    /// Bytes that are no text.
    #[error(
        "this is not text (byte {byte:#04x} at position {position}); expected a CSV file, so export it as CSV first"
    )]
    NotText {
        /// The offending byte.
        byte: u8,
        /// Its place, counted from 0.
        position: usize,
    },
    /// A model in place of a recording.
    #[error("this is the file of a model, no recording; give it with --rig, and recordings in its place")]
    ModelFile,
    /// No row of numbers.
    #[error("no row of numbers in {n_lines} lines; expected rows such as 0.005,1.234 for time and angle")]
    NoNumbers {
        /// Lines in the file.
        n_lines: usize,
    },
    /// Too short to be of use.
    #[error("only {n_found} samples; expected at least {MIN_SAMPLES}, so record at least two swings")]
    TooFewSamples {
        /// Samples found.
        n_found: usize,
    },
    /// Text, nothing, NaN or infinity where a number belongs.
    #[error(
        "{place}, column {column}: \"{value}\" is not a finite number; correct or delete that row (an empty cell is a gap), \
         or choose other columns with --columns"
    )]
    NotANumber {
        /// Line or sample.
        place: String,
        /// Name or number of the column.
        column: String,
        /// What stands there.
        value: String,
    },
    /// A row with too few fields.
    #[error("line {line} has {n_found} fields, but column {column} is needed; complete or delete that row")]
    ShortRow {
        /// Line, counted from 1.
        line: usize,
        /// Fields found.
        n_found: usize,
        /// The column that is not there.
        column: String,
    },
    /// A column was asked for that the file lacks.
    #[error("there is no column {wanted}; the file has {available}: choose with --columns, e.g. {example}")]
    UnknownColumn {
        /// As the user wrote it.
        wanted: String,
        /// Names or count of what there is.
        available: String,
        /// What could be told of this file.
        example: String,
    },
    /// Several columns could be meant.
    #[error("several columns could be the {role}: {candidates}; choose with --columns, e.g. {example}")]
    AmbiguousColumn {
        /// "time" or "angle".
        role: &'static str,
        /// The names in question.
        candidates: String,
        /// What could be told of this file.
        example: String,
    },
    /// Time and readings are of two recordings that stand side by side.
    #[error(
        "{time} and {reading} are of recordings side by side, of which one is longer: in {n_rows} rows only one of them goes on; \
         the times that stand before {reading} go as far as that: choose --columns {cure}"
    )]
    SideBySide {
        /// The column of times that was told.
        time: String,
        /// The column of readings.
        reading: String,
        /// What to tell of this file.
        cure: String,
        /// Rows that have one of them.
        n_rows: usize,
    },
    /// The column is there, and always the same.
    #[error(
        "column {column} does not move: {value} throughout; choose another one with --columns, e.g. {example}, or x and y \
         of a point (the file has {available})"
    )]
    NothingMoves {
        /// Name or number of the column.
        column: String,
        /// What always stands there.
        value: f64,
        /// Names or count of what there is.
        available: String,
        /// What could be told of this file.
        example: String,
    },
    /// Rows in the order of the angle.
    #[error(
        "the rows seem to be sorted by column {by}: put in order, the numbers of column {time} go on evenly, as a time does; sort the \
         rows by column {time}, and if it is not the time after all name the one that is, --columns t=..."
    )]
    SortedByReading {
        /// The column that goes on evenly.
        time: usize,
        /// The column that rises.
        by: usize,
    },
    /// It does not swing freely.
    #[error(
        "column {angle} stays about {value}, which is what {target} says throughout: a controller holds it there by its motor, and \
         gravity alone does not swing it; record how it swings with the motor off. If nothing holds it, say --columns {}",
        told.angle("", "")
    )]
    Held {
        /// What messages call the column of the angle.
        angle: String,
        /// The column of the set point.
        target: String,
        /// What stands there.
        value: f64,
        /// The columns.
        told: Told,
    },
    /// What drives a motor, and neither an angle nor a place.
    #[error(
        "column {column} has no more than {n} values throughout, as what a motor is told, and is neither an angle nor x of a point; \
         choose another one with --columns, e.g. {example}"
    )]
    FewLevels {
        /// Name or number of the column.
        column: String,
        /// As many as are few.
        n: usize,
        /// What could be told of this file.
        example: String,
    },
    /// Whole numbers that count rows.
    #[error(
        "nothing states the unit of the time, whose steps are the same whole number throughout, and in {unit} it would swing there \
         and back in {period_s:.1} s: it seems to count frames or samples; say how many rows a second there are, --rate 30, or \
         the unit if it has one, --columns {}",
        told.with_time(":ms")
    )]
    CountsRows {
        /// The unit that fits best.
        unit: &'static str,
        /// Its period then.
        period_s: f64,
        /// The columns.
        told: Told,
    },
    /// No time and no rate.
    #[error("no time column among {available}; name it with --columns t=..., or give the sampling rate with --rate")]
    NoTimeColumn {
        /// Names or count of what there is.
        available: String,
    },
    /// More columns than a table has.
    #[error("line {line} has {n_columns} columns; expected a row of time and angle for each sample")]
    TooWide {
        /// Counted from 1.
        line: usize,
        /// Its fields.
        n_columns: usize,
    },
    /// The same time twice with different angles.
    #[error(
        "{place}: time {time}{unit} stands there {}, expected it to increase; {}, or ignore the time column with \
         --rate",
        if *n_rows > CLOCK_STOPS { format!("{n_rows} times in a row") } else { "twice".to_owned() },
        cure_of_repeats(*n_rows, *has_digits)
    )]
    TimeRepeats {
        /// Line or sample.
        place: String,
        /// The repeated time.
        time: f64,
        /// Its unit behind a space; nothing where it is not stated and can't be seconds.
        unit: &'static str,
        /// Rows in a row that have it.
        n_rows: usize,
        /// Would the digits that stand there tell the rows apart?
        has_digits: bool,
    },
    /// Time runs backwards.
    #[error(
        "{place}: time goes back from {before}{unit} to {after}{unit}, expected it to increase; if two recordings were \
         joined, split the file there, else sort it or ignore the time column with --rate"
    )]
    TimeBackwards {
        /// Line or sample.
        place: String,
        /// Time of the row before.
        before: f64,
        /// Time of this row.
        after: f64,
        /// As above.
        unit: &'static str,
    },
    /// Angles too large for radians, unit not stated.
    #[error(
        "angles reach {largest}, expected at most {limit} rad for a pendulum; if they are degrees say --degrees, if they are \
         counts or volts say what one is worth, --columns {} or theta={}:54.5deg, if they are a distance (cm, mm) say what one of \
         it is worth, 57.3° over the pendulum's length in that unit, where it swings by less than 20°, if it really turned over \
         say --radians",
        told.angle("", ":4096/turn"),
        told.reading,
        largest = *largest as f32,
        limit = LARGEST_UNSTATED_RAD
    )]
    LooksLikeDegrees {
        /// Largest magnitude in the column.
        largest: f64,
        /// The columns.
        told: Told,
    },
    /// No pendulum turns so often.
    #[error("angles reach {largest:e} rad, expected at most {LARGEST_RAD:e}; check the column and its unit")]
    TooManyTurns {
        /// Largest magnitude, rad.
        largest: f64,
    },
    /// Steps too long for seconds, unit not stated.
    #[error(
        "the median time step is {step} s, expected less than {limit} s for a pendulum; if the column counts {unit}, \
         say so: --columns {}; if it is not the time, name the one that is, t=...; if it counts frames, say how many a second: --rate 30",
        told.with_time(units::finer(*step).1),
        unit = units::finer(*step).0,
        step = *step as f32,
        limit = LONGEST_STEP_S
    )]
    StepTooLong {
        /// Median step as read, s.
        step: f64,
        /// The columns.
        told: Told,
    },
    /// A rate that is no rate.
    #[error("sampling rate {rate_hz} Hz is not possible; expected a positive number such as 200")]
    BadRate {
        /// As given.
        rate_hz: f64,
    },
    /// A header value that does not parse.
    #[error("line {line}: {key} is \"{value}\", expected {expected}; correct that header line")]
    HeaderValue {
        /// Line, counted from 1.
        line: usize,
        /// The key.
        key: String,
        /// What stands there.
        value: String,
        /// What should.
        expected: &'static str,
    },
    /// Written by a later program.
    #[error(
        "line {line}: format {FORMAT_NAME} {version}, this program knows up to {FORMAT_VERSION}; \
         update the program"
    )]
    NewerFormat {
        /// Line, counted from 1.
        line: usize,
        /// Version found.
        version: u32,
    },
    /// Codes without a calibration.
    #[error(
        "only converter codes and no calibration; add header lines such as \"# zero_code: 2048\" and \
         \"# radians_per_code: 0.00144874\""
    )]
    NoCalibration,
    /// A code that is no code.
    #[error("line {line}: converter code \"{value}\" is not a whole number from 0 to 65535; correct that row")]
    BadCode {
        /// Line, counted from 1.
        line: usize,
        /// What stands there.
        value: String,
    },
    /// A format of another program that is not read as it is.
    #[error("this is a {format}: {problem}")]
    Foreign {
        /// What it is.
        format: &'static str,
        /// What is in the way, and what to do.
        problem: String,
    },
    /// Decimal commas between commas.
    #[error(
        "the rows have twice as many fields as there are names: commas stand for decimals and between columns; \
         export it with semicolons or tabs between the columns, or with decimal points"
    )]
    BareCommas,
    /// Thousands marks after numbers that would have to be read anew.
    #[error(
        "line {line}: \"{value}\" has a mark for thousands, but the same mark was read as the decimal one before; \
         export the file without marks for thousands"
    )]
    ThousandsTooLate {
        /// Line, counted from 1.
        line: usize,
        /// What stands there.
        value: String,
    },
    /// Rates that no pendulum of this period reaches, or with which its period would grow.
    #[error("read in rad/s the rates reach {largest:.1}, but {against}: {instead}")]
    NotRadiansPerSecond {
        /// As read, rad/s.
        largest: f64,
        /// What speaks against them.
        against: String,
        /// What they may be, and what to say then.
        instead: String,
    },
    /// Rates far too small for how the period grows with them.
    #[error(
        "read in {unit} the rates reach {largest_rad_s:.4} rad/s, but the period grows with the amplitude as it does for rates \
         {factor:.0} times as large: these are radians a second; say --columns {}, or --degrees if they are degrees all \
         the same",
        told.rate(":rad/s")
    )]
    NotDegreesPerSecond {
        /// The unit as stated.
        unit: &'static str,
        /// As read, rad/s.
        largest_rad_s: f64,
        /// How many times too small.
        factor: f64,
        /// The columns.
        told: Told,
    },
    /// More than one swing can be.
    #[error(
        "more than {} samples, which is more than a free swing has; cut the file, or thin it to 1000 samples a second",
        MOST_SAMPLES
    )]
    TooManySamples,
    /// More bytes than any recording has.
    #[error("the file is too large: a table may have 4 GB, any other format 256 MB, a line 1 MB; cut it into parts")]
    TooLarge,
    /// A swing too fast or too slow for the unit of time that was assumed.
    #[error(
        "it swings there and back in {} s; expected {shortest_s} to {longest_s} s for a pendulum, so {}",
        significant(*period_s, 4),
        told.explains_period(*is_told)
    )]
    ImpossiblePeriod {
        /// As read, s.
        period_s: f64,
        /// Limits, s.
        shortest_s: f64,
        /// Limits, s.
        longest_s: f64,
        /// The columns.
        told: Told,
        /// Did somebody say the unit of the time?
        is_told: bool,
    },
    /// The period does not depend on the amplitude as it would if the angles were radians.
    #[error(
        "read as radians the angles reach {largest_rad:.3}, and {}: these are degrees (say --degrees), angular velocities \
         (say --columns {}) or in another unit (--columns {}), or a spring swings it and no gravity, as in a torsion \
         pendulum, which can't be fitted; if they are radians all the same, say --radians",
        growth_in_words(*predicted_percent, *found_percent),
        told.rate(":rad/s"),
        told.angle("", ":mrad")
    )]
    NotRadians {
        /// Largest angle as read, rad.
        largest_rad: f64,
        /// By the pendulum's law, percent.
        predicted_percent: f64,
        /// As measured, percent.
        found_percent: f64,
        /// The columns.
        told: Told,
    },
    /// The period depends on the amplitude as it would for angles many times as large.
    #[error(
        "read in {unit} the angles reach {largest_rad:.4} rad, but the period grows with the amplitude as it does for \
         angles {factor:.0} times as large: these are radians; say --radians, or --degrees if they are degrees all the same"
    )]
    NotDegrees {
        /// The unit as stated.
        unit: &'static str,
        /// Largest angle as read, rad.
        largest_rad: f64,
        /// How many times too small.
        factor: f64,
    },
    /// x and y that lie on no circle.
    #[error(
        "x and y lie {off_percent:.1} % of the radius off a circle; expected a point on the pendulum: film square to the \
         plane of the swing and from far away, or choose other columns with --columns t=0,x=1,y=2"
    )]
    NoCircle {
        /// Typical distance from the circle, percent of the radius.
        off_percent: f64,
    },
    /// An arc too short to tell where the pivot is.
    #[error(
        "x and y cover too short an arc to tell where the pivot is: its distance is known to {spread_percent:.0} % only; say \
         where it is, --pivot X,Y in the units of the file, or release from a larger angle{}",
        origin_in_words(*off_origin_percent)
    )]
    ShortArc {
        /// Standard deviation of the radius, percent.
        spread_percent: f64,
        /// How far the points are off a circle about the origin of x and y, percent of its radius, where that may be the pivot.
        off_origin_percent: Option<f64>,
    },
    /// Columns without names that move like x and y of a point, whose angle can't be told.
    #[error(
        "columns {x} and {y} move like x and y of a point, and {fault}. If column {x} is the angle, say --columns {}",
        told.angle("", "")
    )]
    SeemsPoint {
        /// Column of x.
        x: usize,
        /// Column of y.
        y: usize,
        /// What is wrong with them.
        fault: Box<Self>,
        /// The columns.
        told: Told,
    },
    /// More runs than the one that was asked for.
    #[error("the file holds {n} runs ({runs}), expected one here; choose one with --run {example}")]
    SeveralRuns {
        /// How many.
        n: usize,
        /// Their names and lengths.
        runs: String,
        /// The second one.
        example: String,
    },
    /// Two of our own files in one.
    #[error(
        "line {line}: the names of the columns stand there again, expected another sample; two recordings were joined: \
         split the file there, and give both"
    )]
    Joined {
        /// Counted from 1.
        line: usize,
    },
    /// Rows of several runs, or of several sensors, in turn.
    #[error("the rows of several runs or sensors stand there in turn ({by}: {runs}); choose one with --run {example}")]
    RunsInTurn {
        /// What names them.
        by: String,
        /// Their names.
        runs: String,
        /// The first one.
        example: String,
    },
    /// A run that is not there.
    #[error(
        "there is no run {wanted}: the file holds {there}; choose one by its name or its number with --run, or leave --run out"
    )]
    NoSuchRun {
        /// As written.
        wanted: String,
        /// How many there are, and what they are called.
        there: String,
    },
    /// No column is the angle.
    #[error(transparent)]
    NoAngle(#[from] NoAngle),
    /// `--columns` could not be understood.
    #[error(transparent)]
    Columns(#[from] ColumnsError),
    /// Samples handed over with different lengths.
    #[error("{n_times} times, {n_angles} angles and {n_codes} codes; expected the same number of each")]
    LengthsDiffer {
        /// Times.
        n_times: usize,
        /// Angles.
        n_angles: usize,
        /// Codes.
        n_codes: usize,
    },
}
