//! Smallest and largest distance of geometry from a point: the radii between which rays must be searched for hits.

use glam::DVec3;

use super::{Disk, Sphere};

/// Smallest and largest distance from a point to something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// To its nearest point.
    pub nearest: f64,
    /// To its farthest point.
    pub farthest: f64,
}

impl Reach {
    /// Of nothing.
    pub const NOTHING: Reach = Reach { nearest: f64::INFINITY, farthest: 0.0 };

    /// Of two things together.
    pub fn union(self, other: Reach) -> Reach {
        Reach { nearest: self.nearest.min(other.nearest), farthest: self.farthest.max(other.farthest) }
    }

    /// From `point` to a sphere's surface.
    pub fn sphere(point: DVec3, sphere: &Sphere) -> Reach {
        let d = point.distance(sphere.center);
        Reach { nearest: (d - sphere.radius).abs(), farthest: d + sphere.radius }
    }

    /// From `point` to an annulus.
    pub fn disk(point: DVec3, disk: &Disk) -> Reach {
        let to = point - disk.center;
        let height = to.dot(disk.normal);
        let radius = (to - height * disk.normal).length();
        let beside = radius - radius.clamp(disk.inner, disk.outer);
        Reach { nearest: libm::hypot(height, beside), farthest: libm::hypot(height, radius + disk.outer) }
    }

    /// From `point` to a triangle.
    pub fn triangle(point: DVec3, corners: [DVec3; 3]) -> Reach {
        let farthest = corners.iter().map(|c| c.distance(point)).fold(0.0, f64::max);
        Reach { nearest: point.distance(nearest_in_triangle(point, corners)), farthest }
    }
}

/// Ericson 2005, "Real-Time Collision Detection", 5.1.5: the Voronoi region of each feature in turn.
fn nearest_in_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + d1 / (d1 - d3) * ab;
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + d2 / (d2 - d6) * ac;
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    }
    a + (vb * ab + vc * ac) / (va + vb + vc)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_of_a_triangle_beats_every_sampled_one() {
        let corners = [DVec3::new(0.1, 0.2, -0.3), DVec3::new(1.4, 0.1, 0.5), DVec3::new(-0.2, 1.1, 0.9)];
        for i in 0..200 {
            let t = i as f64;
            let p = 2.0 * DVec3::new((1.1 * t).sin(), (2.3 * t).cos(), (0.7 * t).sin());
            let nearest = Reach::triangle(p, corners).nearest;
            let mut sampled = f64::INFINITY;
            for j in 0..=100 {
                for k in 0..=100 - j {
                    let (u, v) = (j as f64 / 100.0, k as f64 / 100.0);
                    let q = corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
                    sampled = sampled.min(p.distance(q));
                }
            }
            assert!(nearest <= sampled + 1e-12 && nearest >= sampled - 0.03, "{p}: {nearest} {sampled}");
        }
    }
}
