//! What the tracer does, looked at from outside: its rays.

mod fan;
mod fate;

pub use fan::{Fan, FanError, FanOptions};
