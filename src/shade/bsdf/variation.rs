//! Variation of a lobe over a surface.

use glam::{DVec3, Vec3};

/// Factors on the numbers of a lobe at a point of a surface; a lobe takes those that it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variation {
    /// Of the colour.
    pub color: Vec3,
    /// Of the share of metal.
    pub metallic: f32,
    /// Of the roughness.
    pub roughness: f32,
    /// Of a dielectric's reflectance.
    pub specular: f32,
    /// Of its colour.
    pub specular_color: Vec3,
    /// Of the share that light goes through.
    pub transmission: f32,
    /// Of the share that is coated.
    pub clearcoat: f32,
    /// Of the coat's roughness.
    pub clearcoat_roughness: f32,
    /// Of the colour of the sheen.
    pub sheen_color: Vec3,
    /// Of its roughness.
    pub sheen_roughness: f32,
    /// Of the share that a thin film covers.
    pub iridescence: f32,
    /// Not a factor: the film's thickness, nanometres, where that varies.
    pub film_thickness: Option<f32>,
    /// Of the strength of the anisotropy.
    pub anisotropy: f32,
    /// Not a factor: direction of the anisotropy in the world, where that is known.
    pub tangent: Option<DVec3>,
}
