//! Rays around a hole that does not spin, by quadrature: no steps, and as good as rounding.
//!
//! With û = M/r of the areal radius r, e = Q/M, D = 1 − 2û + e²û² and β = (b/M)², the cosine of the angle between ray and
//! radius is ± f, f² = 1 − βû²D, and the angle swept, the coordinate time, and their radius coordinate r★ (the tortoise
//! coordinate, dr★ = dr/D) are
//!
//! ```text
//! dφ = √β dû/f,   t = Δr★ + b ∫ dφ/(1 + f):
//! ```
//!
//! what is singular at infinity and at the horizon is in r★, a sum of logarithms. A ray that turns at û_t has
//! û = û_t cos a (within the photon sphere û_t cosh a), in which its orbit is nearly a straight line:
//!
//! ```text
//! dφ = da/√q,   f = √β û_t |sin a| √q,   q = 1 − 2û_t (c + 1/(1 + c)) + e²û_t² (1 + c²),   c = cos a;
//! ```
//!
//! q is 0 next to a = 0 only as û_t comes to the photon sphere. Rays that do not turn are integrated over û, where f is
//! 0 beside the photon sphere as b comes to its critical value. Either place of a root next to the path is an imaginary
//! distance ±iδ away, which x = δ sinh v takes to ±iπ/2; then panels of Gauss–Legendre nodes do.

use std::sync::LazyLock;

use super::Launch;
use crate::math::kernel;
use crate::math::quadrature::gauss_legendre;
use crate::math::sin_cos_turns::sinc;
use crate::spacetime::{Fate, StaticHole};

/// A hole whose rays are known by quadrature.
#[derive(Clone, Copy, Debug)]
pub struct ArealQuadrature {
    mass: f64,
    /// (Q/M)².
    e2: f64,
    /// Isotropic radius of the horizon.
    h: f64,
    /// û of the photon sphere, and û²D there.
    circle: f64,
    barrier: f64,
    /// −½ and ⅙ of the second and third derivative of û²D there.
    bow: [f64; 2],
    /// Critical impact parameter.
    critical: f64,
}

/// Way of a ray from its start to its sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Angle swept, radians.
    pub swept: f64,
    /// Its derivative by the angle between direction and radius at the start.
    pub turn: f64,
    /// Cosine of that angle at the end.
    pub cosine: f64,
    /// Coordinate time, in the unit of length.
    pub time: f64,
}

/// Ray from its start to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArealJourney {
    /// Its way to the sphere; `None` if it never crosses that outwards.
    pub passage: Option<Passage>,
    /// Inverse isotropic radius of the point nearest to the centre, if the ray passes one.
    pub periastron: Option<f64>,
}

/// Nodes of a panel.
const NODES: usize = 16;
/// Longest panel in v.
const PANEL: f64 = 1.5;
/// Length of an interval, in δ, up to which one panel over x itself does.
const FEW: f64 = 1.5;
/// Largest δ: what is farther away is as good as at infinity, and x would lose digits.
const FARTHEST: [f64; 2] = [4.0, 1.0];
/// Share of û²D at the photon sphere below which a turning point is found from afar.
const FAR: f64 = 0.5;
/// Most steps of Newton's method.
const MOST_STEPS: usize = 60;

/// Nodes and weights on [−1, 1].
static RULE: LazyLock<[[f64; NODES]; 2]> = LazyLock::new(|| {
    let nodes = gauss_legendre(NODES);
    [std::array::from_fn(|i| nodes[i].0), std::array::from_fn(|i| nodes[i].1)]
});

impl ArealQuadrature {
    /// Rays around `hole`.
    pub fn new(hole: &StaticHole) -> Self {
        let StaticHole { mass, charge } = *hole;
        let e2 = charge * charge;
        let circle = 2.0 / (3.0 + (9.0 - 8.0 * e2).sqrt());
        let barrier = circle * circle * (1.0 - circle * (2.0 - e2 * circle));
        Self {
            mass,
            e2,
            h: 0.5 * mass * ((1.0 - charge) * (1.0 + charge)).sqrt(),
            circle,
            barrier,
            bow: [6.0 * circle * (1.0 - e2 * circle) - 1.0, 4.0 * e2 * circle - 2.0],
            critical: mass / barrier.sqrt(),
        }
    }

