//! The bank: which physics does the model lack? Found from a few swings, without trying any model.
//!
//! In go evenly sampled angles of up to eight releases and the model that ought to follow them ([`refit::Releases`]),
//! out come the suspects with their sizes, and a name or the reason why there is none ([`findings::look`]). On the way:
//!
//! 1. releases are cut into windows of a few periods, each with a start of its own ([`window`]);
//! 2. the model swings through each, with the derivatives of its readings by every number that may be wrong or missing:
//!    one shared transition, one column a number ([`mod@column`], [`mod@swing`], [`mod@follow`]);
//! 3. the model is put right by Gauss and Newton's steps, because a test around a stale one accuses the innocent
//!    ([`refit`]);
//! 4. products of columns and residuals are summed over all windows, their own starts projected out ([`sums`]);
//! 5. the windows are followed once more, for what each has of every candidate's step; neighbours are joined until at
//!    most fourteen clusters are left ([`clusters`]);
//! 6. each candidate is judged by what it gains and by whether all clusters agree ([`judge`], [`chance`]), and named
//!    or not ([`findings`]);
//! 7. what is named is put into the model, and so is the likeliest of those that can't be told from it; the one that
//!    explains more comes first (`contest`).
//!
//! A board keeps the last releases ([`tape`], [`keeper`]) and looks at them in its spare time ([`order`]).
//!
//! No allocation, generic over the number. The list of effects is the only source of candidates.

pub mod chance;
pub mod clusters;
pub mod column;
mod contest;
pub mod findings;
pub mod follow;
pub mod judge;
pub mod keeper;
pub mod order;
pub mod refit;
pub mod smooth;
pub mod sums;
pub mod swing;
pub mod tape;
pub mod window;
