//! The map itself: polynomials on both sides of the photon sphere, and places on it.

use glam::DVec3;

use super::rules::{Lanes, RULES, rule};
use super::weak::WeakBending;
use crate::math::chebyshev::Chebyshev;
use crate::math::columns::columns;
use crate::spacetime::ConformallyFlat;

/// The lens map of a static, spherically symmetric spacetime with one photon sphere.
#[derive(Clone, Debug)]
pub struct Lens {
    /// Critical impact parameter b_c.
    pub(super) critical: f64,
    /// Inverse radius of the photon sphere.
    photon_sphere: f64,
    /// h(s) on both sides of the photon sphere; `None` if a cylindrical throat is between them.
    pub(super) through: Option<Chebyshev>,
    /// Half the length of a cylindrical throat over its radius; 0 without one.
    tube: f64,
    /// Imaginary s within which h is analytic, at most 1.
    pub(super) waist: f64,
    /// h(s) outside.
    pub(super) outside: Chebyshev,
    /// h(s) inside.
    pub(super) inside: Chebyshev,
    /// w(s), over the inverse radius of the photon sphere: its inverse is s without cancellation.
    place: Chebyshev,
    /// |s| up to which h is analytic, inside and outside.
    pub(super) reach: [f64; 2],
    /// κ away from the photon sphere, if a short polynomial is good enough.
    pub(super) bending: Option<WeakBending>,
    /// Gauss–Legendre rules, the number of nodes growing.
    pub(super) rules: Vec<Vec<(Lanes, Lanes)>>,
    /// Resolution that a rule must have: −½ ln of the relative error.
    pub(super) digits: f64,
    /// Relative change of a root that ends its search.
    pub(super) enough: f64,
    /// (κ − 1) B/b_c far away.
    pub(super) weak: f64,
}

columns! {
    /// A place as the lens sees it.
    #[derive(PartialEq)]
    pub struct Site => SiteBlock {
        /// Unit vector from the centre.
        radial: DVec3,
        /// Inverse isotropic radius in the chart of its own side; 0 at infinity.
        w: f64,
        /// 1/B.
        q: f64,
        /// s.
        s: f64,
        /// Proper radius over that of a cylindrical throat, up to its ends; 0 without one.
        depth: f64,
    }
}

/// Terms of the polynomials: enough for rounding.
const TERMS: usize = 48;
/// Distance of an even function's singularities on the imaginary axis over its value at 0, about: those of h, if
/// s² ∝ x² next to 0 and x = ±i is singular.
const WAIST: f64 = 0.7;
/// |s| below which s is found from w: its square loses digits.
pub(super) const NEAR_PHOTON_SPHERE: f64 = 0.05;
/// Inverse radius in units of the photon sphere's, beyond which the index of a horizon at the centre need not be known.
const DEEPEST: f64 = 1e9;

impl Lens {
    /// The lens of `medium`, with relative errors of about `tolerance`; `None` if there is no photon sphere.
    pub fn new<M: ConformallyFlat>(medium: &M, tolerance: f64) -> Option<Self> {
        let (critical, photon_sphere) = (medium.critical_impact_parameter(), 1.0 / medium.photon_sphere());
        if !(critical > 0.0 && photon_sphere.is_finite()) {
            return None;
        }
        // Where the horizon is at the centre, w(s) has a pole at s = -1: it is fitted where it is asked for.
        let (mouth, throat) = (medium.mouth(), medium.throat());
        let (innermost, near) = match medium.horizon() {
            _ if mouth > 0.0 => (photon_sphere, (0.0, 0.5)),
            0.0 => (DEEPEST * photon_sphere, (-0.5, 0.5)),
            horizon => (1.0 / horizon, (-1.0, 1.0)),
        };
        let place = |s: f64| {
            let (low, high) = if s > 0.0 { (0.0, photon_sphere) } else { (photon_sphere, innermost) };
            let is_lower = |w: f64| critical * w / medium.index(w) < 1.0 - s * s;
            bisect(low, high, |w| is_lower(w) == (s > 0.0))
        };
        let h = |s: f64| {
            let w = place(s);
            s / (1.0 - w * medium.pull(w) / medium.index_squared(w))
        };
        // Next to s = 0, where its quotient is 0/0, h is known from afar.
        let whole = (mouth == 0.0).then(|| Chebyshev::fit(TERMS, (-1.0, 1.0), h));
        let part = |low: f64, high: f64| {
            let value = |s: f64| whole.as_ref().map_or_else(|| h(s.abs()), |whole| whole.at(s)[0]);
            Chebyshev::fit(TERMS, (low, high), value).trimmed(0.1 * tolerance)
        };
        let (inside, outside) = (part(-1.0, 0.0), part(0.0, 1.0));
        let stretch = |share: f64| {
            let s = (1.0 - share).sqrt();
            h(s) / s
        };
        let bending = WeakBending::fit(critical, 0.1 * tolerance, stretch);
        // Both intervals are half as long as 1: the middle, and as many halves as the ellipse of convergence is long.
        let reach = [&inside, &outside].map(|fit| 0.5 + 0.5 * fit.reach(0.1 * tolerance));
        Some(Self {
            critical,
            photon_sphere,
            waist: if whole.is_none() { (WAIST * outside.at(0.0)[0]).min(1.0) } else { 1.0 },
            tube: if whole.is_none() { libm::log(mouth / throat) } else { 0.0 },
            through: whole.map(|whole| whole.trimmed(0.1 * tolerance)),
            weak: 0.5 * (1.0 - outside.at(1.0)[1]),
            outside,
            inside,
            bending,
            reach,
            place: Chebyshev::fit(TERMS, near, |s| place(s) / photon_sphere),
            rules: RULES.map(rule).to_vec(),
            digits: -0.5 * libm::log(tolerance),
            enough: tolerance,
        })
    }

