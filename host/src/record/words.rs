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
        End::AtRest => Err(Failure::failed(format!("the pendulum came to rest before it had swung twice; {kept}"))
            .next("release it from a larger angle, let it swing freely, and record it under another name")),
        End::TimeLimit => Err(Failure::failed(format!("the time was up before the pendulum had swung twice; {kept}"))
            .next("record again under another name, and longer: --limit SECONDS gives more time")),
        End::Stopped if taken.is_usable() => {
            Ok(Some(format!("stopped before the pendulum came to rest; the file is usable: {kept}")))
        }
        End::Stopped => Err(Failure::interrupted(format!("stopped before the pendulum had swung twice; {kept}"))
            .next("record again under another name, and let it swing to rest")),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::LinkError;

    fn taken(n_passages: u32, end: End) -> Taken {
        let path = "swing.csv".into();
        let (n_samples, release_rad, swing_s, frames_lost, samples_lost) = (1234, -0.5, 20.5, 0, 0);
        Taken { path, n_samples, release_rad, n_passages, swing_s, frames_lost, samples_lost, end }
    }

    #[test]
    fn two_whole_swings_are_usable_and_what_ended_them_early_is_told() {
        for end in [End::AtRest, End::TimeLimit] {
            assert_eq!(usable(&taken(4, end)).unwrap(), None);
        }
        let stopped = usable(&taken(4, End::Stopped)).unwrap().unwrap();
        assert!(stopped.contains("usable") && stopped.contains("1234 samples are kept in swing.csv"), "{stopped}");
        for end in [End::AtRest, End::TimeLimit, End::Stopped] {
            let refused = usable(&taken(3, end)).unwrap_err();
            assert!(refused.what().contains("swung twice; 1234 samples are kept in swing.csv"), "{}", refused.what());
        }
        let [at_rest, time_limit, stopped] =
            [End::AtRest, End::TimeLimit, End::Stopped].map(|end| usable(&taken(3, end)).unwrap_err());
        assert!(at_rest.what().starts_with("the pendulum came to rest"), "{}", at_rest.what());
        assert!(time_limit.what().starts_with("the time was up") && time_limit.to_string().contains("--limit"));
        assert_eq!([at_rest, time_limit, stopped].map(|failure| failure.exit_code()), [1, 1, 130]);
        let lost = usable(&taken(9, End::Lost(LinkError::StreamStopped { port: "COM3".to_owned() }))).unwrap_err();
        assert!(lost.what().contains("COM3") && lost.what().contains("are kept"), "{}", lost.what());
    }

    #[test]
    fn a_swing_is_told_in_a_sentence() {
        let mut swing = taken(9, End::AtRest);
        // 0.5 rad are 28.65°.
        let whole = "wrote swing.csv: released from -0.500 rad (-28.6°), 20.5 s of swing, 1234 samples (none lost)";
        assert_eq!(in_words(&swing), whole);
        swing.samples_lost = 7;
        assert!(in_words(&swing).ends_with("1234 samples (7 lost)"));
    }
}
