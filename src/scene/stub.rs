//! Stands in for the scene loader on this branch; dropped when the loader is merged.

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};

use super::{Baked, Camera, Settings, SpacetimeKind};
use crate::geometry::{Geometry, Primitives};
use crate::shade::{Environment, Material};

/// Why a scene could not be loaded.
#[derive(Debug, thiserror::Error)]
#[error("cannot read `{}`", path.display())]
pub struct SceneError {
    path: PathBuf,
    source: std::io::Error,
}

/// A sphere in a white room if the file can be read.
///
/// # Errors
/// If the file cannot be read.
pub fn load(path: &Path, _overrides: &[String], black_hole: Option<[f64; 4]>) -> Result<Baked, SceneError> {
    let unreadable = |source| SceneError {
        path: path.to_owned(),
        source,
    };
    std::fs::read(path).map_err(unreadable)?;
    let position = DVec3::new(0.0, 0.0, 5.0);
    let camera = Camera::new(position, -position, DVec3::Y, 40f64.to_radians(), 0.0)
        .ok_or_else(|| unreadable(std::io::ErrorKind::InvalidData.into()))?;
    let spacetime = match black_hole {
        None => SpacetimeKind::Flat,
        Some([x, y, z, schwarzschild_radius]) => SpacetimeKind::Schwarzschild {
            center: DVec3::new(x, y, z),
            schwarzschild_radius,
        },
    };
    Ok(Baked {
        spacetime,
        camera,
        geometry: Geometry::build(Primitives::default()),
        materials: vec![Material::default()],
        entities: vec!["sphere".to_owned()],
        environment: Environment::Constant(Vec3::ONE),
        settings: Settings {
            width: 16,
            height: 12,
            ..Settings::default()
        },
        warnings: Vec::new(),
    })
}
