//! What the tracer does, looked at from outside: its rays, its errors and its speed.

mod fan;
mod fate;
pub mod pareto;
pub mod report;
pub mod sweep;

pub use fan::{Fan, FanError, FanOptions};
