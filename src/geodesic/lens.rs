//! The lens map: which way light goes from one point to another, in closed form but for one integral.
//!
//! Let B = n/w be the impact parameter of a ray that grazes the sphere of inverse radius w. In the plane in which a
//! point has the polar radius B instead of ρ, a ray of impact parameter b is at the angle θ, sin θ = b/B, to the
//! radius. That is a straight line; only the angle swept along it is stretched (and coordinate time as its length is):
//!
//! ```text
//! dφ = κ dθ,   dt = κ dl,   κ = −d ln w / d ln B = 1/(1 − w g/n²).
//! ```
//!
//! κ is 1 in flat space and has a pole at the photon sphere, where B is least, at the critical impact parameter b_c. With
//! s² = 1 − b_c/B, s > 0 outside the photon sphere and s < 0 inside, h = κ s is analytic from the horizon or the other
//! side of a throat (s = −1) to infinity (s = 1): one short polynomial holds the whole lens. From
//!
//! ```text
//! dφ = 2 h ds / √((m − 1 + s²)(m + 1 − s²)),   m = b_c/b,
//! ```
//!
//! hyperbolic substitutions take out what is singular near b = b_c, and a Gauss–Legendre rule with a few nodes gives φ
//! and its derivative to any accuracy.
//!
//! Two points are joined by one ray in each winding class. Where they lie on the same side of the photon sphere, it is
//! found as a straight line of the plane: γ, the angle that it sweeps there, is the unknown, and φ(γ) grows from 0
//! without bound. Where they lie on both sides, m is. The solid angle at x over the area at y, in the chart, is
//!
//! ```text
//! dΩ/dA = b q_x² w_y² / (|sin φ| R),   q = 1/B,   R = |cos θ_x cos θ_y dφ/db|,
//! ```
//!
//! with R = φ′(γ) D on one side, D = q_x q_y times the length of the straight line; in flat space this is 1/distance².

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use glam::DVec3;

use crate::math::chebyshev::Chebyshev;
use crate::math::frame;
use crate::math::kernel::widest;
use crate::math::quadrature::gauss_legendre;
use crate::spacetime::ConformallyFlat;

/// The lens map of a static, spherically symmetric spacetime with one photon sphere.
#[derive(Clone, Debug)]
pub struct Lens {
    /// Critical impact parameter b_c.
    pub(super) critical: f64,
    /// Inverse radius of the photon sphere.
    photon_sphere: f64,
    /// h(s) on both sides of the photon sphere.
    through: Chebyshev,
    /// h(s) outside.
    pub(super) outside: Chebyshev,
    /// h(s) inside.
    pub(super) inside: Chebyshev,
    /// w(s), over the inverse radius of the photon sphere: its inverse is s without cancellation.
    place: Chebyshev,
    /// |s| up to which h is analytic, inside and outside.
    reach: [f64; 2],
    /// Gauss–Legendre rules, the number of nodes growing.
    pub(super) rules: Vec<Vec<(Lanes, Lanes)>>,
    /// What a rule must resolve: −½ ln of the relative error.
    digits: f64,
    /// Relative change of a root that ends its search.
    enough: f64,
    /// (κ − 1) B/b_c far away.
    weak: f64,
}

/// A place as the lens sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Site {
    /// Unit vector from the centre.
    pub(super) radial: DVec3,
    /// Inverse isotropic radius; 0 at infinity.
    w: f64,
    /// 1/B.
    pub(super) q: f64,
    /// s.
    pub(super) s: f64,
}

/// A ray from one place, x, to another, y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connection {
    /// Unit direction at x.
    pub direction: DVec3,
    /// Unit direction of travel at y.
    pub arrival: DVec3,
    /// Angle swept about the centre, radians.
    pub swept: f64,
    /// Impact parameter.
    pub b: f64,
    /// Solid angle at x over the area at y perpendicular to the ray, in the chart; over the solid angle there if y is at
    /// infinity. Infinite where rays of all azimuths meet.
    pub spread: f64,
    /// |dφ/dα| at x and at y, α the angle between ray and radius at one end and the other place fixed.
    pub swing: [f64; 2],
    /// Length of the straight line between two places on one side of the photon sphere, in the plane of B.
    pub(super) line: f64,
}

/// A ray from one place to another in the plane of its orbit.
#[derive(Clone, Copy, Debug)]
struct Track {
    /// Angle swept.
    swept: f64,
    /// Impact parameter.
    b: f64,
    /// Cosine and sine of the angle between the radius and the direction of travel, at the start.
    start: [f64; 2],
    /// The same at the end.
    end: [f64; 2],
    /// R.
    rate: f64,
    /// D; 0 between places on both sides of the photon sphere.
    distance: f64,
}