    /// Follows a ray until it crosses the sphere of inverse isotropic radius `w_out`, not 0, outwards.
    pub fn follow(&self, launch: &Launch, w_out: f64) -> ArealJourney {
        let inwards = launch.v > 0.0;
        let mut followed = ArealJourney { passage: None, periastron: None };
        if (inwards && launch.fate == Fate::Falls) || (!inwards && launch.w < w_out) {
            return followed;
        }
        let n = (launch.v * launch.v + (launch.b * launch.w).powi(2)).sqrt();
        let start = OrbitStart { b: launch.b, cosine: -launch.v / n, grazing: n / launch.w };
        let [from, to] = [launch.w, w_out].map(|w| self.place(w));
        if launch.b < self.critical {
            followed.passage = Some(self.pass(&start, from, to));
            return followed;
        }
        let turn = Turn::new(self, launch.b, from.u <= self.circle);
        if inwards {
            followed.periastron = Some(turn.w);
        }
        if turn.is_reached(to.u) {
            followed.passage = Some(self.swing(&turn, &start, from, to));
        }
        followed
    }

    fn place(&self, w: f64) -> Place {
        let hw = self.h * w;
        Place { u: self.mass * w / (1.0 + self.mass * w + hw * hw), rho: 1.0 / w }
    }

    /// Change of r★ from one place to others, all together.
    fn rise<const N: usize>(&self, from: Place, to: [Place; N]) -> f64 {
        let (h, mass) = (self.h, self.mass);
        let near = from.rho;
        let (mut way, mut gap, [mut factor, mut ratio]) = (0.0, 0.0, [1.0; 2]);
        for far in to.map(|place| place.rho) {
            way += (far - near) * (1.0 - h * h / (near * far));
            let [within, beyond] = [(near - h) / (near + h), (far - h) / (far + h)];
            ratio *= within / beyond;
            factor *= (beyond * (far + h) * (far + h)) / (within * (near + h) * (near + h)) * (near / far);
            // artanh of it over h is all that is left of the difference of two logarithms as h goes to 0; sums of them by
            // the theorem of addition.
            let own = (far - near) / (near * far - h * h);
            gap = (gap + own) / (1.0 + h * h * gap * own);
        }
        let z = h * gap;
        let apart = if z.abs() < 0.1 {
            let square = z * z;
            gap * (0..8).rev().fold(0.0, |sum, k| sum * square + 1.0 / f64::from(2 * k + 1))
        } else {
            -0.5 / h * libm::log(ratio)
        };
        way + 2.0 * mass * libm::log(factor) + (mass * mass + 4.0 * h * h) * apart
    }

    /// The passage of a ray that does not turn.
    fn pass(&self, start: &OrbitStart, from: Place, to: Place) -> Passage {
        let &OrbitStart { b, cosine, grazing } = start;
        let (per_mass, beta) = (b / self.mass, (b / self.mass).powi(2));
        let apart = self.barrier * (self.critical - b) * (self.critical + b) / (b * b * self.bow[0]);
        let delta = apart.sqrt().min(FARTHEST[1]);
        let straight = MonotoneIntegrand { beta, e2: self.e2, circle: self.circle };
        let (low, high) = (to.u - self.circle, from.u - self.circle);
        let [angle, slope, late] = integral(delta, low, high, from.u - to.u, &straight);
        Passage {
            swept: per_mass * angle,
            turn: grazing * cosine * slope / self.mass,
            cosine: (1.0 - beta * self.potential(to.u)).sqrt(),
            time: self.rise(from, [to]) + b * per_mass * late,
        }
    }

