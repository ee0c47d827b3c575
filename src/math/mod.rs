//! Small numerics that no crate gives.

pub mod bernstein;
pub mod frame;
