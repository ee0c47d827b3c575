//! Races: the wavefront and other ways to render the same scene, all in turn in one run.
//!
//! A busy machine slows all contenders of a [`Bench`] alike, and ratios are taken within rounds.

mod cells;
mod contender;
mod growth;
mod point;
mod race;
mod record;
mod report;
mod room;
mod single;
mod vary;

pub use contender::Contender;
pub use point::Point;
pub use race::{Bench, Race, Runs};
pub use record::BenchRecord;
pub use report::report;
pub use room::{bumpy_sphere, room};
pub use vary::{Vary, VaryError};