    /// The passage of a ray with a turning point on its orbit, on the way from which or before which it crosses its
    /// sphere.
    fn swing(&self, turn: &Turn, start: &OrbitStart, from: Place, to: Place) -> Passage {
        let &OrbitStart { b, cosine, grazing } = start;
        let beta_root = b / self.mass;
        let per_sine = beta_root * turn.u;
        let begins = turn.gap(from.u);
        let steep = turn.root(begins);
        // From the direction: beside the turning point the radius does not tell.
        let sine = cosine / (per_sine * steep);
        let ends = turn.gap(to.u);
        let last = turn.root(ends);
        let rising = if to.u == from.u { sine.abs() } else { (ends.abs() * (2.0 - ends)).sqrt() };
        let [first, end] = if turn.side > 0.0 {
            [libm::atan2(sine, 1.0 - begins), libm::atan2(rising, 1.0 - ends)]
        } else {
            [-libm::asinh(sine), -libm::asinh(rising)]
        };
        if first == end {
            return Passage { swept: 0.0, turn: 0.0, cosine, time: 0.0 };
        }
        let over = |low: f64, high: f64| {
            integral(turn.delta, low, high, high - low, &TurningIntegrand { turn, per_sine })
        };
        // |f| has a kink where the ray turns.
        let turns = first < 0.0 && end > 0.0;
        let [swept, slope, late] = if turns {
            let (fall, rise) = (over(0.0, -first), over(0.0, end));
            [0, 1, 2].map(|i| fall[i] + rise[i])
        } else {
            over(first, end)
        };
        // dφ/dû_t at the ends, which move.
        let edge = cosine * (1.0 - ends) / (rising * turn.u * last) - beta_root * (1.0 - begins);
        let by_start = -turn.u * turn.lapse_squared / (b * turn.slope);
        let nearest = Place { u: turn.u, rho: 1.0 / turn.w };
        let rise = if turns { self.rise(nearest, [from, to]) } else { self.rise(from, [to]) };
        Passage {
            swept,
            turn: grazing * by_start * (edge + cosine * slope),
            cosine: per_sine * rising * last,
            time: rise + b * late,
        }
    }

    /// û²D.
    fn potential(&self, u: f64) -> f64 {
        u * u * (1.0 - u * (2.0 - self.e2 * u))
    }
}

/// A place on an orbit.
#[derive(Clone, Copy)]
struct Place {
    u: f64,
    /// Isotropic radius.
    rho: f64,
}

/// Start of a ray on its orbit.
struct OrbitStart {
    b: f64,
    /// Cosine of the angle between direction and radius.
    cosine: f64,
    /// Impact parameter of a ray that grazes the sphere there.
    grazing: f64,
}

/// Turning point of an orbit.
struct Turn {
    u: f64,
    /// Inverse isotropic radius.
    w: f64,
    /// 1 outside the photon sphere, −1 within.
    side: f64,
    /// ½ d(û²D)/dû over û: 0 at the photon sphere.
    slope: f64,
    /// D.
    lapse_squared: f64,
    e2: f64,
    delta: f64,
}