/// Terms of the polynomials: enough for rounding.
const TERMS: usize = 48;
/// Numbers of nodes, multiples of [`LANES`].
const RULES: [usize; 10] = [4, 8, 12, 16, 24, 32, 48, 64, 96, 128];
/// Nodes that are worked on together.
pub(super) const LANES: usize = 4;
pub(super) type Lanes = [f64; LANES];
/// |s| below which s is found from w: its square loses digits.
const NEAR_PHOTON_SPHERE: f64 = 0.05;
/// |s| below which both places are taken to be next to the photon sphere, relative errors of this size included: 1/B,
/// which is largest there, no longer tells them apart.
const ON_PHOTON_SPHERE: f64 = 5e-6;
/// Inverse radius in units of the photon sphere's, beyond which the index of a horizon at the centre need not be known.
const DEEPEST: f64 = 1e9;
/// Angle, radians, that a radial ray is taken to sweep: far below rounding.
const RADIAL: f64 = 1e-20;
/// Angle, radians, above which the sine of the swept angle is that of the angle between the places.
const AROUND: f64 = 1.0;
/// Largest |ln(m − 1)|: of a radial ray, and of one that winds until rounding hides it.
const LARGEST: f64 = 128.0;
/// Relative rounding of a swept angle.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Angle between places, radians, up to which a ray is guessed to be bent weakly.
const WEAK: f64 = 2.8;
/// What the estimated error of a root that is not evaluated must keep of what is enough.
const SLOPE_SAFETY: f64 = 0.1;
/// Most iterations of a root.
const MOST_ITERATIONS: u32 = 60;

impl Lens {
    /// The lens of `medium`, with relative errors of about `tolerance`; `None` if there is no photon sphere.
    pub fn new<M: ConformallyFlat>(medium: &M, tolerance: f64) -> Option<Self> {
        let (critical, photon_sphere) = (medium.critical_impact_parameter(), 1.0 / medium.photon_sphere());
        if !(critical > 0.0 && photon_sphere.is_finite()) {
            return None;
        }
        // Where the horizon is at the centre, w(s) has a pole at s = -1: it is fitted where it is asked for.
        let (innermost, near) = match medium.horizon() {
            0.0 => (DEEPEST * photon_sphere, (-0.5, 0.5)),
            horizon => (1.0 / horizon, (-1.0, 1.0)),
        };
        let place = |s: f64| {
            let (low, high) = if s > 0.0 { (0.0, photon_sphere) } else { (photon_sphere, innermost) };
            let is_lower = |w: f64| critical * w / medium.index(w) < 1.0 - s * s;
            bisect(low, high, |w| is_lower(w) == (s > 0.0))
        };
        // Next to s = 0, where its quotient is 0/0, h is known from afar.
        let whole = Chebyshev::fit(TERMS, (-1.0, 1.0), |s| {
            let w = place(s);
            s / (1.0 - w * medium.pull(w) / medium.index_squared(w))
        });
        let part = |low: f64, high: f64| {
            Chebyshev::fit(TERMS, (low, high), |s| whole.at(s)[0]).trimmed(0.1 * tolerance)
        };
        let (inside, outside) = (part(-1.0, 0.0), part(0.0, 1.0));
        // Both intervals are half as long as 1: the middle, and as many halves as the ellipse of convergence is long.
        let reach = [&inside, &outside].map(|fit| 0.5 + 0.5 * fit.reach(0.1 * tolerance));
        Some(Self {
            critical,
            photon_sphere,
            through: whole.trimmed(0.1 * tolerance),
            weak: 0.5 * (1.0 - outside.at(1.0)[1]),
            outside,
            inside,
            reach,
            place: Chebyshev::fit(TERMS, near, |s| place(s) / photon_sphere),
            rules: RULES.map(rule).to_vec(),
            digits: -0.5 * libm::log(tolerance),
            enough: tolerance,
        })
    }

    /// The place `x`, relative to the centre, not 0 and outside the horizon.
    pub fn site<M: ConformallyFlat>(&self, medium: &M, x: DVec3) -> Site {
        let rho = x.length();
        let w = 1.0 / rho;
        let q = w / medium.index(w);
        let size = (1.0 - self.critical * q).max(0.0).sqrt();
        let mut s = if w > self.photon_sphere { -size } else { size };
        if size < NEAR_PHOTON_SPHERE {
            for _ in 0..3 {
                let [value, slope] = self.place.at(s);
                s -= (value - w / self.photon_sphere) / slope;
            }
            s = s.abs().max(f64::EPSILON).copysign(s);
        }
        Site { radial: x / rho, w, q, s }
    }

