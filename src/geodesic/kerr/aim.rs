//! Aim at a place around a spinning hole, exact to first order in the spin: a root in one dimension in the plane of the
//! orbit, and the winding about the axis, which turns the plane.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::hole::{UnitHole, turned_by};
use super::launch::KerrLaunch;
use super::plane::OrbitPlane;
use crate::math::frame::tangents;

/// A place around the hole: units of its mass, spin along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KerrPlace {
    /// Spheroidal radius.
    pub r: f64,
    /// N.
    pub n: DVec3,
}

/// A ray from a place to another as if nothing wound about the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneShot {
    /// Unit direction at its start, in the frame at rest.
    pub direction: DVec3,
    /// Angle that it sweeps about the centre, radians.
    pub angle: f64,
    /// Angle from falling radially, radians.
    alpha: f64,
    /// Derivative of the inverse radius at the end by α; NaN if unknown.
    by_alpha: f64,
    /// Winding about the axis at the end, radians.
    pub turn: f64,
}

/// A ray to a place, with the winding about the axis on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aimed {
    /// The ray, to where the place is without the winding.
    pub shot: PlaneShot,
    /// The winding, radians.
    turn: f64,
    winding: u32,
}

/// Most rays while the winding about the axis is found.
const MAX_AIMS: usize = 8;
/// Largest difference between the winding about the axis and its guess, radians.
const TURN_TOLERANCE: f64 = 0.003;
/// Largest change of a guess, radians.
const LARGEST_TURN: f64 = 0.7;
/// Most orbits followed for one solution.
const MAX_ORBITS: usize = 32;
/// Error of α, radians.
const TOLERANCE: f64 = 3e-4;
/// Impact parameter near that of capture, of any spin.
const CRITICAL: f64 = 5.5;

/// `n` turned about z by an angle, radians.
pub fn turned(n: DVec3, angle: f64) -> DVec3 {
    turned_by(libm::sincos(angle), n)
}

impl KerrPlace {
    /// From a position in the chart.
    pub fn new(hole: &UnitHole, position: DVec3) -> Self {
        let (r, n) = hole.spheroidal(position);
        Self { r, n }
    }

    /// About how much light comes around from a small light at `other`, relative to what comes the near way: as if
    /// deflection were weak.
    pub fn ratio_around(&self, other: &KerrPlace) -> f64 {
        let off_axis = libm::acos((-self.n.dot(other.n)).clamp(-1.0, 1.0));
        // The angle between light and hole in units of Einstein's.
        let square = off_axis * off_axis / (4.0 * (1.0 / self.r + 1.0 / other.r));
        let magnification = (square + 2.0) / (square * (square + 4.0)).sqrt();
        1.0 - 2.0 / (magnification + 1.0)
    }

    /// The half-plane of orbits that start along `tangent`.
    pub(super) fn plane(&self, hole: &UnitHole, tangent: DVec3) -> Option<OrbitPlane> {
        OrbitPlane::new(hole, (1.0 / self.r, self.n), tangent)
    }

    /// Unit tangent at N of the great circle to `n`, and the angle along it that rays with this winding number sweep.
    pub(super) fn towards(&self, n: DVec3, winding: u32) -> (DVec3, f64) {
        let cos = self.n.dot(n);
        let across = n - cos * self.n;
        let tangent = across.try_normalize().unwrap_or_else(|| tangents(self.n).0);
        let near = libm::atan2(across.length(), cos);
        if winding == 0 { (tangent, near) } else { (-tangent, TAU - near) }
    }

    /// Unit direction in the frame at rest in which an orbit starts.
    pub(super) fn direction(&self, hole: &UnitHole, plane: &OrbitPlane, alpha: f64) -> DVec3 {
        let orbit = plane.orbit(alpha);
        let momentum = orbit.start.momentum(hole, &orbit.constants);
        KerrLaunch::direction_at_rest(hole, (self.r, self.n), momentum)
    }

    /// The ray from here to `target` in the plane of both, with this winding number about the centre, as if nothing
    /// wound about the axis; a `guess` saves time.
    fn shoot(
        &self,
        hole: &UnitHole,
        target: &KerrPlace,
        winding: u32,
        guess: Option<&PlaneShot>,
    ) -> Option<PlaneShot> {
        self.shoot_along(hole, target.r, self.towards(target.n, winding), guess)
    }

    /// The ray from here that leaves along the unit `tangent` across N and is at the radius `to` after an angle, as if
    /// nothing wound about the axis.
    pub(super) fn shoot_along(
        &self,
        hole: &UnitHole,
        to: f64,
        (tangent, angle): (DVec3, f64),
        guess: Option<&PlaneShot>,
    ) -> Option<PlaneShot> {
        let plane = self.plane(hole, tangent)?;
        let guess = guess.map(|shot| PlaneGuess { alpha: shot.alpha, by_alpha: shot.by_alpha });
        let found = solve(hole, &plane, (1.0 / self.r, 1.0 / to), angle, guess)?;
        let PlaneSolution { alpha, by_alpha, turn } = found;
        let direction = self.direction(hole, &plane, alpha);
        direction.is_finite().then_some(PlaneShot { direction, angle, alpha, by_alpha, turn })
    }