impl Turn {
    fn new(hole: &ArealQuadrature, b: f64, outside: bool) -> Self {
        let &ArealQuadrature { mass, e2, circle, barrier, bow, critical, .. } = hole;
        let x = mass / b;
        let (u, slope) = if outside && x * x < FAR * barrier {
            let mut u = x * (1.0 + x * (1.0 + 2.5 * x));
            for _ in 0..MOST_STEPS {
                let step = (hole.potential(u) - x * x) / (2.0 * u * (1.0 - u * (3.0 - 2.0 * e2 * u)));
                u -= step;
                if step.abs() <= 1e-9 * u {
                    break;
                }
            }
            (u, 1.0 - u * (3.0 - 2.0 * e2 * u))
        } else {
            // The square root of what it is below the barrier is no longer flat there.
            let below = barrier * ((b - critical) / b) * ((b + critical) / b);
            let mut y = (below / bow[0]).sqrt() * if outside { 1.0 } else { -1.0 };
            for _ in 0..MOST_STEPS {
                let miss = y * y * (bow[0] + y * (bow[1] - e2 * y)) - below;
                let step = miss / (y * (2.0 * bow[0] + y * (3.0 * bow[1] - 4.0 * e2 * y)));
                y -= step;
                if step.abs() <= 1e-9 * y.abs() {
                    break;
                }
            }
            (circle - y, y * (3.0 - 4.0 * e2 * circle + 2.0 * e2 * y))
        };
        let lapse_squared = 1.0 - u * (2.0 - e2 * u);
        let lapse = lapse_squared.sqrt();
        // Of the root of q beyond c = 1, roughly.
        let root = slope.abs() / (u * (1.5 - 2.0 * e2 * u).max(0.25));
        Self {
            u,
            w: 2.0 * u / (mass * (1.0 - u + lapse)),
            side: if outside { 1.0 } else { -1.0 },
            slope,
            lapse_squared,
            e2,
            delta: (2.0 * root).sqrt().min(FARTHEST[0]),
        }
    }

    /// True if the orbit reaches û.
    fn is_reached(&self, u: f64) -> bool {
        self.side * (self.u - u) >= 0.0
    }

    /// 1 − c at û.
    fn gap(&self, u: f64) -> f64 {
        (self.u - u) / self.u
    }

    /// |q| (1 + c), without cancellation, of these 1 − c and 1 + c.
    #[inline(always)]
    fn product(&self, gap: f64, rest: f64) -> f64 {
        self.side * (self.slope * rest + gap * self.u * (2.0 * rest - 1.0 - self.e2 * self.u * rest * rest))
    }

    /// √|q| at this 1 − c.
    fn root(&self, gap: f64) -> f64 {
        let rest = 2.0 - gap;
        (self.product(gap, rest) / rest).sqrt()
    }
}

/// Integrand of the angle swept, of its derivative by the orbit at fixed x, and of the delay.
trait Integrand {
    fn at(&self, x: f64) -> [f64; 3];
}

/// Integrand over û less that of the photon sphere.
struct MonotoneIntegrand {
    beta: f64,
    e2: f64,
    circle: f64,
}

impl Integrand for MonotoneIntegrand {
    #[inline(always)]
    fn at(&self, x: f64) -> [f64; 3] {
        let u = self.circle + x;
        let f = (1.0 - self.beta * (u * u * (1.0 - u * (2.0 - self.e2 * u)))).sqrt();
        let per = 1.0 / f;
        [per, per * per * per, per / (1.0 + f)]
    }
}

/// Integrand over a.
struct TurningIntegrand<'a> {
    turn: &'a Turn,
    /// √β û_t.
    per_sine: f64,
}

impl Integrand for TurningIntegrand<'_> {
    #[inline(always)]
    fn at(&self, a: f64) -> [f64; 3] {
        let &Turn { u, side, e2, .. } = self.turn;
        let half = 0.5 * a;
        let sine = half * sinc(side * half * half);
        let size = 2.0 * sine * sine;
        let gap = side * size;
        let (c, rest) = (1.0 - gap, 2.0 - gap);
        let product = self.turn.product(gap, rest);
        // 1/(q (1 + c)) for both of its factors: divisions are what takes time.
        let common = 1.0 / (product * rest);
        let (square, per_rest) = (rest * rest * common, product * common);
        let per = square.sqrt();
        let by_u = e2 * u * (1.0 + c * c) - c - per_rest;
        let f_per = self.per_sine * (size * rest).sqrt();
        [per, -side * by_u * per * square, square / (per + f_per)]
    }
}

