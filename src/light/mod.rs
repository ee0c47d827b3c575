//! Light from the scene's emitters, chosen and sampled.

mod tree;

pub use tree::{Emission, Tree};
