//! Glass of a graded index in flat space: Gaussian lenses, n = 1 + Σ aᵢ exp(−|x − cᵢ|²/2sᵢ²), and Luneburg's, n² =
//! 2 − |x − c|²/R² within R.
//!
//! The index of Luneburg's lens is continuous at its edge, but not its slope. No step crosses the edge: from outside, a
//! step reaches as far as the straight ray takes to it; inside, where a ray is an ellipse about the centre, as far as the
//! ellipse does. Which side of the edge a step is on is decided at its start, by where the ray is and, on the edge itself,
//! by where it goes.
//!
//! Reference: Luneburg, "Mathematical Theory of Optics", 1964, 27–29.

use std::sync::Arc;

use glam::DVec3;

use super::index_field::{FieldSurvey, IndexField, Sink, Vectors, Viewpoint};

/// A lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GradedLens {
    /// Densest in its middle, fading away.
    Gaussian {
        /// World position of the middle.
        center: DVec3,
        /// Standard deviation s, scene units; positive.
        width: f64,
        /// Index in the middle less 1.
        amplitude: f64,
    },
    /// Gathers parallel rays in a point of its surface.
    Luneburg {
        /// World position of the middle.
        center: DVec3,
        /// Radius, scene units; positive.
        radius: f64,
    },
}

/// Lenses in flat space. Those of Luneburg are apart from all others, and the index is positive everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Lenses {
    lenses: Arc<[GradedLens]>,
    middle: DVec3,
    turning_radius: f64,
}

/// Distance at which a Gaussian lens ends, in widths: what is left there is 3e-18 of it.
const SUPPORT: f64 = 9.0;
/// Longest step in a Gaussian lens, in widths near the middle and as a part of the distance farther out.
const LONGEST: [f64; 2] = [0.75, 0.25];
/// Distance from the edge of Luneburg's lens that counts as none, relative to its radius.
const EDGE: f64 = 1e-12;

impl GradedLens {
    /// World position of the middle.
    pub fn center(&self) -> DVec3 {
        match *self {
            Self::Gaussian { center, .. } | Self::Luneburg { center, .. } => center,
        }
    }

    /// Distance from the middle at which it ends.
    pub fn support(&self) -> f64 {
        match *self {
            Self::Gaussian { width, .. } => SUPPORT * width,
            Self::Luneburg { radius, .. } => radius,
        }
    }
}

impl Lenses {
    /// These lenses.
    pub fn new(lenses: &[GradedLens]) -> Self {
        let middle = lenses.iter().map(GradedLens::center).sum::<DVec3>() / lenses.len() as f64;
        let reach = |lens: &GradedLens| lens.center().distance(middle) + lens.support();
        let turning_radius = lenses.iter().map(reach).fold(0.0, f64::max);
        Self { lenses: lenses.into(), middle, turning_radius }
    }

    /// The lenses.
    pub fn lenses(&self) -> &[GradedLens] {
        &self.lenses
    }
}

/// A ray beside a sphere.
#[derive(Clone, Copy)]
struct LensAspect {
    /// Position from the middle.
    away: [f64; 3],
    /// Its length squared.
    distance2: f64,
    /// Component of the direction away from the middle, times the distance.
    outwards: f64,
}

impl LensAspect {
    #[inline(always)]
    fn of<const L: usize>(center: DVec3, x: &Vectors<L>, p: &Vectors<L>, l: usize) -> Self {
        let away = [x[0][l] - center.x, x[1][l] - center.y, x[2][l] - center.z];
        let along = |v: [f64; 3], w: [f64; 3]| v[0] * w[0] + v[1] * w[1] + v[2] * w[2];
        let p = [p[0][l], p[1][l], p[2][l]];
        Self { away, distance2: along(away, away), outwards: along(away, p) / along(p, p).sqrt() }
    }

    /// Distance along the straight ray to the sphere of this radius, around the middle, from outside; infinite if it
    /// passes.
    #[inline(always)]
    fn entry(&self, radius: f64) -> f64 {
        let within2 = self.outwards * self.outwards - self.distance2 + radius * radius;
        let meets = (self.outwards < 0.0) & (within2 > 0.0);
        let way = -self.outwards - if meets { within2.sqrt() } else { 0.0 };
        if meets { way } else { f64::INFINITY }
    }

    /// True if a step from there is inside of Luneburg's lens of this radius.
    #[inline(always)]
    fn is_inside(&self, radius: f64) -> bool {
        let depth = self.distance2 / (radius * radius) - 1.0;
        (depth < -EDGE) | ((depth <= EDGE) & (self.outwards < 0.0))
    }
}

