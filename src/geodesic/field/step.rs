//! Steps of rays in a field of refraction, many rays at a time.

use glam::DVec3;

use crate::geodesic::{SpaceArc, Stepper, Trial, fit_space_arc, halfway};
use crate::spacetime::{FieldSurvey, IndexField, Lanes, Vectors, Viewpoint, dot};

/// Rays at places of a field.
#[derive(Clone, Copy, Debug)]
pub struct FieldRays<const L: usize> {
    /// Positions.
    pub x: Vectors<L>,
    /// Momenta, as long as the index.
    pub p: Vectors<L>,
    /// ½∇n².
    pub force: Vectors<L>,
    /// β of projective coordinates for a step from there.
    pub lean: Vectors<L>,
    /// Lengths over which the index changes.
    pub room: Lanes<L>,
    /// Lengths of the longest steps that overlook nothing.
    pub reach: Lanes<L>,
}

/// Steps of rays.
#[derive(Clone, Copy, Debug)]
pub struct FieldStep<const L: usize> {
    /// Their ends; of no use where `ahead` is not positive.
    pub end: FieldRays<L>,
    /// 1 − β·Y at the ends: 0 at infinity.
    pub ahead: Lanes<L>,
    /// Projective displacements Y.
    pub way: Vectors<L>,
    /// Their rates dY/dτ at the ends, times the length of the step.
    pub rate: Vectors<L>,
    /// Length of the steps, relative to the distance over which the field changes.
    pub share: Lanes<L>,
    /// Error of the direction that the stepper estimates, with what the place is off as an angle, radians.
    pub embedded: Lanes<L>,
    /// Relative violation of |p|² = n² before it was undone.
    pub drift: Lanes<L>,
}

/// The vector of a lane.
#[inline(always)]
pub(crate) fn lane<const L: usize>(vectors: &Vectors<L>, l: usize) -> DVec3 {
    DVec3::new(vectors[0][l], vectors[1][l], vectors[2][l])
}

/// Puts a vector into a lane.
#[inline(always)]
pub(crate) fn set_lane<const L: usize>(vectors: &mut Vectors<L>, l: usize, vector: DVec3) {
    (vectors[0][l], vectors[1][l], vectors[2][l]) = (vector.x, vector.y, vector.z);
}

/// A vector as the only one of its lanes.
pub fn alone(vector: DVec3) -> Vectors<1> {
    [[vector.x], [vector.y], [vector.z]]
}

impl<const L: usize> FieldRays<L> {
    /// Rays that start at `x` in the directions `d`, not 0 and of any length.
    #[inline(always)]
    pub fn new(field: &impl IndexField, x: &Vectors<L>, d: &Vectors<L>) -> Self {
        Self::of(x, d, &field.survey(x, d))
    }

    /// Rays in these directions where the field is known.
    #[inline(always)]
    fn of(x: &Vectors<L>, d: &Vectors<L>, survey: &FieldSurvey<L>) -> Self {
        let (mut p, length2) = (*d, dot(d, d));
        for l in 0..L {
            let factor = (survey.index_squared[l] / length2[l]).sqrt();
            for component in &mut p {
                component[l] *= factor;
            }
        }
        let FieldSurvey { force, lean, room, reach, .. } = *survey;
        Self { x: *x, p, force, lean, room, reach }
    }

    /// From where their next steps are seen.
    #[inline(always)]
    fn viewpoint(&self) -> Viewpoint<L> {
        Viewpoint { x: self.x, p: self.p, lean: self.lean }
    }
}

