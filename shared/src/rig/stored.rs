//! What survives a power cut, as bytes.

use super::settings::check_settings;
use crate::curve::{Curve, Knot, MAX_KNOTS};
use crate::effect::CURVE_ID;
use crate::formula::{Formula, MAX_BYTES};
use crate::parameters::Parameters;
use crate::wire::{PROTOCOL, Settings, StoreState};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Version of [`Stored`] in flash with a potentiometer …
const STORED_VERSION: u16 = 1;

/// … and with another sensor, so that firmware from before there were others falls back on its defaults.
const STORED_WITH_SENSOR: u16 = 2;

/// The longest encoded [`Stored`].
pub const MAX_STORED: usize = 320 + MAX_BYTES + 1 + MAX_KNOTS * size_of::<Knot>();

/// What survives a power cut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stored {
    /// Model.
    pub parameters: Parameters<f32>,
    /// Settings and calibration.
    pub settings: Settings,
}

impl Stored {
    /// Bytes for flash: a version, the content, and behind it the knots of the friction curve and the formula, where
    /// there are such. The flash store adds its own check sum.
    pub fn encode<'b>(&self, buffer: &'b mut [u8; MAX_STORED]) -> Option<&'b [u8]> {
        let Parameters { formula, curve, .. } = &self.parameters;
        let mut end = postcard::to_slice(&(self.version(), self), buffer).ok()?.len();
        if let Some(curve) = curve.as_ref().filter(|_| self.has_curve()) {
            end += postcard::to_slice(&curve.knots(), &mut buffer[end..]).ok()?.len();
        }
        let formula = formula.as_ref().map_or(&[][..], Formula::bytes);
        buffer.get_mut(end..end + formula.len())?.copy_from_slice(formula);
        buffer.get(..end + formula.len())
    }

    /// Reads what [`Stored::encode`] wrote; content that does not fit this build is refused with its reason.
    pub fn decode(bytes: &[u8]) -> Result<Self, StoreState> {
        let (version, rest) = postcard::take_from_bytes::<u16>(bytes).map_err(|_| StoreState::Damaged)?;
        if ![STORED_VERSION, STORED_WITH_SENSOR].contains(&version) {
            return Err(StoreState::OtherVersion);
        }
        let (mut stored, mut rest) = postcard::take_from_bytes::<Self>(rest).map_err(|_| StoreState::Damaged)?;
        if version != stored.version() {
            return Err(StoreState::OtherVersion);
        }
        if stored.has_curve() {
            let knots: Vec<Knot, MAX_KNOTS>;
            (knots, rest) = postcard::take_from_bytes(rest).map_err(|_| StoreState::Damaged)?;
            stored.parameters.curve = Curve::through(&knots);
        }
        if !rest.is_empty() {
            stored.parameters.formula = Some(Formula::from_bytes(rest).ok_or(StoreState::Damaged)?);
        }
        let sound = stored.parameters.check().is_ok() && check_settings(&stored.settings).is_ok();
        if sound { Ok(stored) } else { Err(StoreState::Damaged) }
    }

    /// The effect tells: firmware from before there were curves has no such effect, and falls back on its defaults.
    fn has_curve(&self) -> bool {
        self.parameters.values(CURVE_ID).is_some()
    }

    fn version(&self) -> u16 {
        let is_potentiometer = self.settings.sensor.protocol() == PROTOCOL;
        if is_potentiometer { STORED_VERSION } else { STORED_WITH_SENSOR }
    }
}