    /// Rays that keep away from the photon sphere; `None` if a short polynomial is not good enough.
    pub fn weak_bending(&self) -> Option<&WeakBending> {
        self.bending.as_ref()
    }

    /// The place `x`, relative to the centre, not 0 and outside the horizon.
    pub fn site<M: ConformallyFlat>(&self, medium: &M, x: DVec3) -> Site {
        let site = self.rough_site(medium, x);
        if self.is_in_tube(&site) {
            return Site { s: f64::EPSILON, depth: libm::log(x.length() / medium.throat()), ..site };
        }
        if self.is_near_photon_sphere(&site) {
            let mut s = site.s;
            for _ in 0..3 {
                let [value, slope] = self.place.at(s);
                s -= (value - site.w / self.photon_sphere) / slope;
            }
            return Site { s: s.abs().max(f64::EPSILON).copysign(s), ..site };
        }
        site
    }

    /// [`Self::site`] of what is neither near the photon sphere nor in a cylindrical throat.
    #[inline(always)]
    pub(super) fn rough_site<M: ConformallyFlat>(&self, medium: &M, x: DVec3) -> Site {
        let rho = x.length();
        let w = 1.0 / rho;
        let q = w / medium.index(w);
        let size = (1.0 - self.critical * q).max(0.0).sqrt();
        let s = if w > self.photon_sphere { -size } else { size };
        Site { radial: x / rho, w, q, s, depth: self.tube }
    }

    /// True of places in a cylindrical throat.
    #[inline(always)]
    pub(super) fn is_in_tube(&self, site: &Site) -> bool {
        self.through.is_none() && site.w > self.photon_sphere
    }

    /// True of places so near to the photon sphere that s loses digits.
    #[inline(always)]
    pub(super) fn is_near_photon_sphere(&self, site: &Site) -> bool {
        site.s.abs() < NEAR_PHOTON_SPHERE
    }

    /// The place at infinity in the unit direction `radial`.
    pub fn infinity(&self, radial: DVec3) -> Site {
        Site { radial, w: 0.0, q: 0.0, s: 1.0, depth: self.tube }
    }
}

impl Site {
    /// Unit vector from the centre, as seen from the near side of a throat.
    pub fn radial(&self) -> DVec3 {
        self.radial
    }

    /// True if one of the places is in a cylindrical throat, and the other is not at the same depth: rays between them do
    /// not turn.
    pub fn is_at_other_depth(&self, other: &Self) -> bool {
        self.depth != other.depth
    }

    /// True if rays between the places pass the photon sphere, or a part of a cylindrical throat: they do not turn.
    pub(super) fn is_beyond(&self, other: &Self) -> bool {
        self.is_at_other_depth(other) || (self.s > 0.0) != (other.s > 0.0)
    }

    /// The place on the other side of a throat that looks as this one does from here, in the unit direction `radial` as
    /// seen from this side. Geometry factors to it are to areas in its own chart.
    pub fn beyond_throat(self, radial: DVec3) -> Self {
        Self { radial, s: -self.s, depth: -self.depth, ..self }
    }
}

/// Bisects for the number at which a predicate that holds from `low` on ceases to, between `low` and `high`.
pub(super) fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
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
