//! Orthonormal frames around a normal.

use glam::DVec3;

/// Two unit vectors that complete the unit vector `normal` to a right-handed orthonormal frame.
///
/// Duff et al. 2017, "Building an Orthonormal Basis, Revisited", JCGT 6(1).
#[inline(always)]
pub fn tangents(normal: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0_f64.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    (
        DVec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
        DVec3::new(b, sign + normal.y * normal.y * a, -normal.y),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_complete_a_right_handed_orthonormal_frame_at_every_pole_and_between() {
        let mut normals = vec![DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        for i in 0..1000 {
            let (a, b) = (i as f64 * 0.7, i as f64 * 1.3);
            normals.push(DVec3::new(a.sin() * b.cos(), a.sin() * b.sin(), a.cos()));
        }
        for n in normals {
            let (t, s) = tangents(n);
            assert!(t.dot(n).abs() < 1e-14 && s.dot(n).abs() < 1e-14 && t.dot(s).abs() < 1e-14, "{n}");
            assert!((t.cross(s) - n).length() < 1e-14, "{n}");
        }
    }
}