    /// The ray from `x` to `y` that sweeps g, the angle between them (`winding` 0), 2π − g (1), 2π + g (2), and so on;
    /// `None` if the places are the same and it need not leave, or if rounding hides it.
    pub fn connect(&self, x: &Site, y: &Site, winding: u32) -> Option<Connection> {
        let spin = x.radial.cross(y.radial);
        let sin = spin.length();
        let angle = libm::atan2(sin, x.radial.dot(y.radial));
        let (turns, odd) = (f64::from(winding) * PI, winding % 2 == 1);
        let swept = if odd { turns + (PI - angle) } else { turns + angle };
        let radial = swept < RADIAL;
        if radial && x.w == y.w {
            return None;
        }
        let (swept, sine) = if radial { (RADIAL, RADIAL) } else { (swept, sin) };
        let track = self.track(x, y, swept)?;
        let axis = if sin > 0.0 { spin / sin } else { x.radial.cross(frame::tangents(x.radial).0) };
        let axis = if odd { -axis } else { axis };
        let vector = |site: &Site, [cos, sin]: [f64; 2]| {
            // The axis is only as good as the angle between the places is large.
            let along = axis.cross(site.radial).normalize();
            (cos * site.radial + sin * along).normalize()
        };
        Some(Connection {
            direction: vector(x, track.start),
            arrival: vector(y, track.end),
            swept,
            b: track.b,
            spread: spread(x, y, &track, sine),
            swing: [track.rate / (x.q * track.end[0].abs()), track.rate / (y.q * track.start[0].abs())],
            line: track.distance / (x.q * y.q),
        })
    }

    /// The unit direction in which the ray that [`Self::connect`] finds arrives at `y`, roughly and at once: to first order
    /// in the bending if the ray does not go around, else as the critical ray.
    pub fn aim(&self, x: &Site, y: &Site, winding: u32) -> DVec3 {
        let spin = x.radial.cross(y.radial);
        let sin = spin.length();
        let angle = libm::atan2(sin, x.radial.dot(y.radial));
        let odd = winding % 2 == 1;
        let axis = if sin > 0.0 { spin / sin } else { x.radial.cross(frame::tangents(x.radial).0) };
        let along = if odd { -axis } else { axis }.cross(y.radial);
        let reversed = y.q > x.q;
        let (near, far) = if reversed { (y, x) } else { (x, y) };
        let gamma = self.guess(near, far, angle, sin / (1.0 + x.radial.dot(y.radial)));
        let is_weak = winding == 0 && far.s > 0.0 && near.s > 0.0 && gamma > 0.0 && angle < WEAK;
        let [cos, sin] = if is_weak {
            let d = distance(near, far, gamma);
            let (sin, cos) = libm::sincos(gamma);
            if reversed {
                [-(near.q * cos - far.q) / d, near.q * sin / d]
            } else {
                [(near.q - far.q * cos) / d, far.q * sin / d]
            }
        } else {
            let sin = (self.critical * y.q).min(1.0);
            [(1.0 - sin * sin).sqrt().copysign(y.s), sin]
        };
        (cos * y.radial + sin * along).try_normalize().unwrap_or(y.radial)
    }

    /// The part of the light from a small source at `y` that goes around the far side, relative to what comes the near
    /// way, for a lens that bends rays by 2c/b: exact far from the centre and close to alignment, an estimate elsewhere.
    ///
    /// The images of a point mass \[Schneider, Ehlers, Falco 1992, "Gravitational Lenses", 2.3\].
    pub fn odds(&self, x: &Site, y: &Site) -> f64 {
        let (spin, along) = (x.radial.cross(y.radial).length(), x.radial.dot(y.radial));
        let off = libm::atan2(spin, -along);
        // b²/f − b off − 2c = 0, whose roots are the impact parameters of the two images.
        let root = (off * off + 8.0 * self.weak * self.critical * (x.w + y.w)).sqrt();
        ((root - off) / (root + off)).powi(2)
    }

