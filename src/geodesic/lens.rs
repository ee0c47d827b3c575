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

use std::f64::consts::PI;

use glam::DVec3;

use crate::math::chebyshev::Chebyshev;
use crate::math::frame;
use crate::math::quadrature::gauss_legendre;
use crate::spacetime::ConformallyFlat;

/// The lens map of a static, spherically symmetric spacetime with one photon sphere.
#[derive(Clone, Debug)]
pub struct Lens {
    /// Critical impact parameter b_c.
    critical: f64,
    /// Inverse radius of the photon sphere.
    photon_sphere: f64,
    /// h(s) on both sides of the photon sphere.
    through: Chebyshev,
    /// h(s) outside.
    outside: Chebyshev,
    /// h(s) inside.
    inside: Chebyshev,
    /// w(s), over the inverse radius of the photon sphere: its inverse is s without cancellation.
    place: Chebyshev,
    /// Rules of integration, the number of nodes growing.
    rules: Vec<Rule>,
    /// Relative change of a root that ends its search.
    enough: f64,
    /// (κ − 1) B/b_c far away.
    weak: f64,
}

/// A place as the lens sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Site {
    /// Unit vector from the centre.
    radial: DVec3,
    /// Inverse isotropic radius; 0 at infinity.
    w: f64,
    /// 1/B.
    q: f64,
    /// s.
    s: f64,
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
}

/// A Gauss–Legendre rule for functions whose singularities are π/2 or farther from the real axis.
#[derive(Clone, Debug)]
struct Rule {
    /// Half the longest interval on which it is good enough.
    reach: f64,
    /// Nodes on [−1, 1] and weights, in groups.
    nodes: Vec<(Lanes, Lanes)>,
}

/// Terms of the polynomials: enough for rounding.
const TERMS: usize = 48;
/// Numbers of nodes, multiples of [`LANES`].
const RULES: [usize; 10] = [4, 8, 12, 16, 24, 32, 48, 64, 96, 128];
/// Nodes that are worked on together.
const LANES: usize = 4;
type Lanes = [f64; LANES];
/// |s| below which s is found from w: its square loses digits.
const NEAR_PHOTON_SPHERE: f64 = 0.05;
/// Angles between places, radians, below which a ray that does not go around is radial.
const RADIAL: f64 = 1e-9;
/// Angle between places, radians, up to which a ray is guessed to be bent weakly.
const WEAK: f64 = 2.8;
/// Most iterations of a root.
const MOST_ITERATIONS: u32 = 60;

impl Lens {
    /// The lens of `medium`, with relative errors of about `tolerance`; `None` if there is no photon sphere.
    pub fn new<M: ConformallyFlat>(medium: &M, tolerance: f64) -> Option<Self> {
        let (critical, photon_sphere) = (medium.critical_impact_parameter(), 1.0 / medium.photon_sphere());
        if !(critical > 0.0 && photon_sphere.is_finite()) {
            return None;
        }
        let innermost = 1.0 / medium.horizon();
        let place = |s: f64| {
            let (low, high) = if s > 0.0 { (0.0, photon_sphere) } else { (photon_sphere, innermost) };
            let is_lower = |w: f64| critical * w / medium.index_squared(w).sqrt() < 1.0 - s * s;
            bisect(low, high, |w| is_lower(w) == (s > 0.0))
        };
        let stretch = |low: f64, high: f64| {
            let h = |s: f64| {
                let w = place(s);
                s / (1.0 - w * medium.pull(w) / medium.index_squared(w))
            };
            Chebyshev::fit(TERMS, (low, high), h).trimmed(0.1 * tolerance)
        };
        let outside = stretch(0.0, 1.0);
        Some(Self {
            critical,
            photon_sphere,
            through: stretch(-1.0, 1.0),
            weak: 0.5 * (1.0 - outside.at(1.0)[1]),
            outside,
            inside: stretch(-1.0, 0.0),
            place: Chebyshev::fit(TERMS, (-1.0, 1.0), |s| place(s) / photon_sphere),
            rules: RULES.map(|count| Rule::new(count, tolerance)).to_vec(),
            enough: (10.0 * tolerance).max(4.0 * f64::EPSILON),
        })
    }

    /// The place `x`, relative to the centre, not 0 and outside the horizon.
    pub fn site<M: ConformallyFlat>(&self, medium: &M, x: DVec3) -> Site {
        let rho = x.length();
        let w = 1.0 / rho;
        let q = w / medium.index_squared(w).sqrt();
        let size = (1.0 - self.critical * q).max(0.0).sqrt();
        let mut s = if w > self.photon_sphere { -size } else { size };
        if size < NEAR_PHOTON_SPHERE {
            for _ in 0..3 {
                let [value, slope] = self.place.at(s);
                s -= (value - w / self.photon_sphere) / slope;
            }
        }
        Site { radial: x / rho, w, q, s }
    }

