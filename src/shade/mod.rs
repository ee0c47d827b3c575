//! Materials, their lobes, and light from infinity.

mod environment;
mod material;

pub use environment::{Environment, LatLong};
pub use material::{Lobe, Material};
