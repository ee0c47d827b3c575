//! Surroundings of a scene: light from infinity that an option names, or that a bare model gets.

use std::path::PathBuf;

use glam::Vec3;

use super::populate;
use super::world::World;
use crate::asset::{AssetError, Files, load_image};
use crate::shade::Environment;

/// Light from infinity, as an option names it.
#[derive(Clone, Debug, PartialEq)]
pub enum Surroundings {
    /// The built-in sky.
    Sky,
    /// Radiance, the same from everywhere, linear RGB.
    Color(Vec3),
    /// A latitude-longitude picture.
    Image(PathBuf),
}

impl Surroundings {
    /// Reads the picture, if it is one.
    pub(super) fn load(&self, files: &Files, warnings: &mut Vec<String>) -> Result<Environment, AssetError> {
        Ok(match self {
            Self::Sky => populate::sky(1.0),
            Self::Color(Vec3::ZERO) => Environment::Black,
            Self::Color(colour) => Environment::Constant(*colour),
            Self::Image(path) => populate::panorama(load_image(path, files)?, 1.0, 0.0, warnings),
        })
    }
}

/// Puts a sky around a model in which nothing emits light, and says what is around it.
pub(super) fn surround(world: &mut World) {
    let what = if world.emits() {
        "a model carries no world: the background is black"
    } else {
        world.environment = populate::sky(1.0);
        "nothing in the model emits light, so the built-in sky lights it"
    };
    world.notes.push(format!("{what}; --environment takes a picture, R,G,B, sky or black"));
}
