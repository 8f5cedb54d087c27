//! What was recorded, in words.

use super::{End, Taken};
use crate::error::Failure;

/// Is there a swing to learn from? Gives what is worth a warning.
///
/// # Errors
/// Anything but a usable swing, told together with what was kept.
pub fn usable(taken: &Taken) -> Result<Option<String>, Failure> {
    let kept = format!("{} samples are kept in {}", taken.n_samples, taken.path.display());
    match &taken.end {
        End::AtRest | End::TimeLimit if taken.is_usable() => Ok(None),
        End::AtRest | End::TimeLimit => {
            Err(Failure::failed(format!("the pendulum came to rest before it had swung twice; {kept}"))
                .next("release it from a larger angle, and let it swing freely"))
        }
        End::Stopped if taken.is_usable() => {
            Ok(Some(format!("stopped before the pendulum came to rest; the file is usable: {kept}")))
        }
        End::Stopped => Err(Failure::failed(format!("stopped before the pendulum had swung twice; {kept}"))
            .next("record again and let it swing to rest")),
        End::Disconnected { code, sensor } => Err(Failure::failed(format!(
            "the {} reads code {code}, an end of its range, since {:.1} s after the release; {kept}",
            sensor.name(),
            taken.swing_s
        ))
        .next(format!("{}; release from a smaller angle if it left its track", sensor.wires()))),
        End::Lost(error) => Err(Failure::failed(format!("{error}; {kept}")).next(error.next_step())),
    }
}

/// One swing in a sentence.
pub fn in_words(taken: &Taken) -> String {
    let lost = match taken.samples_lost {
        0 => "none lost".to_owned(),
        n_lost => format!("{n_lost} lost"),
    };
    format!(
        "wrote {}: released from {:.3} rad ({:.1}°), {:.1} s of swing, {} samples ({lost})",
        taken.path.display(),
        taken.release_rad,
        taken.release_rad.to_degrees(),
        taken.swing_s,
        taken.n_samples
    )
}