    /// Winding number and [`Connection::spread`] of a ray that leaves `x` in the unit `direction` and arrives at `y`
    /// travelling in the unit direction `arrival`.
    pub fn ray(&self, x: &Site, direction: DVec3, y: &Site, arrival: DVec3) -> Option<(u32, f64)> {
        let (spin, across) = (x.radial.cross(y.radial), x.radial.cross(direction));
        let b = across.length().max(RADIAL) / x.q;
        let track = if (x.s > 0.0) != (y.s > 0.0) {
            self.through(x, y, (self.critical - b).max(0.0) / b)
        } else {
            let side = x.s.signum();
            let (near, far) = if y.q > x.q { (y, x) } else { (x, y) };
            let cos = if y.q > x.q { -arrival.dot(y.radial) } else { direction.dot(x.radial) };
            let leaving = (b * near.q).min(1.0);
            let cos = (1.0 - leaving * leaving).sqrt().copysign(side * cos);
            let gamma = libm::atan2(leaving, cos) - libm::asin((b * far.q).min(1.0));
            self.beside(near, far, gamma.max(RADIAL)).map(|track| oriented(track, y.q > x.q))
        }?;
        // g is between 0 and π, and the winding even, if the ray sets out on the short way.
        let turns = track.swept / (2.0 * PI);
        let winding = if spin.dot(across) < 0.0 {
            2.0 * (turns + 0.25).round() - 1.0
        } else {
            2.0 * (turns - 0.25).round()
        };
        let sine = if track.swept < AROUND { libm::sin(track.swept) } else { spin.length() };
        Some((winding.max(0.0) as u32, spread(x, y, &track, sine)))
    }

    /// The ray from `x` to `y` that sweeps an angle.
    fn track(&self, x: &Site, y: &Site, swept: f64) -> Option<Track> {
        widest(Tracking { lens: self, x, y, swept })
    }

    #[inline(always)]
    fn find_track(&self, x: &Site, y: &Site, swept: f64) -> Option<Track> {
        if x.s.abs().max(y.s.abs()) < ON_PHOTON_SPHERE {
            return Some(self.circling(x, y, swept));
        }
        if (x.s > 0.0) != (y.s > 0.0) {
            // ln(m − 1), of which ln(e^φ − 1) is nearly a linear function.
            let wanted = size(swept);
            return root(
                (-LARGEST, LARGEST, -wanted),
                self.enough,
                &Across { lens: self, x, y, swept, wanted },
            );
        }
        let reversed = y.q > x.q;
        let (near, far) = if reversed { (y, x) } else { (x, y) };
        // Where b reaches b_c beyond the point next to the photon sphere: cos θ = −√(1 − (b_c q)²).
        let critical = |site: &Site| {
            let s2 = site.s * site.s;
            libm::atan2(1.0 - s2, (s2 * (2.0 - s2)).sqrt())
        };
        let most = PI - critical(near) - critical(far);
        let guess =
            if swept < 0.9 * most { self.guess(near, far, swept, libm::tan(0.5 * swept)) } else { swept };
        let guess = if guess < 0.98 * most { guess } else { most * (1.0 - 0.5 * libm::exp(-swept)) };
        root((0.0, most, guess), self.enough, &Beside { lens: self, near, far, swept })
            .map(|track| oriented(track, reversed))
    }

    /// The straight angle of a weakly bent ray that sweeps an angle whose half has the tangent `half`: κ is 1 + c q to
    /// first order, and q adds up along the line to the sum of both ends' times that tangent.
    #[inline(always)]
    fn guess(&self, near: &Site, far: &Site, swept: f64, half: f64) -> f64 {
        let bend = self.weak * self.critical * (near.q + far.q);
        let first = bend * half;
        // The tangent at the first guess, by its derivatives.
        let slope = 0.5 * (1.0 + half * half);
        let less = half - first * slope * (1.0 - 0.5 * first * half);
        let slope = 0.5 * (1.0 + less * less);
        swept - first - (bend * less - first) / (1.0 + bend * slope)
    }

    /// The ray between two places on the same side of the photon sphere that sweeps the angle `gamma` as a straight
    /// line; from `near`, with the larger q, to `far`.
    #[inline(always)]
    fn beside(&self, near: &Site, far: &Site, gamma: f64) -> Option<Track> {
        let (side, fit) = if near.s < 0.0 { (-1.0, &self.inside) } else { (1.0, &self.outside) };
        let (b, leaving, arriving, d) = straight(near, far, gamma);
        let (sin, cos) = libm::sincos(gamma);
        let db = (cos * d * d - near.q * far.q * sin * sin) / (d * d * d);
        let m = self.critical / b;
        let (swept, slope) = if m > 1.0 {
            // Far away s is 1 to rounding.
            let sum = (near.s + far.s).abs();
            let gap = if sum > 2.0 * NEAR_PHOTON_SPHERE {
                self.critical * (near.q - far.q) / sum
            } else {
                (near.s - far.s).abs()
            };
            let (swept, slope) = self.monotone(fit, near.s, far.s, gap, m - 1.0);
            (swept, -slope * m / b * db)
        } else {
            let [end, start] = [leaving, arriving].map(|[cos, sin]| -cos / (1.0 + sin));
            let (swept, by_b) = self.turning(fit, (start, end, gamma), b, side);
            let [at_near, at_far] = [near, far].map(|site| fit.at(site.s)[0] / site.s.abs());
            let bend = far.q * (near.q * cos - far.q) / (d * d);
            (swept, at_near * (1.0 + bend) - at_far * bend + by_b * db)
        };
        let outwards = |[cos, sin]: [f64; 2]| [side * cos, sin];
        let (start, end) = (outwards(leaving), outwards(arriving));
        let track = Track { swept, b, start, end, rate: slope * d, distance: d };
        (swept.is_finite() && track.rate > 0.0).then_some(track)
    }