    /// The ray from `x` to `y` that sweeps g, the angle between them (`winding` 0), 2π − g (1), 2π + g (2), and so on;
    /// `None` if rounding hides it or if there is none.
    pub fn connect(&self, x: &Site, y: &Site, winding: u32) -> Option<Connection> {
        let spin = x.radial.cross(y.radial);
        let sin = spin.length();
        let angle = sin.atan2(x.radial.dot(y.radial));
        let (turns, odd) = (f64::from(winding) * PI, winding % 2 == 1);
        let swept = if odd { turns + (PI - angle) } else { (turns + angle).max(RADIAL) };
        let half = sin / (1.0 + x.radial.dot(y.radial));
        let track = self.track(x, y, swept, half)?;
        let axis = if sin > 0.0 { spin / sin } else { x.radial.cross(frame::tangents(x.radial).0) };
        let axis = if odd { -axis } else { axis };
        let vector = |site: &Site, [cos, sin]: [f64; 2]| {
            (cos * site.radial + sin * axis.cross(site.radial)).normalize()
        };
        let (direction, arrival) = (vector(x, track.start), vector(y, track.end));
        Some(Connection {
            direction: if angle < RADIAL && winding == 0 {
                track.start[0].signum() * x.radial
            } else {
                direction
            },
            arrival: if angle < RADIAL && winding == 0 { track.end[0].signum() * y.radial } else { arrival },
            swept,
            b: track.b,
            spread: spread(x, y, &track),
            swing: [track.rate / (x.q * track.end[0].abs()), track.rate / (y.q * track.start[0].abs())],
        })
    }

