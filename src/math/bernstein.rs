//! The first sign change of a polynomial in Bernstein form on [0, 1].
//!
//! Signs decide: a polynomial that starts on one side of zero and ends on the other has a root, whatever the rounding
//! in between. Zero counts as positive, so that consecutive intervals share a crossing at their common end exactly
//! once.

/// Smallest `s` in [0, 1] at which Σ `c[i]` B_i(s) changes sign, if any.
///
/// A root of even multiplicity (a touch without crossing) may be missed. Descartes' rule in Bernstein form: no sign
/// variation, no root; one variation, one root; else subdivide.
#[inline(always)]
pub fn first_sign_change<const N: usize>(c: [f64; N]) -> Option<f64> {
    let above = c.iter().filter(|&&value| positive(value)).count();
    if above == 0 || above == N { None } else { first_root(c) }
}

/// The search proper: rare enough beside misses to be kept out of line.
#[inline(never)]
fn first_root<const N: usize>(c: [f64; N]) -> Option<f64> {
    isolated(c).map(|part| part.place(bracketed_roots(&part.c.map(|c| [c]))[0]))
}

/// A polynomial on a part of [0, 1] on which its coefficients change sign once.
#[derive(Clone, Copy, Debug)]
pub struct Isolated<const N: usize> {
    /// Its Bernstein coefficients on that part.
    pub c: [f64; N],
    start: f64,
    width: f64,
}

impl<const N: usize> Isolated<N> {
    /// Place in [0, 1] of a root, given where in the part it is.
    #[inline(always)]
    pub fn place(&self, root: f64) -> f64 {
        self.start + self.width * root
    }
}

/// The part of [0, 1] on which a polynomial of given Bernstein coefficients changes sign first, and once.
#[inline(always)]
pub fn isolated<const N: usize>(c: [f64; N]) -> Option<Isolated<N>> {
    // By far the most, for which no call is worth it.
    if variations(&c) == 1 {
        return Some(Isolated { c, start: 0.0, width: 1.0 });
    }
    subdivided(c, (0.0, 1.0, 0))
}

/// True if a value lies on the positive side; zero does.
#[inline(always)]
pub fn positive(value: f64) -> bool {
    value >= 0.0
}

/// Sign variations of the coefficients: at least as many as there are roots.
#[inline(always)]
pub fn variations<const N: usize>(c: &[f64; N]) -> usize {
    c.windows(2).filter(|pair| positive(pair[0]) != positive(pair[1])).count()
}

/// Depth at which two roots in one interval are taken for a touch: they are closer than 2⁻⁴⁰ of it.
const MAX_DEPTH: u32 = 40;

/// The first such part of an interval that was halved `depth` times, left half before right half.
fn subdivided<const N: usize>(c: [f64; N], (start, width, depth): (f64, f64, u32)) -> Option<Isolated<N>> {
    match variations(&c) {
        0 => None,
        1 => Some(Isolated { c, start, width }),
        _ if depth == MAX_DEPTH => None,
        _ => {
            let ((left, right), half) = (halves(c), 0.5 * width);
            subdivided(left, (start, half, depth + 1))
                .or_else(|| subdivided(right, (start + half, half, depth + 1)))
        }
    }
}

/// De Casteljau's subdivision at ½.
fn halves<const N: usize>(mut c: [f64; N]) -> ([f64; N], [f64; N]) {
    let mut left = [0.0; N];
    let mut right = [0.0; N];
    for level in 0..N {
        left[level] = c[0];
        right[N - 1 - level] = c[N - 1 - level];
        for i in 0..N - 1 - level {
            c[i] = 0.5 * (c[i] + c[i + 1]);
        }
    }
    (left, right)
}

/// Values of polynomials of degree 2 or more at `s`, their first and their second derivatives, by de Casteljau's
/// algorithm, in the form that is exact at both ends.
#[inline(always)]
fn values<const N: usize, const L: usize>(c: &[[f64; L]; N], s: &[f64; L]) -> [[f64; L]; 3] {
    let mut c = *c;
    for level in 1..N - 2 {
        for i in 0..N - level {
            for l in 0..L {
                c[i][l] = (1.0 - s[l]) * c[i][l] + s[l] * c[i + 1][l];
            }
        }
    }
    let degree = (N - 1) as f64;
    let mut out = [[0.0; L]; 3];
    for l in 0..L {
        let (s, t) = (s[l], 1.0 - s[l]);
        let [a, b, c] = [c[0][l], c[1][l], c[2][l]];
        let (start, end) = (t * a + s * b, t * b + s * c);
        out[0][l] = t * start + s * end;
        out[1][l] = degree * (end - start);
        out[2][l] = degree * (degree - 1.0) * ((c - b) - (b - a));
    }
    out
}

/// Interval in which a root is known well enough.
const NARROW: f64 = 4e-15;

