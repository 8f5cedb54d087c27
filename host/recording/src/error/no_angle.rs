//! Why no column is the angle of a pendulum.

use thiserror::Error;

/// Why no column is the angle of a pendulum.
#[derive(Debug, Error)]
pub enum NoAngle {
    /// No angle.
    #[error("no angle column among {available}; name it with --columns theta=...{}", such_as(example.as_deref()))]
    NoColumn {
        /// Names or count of what there is.
        available: String,
        /// What could be told of this file, where a column moves.
        example: Option<String>,
    },
    /// Nothing but accelerations.
    #[error(
        "{available}: among them are accelerations, which can't be fitted, because they hold motion and gravity at once and \
         depend on where the sensor sits; record the gyroscope (angular velocity) too, or instead. If another column is \
         the angle, name it with --columns theta=..."
    )]
    OnlyAccelerations {
        /// Names or count of what there is.
        available: String,
    },
    /// Nothing but accelerations, and no names.
    #[error(
        "columns {columns} are in steps of {step} and together about as long as gravity, as accelerations in {unit} are (a \
         micro:bit's): they can't be fitted, because they hold motion and gravity at once; record an angle or a gyroscope \
         (angular velocity), or film it. If another column is the angle, name it with --columns theta=..."
    )]
    BareAccelerations {
        /// Their places.
        columns: String,
        /// What all of them are multiples of.
        step: f64,
        /// Of the step.
        unit: &'static str,
    },
    /// Axes of sensors, and no names.
    #[error(
        "columns {columns} stand in brackets, as the axes of an accelerometer, a gyroscope or a compass do, and nothing says which of \
         them is which: a gyroscope's are angular velocities, of which the one along the shaft can be fitted: --columns {example} (or \
         rad/s). If another column is the angle, name it with --columns theta=..."
    )]
    BareVectors {
        /// Their places.
        columns: String,
        /// What could be told of this file.
        example: String,
    },
    /// An angle that is none of the pendulum.
    #[error(
        "column {angle} is the direction of {a} and {b}, as computed from accelerations: on a pendulum that swings freely these \
         show the pull in its rod and hardly turn, however far it swings, so that this is not its angle; record a gyroscope \
         (angular velocity) or an angle, or film it. If it is the angle all the same, name it with --columns theta=..."
    )]
    Tilt {
        /// What messages call its column.
        angle: String,
        /// The one of the two.
        a: String,
        /// The other.
        b: String,
    },
    /// Nothing but periods and the like.
    #[error(
        "{available}: among them are durations, periods or what a light gate gives, which can't be fitted, because they tell nothing \
         of the motion in between; record the angle or the angular velocity through the swing. If another column is the \
         angle, name it with --columns theta=..."
    )]
    OnlyDurations {
        /// Names or count of what there is.
        available: String,
    },
    /// Nothing but volts or counts.
    #[error(
        "no angle column among {available}, but volts or counts, which are angles once it is told what one is worth: \
         --columns {example}:54.5deg (a volt is 54.5°) or --columns {example}:4096/turn (4096 counts a turn), and with \
         --zero what stands there while the pendulum hangs. If another column is the angle, name it with --columns theta=..."
    )]
    OnlyRaw {
        /// Names or count of what there is.
        available: String,
        /// What could be told of this file.
        example: String,
    },
    /// Volts or the like that by their name are a motor's, and something that it may move.
    #[error(
        "no angle column among {available}; by its name {drive} drives the pendulum, and {moved} may be its angle: \
         --columns {example}. If another column is the angle, name it with --columns theta=..."
    )]
    BesideDrive {
        /// Names or count of what there is.
        available: String,
        /// What messages call the drive.
        drive: String,
        /// The same of what it may move.
        moved: String,
        /// What could be told of this file.
        example: String,
    },
    /// One coordinate of a point.
    #[error(
        "{column} is one coordinate of a point and no angle; export x and y of it, or where it swings by less than 20° say \
         what one unit is worth, 57.3° over the pendulum's length in that unit: --columns {example}:0.19deg where it is \
         300 long. If another column is the angle, name it with --columns theta=..."
    )]
    OnlyX {
        /// The coordinate.
        column: String,
        /// What could be told of this file.
        example: String,
    },
    /// Nothing but an orientation as a quaternion.
    #[error(
        "no angle column among {available}, but an orientation as a quaternion, which is not read; log its angles (roll, \
         pitch, yaw) or the gyroscope too. If another column is the angle, name it with --columns theta=..."
    )]
    OnlyQuaternions {
        /// Names or count of what there is.
        available: String,
    },
    /// x, y and z that are no point's.
    #[error(
        "its x, y and z are no point that swings; if they are the axes of a gyroscope, name the one that moves, --columns \
         {example}"
    )]
    ThreeAxes {
        /// What could be told of this file.
        example: String,
    },
}

fn such_as(example: Option<&str>) -> String {
    example.map_or(String::new(), |example| format!(", e.g. {example}"))
}
