//! Oddities of a scene, though nothing is wrong with it: a hole that nobody sees, lights that hardly light.

use std::f64::consts::PI;

use glam::DVec3;

use super::Camera;
use super::systems::Bounds;
use crate::light::Punctual;
use crate::shade::Environment;
use crate::spacetime::{ConformallyFlat, Mouths, SpacetimeKind, Wormhole};

/// Radiance of a white surface that a picture at exposure 0 shows as nearly black.
const DIM: f64 = 0.02;

/// Oddities of where holes are: outside of what the surfaces and the camera span, or out of the picture.
pub(super) fn of_holes(
    spacetime: &SpacetimeKind,
    camera: &Camera,
    aspect: f64,
    boxes: &[(Bounds, u32)],
) -> Vec<String> {
    let of = |(center, shadow)| of_hole(center, shadow, camera, aspect, boxes);
    let beside = |(mouths, metric): (Mouths, Wormhole)| {
        vec![(mouths.center(camera.side), metric.critical_impact_parameter())]
    };
    let shadows = spacetime.wormhole().map_or_else(|| spacetime.shadows(), beside);
    shadows.into_iter().flat_map(of).collect()
}

/// Warning of what is not seen of punctual lights in a spacetime.
pub(super) fn of_aim(spacetime: &SpacetimeKind) -> Option<&'static str> {
    match spacetime {
        SpacetimeKind::Flat
        | SpacetimeKind::Spherical { .. }
        | SpacetimeKind::Wormhole { .. }
        | SpacetimeKind::Indexed(_) => None,
        SpacetimeKind::Spinning { .. } => Some(
            "punctual lights are seen along rays that go the near way and around the hole once; some of those that go \
             around may be missed: surfaces that emit miss nothing",
        ),
    }
}

/// Warning of a sun that light samples are not aimed at in a spacetime.
pub(super) fn of_sun(spacetime: &SpacetimeKind, environment: &Environment) -> Option<&'static str> {
    let has_disk = matches!(environment, Environment::SunSky(sky) if sky.disk().is_some());
    match spacetime {
        SpacetimeKind::Flat
        | SpacetimeKind::Spherical { .. }
        | SpacetimeKind::Wormhole { .. }
        | SpacetimeKind::Spinning { .. } => None,
        SpacetimeKind::Indexed(_) => has_disk.then_some(
            "among several holes and through lenses the disk of the sun is found by chance alone, which leaves bright \
             dots; write sun_disk = false and a light of kind \"distant\"",
        ),
    }
}

/// Oddities of where a hole is whose shadow has this radius from afar.
fn of_hole(center: DVec3, shadow: f64, camera: &Camera, aspect: f64, boxes: &[(Bounds, u32)]) -> Vec<String> {
    let [x, y, z] = center.to_array().map(|value| value as f32);
    let mut notes = Vec::new();
    if let Some(bounds) = Bounds::of_all(boxes) {
        let (min, max) = (bounds.min.min(camera.position), bounds.max.max(camera.position));
        let outside = center - center.clamp(min, max);
        if outside.length() > shadow {
            let [low, high] = [min, max].map(|corner| {
                let [x, y, z] = corner.to_array().map(|value| value as f32);
                format!("{x},{y},{z}")
            });
            notes.push(format!(
                "the hole at {x},{y},{z} is outside the scene, which reaches from {low} to {high} (Y is up)"
            ));
        }
    }
    if !camera.sees_ball(center, shadow, aspect) {
        notes.push(format!("the hole at {x},{y},{z} is out of the camera's view"));
    }
    notes
}

/// True if there are lights but none lights a white surface well, in a scene of these boxes that nothing else lights.
pub(super) fn is_dim(lights: &[Punctual], boxes: &[(Bounds, u32)]) -> bool {
    let Some(Bounds { min, max }) = Bounds::of_all(boxes) else {
        return false;
    };
    let (middle, radius) = (0.5 * (min + max), 0.5 * (max - min).length());
    let radiance = |light: &Punctual| {
        let peak = f64::from(light.peak().max_element());
        match light.position() {
            None => peak / PI,
            Some(position) => peak / (PI * position.distance(middle).max(0.5 * radius).powi(2)),
        }
    };
    !lights.is_empty() && lights.iter().all(|light| radiance(light) < DIM)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn camera() -> Camera {
        Camera::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z, DVec3::Y, 0.7, 0.0).unwrap()
    }

    fn notes(center: DVec3) -> Vec<String> {
        let hole = SpacetimeKind::black_hole(center, 0.1);
        of_holes(&hole, &camera(), 1.0, &[(Bounds { min: DVec3::splat(-2.0), max: DVec3::splat(2.0) }, 0)])
    }

    #[test]
    fn a_hole_within_the_scene_and_in_view_is_not_odd() {
        assert!(notes(DVec3::ZERO).is_empty());
        assert!(notes(DVec3::new(0.0, 0.0, 2.05)).is_empty(), "between the scene and the camera");
        assert!(of_holes(&SpacetimeKind::Flat, &camera(), 1.0, &[]).is_empty());
    }

    #[test]
    fn a_hole_outside_or_out_of_view_is_said() {
        let beside = notes(DVec3::new(1.9, 0.0, 1.9));
        assert_eq!(beside, ["the hole at 1.9,0,1.9 is out of the camera's view"]);
        let behind = notes(DVec3::new(0.0, 0.0, 9.0));
        assert_eq!(behind.len(), 2, "{behind:?}");
        let below = notes(DVec3::new(0.0, -2.5, -20.0));
        assert_eq!(below.len(), 1);
        assert!(below[0].contains("from -2,-2,-2 to 2,2,5"), "{below:?}");
        // The middle of the hole is out of the picture, but not its shadow.
        assert!(notes(DVec3::new(0.0, 1.9, 0.05)).is_empty());
    }

    #[test]
    fn lights_are_dim_by_what_they_give_a_white_surface() {
        let boxes = [(Bounds { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) }, 0)];
        // Blender's first light: 1000 W, 7 m away.
        let blender = |scale: f32| Punctual::Point {
            position: DVec3::new(4.1, 5.9, -1.0),
            intensity: Vec3::splat(1000.0 * scale * 0.25 * std::f32::consts::FRAC_1_PI),
        };
        assert!(!is_dim(&[blender(1.0)], &boxes));
        assert!(is_dim(&[blender(1.0 / 683.0)], &boxes));
        assert!(!is_dim(&[blender(1.0 / 683.0), blender(1.0)], &boxes));
        assert!(!is_dim(&[], &boxes));
        let sun = |irradiance: f32| Punctual::Distant {
            direction: DVec3::NEG_Y,
            irradiance: Vec3::splat(irradiance),
        };
        assert!(is_dim(&[sun(1.0 / 683.0)], &boxes) && !is_dim(&[sun(1.0)], &boxes));
    }
}
