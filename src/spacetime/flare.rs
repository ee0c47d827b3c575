//! Space beyond the mouth of Interstellar's wormhole: a table of its index of refraction.
//!
//! Its shape depends on μ = M/r₀ alone. In units of r₀ and from the mouth on, with x as there,
//!
//! ```text
//! r = 1 + μ (x atan x − ½ ln(1 + x²)),  ln(ρ/ρ_mouth) = ½πμ ∫₀ˣ dx/r,  ln n = μ ∫ₓ^∞ atan(1/x)/r dx.
//! ```
//!
//! Far away n − 1 = M w + O(w² ln w): no power series in w. The table has polynomials of (n − 1)/Mw and of g/M between
//! quarters of octaves of y = 1 + c (ρ/ρ_mouth − 1), with c such that x ≈ y next to the mouth if M is small: the
//! functions are analytic but for |x| ≥ 1 on the imaginary axis and a branch at ρ = 0, so that as few terms do anywhere.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};
use std::fmt;
use std::sync::{Mutex, PoisonError};

use crate::math::quadrature::gauss_legendre;
use crate::math::real::Real;

/// Terms of a polynomial: enough for rounding.
const TERMS: usize = 16;
/// Polynomials to an octave, as a power of two.
const PART_BITS: u32 = 2;
/// Octaves: so far away that n − 1 is M w to rounding, and so near that y is a number in f32.
const OCTAVES: usize = 120;
/// Polynomials of a table.
const PIECES: usize = OCTAVES << PART_BITS;
/// x from which n − 1 is M w.
const FARTHEST: f64 = 1e17;
/// Largest arsinh x that is integrated to: that of the largest number.
const LARGEST_ARSINH: f64 = 711.0;
/// Bounds of μ: beyond, and of what is no number, tables are those of the bound.
const SHAPES: (f64, f64) = (1e-4, 100.0);

/// Table of a shape.
pub(super) struct Flare {
    /// μ.
    shape: f64,
    /// n at the mouth.
    pub(super) index_at_mouth: f64,
    /// c.
    scale: f64,
    pieces: Box<[FlarePiece; PIECES]>,
}

/// Polynomials in (y − middle) · per_half.
#[derive(Clone, Copy, Debug, Default)]
struct FlarePiece {
    middle: f64,
    per_half: f64,
    /// Coefficients of (n − 1)/Mw, by power.
    excess: [f64; TERMS],
    /// Coefficients of g/M.
    pull: [f64; TERMS],
}

impl fmt::Debug for Flare {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Flare").field("shape", &self.shape).finish_non_exhaustive()
    }
}

impl PartialEq for Flare {
    fn eq(&self, other: &Self) -> bool {
        self.shape == other.shape
    }
}

/// Most tables, of 130 kB each.
pub(super) const MOST_TABLES: usize = 1000;

/// Tables, by the bits of their shapes. They are kept for as long as the program runs: spacetimes are copied freely.
static TABLES: Mutex<BTreeMap<u64, &'static Flare>> = Mutex::new(BTreeMap::new());

impl Flare {
    /// The table of shape μ; some other one if there are too many, see [`Self::is_of`].
    pub(super) fn of(shape: f64) -> &'static Self {
        let shape = bounded(shape);
        let mut tables = TABLES.lock().unwrap_or_else(PoisonError::into_inner);
        if tables.len() >= MOST_TABLES
            && !tables.contains_key(&shape.to_bits())
            && let Some(other) = tables.values().next()
        {
            return other;
        }
        tables.entry(shape.to_bits()).or_insert_with(|| Box::leak(Box::new(Self::new(shape))))
    }

    /// True if it is the table of shape μ.
    pub(super) fn is_of(&self, shape: f64) -> bool {
        self.shape == bounded(shape)
    }

    /// (n − 1)/Mw at the inverse radius `w` of at most that of the `mouth`, which may be below 0.
    #[inline(always)]
    pub(super) fn excess<R: Real>(&self, mouth: f64, w: R) -> R {
        let (piece, t) = self.place(mouth, w);
        horner(&piece.excess, t)
    }

    /// g/M there.
    #[inline(always)]
    pub(super) fn pull<R: Real>(&self, mouth: f64, w: R) -> R {
        let (piece, t) = self.place(mouth, w);
        horner(&piece.pull, t)
    }

    /// Polynomials for an inverse radius, and their variable there.
    #[inline(always)]
    fn place<R: Real>(&self, mouth: f64, w: R) -> (&FlarePiece, R) {
        let y = R::of(1.0) + R::of(self.scale) * ((R::of(1.0 / mouth) - w) / w);
        // Steps to infinity end beyond it: the index goes on there as it comes.
        let y = if w > R::of(0.0) { y } else { R::of(LAST) };
        let y = y.at_most(R::of(LAST)).at_least(R::of(1.0));
        let octave_part = y.value().to_bits() >> (f64::MANTISSA_DIGITS - 1 - PART_BITS);
        let piece = &self.pieces[(octave_part as usize).wrapping_sub(FIRST).min(PIECES - 1)];
        (piece, (y - R::of(piece.middle)) * R::of(piece.per_half))
    }
}