/// The roots of polynomials with exactly one sign variation each, side by side: Halley's method within a bracket, which
/// is halved where it leads out and which the last step closes from the other side. Lanes do not depend on each other.
#[inline(always)]
pub fn bracketed_roots<const N: usize, const L: usize>(c: &[[f64; L]; N]) -> [f64; L] {
    let (mut a, mut b, mut s) = ([0.0; L], [1.0; L], [0.0; L]);
    let mut enough = [0.0; L];
    for l in 0..L {
        let (start, end) = (c[0][l], c[N - 1][l]);
        // An end that is zero, but for rounding, is not to be taken for the root.
        let secant = start / (start - end);
        s[l] = if (secant > 0.0) & (secant < 1.0) { secant } else { 0.5 };
        enough[l] = 1e-15 * start.abs().min(end.abs());
    }
    for iteration in 0..100 {
        let [f, d, dd] = values(c, &s);
        let mut open = [0.0; L];
        for l in 0..L {
            let (at, value, slope, bend) = (s[l], f[l], d[l], dd[l]);
            let is_right = positive(value) == positive(c[N - 1][l]);
            let (left, right) = (if is_right { a[l] } else { at }, if is_right { at } else { b[l] });
            let twice = value + value;
            let step = twice * slope / ((slope + slope) * slope - value * bend);
            // A step into the bracket that is too small to matter goes beyond the root, and closes the bracket.
            let inwards = if is_right { step } else { -step };
            let shift = if inwards.abs() < NARROW { 0.5 * NARROW } else { inwards };
            let next = if is_right { at - shift } else { at + shift };
            let inside = (next > left) & (next < right) & (iteration % 8 != 7);
            let next = if inside { next } else { 0.5 * (left + right) };
            let (left, right) = if value.abs() <= enough[l] { (at, at) } else { (left, right) };
            let found = right - left <= NARROW;
            let middle = 0.5 * (left + right);
            // The bracket of a root that is found stays closed, however long other lanes take.
            (a[l], b[l]) = (if found { middle } else { left }, if found { middle } else { right });
            (s[l], open[l]) = (if found { middle } else { next }, if found { 0.0 } else { 1.0 });
        }
        if open == [0.0; L] {
            break;
        }
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bernstein coefficients of Π (s − r) times `lead`, degree 4.
    fn from_roots(roots: [f64; 4], lead: f64) -> [f64; 5] {
        let mut monomial = [lead, 0.0, 0.0, 0.0, 0.0];
        for (degree, r) in roots.iter().enumerate() {
            for k in (0..=degree).rev() {
                monomial[k + 1] += monomial[k];
                monomial[k] *= -r;
            }
        }
        let binomial = [1.0, 4.0, 6.0, 4.0, 1.0];
        let choose = |n: usize, k: usize| (0..k).fold(1.0, |p, i| p * (n - i) as f64 / (i + 1) as f64);
        std::array::from_fn(|i| (0..=i).map(|k| choose(i, k) / binomial[k] * monomial[k]).sum())
    }

    #[test]
    fn the_smallest_root_in_the_interval_is_found() {
        for (roots, expected) in [
            ([0.25, 2.0, 3.0, -1.0], Some(0.25)),
            ([0.75, 0.5, 0.25, 0.125], Some(0.125)),
            ([0.9, 0.3, 5.0, -2.0], Some(0.3)),
            ([0.5001, 0.5, 7.0, -9.0], Some(0.5)),
            ([2.0, 3.0, -1.0, -2.0], None),
            ([1e-9, 0.5, 3.0, 4.0], Some(1e-9)),
        ] {
            for lead in [1.0, -3.0, 1e10] {
                let found = first_sign_change(from_roots(roots, lead));
                match (found, expected) {
                    (Some(found), Some(expected)) => {
                        assert!((found - expected).abs() < 1e-9, "{roots:?}: {found} is not {expected}")
                    }
                    (found, expected) => assert_eq!(found, expected, "{roots:?}"),
                }
            }
        }
    }

    #[test]
    fn roots_side_by_side_are_those_one_by_one() {
        let all: Vec<[f64; 5]> = (0..8)
            .map(|i| from_roots([0.1 * (1.0 + f64::from(i)), 2.0, 3.0, -1.0 - f64::from(i)], 1.0))
            .collect();
        // Roots that are known by their brackets, beside one that takes long.
        let uneven = (0..8).map(|i| match i {
            0 => [-1e-60, -1e-60, -1e-60, -1e-60, 1.0],
            _ => [-1e-6 * f64::from(i), -1.0, -1.0, -1.0, 1.0],
        });
        for all in [all, uneven.collect()] {
            let side_by_side =
                bracketed_roots::<5, 8>(&std::array::from_fn(|k| std::array::from_fn(|l| all[l][k])));
            for (c, root) in all.iter().zip(side_by_side) {
                assert_eq!(first_sign_change(*c), Some(root), "{c:?}");
            }
        }
    }

    #[test]
    fn a_touch_without_crossing_is_no_sign_change_and_ends() {
        assert_eq!(first_sign_change(from_roots([0.5, 0.5, 2.0, 3.0], 1.0)), None);
    }

    #[test]
    fn a_crossing_at_a_shared_end_is_found_once() {
        let rising = [-1.0, -0.5, 0.0];
        let onwards = [0.0, 0.5, 1.0];
        let found = [first_sign_change(rising), first_sign_change(onwards)];
        assert_eq!(found.iter().flatten().count(), 1, "{found:?}");
    }
}