/// Integrals over x from `low`, a `gap` below `high`; δ is the distance of singularities from x = 0.
fn integral<F: Integrand>(delta: f64, low: f64, high: f64, gap: f64, f: &F) -> [f64; 3] {
    if gap < FEW * delta {
        return kernel::widest(PanelSums(Even { middle: 0.5 * (low + high), half: 0.5 * gap, f }));
    }
    let exp_arsinh = |x: f64| {
        let larger = x.abs() + (1.0 + x * x).sqrt();
        if x < 0.0 { 1.0 / larger } else { larger }
    };
    let middle = (exp_arsinh(low / delta) * exp_arsinh(high / delta)).sqrt();
    let half = libm::asinh(gap / (delta * (middle + 1.0 / middle)));
    let panels = (2.0 / PANEL * half).ceil().max(1.0);
    let half = half / panels;
    let mut sums = [0.0; 3];
    for panel in 0..panels as usize {
        let from_middle = (2 * panel + 1) as f64 - panels;
        let middle = if from_middle == 0.0 { middle } else { middle * libm::exp(from_middle * half) };
        let middle = [middle, 1.0 / middle];
        let part = kernel::widest(PanelSums(Stretched { delta, middle, half, f }));
        for i in 0..3 {
            sums[i] += part[i];
        }
    }
    sums
}

/// Panel of integrals, as ones over [−1, 1].
trait Panel {
    /// Integrands at a node, and the factor that they have in common.
    fn at(&self, node: f64) -> ([f64; 3], f64);
}

/// Panel over x, as singularities are far away.
struct Even<'a, F> {
    middle: f64,
    /// Half its length.
    half: f64,
    f: &'a F,
}

impl<F: Integrand> Panel for Even<'_, F> {
    #[inline(always)]
    fn at(&self, node: f64) -> ([f64; 3], f64) {
        (self.f.at(self.middle + self.half * node), self.half)
    }
}

/// Panel over v, x = δ sinh v.
struct Stretched<'a, F> {
    delta: f64,
    /// exp v in its middle, and exp −v.
    middle: [f64; 2],
    /// Half its length.
    half: f64,
    f: &'a F,
}

impl<F: Integrand> Panel for Stretched<'_, F> {
    #[inline(always)]
    fn at(&self, node: f64) -> ([f64; 3], f64) {
        let Self { delta, middle, half, f } = self;
        let [up, down] = exp_both(half * node);
        let (grown, shrunk) = (middle[0] * up, middle[1] * down);
        (f.at(0.5 * delta * (grown - shrunk)), 0.5 * delta * half * (grown + shrunk))
    }
}

/// Sums over the nodes of a panel.
struct PanelSums<P>(P);

impl<P: Panel> pulp::NullaryFnOnce for PanelSums<P> {
    type Output = [f64; 3];

    #[inline(always)]
    fn call(self) -> [f64; 3] {
        let [nodes, weights] = &*RULE;
        let mut parts = [[0.0; NODES]; 3];
        for lane in 0..NODES {
            let (values, factor) = self.0.at(nodes[lane]);
            let weight = weights[lane] * factor;
            for i in 0..3 {
                parts[i][lane] = weight * values[i];
            }
        }
        parts.map(tree_sum)
    }
}

/// exp x and exp −x, of |x| ≤ 1.
#[inline(always)]
fn exp_both(x: f64) -> [f64; 2] {
    let half = 0.5 * x;
    let square = half * half;
    let (mut even, mut odd) = (1.0, 1.0);
    for k in (1..8).rev() {
        let k = f64::from(2 * k);
        even = 1.0 + square * (1.0 / (k * (k - 1.0))) * even;
        odd = 1.0 + square * (1.0 / (k * (k + 1.0))) * odd;
    }
    let (up, down) = (even + half * odd, even - half * odd);
    [up * up, down * down]
}