    /// The ray with m − 1 = `above` > 0 between two places on both sides of the photon sphere.
    #[inline(always)]
    fn through(&self, x: &Site, y: &Site, above: f64) -> Option<Track> {
        let (swept, slope) = self.monotone(&self.through, x.s, y.s, (x.s - y.s).abs(), above);
        let m = 1.0 + above;
        let b = self.critical / m;
        let way = if y.s > x.s { 1.0 } else { -1.0 };
        // 1 − (b/B)², without cancellation.
        let [start, end] = [x, y].map(|site| {
            let s2 = site.s * site.s;
            [way * ((above + s2) * (m + 1.0 - s2)).sqrt() / m, b * site.q]
        });
        let rate = (start[0] * end[0] * slope * m / b).abs();
        (above > 0.0 && swept.is_finite() && rate > 0.0).then_some(Track {
            swept,
            b,
            start,
            end,
            rate,
            distance: 0.0,
        })
    }

    /// The ray between two places next to the photon sphere that sweeps an angle. There s is a sum of e^λφ and e^−λφ.
    fn circling(&self, x: &Site, y: &Site, swept: f64) -> Track {
        let growth = FRAC_1_SQRT_2 / self.outside.at(0.0)[0];
        let (sinh, cosh) = (libm::sinh(growth * swept), libm::cosh(growth * swept));
        // ds/d(λφ), whose square is m − 1 + s².
        let rates = [(y.s - x.s * cosh) / sinh, (y.s * cosh - x.s) / sinh];
        let above = rates[0] * rates[0] - x.s * x.s;
        let m = 1.0 + above;
        let b = self.critical / m;
        let vector = |site: &Site, rate: f64| {
            let cos = (rate * (m + 1.0 - site.s * site.s).sqrt() / m).clamp(-1.0, 1.0);
            [cos, (1.0 - cos * cos).sqrt()]
        };
        let (start, end) = (vector(x, rates[0]), vector(y, rates[1]));
        let distance = x.q * (end[0] - start[0]).abs();
        Track { swept, b, start, end, rate: x.q * sinh / growth, distance }
    }

    /// φ and dφ/dm of a ray with m − 1 = `above` > 0, between two places that are `gap` apart.
    #[inline(always)]
    fn monotone(&self, fit: &Chebyshev, from: f64, to: f64, gap: f64, above: f64) -> (f64, f64) {
        // Where both singularities are far away, a longer unit would cost s its digits.
        let unit = above.sqrt().min(1.0);
        let m = 1.0 + above;
        let (low, high) = (from.min(to), from.max(to));
        // Where the root below is 0, or h ceases to be analytic.
        let bound = (m + 1.0).sqrt();
        let beyond = [-self.reach[0].min(bound), self.reach[1].min(bound)].map(|s| s / unit);
        let [swept, slope] = self.integrate((low / unit, high / unit, gap / unit), beyond, |sinh, cosh| {
            let s = sinh.map(|sinh| unit * sinh);
            let [h, _] = fit.at_each(s);
            std::array::from_fn(|i| {
                let s2 = s[i] * s[i];
                let below = (above + s2) * (m + 1.0 - s2);
                let term = 2.0 * h[i] * unit * cosh[i] / below.sqrt();
                [term, term / below]
            })
        });
        (swept, -m * slope)
    }

