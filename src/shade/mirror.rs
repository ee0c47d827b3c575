//! Perfect specular reflection.

use glam::DVec3;

/// The mirror image of `direction` about a surface of unit normal `normal` (either side).
pub fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    (direction - 2.0 * direction.dot(normal) * normal).normalize()
}
