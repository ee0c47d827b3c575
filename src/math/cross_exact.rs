//! Differences of products without cancellation.

use glam::DVec3;

/// a b − c d to within 1.5 units in the last place.
///
/// Jeannerod, Louvet, Muller 2013, "Further analysis of Kahan's algorithm for the accurate computation of 2×2
/// determinants", Math. Comp. 82, 2245.
#[inline(always)]
pub fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let cd = c * d;
    let error = c.mul_add(-d, cd);
    a.mul_add(b, -cd) + error
}

/// a × b, each component to within 1.5 units in its last place, however nearly parallel the vectors are.
#[inline(always)]
pub fn cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        difference_of_products(a.y, b.z, a.z, b.y),
        difference_of_products(a.z, b.x, a.x, b.z),
        difference_of_products(a.x, b.y, a.y, b.x),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cross_product_of_nearly_parallel_vectors_keeps_all_digits() {
        // (1 + ε, 1) × (1, 1 − ε) = (1 + ε)(1 − ε) − 1 = −ε².
        let e = f64::EPSILON;
        let product = cross(DVec3::new(1.0 + e, 1.0, 0.0), DVec3::new(1.0, 1.0 - e, 0.0));
        assert_eq!(product.z, -e * e);
    }
}