    /// φ, and dφ/db at fixed angles, of a ray of impact parameter `b` > b_c between the angles 2 atan `start` and 2 atan
    /// `end`, `gamma` apart, from its turning point, on the side of the photon sphere that `side` says.
    #[inline(always)]
    fn turning(
        &self,
        fit: &Chebyshev,
        (start, end, gamma): (f64, f64, f64),
        b: f64,
        side: f64,
    ) -> (f64, f64) {
        let m = self.critical / b;
        // Of tan²(θ/2) where B would be b_c: negative.
        let pole = ((b - self.critical) / (b + self.critical)).max(f64::MIN_POSITIVE).sqrt();
        let scale = (1.0 + m).sqrt();
        let gap = libm::sin(0.5 * gamma) * ((1.0 + start * start) * (1.0 + end * end)).sqrt();
        let range = (start / pole, end / pole, gap / pole);
        let [swept, by_b] = self.integrate(range, [-f64::INFINITY, f64::INFINITY], |sinh, cosh| {
            let round: Lanes = sinh.map(|sinh| (1.0 + (pole * sinh).powi(2)).sqrt());
            let s: Lanes = std::array::from_fn(|i| side * scale * pole * cosh[i] / round[i]);
            let [h, dh] = fit.at_each(s);
            std::array::from_fn(|i| {
                let share = 1.0 / (scale * round[i]);
                let s2 = s[i] * s[i];
                [2.0 * h[i] * share, (1.0 - s2) * (h[i] - s[i] * dh[i]) * share / s2]
            })
        });
        (swept, -by_b / b)
    }

    /// Integrals over v, sinh v from `low` to `high`, of two functions of sinh v and cosh v whose singularities are where
    /// sinh v has the values `beyond` or have an imaginary part of at least π/2. `gap` is `high` − `low`, without its
    /// rounding.
    #[inline(always)]
    fn integrate(
        &self,
        (low, high, gap): (f64, f64, f64),
        beyond: [f64; 2],
        f: impl Fn(Lanes, Lanes) -> [[f64; 2]; LANES],
    ) -> [f64; 2] {
        let exp_arsinh = |sinh: f64| {
            let larger = sinh.abs() + (1.0 + sinh * sinh).sqrt();
            if sinh < 0.0 { 1.0 / larger } else { larger }
        };
        let middle = (exp_arsinh(low) * exp_arsinh(high)).sqrt();
        let half = arsinh(gap / (middle + 1.0 / middle));
        // A rule of N nodes on an ellipse that keeps off the singularities [Trefethen 2013, th. 19.3]. On the real axis the
        // nearer one counts.
        let nearer = (middle / exp_arsinh(beyond[0])).min(exp_arsinh(beyond[1]) / middle);
        let real = (libm::log(nearer) / half).max(1.0);
        let across = arsinh(0.5 * PI / half.max(1e-3));
        let wanted = self.digits / across.min(libm::log(real + (real * real - 1.0).sqrt())).max(1e-3);
        let longest = RULES.len() - 1;
        let rule = RULES.iter().position(|&nodes| nodes as f64 >= wanted).unwrap_or(longest);
        let mut sums = [0.0; 2];
        for (x, weight) in &self.rules[rule] {
            let grown = x.map(|x| middle * libm::exp(half * x));
            let shrunk = grown.map(|grown| 1.0 / grown);
            let values = f(
                std::array::from_fn(|i| 0.5 * (grown[i] - shrunk[i])),
                std::array::from_fn(|i| 0.5 * (grown[i] + shrunk[i])),
            );
            for ([a, b], weight) in values.iter().zip(weight) {
                sums[0] += weight * a;
                sums[1] += weight * b;
            }
        }
        sums.map(|sum| half * sum)
    }
}

/// `count` nodes and weights in groups.
fn rule(count: usize) -> Vec<(Lanes, Lanes)> {
    let nodes = gauss_legendre(count);
    let group = |group: &[(f64, f64); LANES]| (group.map(|node| node.0), group.map(|node| node.1));
    nodes.as_chunks().0.iter().map(group).collect()
}

impl Site {
    /// The place at infinity in the unit direction `radial`.
    pub fn infinity(radial: DVec3) -> Self {
        Self { radial, w: 0.0, q: 0.0, s: 1.0 }
    }
}

/// [`Connection::spread`] of a track from `x` to `y`, given |sin φ|.
fn spread(x: &Site, y: &Site, track: &Track, sine: f64) -> f64 {
    let far = if y.w > 0.0 { y.w * y.w } else { 1.0 };
    track.b * x.q * x.q * far / (sine * track.rate)
}

/// Inverse hyperbolic sine of a number ≥ 0, to relative rounding and faster than the standard library's.
#[inline(always)]
fn arsinh(x: f64) -> f64 {
    if x > 0.05 {
        return libm::log(x + (1.0 + x * x).sqrt());
    }
    // Its Taylor series: the next term is below 1e-17.
    let square = x * x;
    let terms = [-63.0 / 2816.0, 35.0 / 1152.0, -5.0 / 112.0, 3.0 / 40.0, -1.0 / 6.0];
    x + x * terms.iter().fold(0.0, |sum, term| (sum + term) * square)
}

