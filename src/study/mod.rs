//! Studies of the tracer from outside: its rays, its errors, its speed and its pictures.
//!
#![doc = include_str!("measurements.md")]
#![doc = include_str!("columns.md")]

pub mod bench;
pub(crate) mod camera_rays;
pub mod compare;
pub(crate) mod connections;
mod errors;
pub mod estimate;
mod fan;
mod field_outlines;
pub(crate) mod forecast;
pub mod free;
pub mod input_error;
pub(crate) mod light_sampling;
pub mod noise;
mod pareto;
pub(crate) mod reference;
mod render;
pub(crate) mod report;
pub(crate) mod rounds;
pub(crate) mod spinning_connections;
mod spinning_sections;
pub(crate) mod table;
pub(crate) mod table_rays;
mod trade_off;
pub(crate) mod way;
pub mod window;

pub(crate) use fan::{Fan, FanError, FanOptions};