fn bounded(shape: f64) -> f64 {
    shape.at_least(SHAPES.0).at_most(SHAPES.1)
}

/// y within the last polynomial; a number of f32, too.
const LAST: f64 = f64::from_bits(((OCTAVES as u64 + 1022) << 52) | (0b11 << 50));
/// Number of the first polynomial among all that bits can tell.
const FIRST: usize = 1023 << PART_BITS;

/// Σ coefficients × powers.
#[inline(always)]
fn horner<R: Real>(coefficients: &[f64; TERMS], t: R) -> R {
    let mut sum = R::of(coefficients[TERMS - 1]);
    for i in 1..TERMS {
        sum = sum * t + R::of(coefficients[TERMS - 1 - i]);
    }
    sum
}

/// (r − r₀)/M.
fn rise(x: f64) -> f64 {
    if x < 1e-2 {
        // Its Taylor series, without cancellation: the next term is below 1e-17 of the first.
        let square = x * x;
        let terms = [-1.0 / 132.0, 1.0 / 90.0, -1.0 / 56.0, 1.0 / 30.0, -1.0 / 12.0];
        return square * (0.5 + terms.iter().fold(0.0, |sum, term| (sum + term) * square));
    }
    x * libm::atan(x) - 0.5 * libm::log1p(x * x)
}

/// Places on the way outwards.
#[derive(Clone, Copy)]
struct FlareNode {
    y: f64,
    /// ρ/ρ_mouth.
    stretch: f64,
    x: f64,
}

impl Flare {
    fn new(shape: f64) -> Self {
        let scale = 1.0 / (FRAC_PI_2 * shape).min(1.0);
        let mut flare =
            Self { shape, index_at_mouth: 1.0, scale, pieces: Box::new([FlarePiece::default(); PIECES]) };
        let rule = gauss_legendre(8);
        // Chebyshev points of all polynomials, in order.
        let mut nodes = vec![FlareNode { y: 1.0, stretch: 1.0, x: 0.0 }];
        let cosine = |k: usize| -libm::cos(PI * (k as f64 + 0.5) / TERMS as f64);
        let mut used = 0;
        while used < PIECES && nodes[nodes.len() - 1].x < FARTHEST {
            let [low, high] = [used, used + 1].map(|i| f64::from_bits(((FIRST + i) as u64) << 50));
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            flare.pieces[used] = FlarePiece { middle, per_half: 1.0 / half, ..FlarePiece::default() };
            for k in 0..TERMS {
                let y = middle + half * cosine(k);
                let next = flare.next(&rule, nodes[nodes.len() - 1], y);
                nodes.push(next);
            }
            used += 1;
        }
        // ln n, from far away, where it is μ/½πμ x.
        let mut log = FRAC_2_PI / nodes[nodes.len() - 1].x;
        let mut logs = vec![log; nodes.len()];
        for i in (1..nodes.len()).rev() {
            let (from, to) = (nodes[i - 1].x, nodes[i].x);
            log += integral(&rule, (from, to), |x| shape * libm::atan2(1.0, x) / flare.areal(x));
            logs[i - 1] = log;
        }
        flare.index_at_mouth = libm::exp(logs[0]);
        for (number, piece) in flare.pieces[..used].iter_mut().enumerate() {
            let node = |k: usize| 1 + number * TERMS + k;
            // 1/w in units of r₀.
            let rho = |k: usize| nodes[node(k)].stretch / flare.index_at_mouth;
            piece.excess = powers(&std::array::from_fn(|k| libm::expm1(logs[node(k)]) * rho(k) / shape));
            piece.pull = powers(&std::array::from_fn(|k| {
                let n = libm::exp(logs[node(k)]);
                n * n * rho(k) * FRAC_2_PI * libm::atan2(1.0, nodes[node(k)].x) / shape
            }));
        }
        let mut last = FlarePiece::default();
        (last.excess[0], last.pull[0]) = (1.0, 1.0);
        flare.pieces[used..].fill(last);
        flare.pieces[PIECES - 1] = last;
        flare
    }

