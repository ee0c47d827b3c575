//! Rotations from angles, with the sines and cosines of `libm`: glam's own are those of the C library.

use glam::{DQuat, DVec3};

/// The rotation about a unit `axis` by an angle in radians.
pub fn about(axis: DVec3, angle: f64) -> DQuat {
    let (sin, cos) = libm::sincos(0.5 * angle);
    let vector = axis * sin;
    DQuat::from_xyzw(vector.x, vector.y, vector.z, cos)
}

/// Rotations about the fixed axes x, y, z, one after the other, by angles in radians.
pub fn about_fixed_axes(angles: DVec3) -> DQuat {
    about(DVec3::Z, angles.z) * about(DVec3::Y, angles.y) * about(DVec3::X, angles.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::EulerRot;

    #[test]
    fn rotations_are_those_of_glam() {
        let angles = DVec3::new(0.3, -1.2, 2.9);
        let euler = DQuat::from_euler(EulerRot::ZYX, angles.z, angles.y, angles.x);
        assert!(about_fixed_axes(angles).abs_diff_eq(euler, 1e-15));
        let axis = DVec3::new(2.0, -1.0, 0.5).normalize();
        assert!(about(axis, 4.0).abs_diff_eq(DQuat::from_axis_angle(axis, 4.0), 1e-15));
    }
}
