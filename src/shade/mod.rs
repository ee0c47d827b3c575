//! Materials, their lobes, light from infinity, and the random numbers that choose among them.

pub mod dielectric;
pub mod diffuse;
mod environment;
mod material;
mod media;
pub mod mirror;
mod sampler;
mod scatter;
mod sobol;

pub use environment::{Environment, LatLong};
pub use material::{Lobe, Material};
pub use media::{Crossing, Media};
pub use sampler::{Key, Sampler};
pub use scatter::{Bounce, Incidence, evaluate, scatter};