/// Sum in an order that lanes can keep.
#[inline(always)]
fn tree_sum(mut terms: [f64; NODES]) -> f64 {
    let mut count = NODES / 2;
    while count > 0 {
        for i in 0..count {
            terms[i] += terms[i + count];
        }
        count /= 2;
    }
    terms[0]
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geodesic::{Control, Dop853, OrbitEnd, Phase, elapsed, follow};
    use crate::spacetime::{ConformallyFlat, ReissnerNordstrom};

    /// Angle and time to the sphere, and where a ray comes nearest, in steps.
    fn stepped(medium: &ReissnerNordstrom, launch: &Launch, w_out: f64) -> (Option<[f64; 2]>, Option<f64>) {
        let start = Phase::new(medium, launch.w, launch.v);
        let control = Control::new(medium, 1e-13, f64::INFINITY);
        let mut time = 0.0;
        let journey = follow(medium, &Dop853, &control, (launch.b, start, launch.fate), w_out, |step| {
            time += elapsed(medium, &Dop853, step);
        });
        let way = match journey.end {
            OrbitEnd::Crosses(_, swept) => Some([swept, time]),
            OrbitEnd::Falls | OrbitEnd::Misses => None,
            lost => panic!("{launch:?}: {lost:?}"),
        };
        (way, journey.periastron)
    }

    #[test]
    fn ends_angles_and_times_are_those_of_small_steps() {
        let mut crossings = 0;
        for charge in [0.0, 0.6, -0.99, 1.0] {
            let medium = ReissnerNordstrom::new(1.0, charge);
            let quadrature = ArealQuadrature::new(&medium.hole());
            for start in [0.3, 0.6, 1.1, 5.0, 50.0, 1e6] {
                for (i, out) in (1..40).flat_map(|i| [0.5, 0.9, 1.2, 6.0, 200.0, 1e7].map(|out| (i, out))) {
                    let angle = 0.077 * f64::from(i);
                    let direction = DVec3::new(libm::cos(angle), libm::sin(angle), 0.0);
                    let launch = Launch::new(&medium, start * DVec3::X, direction, f64::EPSILON);
                    let (way, periastron) = stepped(&medium, &launch, 1.0 / out);
                    let found = quadrature.follow(&launch, 1.0 / out);
                    let case = format!("charge {charge} from {start} at {angle} to {out}");
                    assert_eq!(found.passage.is_some(), way.is_some(), "{case}: {found:?} {way:?}");
                    assert_eq!(found.periastron.is_some(), periastron.is_some(), "{case}");
                    if let (Some(w), Some(exact)) = (found.periastron, periastron) {
                        assert!((w / exact - 1.0).abs() < 1e-9, "{case}: {w} {exact}");
                    }
                    let (Some(passage), Some([swept, time])) = (found.passage, way) else { continue };
                    crossings += 1;
                    let beside = |turned: f64| {
                        let angle = angle + turned;
                        let direction = DVec3::new(libm::cos(angle), libm::sin(angle), 0.0);
                        let launch = Launch::new(&medium, start * DVec3::X, direction, f64::EPSILON);
                        quadrature.follow(&launch, 1.0 / out).passage.map(|passage| passage.swept)
                    };
                    let sens = passage.turn.abs().max(1.0);
                    assert!((passage.swept - swept).abs() < 1e-11 * sens, "{case}: {passage:?}, {swept}");
                    assert!(
                        (passage.time - time).abs() < 1e-10 * time + 1e-11 * sens,
                        "{case}: {passage:?}, {time}"
                    );
                    if let (Some(more), Some(less)) = (beside(1e-6), beside(-1e-6)) {
                        let turn = 0.5e6 * (more - less);
                        assert!(
                            (passage.turn - turn).abs() < 1e-4 * sens,
                            "{case}: {passage:?}, turn {turn}"
                        );
                    }
                    let n = medium.index(1.0 / out);
                    let sine = launch.b / (out * n);
                    assert!((passage.cosine.hypot(sine) - 1.0).abs() < 1e-12, "{case}: {passage:?} {sine}");
                }
            }
        }
        assert!(crossings > 1000, "{crossings}");
    }

    #[test]
    fn exponentials_are_those_of_the_library_to_rounding() {
        for i in -100..=100 {
            let x = 0.01 * f64::from(i);
            let [up, down] = exp_both(x);
            assert!((up / x.exp() - 1.0).abs() < 1e-15 && (down * x.exp() - 1.0).abs() < 1e-15, "{x}");
        }
    }
}