impl IndexField for Lenses {
    #[inline(always)]
    fn survey<const L: usize>(&self, x: &Vectors<L>, p: &Vectors<L>) -> FieldSurvey<L> {
        let (mut index, mut slope) = ([1.0; L], [[0.0; L]; 3]);
        let (mut inner, mut inner_force) = ([0.0; L], [[0.0; L]; 3]);
        let (mut room, mut reach) = ([f64::INFINITY; L], [f64::INFINITY; L]);
        for lens in &*self.lenses {
            for l in 0..L {
                let beside = LensAspect::of(lens.center(), x, p, l);
                let LensAspect { away, distance2, outwards } = beside;
                let (scale, longest);
                match *lens {
                    GradedLens::Gaussian { width, amplitude, .. } => {
                        let per_width2 = 1.0 / (width * width);
                        let excess = amplitude * libm::exp(-0.5 * distance2 * per_width2);
                        index[l] += excess;
                        for k in 0..3 {
                            slope[k][l] -= excess * per_width2 * away[k];
                        }
                        scale = (width * width + distance2).sqrt();
                        let near = (LONGEST[0] * width).max(LONGEST[1] * distance2.sqrt());
                        let outside = distance2 > SUPPORT * SUPPORT * width * width;
                        longest = if outside { beside.entry(SUPPORT * width).max(near) } else { near };
                    }
                    GradedLens::Luneburg { radius, .. } => {
                        scale = (radius * radius).max(distance2).sqrt();
                        if beside.is_inside(radius) {
                            let part = distance2 / (radius * radius);
                            inner[l] += 1.0 - part;
                            for k in 0..3 {
                                inner_force[k][l] -= away[k] / (radius * radius);
                            }
                            let n = (2.0 - part).max(0.0).sqrt();
                            // |X₀ cos θ + P R sin θ| = R, X₀ and P being position and momentum, θ = σ/R.
                            let twice = libm::atan2((1.0 - part).max(0.0), outwards * n / radius);
                            longest = 0.5 * radius * twice * n;
                        } else {
                            longest = beside.entry(radius);
                        }
                    }
                }
                room[l] = scale.min(room[l]);
                reach[l] = longest.min(reach[l]);
            }
        }
        let (mut index_squared, mut force) = ([0.0; L], [[0.0; L]; 3]);
        for l in 0..L {
            index_squared[l] = index[l] * index[l] + inner[l];
            for k in 0..3 {
                force[k][l] = index[l] * slope[k][l] + inner_force[k][l];
            }
        }
        FieldSurvey { index_squared, force, lean: [[0.0; L]; 3], room, reach }
    }

    /// Projective coordinates are the plain ones.
    #[inline(always)]
    fn acceleration<const L: usize>(&self, from: &Viewpoint<L>, y: &Vectors<L>) -> Vectors<L> {
        let (mut index, mut slope) = ([1.0; L], [[0.0; L]; 3]);
        let mut force = [[0.0; L]; 3];
        for lens in &*self.lenses {
            for l in 0..L {
                let center = lens.center();
                let at = |k: usize| from.x[k][l] + y[k][l] - center[k];
                let away = [at(0), at(1), at(2)];
                match *lens {
                    GradedLens::Gaussian { width, amplitude, .. } => {
                        let per_width2 = 1.0 / (width * width);
                        let distance2 = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
                        let excess = amplitude * libm::exp(-0.5 * distance2 * per_width2);
                        index[l] += excess;
                        for k in 0..3 {
                            slope[k][l] -= excess * per_width2 * away[k];
                        }
                    }
                    GradedLens::Luneburg { radius, .. } => {
                        if LensAspect::of(center, &from.x, &from.p, l).is_inside(radius) {
                            for k in 0..3 {
                                force[k][l] -= away[k] / (radius * radius);
                            }
                        }
                    }
                }
            }
        }
        for l in 0..L {
            for k in 0..3 {
                force[k][l] += index[l] * slope[k][l];
            }
        }
        force
    }

    /// Space is flat.
    fn area_scale(&self, _: DVec3) -> f64 {
        1.0
    }

    fn middle(&self) -> DVec3 {
        self.middle
    }

    fn turning_radius(&self) -> f64 {
        self.turning_radius
    }

    fn sinks(&self) -> &[Sink] {
        &[]
    }
}
