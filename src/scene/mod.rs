//! The scene: as authored (an ECS world), and as baked (flat tables).
//!
//! Text → `file` tables → `populate` → `World` of `components` → `systems` → `bake` → [`Baked`]. A glTF
//! or OBJ file by itself is a scene file with one entity.
//!
#![doc = include_str!("keys.md")]

mod advice;
mod bake;
mod baked;
mod bare_model;
mod camera;
mod check;
pub(crate) mod components;
mod ergosphere;
mod error;
mod file;
mod foreign;
mod hole;
mod light;
mod listed;
mod load;
mod material;
mod optics;
mod overrides;
mod populate;
mod projection;
mod settings;
mod squash;
mod sun_sky;
mod surroundings;
mod systems;
mod text;
mod world;

pub use baked::{Baked, FarLights};
pub use camera::Camera;
pub use error::{Diagnostic, SceneError};
pub use load::{LoadOptions, load, load_with};
pub use projection::{Fisheye, LocalRay, Orthographic, Perspective, PixelWidth, Projection, ThinLens};
#[cfg(feature = "cli")]
pub use settings::flag_name;
pub use settings::{
    Background, Filter, LightSampling, MAX_SEGMENTS, MAX_SPP, MAX_WINDING, Precision, SamplerKind, Schedule,
    Settings, StepperKind,
};
pub use surroundings::Surroundings;

#[cfg(test)]
mod tests;
