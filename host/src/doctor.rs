//! Is everything well between the pendulum and this program? One finding a question, each with what to do next.
//!
//! In: a port (or none) and perhaps a model file. Out: findings. Nothing on the rig is changed.

mod board;
mod model;
mod signal;
mod system;

pub use signal::Signal;
pub use system::UDEV_RULE;

use crate::link::{self, LinkError, SIMULATED, Session};
use crate::rigfile::RigFile;
use serde::Serialize;
use serialport::SerialPortInfo;

/// The answer to one question.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What was looked at.
    pub what: &'static str,
    /// Is it as it should be?
    pub ok: bool,
    /// What was found.
    pub found: String,
    /// What to do, if there is something to do.
    pub next: Option<String>,
}

impl Finding {
    fn ok(what: &'static str, found: impl Into<String>) -> Self {
        Self { what, ok: true, found: found.into(), next: None }
    }

    fn look(what: &'static str, found: impl Into<String>, next: impl Into<String>) -> Self {
        Self { what, ok: false, found: found.into(), next: Some(next.into()) }
    }

    /// As it should be if there is no reason to look.
    fn of(what: &'static str, found: impl Into<String>, complaint: Option<&str>) -> Self {
        match complaint {
            None => Self::ok(what, found),
            Some(next) => Self::look(what, found, next),
        }
    }
}

/// Everything that was found.
#[derive(Clone, Debug, Serialize)]
pub struct Checkup {
    /// The port that was looked at.
    pub port: Option<String>,
    /// Is everything as it should be?
    pub healthy: bool,
    /// In the order from the plug to the model.
    pub findings: Vec<Finding>,
}

/// Looks at the computer, the port, the board, its signal and its model. Without a port the only USB serial port is
/// taken, if there is exactly one. `listens` is called before a board is listened to for some seconds.
pub fn examine(port: Option<&str>, model: Option<&RigFile>, listens: &dyn Fn()) -> Checkup {
    let ports = system::ports();
    let port = chosen(port, &ports);
    let mut findings = match &port {
        Some(name) if is_simulated(name) => vec![Finding::ok("serial port", "none needed for the simulated rig")],
        _ => system::look(&ports, port.as_deref()),
    };
    if let Some(name) = &port {
        match link::connect(name) {
            Err(error) => findings.push(unreachable(&error)),
            Ok(mut session) => {
                if !is_simulated(name) {
                    listens();
                }
                findings.extend(of_rig(&mut session, model));
            }
        }
    }
    let healthy = findings.iter().all(|finding| finding.ok);
    Checkup { port, healthy, findings }
}

fn chosen(named: Option<&str>, ports: &[SerialPortInfo]) -> Option<String> {
    named.map(str::to_owned).or_else(|| system::only_rig(ports))
}

fn is_simulated(port: &str) -> bool {
    port.split(':').next() == Some(SIMULATED)
}

fn unreachable(error: &LinkError) -> Finding {
    let what = if matches!(error, LinkError::NoPermission { .. }) { "permission" } else { "rig" };
    let mut finding = Finding::look(what, error.to_string(), error.next_step());
    if what == "permission" {
        finding.next = Some(format!("{}\n{}", system::HOW_TO_ALLOW, UDEV_RULE.trim_end()));
    }
    finding
}

fn of_rig(session: &mut Session, model: Option<&RigFile>) -> Vec<Finding> {
    let mut findings = vec![board::greeting(session)];
    let rest = (|| -> Result<Vec<Finding>, LinkError> {
        let settings = session.settings()?;
        let signal = Signal::listen(session, &settings)?;
        let mut found = vec![board::effects(session)];
        found.extend(board::health(&session.statistics()?));
        if let Some(chip) = session.chip()? {
            found.extend(board::chip(&chip, settings.rate_hz));
        }
        found.extend(signal.findings(&settings));
        found.push(model::calibration(&settings.sensor));
        let parameters = session.parameters()?;
        found.extend(model::zero(&signal, &settings.sensor, &parameters.map(f64::from)));
        found.extend(model::parameters(&parameters, &settings.sensor, model));
        Ok(found)
    })();
    match rest {
        Ok(found) => findings.extend(found),
        Err(error) => findings.push(broken_off(&error)),
    }
    findings
}

/// What ended the check-up.
fn broken_off(error: &LinkError) -> Finding {
    let what = if matches!(error, LinkError::BadSetting { .. }) { "settings" } else { "link" };
    Finding::look(what, error.to_string(), error.next_step())
}