impl<const L: usize> FieldStep<L> {
    /// One step each, of lengths `h` in τ; shorter steps from the same start are its dense output. `N` is 3 `L`: all rays
    /// together are one system of so many dimensions.
    #[inline(always)]
    pub fn new<const N: usize>(
        field: &impl IndexField,
        stepper: &impl Stepper,
        start: &FieldRays<L>,
        h: &Lanes<L>,
    ) -> Self {
        let view = start.viewpoint();
        let lean = &view.lean;
        // In units of each ray's own step.
        let squared = |mut force: Vectors<L>| {
            for component in &mut force {
                for l in 0..L {
                    component[l] *= h[l] * h[l];
                }
            }
            flat::<L, N>(&force)
        };
        let mut speed = view.p;
        for component in &mut speed {
            for l in 0..L {
                component[l] *= h[l];
            }
        }
        let force = |_: f64, y: [f64; N]| squared(field.acceleration(&view, &vectors::<L, N>(&y)));
        let start_force = squared(start.force);
        let Trial { gain, velocity, position_error, velocity_error } =
            stepper.step(force, [[0.0; N], flat::<L, N>(&speed), start_force], 1.0);
        let (way, rate) = (vectors::<L, N>(&gain), vectors::<L, N>(&velocity));
        let (way_error, rate_error) = (vectors::<L, N>(&position_error), vectors::<L, N>(&velocity_error));

        let (leaning, leaning_rate) = (dot(lean, &way), dot(lean, &rate));
        let leaning_error = dot(lean, &rate_error);
        let (mut x, mut p, mut p_error) = (start.x, [[0.0; L]; 3], [[0.0; L]; 3]);
        let mut ahead = [0.0; L];
        for l in 0..L {
            ahead[l] = 1.0 - leaning[l];
            let (per_ahead, per_h) = (1.0 / ahead[l], 1.0 / h[l]);
            for k in 0..3 {
                x[k][l] += way[k][l] * per_ahead;
                p[k][l] = per_h * (ahead[l] * rate[k][l] + way[k][l] * leaning_rate[l]);
                p_error[k][l] = per_h * (ahead[l] * rate_error[k][l] + way[k][l] * leaning_error[l]);
            }
        }
        let survey = field.survey(&x, &p);
        let momentum2 = dot(&p, &p);
        let (error_along, way_error_along) = (dot(&p_error, &p), dot(&way_error, &rate));
        let (p_error2, way_error2, rate2) =
            (dot(&p_error, &p_error), dot(&way_error, &way_error), dot(&rate, &rate));
        let (mut embedded, mut drift, mut share) = ([0.0; L], [0.0; L], [0.0; L]);
        let speed2 = dot(&speed, &speed);
        for l in 0..L {
            // What is along the ray moves nothing.
            let turned = p_error2[l] - error_along[l] * error_along[l] / momentum2[l];
            let moved = way_error2[l] - way_error_along[l] * way_error_along[l] / rate2[l];
            let (turned, moved) =
                (if turned > 0.0 { turned } else { 0.0 }, if moved > 0.0 { moved } else { 0.0 });
            let room = start.room[l];
            embedded[l] = (turned / momentum2[l]).sqrt() + moved.sqrt() / room;
            let nearest = if survey.room[l] < room { survey.room[l] } else { room };
            share[l] = speed2[l].sqrt() * nearest / (room * room);
            drift[l] = (momentum2[l] / survey.index_squared[l] - 1.0).abs();
        }
        Self { end: FieldRays::of(&x, &p, &survey), ahead, way, rate, share, embedded, drift }
    }

    /// Arc of a ray's step from the start, as displacements: middle control point, end, weight, and its distance from the
    /// ray.
    ///
    /// Conics stay conics in projective coordinates, in which the ray is the straighter one. One that `starts_on` a
    /// surface keeps the tangent there.
    #[inline(always)]
    pub fn arc(&self, start: &FieldRays<L>, h: f64, starts_on: bool, l: usize) -> (DVec3, DVec3, f64, f64) {
        let (lean, way, rate) = (lane(&start.lean, l), lane(&self.way, l), lane(&self.rate, l));
        let q = self.ahead[l];
        let force = lane(&self.end.force, l);
        let bend = (h * h / (q * q * q)) * (force - way * lean.dot(force));
        let (speed, first_bend) = (h * lane(&start.p, l), h * h * lane(&start.force, l));
        let (first, last) = ([speed, first_bend], [rate, bend]);
        let SpaceArc { middle, weight, error } =
            fit_space_arc(way, halfway(1.0, way, first, last), first, last, starts_on);
        let at_middle = 1.0 - lean.dot(middle);
        let scale = 1.0 / if q < 1.0 { q } else { 1.0 };
        let weight = weight * at_middle / q.sqrt();
        let error = if at_middle > 0.0 { scale * error } else { f64::INFINITY };
        (middle / at_middle, way / q, weight, error)
    }
}

/// Vectors of lanes as one vector.
#[inline(always)]
fn flat<const L: usize, const N: usize>(vectors: &Vectors<L>) -> [f64; N] {
    const { assert!(N == 3 * L) };
    let mut flat = [0.0; N];
    for k in 0..3 {
        for l in 0..L {
            flat[k * L + l] = vectors[k][l];
        }
    }
    flat
}

/// Vectors of lanes from one vector.
#[inline(always)]
fn vectors<const L: usize, const N: usize>(flat: &[f64; N]) -> Vectors<L> {
    const { assert!(N == 3 * L) };
    let mut vectors = [[0.0; L]; 3];
    for k in 0..3 {
        for l in 0..L {
            vectors[k][l] = flat[k * L + l];
        }
    }
    vectors
}
