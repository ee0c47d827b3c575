//! What the tracer does, looked at from outside: its rays, its errors, its speed and its pictures.

pub mod compare;
pub mod connections;
pub mod ends;
mod fan;
pub mod free;
pub mod noise;
pub mod pareto;
pub mod report;
pub mod sweep;

pub use fan::{Fan, FanError, FanOptions};
