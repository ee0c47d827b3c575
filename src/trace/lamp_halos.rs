//! Halos of small lamps: spheres around them, several times as large, by which pixels with images of them are found.
//!
//! Mirrors, glass and holes show a small lamp in images far below a pixel: hardly any ray meets them, and what does is
//! a bright dot. Many more rays cross its halo, whose image is around that of the lamp and larger by as much. So rays
//! are split where one crosses a halo, as in multilevel splitting \[Kahn & Harris 1951, "Estimation of Particle
//! Transmission by Random Sampling"\].

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::DVec3;

use super::transport::Transport;
use crate::geometry::{Found, Geometry, PrimitiveId, Primitives, Segment, Sphere, Surface};
use crate::scene::Baked;
use crate::spacetime::Side;

/// Radius of a halo in half the extent of its lamp.
const SIZE: f64 = 8.0;
/// Part of the picture that all halos together take, as the camera would see them without mirrors, glass and holes.
/// Those of small lamps come first: images of large ones are found without.
const SHARE: f64 = 0.1;

/// Halos of the small lamps of a scene.
pub struct LampHalos(Geometry);

impl LampHalos {
    /// Those of a scene; `None` if it has no lamps, or none small enough.
    pub fn of(scene: &Baked) -> Option<Self> {
        if !scene.materials.iter().any(|material| material.emits()) {
            return None;
        }
        let pixel = scene.pixel();
        let pixels = |halo: &Sphere| {
            let distance = halo.center.distance(scene.camera.position);
            PI * (halo.radius / pixel.at(distance)).powi(2)
        };
        let mut halos = around_lamps(scene);
        halos.sort_by(|(_, a), (_, b)| pixels(a).total_cmp(&pixels(b)));
        let mut left = SHARE * (scene.settings.width * scene.settings.height) as f64;
        halos.retain(|(_, halo)| {
            left -= pixels(halo);
            left >= 0.0
        });
        if halos.is_empty() {
            return None;
        }
        let [near, far] = Side::BOTH.map(|of| {
            let spheres = halos.iter().filter(|(side, _)| *side == of).map(|(_, halo)| (*halo, NO_SURFACE));
            Geometry::build(Primitives { spheres: spheres.collect(), ..Primitives::default() })
        });
        Some(Self(near.with_far(far)))
    }

    /// True if a move crosses a halo before what is found.
    pub fn are_crossed<T: Transport>(
        &self,
        transport: &T,
        (flight, step, found): (&T::Flight, &T::Move, Option<Found>),
    ) -> bool {
        transport.course(flight, step).is_some_and(|course| {
            let end = found.map_or(1.0, |found| course.parameter_beside(found.point));
            let halo = self.0.intersect(&course, PrimitiveId::none_on(transport.side(flight)));
            halo.is_some_and(|halo| halo.s <= end)
        })
    }
}

/// Surface of halos, which none has.
const NO_SURFACE: Surface = Surface { material: 0, entity: 0 };

/// A halo around all that emits of each entity, and its side.
fn around_lamps(scene: &Baked) -> Vec<(Side, Sphere)> {
    let emits = |surface: &Surface| scene.materials[surface.material as usize].emits();
    let mut lamps: BTreeMap<u32, (Side, [DVec3; 2])> = BTreeMap::new();
    for (primitive, shape, surface) in scene.geometry.shapes(emits) {
        let (low, high) = shape.bounds();
        let (_, bounds) = lamps.entry(surface.entity).or_insert((primitive.side(), [low, high]));
        *bounds = [bounds[0].min(low), bounds[1].max(high)];
    }
    let halo = |[low, high]: [DVec3; 2]| Sphere {
        center: 0.5 * (low + high),
        radius: SIZE * 0.5 * (high - low).max_element(),
    };
    lamps.into_values().map(|(side, bounds)| (side, halo(bounds))).collect()
}
