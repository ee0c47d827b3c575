//! Files of geometry and images, read into plain tables; every loader says what it does not understand.
//!
#![doc = include_str!("formats.md")]

mod error;
pub(crate) mod exr;
mod files;
mod flaw;
mod gltf;
mod image;
mod memory;
mod model;
mod mtl;
mod notes;
mod obj;
mod primaries;
mod statements;
mod tangents;
mod textures;
mod tidy;

pub use error::AssetError;
pub use files::Files;
pub(crate) use flaw::Flaw;
pub(crate) use gltf::load as load_gltf;
pub use image::{Picture, load as load_image};
pub use memory::Memory;
pub(crate) use model::{Model, ModelCamera, ModelHole, ModelNode, ModelView};
pub(crate) use obj::load as load_obj;
