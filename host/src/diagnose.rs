//! Discovery: which physical effect is missing from the model?
//!
//! The base model is fitted first. If it leaves more than the noise, every effect of the list is tried: a score test
//! ([`score`]) tells in one linearised step what each could gain, the promising ones are fitted in earnest
//! ([`trial`]), and [`search`] goes on with pairs until nothing significant is left. [`verdict`] says what may be
//! claimed, what can't be told apart ([`replacement`]), what is only a shifted zero of the sensor ([`zero`]), and what
//! stays unexplained; for that, [`formulas`] searches small laws if somebody wishes.

pub mod evidence;
pub mod formulas;
pub mod physical;
pub mod replacement;
pub mod score;
pub mod search;
pub mod trial;
pub mod verdict;
pub mod zero;

pub use evidence::Evidence;
pub use trial::Value;
pub use verdict::{Candidate, Diagnosis, Step, Suggestion, Wishes, diagnose, diagnose_counted, diagnose_with};
