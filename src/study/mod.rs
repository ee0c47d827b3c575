//! What the tracer does, looked at from outside: its rays, its errors, its speed and its pictures.
//!
#![doc = include_str!("measurements.md")]
#![doc = include_str!("columns.md")]

pub mod bench;
pub mod compare;
pub mod connections;
pub mod ends;
pub mod estimate;
mod fan;
pub mod forecast;
pub mod free;
pub mod lights;
pub mod noise;
pub mod pareto;
pub mod reference;
pub mod report;
pub mod sweep;
pub mod window;

pub use fan::{Fan, FanError, FanOptions};