/// Of the straight line between two places that are seen under the angle `gamma`: impact parameter, cosine and sine of the
/// angle to the radius at the start and at the end, and [`distance`].
#[inline(always)]
fn straight(near: &Site, far: &Site, gamma: f64) -> (f64, [f64; 2], [f64; 2], f64) {
    let (sin, cos) = libm::sincos(gamma);
    let d = distance(near, far, gamma);
    let leaving = [(near.q * cos - far.q) / d, near.q * sin / d];
    let arriving = [(near.q - far.q * cos) / d, far.q * sin / d];
    (sin / d, leaving, arriving, d)
}

/// The search for a track, for the widest vectors that the machine has.
struct Tracking<'a> {
    lens: &'a Lens,
    x: &'a Site,
    y: &'a Site,
    swept: f64,
}

impl pulp::NullaryFnOnce for Tracking<'_> {
    type Output = Option<Track>;

    #[inline(always)]
    fn call(self) -> Option<Track> {
        self.lens.find_track(self.x, self.y, self.swept)
    }
}

/// q_x q_y times the length of the straight line between two places that are seen under an angle: the third side of the
/// triangle of their inverse radii.
#[inline(always)]
fn distance(x: &Site, y: &Site, angle: f64) -> f64 {
    let half = libm::sin(0.5 * angle);
    ((x.q - y.q).powi(2) + 4.0 * x.q * y.q * half * half).sqrt()
}

/// The track, or the same run backwards.
#[inline(always)]
fn oriented(track: Track, reversed: bool) -> Track {
    if !reversed {
        return track;
    }
    let [start, end] = [track.end, track.start].map(|[cos, sin]| [-cos, sin]);
    Track { start, end, ..track }
}

/// The rays between two places, by one number.
trait Family {
    /// The ray at a place, how far that is beyond the wanted one by Newton's method, and how much too far the ray sweeps.
    fn at(&self, place: f64) -> Option<(Track, f64, f64)>;

    /// The wanted ray at a place, given how the swept angle grows there; `None` if only an integral tells.
    fn at_root(&self, place: f64, slope: f64) -> Option<Track>;
}

/// Rays between two places on both sides of the photon sphere, by ln(m − 1).
struct Across<'a> {
    lens: &'a Lens,
    x: &'a Site,
    y: &'a Site,
    swept: f64,
    /// [`size`] of it.
    wanted: f64,
}

/// Nearly a linear function of ln(m − 1): ln(e^φ − 1).
fn size(swept: f64) -> f64 {
    swept + libm::log(-libm::expm1(-swept))
}

impl Family for Across<'_> {
    #[inline(always)]
    fn at(&self, t: f64) -> Option<(Track, f64, f64)> {
        let above = libm::exp(t);
        let track = self.lens.through(self.x, self.y, above)?;
        // dφ/dt = dφ/db db/dm dm/dt, b = b_c/m.
        let slope = track.rate / (track.start[0] * track.end[0]).abs();
        let slope = -slope * self.lens.critical * above / (1.0 + above).powi(2);
        let shift = (size(track.swept) - self.wanted) * -libm::expm1(-track.swept) / slope;
        Some((track, shift, self.swept - track.swept))
    }

    #[inline(always)]
    fn at_root(&self, _: f64, _: f64) -> Option<Track> {
        None
    }
}

/// Rays between two places on one side of the photon sphere, by the angle that they sweep as straight lines.
struct Beside<'a> {
    lens: &'a Lens,
    near: &'a Site,
    far: &'a Site,
    swept: f64,
}

impl Family for Beside<'_> {
    #[inline(always)]
    fn at(&self, gamma: f64) -> Option<(Track, f64, f64)> {
        let track = self.lens.beside(self.near, self.far, gamma)?;
        let slope = track.rate / track.distance;
        // Towards the critical ray e^−φ is linear in γ.
        let excess = track.swept - self.swept;
        let shift =
            if excess.abs() < 0.5 { excess * (1.0 + 0.5 * excess) } else { libm::expm1(excess).min(1e3) };
        Some((track, shift / slope, excess))
    }

    #[inline(always)]
    fn at_root(&self, gamma: f64, slope: f64) -> Option<Track> {
        let (b, start, end, distance) = straight(self.near, self.far, gamma);
        let side = self.near.s.signum();
        let [start, end] = [start, end].map(|[cos, sin]| [side * cos, sin]);
        Some(Track { swept: self.swept, b, start, end, rate: slope * distance, distance })
    }
}

