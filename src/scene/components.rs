//! Components that an entity of the scene may have; each has only what it needs.

use std::ops::Range;

use glam::DAffine3;
use hecs::Entity;

use super::projection::Projection;
use crate::asset::ModelHole;
use crate::geometry::{Disk, Sphere};
use crate::light::Punctual;

/// Name in the file, for people and for the object-id AOV.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name(pub String);

/// The entity whose space this one is placed in; it was spawned earlier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parent(pub Entity);

/// Entity space → the parent's, or the world for an entity without parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalTransform(pub DAffine3);

/// Entity space → world; derived from [`LocalTransform`] and [`Parent`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldTransform(pub DAffine3);

/// A sphere in entity space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereShape(pub Sphere);

/// A flat annulus in entity space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiskShape(pub Disk);

/// Index of a mesh in the world's mesh table; entities share meshes by sharing handles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MeshHandle(pub u32);

/// Index of a material in the world's material table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MaterialHandle(pub u32);

/// Triangle meshes in entity space, each with its material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshShape(pub Vec<(MeshHandle, MaterialHandle)>);

/// A punctual light, in entity space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightShape(pub Punctual);

/// A camera that looks along −Z of its entity, +Y upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraLens {
    /// Projection.
    pub projection: Projection,
    /// Distance at which rays start, scene units.
    pub near: f64,
    /// Width over height of the picture that it is meant for.
    pub aspect: Option<f64>,
}

/// A black hole that is to be here, in entity space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoleMark(pub ModelHole);

/// The far side of a wormhole as the place of the entity and of those placed in its space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OnFarSide;

/// Byte range of the scene file in which the entity is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AuthoredAt(pub Range<usize>);