    /// r/r₀.
    fn areal(&self, x: f64) -> f64 {
        1.0 + self.shape * rise(x)
    }

    /// The next place on the way outwards, at `y`.
    fn next(&self, rule: &[(f64, f64)], before: FlareNode, y: f64) -> FlareNode {
        let stretch = 1.0 + (y - 1.0) / self.scale;
        let wanted = libm::log1p((y - before.y) / (self.scale * before.stretch));
        let slope = |x: f64| FRAC_PI_2 * self.shape / self.areal(x);
        // Newton's method: the integral is concave where r grows, so that it comes from below.
        let mut x = before.x + wanted / slope(before.x);
        for _ in 0..8 {
            let shift = (wanted - integral(rule, (before.x, x), slope)) / slope(x);
            x += shift;
            if shift.abs() <= 2.0 * f64::EPSILON * x {
                break;
            }
        }
        FlareNode { y, stretch, x }
    }

    /// ln(ρ/ρ_mouth).
    fn log_stretch(&self, x: f64) -> f64 {
        let end = libm::asinh(x).min(LARGEST_ARSINH);
        let panels = (4.0 * end).ceil().max(1.0);
        let rule = gauss_legendre(16);
        let slope = |t: f64| {
            let x = libm::sinh(t);
            FRAC_PI_2 * self.shape / self.areal(x) * (1.0 + x * x).sqrt()
        };
        let bound = |i: usize| end * i as f64 / panels;
        (0..panels as usize).map(|i| integral(&rule, (bound(i), bound(i + 1)), slope)).sum()
    }

    /// ρ/ρ_mouth at the proper distance `way` ≥ 0 from the mouth, in units of r₀.
    pub(super) fn stretch(&self, way: f64) -> f64 {
        libm::exp(self.log_stretch(way / (FRAC_PI_2 * self.shape)))
    }

    /// Proper distance from the mouth, in units of r₀, at ρ/ρ_mouth = `stretch` ≥ 1.
    pub(super) fn way(&self, stretch: f64) -> f64 {
        let wanted = libm::log(stretch);
        let slope = |x: f64| FRAC_PI_2 * self.shape / self.areal(x);
        // By y: next to the mouth and far away they are proportional.
        let (mut low, mut high) = (0.0, f64::MAX.sqrt());
        let mut x = (stretch - 1.0) / (FRAC_PI_2 * self.shape);
        for _ in 0..200 {
            let excess = self.log_stretch(x) - wanted;
            if excess > 0.0 {
                high = x;
            } else {
                low = x;
            }
            let newton = x - excess / slope(x);
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            let shift = (next - x).abs();
            x = next;
            if shift <= 4.0 * f64::EPSILON * x {
                break;
            }
        }
        FRAC_PI_2 * self.shape * x
    }
}

/// ∫ f between two bounds.
fn integral(rule: &[(f64, f64)], (low, high): (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    half * rule.iter().map(|&(node, weight)| weight * f(middle + half * node)).sum::<f64>()
}

/// Coefficients of powers of the polynomial with these values in Chebyshev points, in increasing order.
///
/// By those of Chebyshev polynomials, which fall: at once, the large coefficients of these would cost digits.
fn powers(values: &[f64; TERMS]) -> [f64; TERMS] {
    let mut powers = [0.0; TERMS];
    // Coefficients of Tₙ₋₁ and of Tₙ.
    let (mut before, mut this) = ([0.0; TERMS], [0.0; TERMS]);
    this[0] = 1.0;
    for degree in 0..TERMS {
        let twice = if degree == 0 { 1.0 } else { 2.0 };
        let angle = |k: usize| PI * (1.0 - (k as f64 + 0.5) / TERMS as f64);
        let share = |(k, value): (usize, &f64)| value * libm::cos(degree as f64 * angle(k));
        let sum: f64 = values.iter().enumerate().map(share).sum();
        for (power, coefficient) in powers.iter_mut().zip(this) {
            *power += twice / TERMS as f64 * sum * coefficient;
        }
        let next = std::array::from_fn(|i| twice * if i > 0 { this[i - 1] } else { 0.0 } - before[i]);
        (before, this) = (this, next);
    }
    powers
}
