//! Studies of the tracer from outside: its rays, its errors, its speed and its pictures.
//!
#![doc = include_str!("measurements.md")]
#![doc = include_str!("columns.md")]

pub mod bench;
mod by_family;
pub(crate) mod camera_rays;
pub mod compare;
mod errors;
pub mod estimate;
mod fan;
mod fan_frame;
mod field_outlines;
pub(crate) mod forecast;
pub mod free;
mod hole_columns;
pub mod input_error;
pub(crate) mod join;
mod lengths;
pub(crate) mod light_sampling;
pub mod noise;
mod pareto;
pub(crate) mod reference;
mod render;
pub(crate) mod report;
pub(crate) mod rounds;
mod spinning_sections;
pub(crate) mod table;
pub(crate) mod table_rays;
mod trade_off;
pub(crate) mod way;
pub mod window;

pub(crate) use fan::{Fan, FanError, FanOptions};
