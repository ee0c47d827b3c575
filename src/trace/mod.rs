//! From baked tables to a picture.
//!
//! A [`Session`] chooses a [`transport`] for the scene's spacetime and a schedule, learns what helps light sampling,
//! cuts the picture into tiles and the samples into passes, and has worker threads run the `stages` over them;
//! [`render`] is a loop around it.
//!
#![doc = include_str!("wavefront.md")]

mod arc_sweep;
mod choice;
pub(crate) mod cpu_clock;
pub mod curved;
mod edge_pixels;
mod field;
mod flight_status;
mod halt;
mod illumination;
mod job;
mod lamp_halos;
mod land_on_arc;
mod land_on_ray;
mod launch_point;
mod learn;
mod paper;
mod passes;
mod path;
mod per_pixel;
mod polyline;
mod probe;
mod ray_batch;
mod ray_cone;
mod ray_end;
mod render;
mod run;
mod samples;
mod session;
mod shoot;
mod sort_hits;
mod spinning;
mod split;
pub(crate) mod stages;
mod state;
mod stats;
pub(crate) mod steppers;
mod straight;
mod surroundings;
mod tile;
mod tracer;
pub mod transport;
mod vertex;
mod wavefront;
mod work;
mod worker;

pub use illumination::LightSummary;
pub use polyline::{Polyline, PolylinePiece, polylines};
pub use probe::{Probe, Reading, probe};
pub use ray_end::RayEnd;
pub use render::{Progress, Rendered, render};
pub use run::Run;
pub use session::Session;
pub use shoot::{Ray, Shot, shoot};
pub use state::State;
pub use stats::{Counters, Fates, Occupancy, StageCost, StageTimes, Stats};