/// The ray that sweeps as much as is wanted, between two bounds of its number and from a guess.
///
/// Where two places before tell the slope well enough, the last is not integrated.
#[inline(always)]
fn root((mut low, mut high, guess): (f64, f64, f64), enough: f64, rays: &impl Family) -> Option<Track> {
    let mut at = guess.clamp(low, high);
    let mut best = None;
    // The place before, and the slope of the swept angle there.
    let mut before: Option<(f64, f64)> = None;
    for _ in 0..MOST_ITERATIONS {
        let Some((track, shift, excess)) = rays.at(at) else {
            // Too close to the critical ray for a number.
            high = at;
            at = 0.5 * (low + high);
            continue;
        };
        best = Some(track);
        if excess > 0.0 {
            high = at;
        } else {
            low = at;
        }
        let met = (enough * track.swept.min(1.0)).max(ROUNDING * track.swept);
        let is_met = excess.abs() <= met || shift.abs() <= f64::EPSILON * at.abs();
        if is_met || high - low <= f64::EPSILON * high.abs() {
            break;
        }
        let next = at - shift;
        let is_inside = next > low && next < high;
        let slope = track.rate / track.distance;
        if let (Some((place, earlier)), true) = (before, is_inside) {
            // The slope varies by `bend` from place to place: Newton's next error, and what is left of the slope's beyond
            // the straight line through both.
            let change = (slope - earlier) / (at - place);
            let bend = (change / slope).abs();
            let left = (bend * shift).abs() * ((next - place) * bend).abs().max((shift / at).abs());
            if left < SLOPE_SAFETY * enough {
                let found = rays.at_root(next, slope + change * (next - at));
                if found.is_some() {
                    return found;
                }
            }
        }
        before = Some((at, slope));
        at = if is_inside { next } else { 0.5 * (low + high) };
    }
    best
}

/// Where a predicate that holds from `low` on ceases to, between `low` and `high`.
fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    while high - low > f64::EPSILON * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spacetime::Schwarzschild;

    fn lens() -> (Schwarzschild, Lens) {
        let hole = Schwarzschild::new(1.0);
        (hole, Lens::new(&hole, 1e-15).unwrap())
    }

    /// The unit vector at an angle in a plane.
    fn at(angle: f64) -> DVec3 {
        DVec3::new(angle.cos(), angle.sin(), 0.0)
    }

    #[test]
    fn light_from_infinity_is_deflected_as_einstein_and_the_next_order_say() {
        let (hole, lens) = lens();
        for bend in [1e-2, 1e-3, 1e-4] {
            // Far behind the hole, swept π + bend.
            let (x, y) = (Site::infinity(at(0.0)), lens.site(&hole, 1e9 * at(PI + bend)));
            let ray = lens.connect(&x, &y, 1).unwrap();
            // bend = 2 r_s/b + 15π/16 (r_s/b)², less the angle b/ρ that is left.
            let expected = 2.0 / ray.b + 15.0 * PI / 16.0 / (ray.b * ray.b) - ray.b / 1e9;
            assert!((expected / bend - 1.0).abs() < 3.0 * bend * bend + 1e-8, "{bend}: {expected}");
            assert!(ray.direction.distance(-at(0.0)) < 1e-15 && ray.arrival.distance(at(PI + bend)) < 1e-4);
        }
    }

    #[test]
    fn the_photon_sphere_joins_its_points_by_circles() {
        let (hole, lens) = lens();
        let rho = hole.photon_sphere();
        for angle in [0.1, 1.0, 3.0] {
            let [x, y] = [0.0, angle].map(|angle| lens.site(&hole, rho * at(angle)));
            for winding in 0..3 {
                let ray = lens.connect(&x, &y, winding).unwrap();
                assert!((ray.b / lens.critical - 1.0).abs() < 1e-14, "{ray:?}");
                let way = if winding == 1 { -1.0 } else { 1.0 };
                assert!(ray.direction.distance(way * at(0.5 * PI)) < 1e-6, "{ray:?}");
                // Rays beside it part like sin φ across its plane, like sinh φ in it.
                let exact = 1.0 / (rho * rho * (ray.swept.sin() * ray.swept.sinh()).abs());
                assert!((ray.spread / exact - 1.0).abs() < 1e-12, "{ray:?}, exactly {exact}");
                let time = lens.time(&x, &y, &ray);
                assert!((time / (ray.b * ray.swept) - 1.0).abs() < 1e-12, "{time}");
            }
        }
    }

    #[test]
    fn one_place_is_joined_to_itself_only_around_the_hole() {
        let (hole, lens) = lens();
        let x = lens.site(&hole, DVec3::new(1.0, 2.0, -3.0));
        assert_eq!(lens.connect(&x, &x, 0), None);
        let ring = lens.connect(&x, &x, 1).unwrap();
        assert_eq!((ring.swept, ring.spread), (2.0 * PI, f64::INFINITY));
    }
}
