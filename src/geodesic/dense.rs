//! Dense output of a step: the quintic that matches position, momentum and force at both ends.

use glam::DVec3;

use super::Step;

/// Quintic Hermite interpolant of a step, over s in [0, 1]; its error is O(h⁶) beside that of the ends.
#[derive(Clone, Copy, Debug)]
pub struct Dense {
    coefficients: [DVec3; 6],
}

impl Dense {
    /// The interpolant of `step`.
    pub fn new(step: &Step) -> Self {
        let h = step.h;
        let [x0, p0, f0] = step.start;
        let [x1, p1, f1] = step.end;
        let (v0, v1) = (h * p0, h * p1);
        let (a0, a1) = (0.5 * h * h * f0, 0.5 * h * h * f1);
        let d = x1 - x0 - v0 - a0;
        let e = v1 - v0 - 2.0 * a0;
        let g = a1 - a0;
        Self {
            coefficients: [
                x0,
                v0,
                a0,
                10.0 * d - 4.0 * e + g,
                -15.0 * d + 7.0 * e - 2.0 * g,
                6.0 * d - 3.0 * e + g,
            ],
        }
    }

    /// Position at `s`.
    pub fn position(&self, s: f64) -> DVec3 {
        self.coefficients.iter().rev().fold(DVec3::ZERO, |sum, &c| sum * s + c)
    }

    /// dx/ds at `s`: along the ray, of length h n.
    pub fn velocity(&self, s: f64) -> DVec3 {
        let [_, c1, c2, c3, c4, c5] = self.coefficients;
        c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))
    }

    /// Parameter of the point that lies at the same distance along `axis` (start to end) as `point`.
    pub fn parameter_beside(&self, point: DVec3, axis: DVec3) -> f64 {
        let target = (point - self.coefficients[0]).dot(axis);
        let guess = (target / axis.length_squared()).clamp(0.0, 1.0);
        let mut s = guess;
        for _ in 0..4 {
            let miss = (self.position(s) - self.coefficients[0]).dot(axis) - target;
            let next = s - miss / self.velocity(s).dot(axis);
            if !next.is_finite() {
                return guess;
            }
            let moved = (next - s).abs();
            s = next.clamp(0.0, 1.0);
            if moved < 1e-6 {
                break;
            }
        }
        s
    }

    /// Coordinate length from the start to `s`, by Gauss–Legendre quadrature of order 10.
    pub fn length(&self, s: f64) -> f64 {
        const NODES: [(f64, f64); 5] = [
            (0.0, 128.0 / 225.0),
            (0.538_469_310_105_683, 0.478_628_670_499_366),
            (-0.538_469_310_105_683, 0.478_628_670_499_366),
            (0.906_179_845_938_664, 0.236_926_885_056_189),
            (-0.906_179_845_938_664, 0.236_926_885_056_189),
        ];
        NODES.iter().map(|(x, w)| w * self.velocity(0.5 * s * (1.0 + x)).length()).sum::<f64>() * 0.5 * s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dense_output_reproduces_a_quintic_exactly() {
        let c = [1.0, -2.0, 0.5, 0.3, -0.7, 0.2];
        let value = |s: f64| c.iter().rev().fold(0.0, |sum, k| sum * s + k);
        let first = |s: f64| (1..6).map(|k| k as f64 * c[k] * s.powi(k as i32 - 1)).sum::<f64>();
        let second = |s: f64| (2..6).map(|k| (k * (k - 1)) as f64 * c[k] * s.powi(k as i32 - 2)).sum::<f64>();
        let h = 0.8;
        let end =
            |s: f64| [DVec3::splat(value(s)), DVec3::splat(first(s) / h), DVec3::splat(second(s) / h / h)];
        let dense = Dense::new(&Step { start: end(0.0), end: end(1.0), h, momentum_error: DVec3::ZERO });
        for i in 0..=10 {
            let s = i as f64 / 10.0;
            assert!((dense.position(s).x - value(s)).abs() < 1e-13, "position at {s}");
            assert!((dense.velocity(s).x - first(s)).abs() < 1e-12, "velocity at {s}");
        }
    }
}