    /// The ray from here to `target` with this winding number.
    pub fn aim(&self, hole: &UnitHole, target: &KerrPlace, winding: u32) -> Option<Aimed> {
        let place = |turn: f64| KerrPlace { n: turned(target.n, -turn), ..*target };
        let (shot, turn) = with_own_turn(0.0, TURN_TOLERANCE, |turn, before: Option<&PlaneShot>| {
            let shot = self.shoot(hole, &place(turn), winding, before)?;
            Some((shot, shot.turn))
        })?;
        Some(Aimed { shot, turn, winding })
    }
}

/// The ray whose winding about the axis is that with which it was aimed, within `tolerance`, radians, and that winding:
/// by secants from a `guess`. `aim` gives the ray for a winding, and the winding that it has; the ray before may help.
pub fn with_own_turn<T>(
    guess: f64,
    tolerance: f64,
    aim: impl Fn(f64, Option<&T>) -> Option<(T, f64)>,
) -> Option<(T, f64)> {
    let mut turn = guess;
    let (mut ray, mut own) = aim(turn, None)?;
    // The guess before and how far off it was.
    let mut before: Option<(f64, f64)> = None;
    for _ in 1..MAX_AIMS {
        let miss = own - turn;
        if miss.abs() < tolerance {
            break;
        }
        let step = match before {
            Some((guess, missed)) if (miss - missed).abs() > 0.3 * (turn - guess).abs() => {
                -miss * (turn - guess) / (miss - missed)
            }
            _ => miss,
        };
        before = Some((turn, miss));
        turn += step.clamp(-LARGEST_TURN, LARGEST_TURN);
        (ray, own) = aim(turn, Some(&ray))?;
    }
    Some((ray, turn))
}

impl Aimed {
    /// Direction in which a `position` beside the end is seen, by rays that wind about the axis as much.
    pub fn beside(&self, from: &KerrPlace, hole: &UnitHole, position: DVec3) -> Option<DVec3> {
        let place = KerrPlace::new(hole, position);
        let place = KerrPlace { n: turned(place.n, -self.turn), ..place };
        Some(from.shoot(hole, &place, self.winding, Some(&self.shot))?.direction)
    }

    /// True if the ray goes around the hole.
    pub fn goes_around(&self) -> bool {
        self.winding > 0
    }

    /// Sine of the angle that the orbit sweeps, without its sign: the plane is as uncertain as this is small.
    pub fn steadiness(&self) -> f64 {
        libm::sin(self.shot.angle).abs()
    }
}

/// A guess of a ray in a plane that ends at a radius, and the derivative of the inverse radius at its end by α.
#[derive(Clone, Copy)]
pub(super) struct PlaneGuess {
    pub(super) alpha: f64,
    pub(super) by_alpha: f64,
}

/// A ray in a plane that ends at a radius.
pub(super) struct PlaneSolution {
    pub(super) alpha: f64,
    pub(super) by_alpha: f64,
    pub(super) turn: f64,
}

