//! Emitters and how to find them.

mod punctual;

pub use punctual::Punctual;
