//! The scene: as authored (an ECS world), and as baked (flat tables).

mod baked;
mod camera;
mod settings;
mod stub;

pub use baked::{Baked, SpacetimeKind};
pub use camera::Camera;
pub use settings::{Filter, SamplerKind, Schedule, Settings, StepperKind};
pub use stub::{SceneError, load};