    /// The unit direction in which the ray that [`Self::connect`] finds arrives at `y`, roughly and at once: to first order
    /// in the bending if the ray does not go around, else as the critical ray.
    pub fn aim(&self, x: &Site, y: &Site, winding: u32) -> DVec3 {
        let spin = x.radial.cross(y.radial);
        let sin = spin.length();
        let angle = sin.atan2(x.radial.dot(y.radial));
        let odd = winding % 2 == 1;
        let axis = if sin > 0.0 { spin / sin } else { x.radial.cross(frame::tangents(x.radial).0) };
        let along = if odd { -axis } else { axis }.cross(y.radial);
        let reversed = y.q > x.q;
        let (near, far) = if reversed { (y, x) } else { (x, y) };
        let gamma = self.guess(near, far, angle, sin / (1.0 + x.radial.dot(y.radial)));
        let is_weak = winding == 0 && far.s > 0.0 && near.s > 0.0 && gamma > 0.0 && angle < WEAK;
        let [cos, sin] = if is_weak {
            let d = distance(near, far, gamma);
            let (sin, cos) = gamma.sin_cos();
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
        let off = spin.atan2(-along);
        // b²/f − b off − 2c = 0, whose roots are the impact parameters of the two images.
        let root = (off * off + 8.0 * self.weak * self.critical * (x.w + y.w)).sqrt();
        ((root - off) / (root + off)).powi(2)
    }

    /// Winding number and [`Connection::spread`] of a ray that leaves `x` in the unit `direction` and arrives at `y`
    /// travelling in the unit direction `arrival`.
    pub fn ray(&self, x: &Site, direction: DVec3, y: &Site, arrival: DVec3) -> Option<(u32, f64)> {
        let sine = x.radial.cross(direction).length();
        let b = sine / x.q;
        let track = if (x.s > 0.0) != (y.s > 0.0) {
            self.through(x, y, self.critical / b)
        } else {
            let side = x.s.signum();
            let (near, far) = if y.q > x.q { (y, x) } else { (x, y) };
            let cos = if y.q > x.q { -arrival.dot(y.radial) } else { direction.dot(x.radial) };
            let leaving = (b * near.q).min(1.0);
            let cos = (1.0 - leaving * leaving).sqrt().copysign(side * cos);
            let gamma = leaving.atan2(cos) - (b * far.q).min(1.0).asin();
            self.beside(near, far, gamma.max(RADIAL)).map(|track| oriented(track, y.q > x.q))
        }?;
        Some(((track.swept / PI) as u32, spread(x, y, &track)))
    }

    /// The ray from `x` to `y` that sweeps an angle.
    fn track(&self, x: &Site, y: &Site, swept: f64, half: f64) -> Option<Track> {
        if (x.s > 0.0) != (y.s > 0.0) {
            // ln(m − 1), in which φ has a linear and an exponential end.
            let (low, high) = (-64.0, 64.0);
            return root((low, high, -swept), self.enough, |t| {
                let excess = f64::exp(t);
                let track = self.through(x, y, 1.0 + excess)?;
                // dφ/dt = dφ/db db/dm dm/dt, b = b_c/m.
                let slope = track.rate / (track.start[0] * track.end[0]).abs();
                let slope = -slope * self.critical * excess / (1.0 + excess).powi(2);
                Some((track, (track.swept - swept) / slope, swept - track.swept))
            });
        }
        let reversed = y.q > x.q;
        let (near, far) = if reversed { (y, x) } else { (x, y) };
        // Where b reaches b_c beyond the point next to the photon sphere: cos θ = −√(1 − (b_c q)²).
        let critical = |site: &Site| {
            let s2 = site.s * site.s;
            (1.0 - s2).atan2((s2 * (2.0 - s2)).sqrt())
        };
        let most = PI - critical(near) - critical(far);
        let guess = if swept < 0.9 * most { self.guess(near, far, swept, half) } else { swept };
        let guess = if guess < 0.98 * most { guess } else { most * (1.0 - 0.5 * (-swept).exp()) };
        root((0.0, most, guess), self.enough, |gamma| {
            let track = self.beside(near, far, gamma)?;
            let slope = track.rate / distance(near, far, gamma);
            // Towards the critical ray e^−φ is linear in γ.
            let excess = track.swept - swept;
            let shift =
                if excess.abs() < 0.5 { excess * (1.0 + 0.5 * excess) } else { excess.exp_m1().min(1e3) };
            let shift = shift / slope;
            Some((track, shift, excess))
        })
        .map(|track| oriented(track, reversed))
    }

    /// The straight angle of a weakly bent ray that sweeps an angle whose half has the tangent `half`: κ is 1 + c q to
    /// first order, and q adds up along the line to the sum of both ends' times that tangent.
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
    fn beside(&self, near: &Site, far: &Site, gamma: f64) -> Option<Track> {
        let (side, fit) = if near.s < 0.0 { (-1.0, &self.inside) } else { (1.0, &self.outside) };
        let (sin, cos) = gamma.sin_cos();
        let d = distance(near, far, gamma);
        let (b, db) = (sin / d, (cos * d * d - near.q * far.q * sin * sin) / (d * d * d));
        let leaving = [(near.q * cos - far.q) / d, near.q * sin / d];
        let arriving = [(near.q - far.q * cos) / d, far.q * sin / d];
        let m = self.critical / b;
        let (swept, slope) = if m > 1.0 {
            let (swept, slope) = self.monotone(fit, near.s, far.s, m);
            (swept, -slope * m / b * db)
        } else {
            let [end, start] = [leaving, arriving].map(|[cos, sin]| -cos / (1.0 + sin));
            let (swept, by_b) = self.turning(fit, start, end, b, side);
            let [at_near, at_far] = [near, far].map(|site| fit.at(site.s)[0] / site.s.abs());
            let bend = far.q * (near.q * cos - far.q) / (d * d);
            (swept, at_near * (1.0 + bend) - at_far * bend + by_b * db)
        };
        let outwards = |[cos, sin]: [f64; 2]| [side * cos, sin];
        let track = Track { swept, b, start: outwards(leaving), end: outwards(arriving), rate: slope * d };
        (swept.is_finite() && track.rate > 0.0).then_some(track)
    }

    /// The ray of impact parameter b_c/m, m > 1, between two places on both sides of the photon sphere.
    fn through(&self, x: &Site, y: &Site, m: f64) -> Option<Track> {
        let (swept, slope) = self.monotone(&self.through, x.s, y.s, m);
        let b = self.critical / m;
        let way = if y.s > x.s { 1.0 } else { -1.0 };
        let [start, end] = [x, y].map(|site| {
            let sin = b * site.q;
            [way * (1.0 - sin * sin).max(0.0).sqrt(), sin]
        });
        let rate = (start[0] * end[0] * slope * m / b).abs();
        (m > 1.0 && swept.is_finite() && rate > 0.0).then_some(Track { swept, b, start, end, rate })
    }

    /// φ and dφ/dm of a ray with m > 1, between two places.
    fn monotone(&self, fit: &Chebyshev, from: f64, to: f64, m: f64) -> (f64, f64) {
        let u2 = m - 1.0;
        let u = u2.sqrt();
        let (low, high) = (from.min(to), from.max(to));
        let [swept, slope] = self.integrate(low / u, high / u, |sinh, cosh| {
            let s = sinh.map(|sinh| u * sinh);
            let [h, _] = fit.at_each(s);
            std::array::from_fn(|i| {
                let rest = m + 1.0 - s[i] * s[i];
                let term = 2.0 * h[i] / rest.sqrt();
                [term, term / (cosh[i] * cosh[i] * rest)]
            })
        });
        (swept, -m * slope / u2)
    }

    /// φ, and dφ/db at fixed angles, of a ray of impact parameter `b` > b_c between the angles 2 atan `start` and 2 atan
    /// `end` from its turning point, on the side of the photon sphere that `side` says.
    fn turning(&self, fit: &Chebyshev, start: f64, end: f64, b: f64, side: f64) -> (f64, f64) {
        let m = self.critical / b;
        // Of tan²(θ/2) where B would be b_c: negative.
        let pole = ((b - self.critical) / (b + self.critical)).max(f64::MIN_POSITIVE).sqrt();
        let scale = (1.0 + m).sqrt();
        let [swept, by_b] = self.integrate(start / pole, end / pole, |sinh, cosh| {
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

    /// Integrals over v, sinh v from `low` to `high`, of two functions of sinh v and cosh v that have singularities no
    /// closer to the real axis than π/2.
    #[inline(always)]
    fn integrate(&self, low: f64, high: f64, f: impl Fn(Lanes, Lanes) -> [[f64; 2]; LANES]) -> [f64; 2] {
        // e^v.
        let [first, last] = [low, high].map(|sinh| {
            let larger = sinh.abs() + (1.0 + sinh * sinh).sqrt();
            if sinh < 0.0 { 1.0 / larger } else { larger }
        });
        let (middle, half) = (first.sqrt() * last.sqrt(), 0.5 * (last / first).ln());
        let rule = self.rules.iter().find(|rule| half <= rule.reach).or(self.rules.last());
        let mut sums = [0.0; 2];
        for (x, weight) in rule.iter().flat_map(|rule| &rule.nodes) {
            let grown = x.map(|x| middle * (half * x).exp());
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

impl Rule {
    fn new(count: usize, tolerance: f64) -> Self {
        let nodes = gauss_legendre(count);
        let group = |group: &[(f64, f64); LANES]| (group.map(|node| node.0), group.map(|node| node.1));
        Self {
            // The largest ellipse that keeps off the singularities [Trefethen 2013, th. 19.3].
            reach: 0.5 * PI / (-0.5 * tolerance.ln() / count as f64).sinh(),
            nodes: nodes.as_chunks().0.iter().map(group).collect(),
        }
    }
}

impl Site {
    /// The place at infinity in the unit direction `radial`.
    pub fn infinity(radial: DVec3) -> Self {
        Self { radial, w: 0.0, q: 0.0, s: 1.0 }
    }
}

/// [`Connection::spread`] of a track from `x` to `y`.
fn spread(x: &Site, y: &Site, track: &Track) -> f64 {
    let far = if y.w > 0.0 { y.w * y.w } else { 1.0 };
    // Where places are in line, the sine is that of their angle rather than of what was found; a radial ray has neither.
    let sin = x.radial.cross(y.radial).length();
    let is_radial = sin < RADIAL && x.radial.dot(y.radial) > 0.0;
    let sin = if is_radial { track.swept.sin().abs() } else { sin };
    track.b * x.q * x.q * far / (sin * track.rate)
}

/// q_x q_y times the length of the straight line between two places that are seen under an angle: the third side of the
/// triangle of their inverse radii.
fn distance(x: &Site, y: &Site, angle: f64) -> f64 {
    let half = (0.5 * angle).sin();
    ((x.q - y.q).powi(2) + 4.0 * x.q * y.q * half * half).sqrt()
}

/// The track, or the same run backwards.
fn oriented(track: Track, reversed: bool) -> Track {
    if !reversed {
        return track;
    }
    let [start, end] = [track.end, track.start].map(|[cos, sin]| [-cos, sin]);
    Track { start, end, ..track }
}

/// The track at the root of a function that grows, between two bounds and from a guess: `f` gives the track at a place,
/// how far it is beyond the root by Newton's method, and whether it is beyond it at all.
fn root(
    (mut low, mut high, guess): (f64, f64, f64),
    enough: f64,
    f: impl Fn(f64) -> Option<(Track, f64, f64)>,
) -> Option<Track> {
    let mut at = guess.clamp(low, high);
    let mut best = None;
    for _ in 0..MOST_ITERATIONS {
        let Some((track, shift, excess)) = f(at) else {
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
        let is_met = excess.abs() <= enough * track.swept.min(1.0) || shift.abs() <= f64::EPSILON * at.abs();
        if is_met || high - low <= f64::EPSILON * high.abs() {
            break;
        }
        let next = at - shift;
        at = if next > low && next < high { next } else { 0.5 * (low + high) };
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
