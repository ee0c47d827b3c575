//! Races: the wavefront and other ways to render the same scene, all in turn in one run.
//!
//! A busy machine slows all contenders of a `Bench` alike, and ratios are taken within rounds.

mod cells;
mod contender;
mod growth;
mod point;
mod previous;
mod race;
mod record;
mod report;
mod room;
mod single;
mod vary;

pub(crate) use contender::Contender;
pub(crate) use point::Point;
pub(crate) use previous::Previous;
pub(crate) use race::{Bench, Race};
pub(crate) use record::BenchRecord;
pub(crate) use report::report;
pub use room::{bumpy_sphere, room};
pub(crate) use vary::{Vary, VaryError};
