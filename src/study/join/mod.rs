//! Rays that join two points in empty space, as tables have them.
//!
//! A family of spacetimes has one file with its [`JoinForm`]: the columns that are found, and how; and one line in
//! [`JoinForm::of`].

mod central;
mod form;
mod forms;
mod lens_cache;
mod several_holes;
mod shadow_edge;
mod spinning;
mod windings;

pub(crate) use form::{JoinForm, Joints, POINTS, PointPair};
pub(crate) use lens_cache::LensCache;
