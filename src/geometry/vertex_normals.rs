//! Normals between the vertices of triangles.

use glam::{DMat3, DVec3, Vec3};

use super::Triangle;
use crate::math::columns::columns;
use crate::math::kernel::Kernel;

columns! {
    /// Normals at the vertices of a triangle, object space; not always unit.
    pub struct VertexNormals => VertexNormalsBlock {
        /// At the first.
        a: Vec3,
        /// At the second.
        b: Vec3,
        /// At the third.
        c: Vec3,
    }
}

columns! {
    /// Hit on a smooth triangle of a mesh that appears once.
    pub struct SmoothHit => SmoothHitBlock {
        /// Point of the triangle, relative to the origin.
        point: DVec3,
        /// Columns of the map from object normals to world normals.
        x: DVec3,
        /// The second.
        y: DVec3,
        /// The third.
        z: DVec3,
        /// True if the mesh's placement turns left into right.
        is_mirrored: bool,
    }
}

columns! {
    /// Normals of a surface in the world, unit.
    pub struct SurfaceNormals => SurfaceNormalsBlock {
        /// Geometric normal.
        geometric: DVec3,
        /// Shading normal.
        shading: DVec3,
    }
}

impl VertexNormals {
    /// Their sum by weights.
    #[inline(always)]
    pub fn weighted(&self, [a, b, c]: [f64; 3]) -> DVec3 {
        // From zero on, as sums are: negative zeros add up to zero.
        DVec3::ZERO + a * self.a.as_dvec3() + b * self.b.as_dvec3() + c * self.c.as_dvec3()
    }
}

/// Kernel that interpolates normals.
pub(super) struct Interpolating;

impl Kernel for Interpolating {
    type A = (Triangle, VertexNormals);
    type B = SmoothHit;
    type Out = SurfaceNormals;

    #[inline(always)]
    fn run(&self, (triangle, vertices): &(Triangle, VertexNormals), hit: &SmoothHit) -> SurfaceNormals {
        let geometric = triangle.normal().normalize();
        let (u, v) = triangle.barycentrics(hit.point);
        // Flattened triangles of mirrored placements were rewound, see `Placing`.
        let (b, c) = if hit.is_mirrored { (v, u) } else { (u, v) };
        let normal = DMat3::from_cols(hit.x, hit.y, hit.z) * vertices.weighted([1.0 - u - v, b, c]);
        let inverse = normal.length_recip();
        let is_direction = inverse.is_finite() & (inverse > 0.0);
        let pick = |smooth: f64, flat: f64| if is_direction { smooth * inverse } else { flat };
        let shading =
            DVec3::new(pick(normal.x, geometric.x), pick(normal.y, geometric.y), pick(normal.z, geometric.z));
        SurfaceNormals { geometric, shading }
    }
}
