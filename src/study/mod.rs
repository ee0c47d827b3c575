//! What can be learnt from finished pictures and rays.

pub mod compare;
pub mod free;
pub mod noise;