/// The ray in a plane that goes from the first inverse radius to the second while it sweeps `angle`.
pub(super) fn solve(
    hole: &UnitHole,
    plane: &OrbitPlane,
    (from, to): (f64, f64),
    angle: f64,
    guess: Option<PlaneGuess>,
) -> Option<PlaneSolution> {
    let (sin, cos) = libm::sincos(angle);
    let mut alpha = match guess {
        Some(guess) => guess.alpha,
        None => {
            // In flat space, but not captured.
            let flat = if angle < PI { libm::atan2(sin.max(1e-9), to / from - cos) } else { 0.0 };
            let captured = if from < 0.3 { CRITICAL * from } else { 1.0 };
            if angle < 1.5 { flat } else { flat.max(1.05 * captured.min(FRAC_PI_2)) }
        }
    };
    // Too steep a fall, and too flat.
    let (mut low, mut high) = (0.0, PI);
    let mut before: Option<(f64, f64)> = None;
    for _ in 0..MAX_ORBITS {
        let end = plane.orbit(alpha).follow(hole, angle);
        let is_lost = end.left > 0.0;
        let miss = end.u - to;
        if miss.is_nan() {
            return None;
        }
        if miss > 0.0 {
            low = alpha;
        } else {
            high = alpha;
        }
        let mut by_alpha = f64::NAN;
        let next = match before {
            _ if is_lost => f64::NAN,
            Some((other, missed)) => {
                by_alpha = (miss - missed) / (alpha - other);
                alpha - miss / by_alpha
            }
            None => {
                let sin_alpha = libm::sin(alpha);
                let slope = guess.map_or(f64::NAN, |guess| -guess.by_alpha);
                let slope = if slope > 0.0 { slope } else { from * sin.max(0.2) / (sin_alpha * sin_alpha) };
                alpha + (miss / slope).clamp(-0.3, 0.3)
            }
        };
        let next = if next > low && next < high {
            next
        } else if high == PI {
            2.0 * libm::atan(1.5 * libm::tan(0.5 * low))
        } else if low == 0.0 {
            2.0 * libm::atan(libm::tan(0.5 * high) / 1.5)
        } else {
            0.5 * (low + high)
        };
        before = (!is_lost).then_some((alpha, miss));
        let is_found = !is_lost && (next - alpha).abs() < TOLERANCE;
        alpha = next;
        if is_found || high - low < TOLERANCE {
            // Of a warm start that was right at once.
            let by_alpha =
                if by_alpha.is_nan() { guess.map_or(by_alpha, |guess| guess.by_alpha) } else { by_alpha };
            return Some(PlaneSolution { alpha, by_alpha, turn: end.winding });
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesic::kerr::{Series, SeriesControl, SeriesStep, dense_displacement};

    /// TestNumbers in [0, 1), evenly.
    struct TestNumbers(u64);

    impl TestNumbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }

        fn direction(&mut self) -> DVec3 {
            let z = 2.0 * self.next() - 1.0;
            let (sin, cos) = libm::sincos(TAU * self.next());
            let s = (1.0 - z * z).sqrt();
            DVec3::new(s * cos, s * sin, z)
        }

        fn position(&mut self, least: f64, most: f64) -> DVec3 {
            least * libm::pow(most / least, self.next()) * self.direction()
        }
    }

    /// Nearest point to `y` of the whole ray from `x` in a direction.
    fn nearest(hole: &UnitHole, x: DVec3, direction: DVec3, y: DVec3) -> DVec3 {
        let KerrLaunch { constants, mut state } = KerrLaunch::at_rest(hole, x, direction);
        let control = SeriesControl::new(10, 1e-7);
        let (mut nearest, mut before) = (x, x);
        while state.u > 0.01 && state.u < 0.95 * hole.horizon {
            let series = Series::<10>::new(hole, &constants, &state);
            let h = 0.5 * control.length(hole, &series);
            for part in 1..=32 {
                let end = hole.position(state.u, state.n)
                    + dense_displacement(hole, &series, h * f64::from(part) / 32.0);
                let chord = end - before;
                let s = ((y - before).dot(chord) / chord.length_squared()).clamp(0.0, 1.0);
                let point = before + s * chord;
                if point.distance(y) < nearest.distance(y) {
                    nearest = point;
                }
                before = end;
            }
            state = SeriesStep::new(hole, &constants, &series, h).end;
        }
        nearest
    }

    /// Errors of aims in radians, sorted: the direction to the point that the ray meets, less that of the ray.
    fn errors(a: f64, winding: u32, wanted: impl Fn(f64) -> bool) -> Vec<f64> {
        let hole = UnitHole::new(a, 0.0);
        let (mut numbers, mut errors) = (TestNumbers(7), Vec::new());
        while errors.len() < 200 {
            let (x, y) = (numbers.position(4.0, 30.0), numbers.position(3.0, 30.0));
            if !wanted(x.normalize().dot(y.normalize())) {
                continue;
            }
            let (place, target) = (KerrPlace::new(&hole, x), KerrPlace::new(&hole, y));
            let aim = place.aim(&hole, &target, winding).expect("an aim");
            let met = nearest(&hole, x, aim.shot.direction, y);
            let error = aim.beside(&place, &hole, met);
            errors.push(error.map_or(1.0, |direction| direction.distance(aim.shot.direction)));
        }
        errors.sort_by(f64::total_cmp);
        errors
    }

    /// Largest medians of errors, radians: of rays that go the near way, and of those that go around.
    fn check(a: f64, [near, around]: [f64; 2]) {
        for (winding, most) in [(0, near), (1, around)] {
            for (name, [least, greatest]) in
                [("same", [0.5, 1.0]), ("side", [-0.5, 0.5]), ("behind", [-1.0, -0.5])]
            {
                let errors = errors(a, winding, |cos| cos > least && cos < greatest);
                let [median, p90] = [100, 180].map(|i| errors[i]);
                println!("a = {a}, {winding}, {name}: median {median:.1e}, nine of ten {p90:.1e}");
                assert!(median < most && p90 < 10.0 * most, "a = {a}, {winding}, {name}: {median}, {p90}");
            }
        }
    }

    #[test]
    fn the_aim_is_exact_without_spin() {
        check(0.0, [5e-4, 5e-4]);
    }

    #[test]
    fn errors_of_the_aim_are_of_second_order_in_the_spin() {
        check(0.1, [1e-3, 1e-3]);
        check(-0.5, [2.5e-3, 6e-3]);
        check(0.9, [8e-3, 2e-2]);
        check(-0.998, [1e-2, 2.5e-2]);
    }
}
