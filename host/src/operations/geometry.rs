//! Is the geometry that a rig reports its own? A board whose flash is empty begins with the paper's pendulum, and beside
//! another one every torque that is found with it is wrong by the ratio of their m·g·l.

use super::watch::is_simulated;
use crate::error::Failure;
use crate::link::{LinkError, Session};
use shared::motion::Pendulum;
use shared::wire::StoreState;

/// How somebody's own geometry gets into a file.
const OWN: &str =
    "host init --mass KG --length M --inertia KG·M² (or --unknown-geometry) writes your own into rig.toml";

/// What to say where mass and length are those that a board begins with; nothing of a simulated rig, which has them.
///
/// # Errors
/// The link.
pub fn doubt(session: &mut Session) -> Result<Option<String>, LinkError> {
    if is_simulated(session.port()) || session.statistics()?.health.store == StoreState::Loaded {
        return Ok(None);
    }
    // What was pushed since the board started is not the board's own any more, though flash was empty then.
    let (Pendulum { mass_kg, length_m, .. }, paper) = (session.parameters()?.pendulum, Pendulum::<f32>::paper());
    let is_default = (mass_kg, length_m) == (paper.mass_kg, paper.length_m);
    Ok(is_default.then(|| {
        format!(
            "mass and length are those of the paper's pendulum ({mass_kg:.3} kg, {length_m:.3} m), because the board's \
             flash holds no model and no file was given: beside another pendulum every torque is wrong; {OWN}"
        )
    }))
}

/// A model that does not follow the swings, where its geometry was doubted before.
#[must_use]
pub fn explained(failure: Failure, doubt: Option<&str>) -> Failure {
    let Some(doubt) = doubt else { return failure };
    let next = failure.next_step().map_or(String::new(), |next| format!("; or {next}"));
    failure.next(format!("{doubt}{next}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{self, changed};
    use shared::parameters::Parameters;
    use shared::wire::{Answer, Frame};

    #[test]
    fn a_board_with_empty_flash_has_the_papers_pendulum_until_it_gets_another_one() {
        let mut session = changed::session(|frame| vec![frame]).unwrap();
        let said = doubt(&mut session).unwrap().unwrap();
        assert!(said.contains("paper's pendulum (0.147 kg, 0.156 m)") && said.contains("host init"), "{said}");
        let mut own = Parameters::paper();
        own.pendulum.mass_kg = 0.2;
        session.push(&own).unwrap();
        assert_eq!(doubt(&mut session).unwrap(), None);
    }

    #[test]
    fn what_a_board_has_in_its_flash_and_what_is_simulated_is_not_doubted() {
        let loaded = |mut frame| {
            if let Frame::Answer(_, Answer::Statistics(statistics)) = &mut frame {
                statistics.health.store = StoreState::Loaded;
            }
            vec![frame]
        };
        assert_eq!(doubt(&mut changed::session(loaded).unwrap()).unwrap(), None);
        assert_eq!(doubt(&mut link::connect("sim").unwrap()).unwrap(), None);
    }

    #[test]
    fn where_nothing_follows_the_geometry_is_asked_about_first() {
        let failure = || Failure::failed("the model does not follow").next("check the units");
        assert_eq!(explained(failure(), None), failure());
        assert_eq!(
            explained(failure(), Some("it is the paper's")).next_step(),
            Some("it is the paper's; or check the units")
        );
    }
}
