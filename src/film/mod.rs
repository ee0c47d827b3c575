//! From sample sums to files.

mod image;

pub use image::{Aov, Image, Plane};
