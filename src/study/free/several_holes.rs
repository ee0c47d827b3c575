//! Rays among several holes at rest, in isotropic coordinates; the holes are in the rows.

use glam::DVec3;

use super::super::hole_columns::{HOLES, holes};
use super::super::input_error::{Input, InputError};
use super::super::lengths::Lengths;
use super::super::table::Cell;
use super::sensitivity::sensitivity;
use super::{Accuracy, Arrival, Cells, FreeRayEnd, SphereCrossing, TableForm, Traced};
use crate::geodesic::{
    Dop853, FieldControl, FieldEnd, FieldJourney, FieldRays, FieldStep, Rkn6, Stepper, alone,
    elapsed_in_field, follow_field,
};
use crate::scene::{Precision, StepperKind};
use crate::spacetime::{SeveralHoles, SpacetimeKind};

/// Columns of a ray's start, of its direction, of any length, and of its sphere.
const START: [&str; 3] = ["x0", "y0", "z0"];
const DIRECTION: [&str; 3] = ["dx0", "dy0", "dz0"];
const SPHERE: [&str; 4] = ["cx", "cy", "cz", "r_out"];
/// Form of the tables.
pub(super) static FORM: TableForm = TableForm {
    needed: &["x0", "y0", "z0", "dx0", "dy0", "dz0", "cx", "cy", "cz", "r_out"],
    optional: &HOLES,
    results: &["hole", "x1", "y1", "z1", "dx1", "dy1", "dz1", "t", "L_axis", "sens"],
    crossing: ["x1", "y1", "z1", "dx1", "dy1", "dz1", "sens"],
    steppers: &[StepperKind::Rkn6, StepperKind::Dop853],
    stepper: None,
    radius: |_, cells| cells.last(),
    trace: |_: &SpacetimeKind, cells, accuracy| Ok(FieldRay::new(cells, accuracy)?.traced(accuracy)),
    arrive: |_: &SpacetimeKind, cells, accuracy| Ok(FieldRay::new(cells, accuracy)?.arrival(accuracy)),
};

/// Accuracy with which the rays beside a ray are followed, for its sensitivity.
const BESIDE: Accuracy =
    Accuracy { stepper: StepperKind::Dop853, tolerance: 1e-13, precision: Precision::F64 };

/// A ray about to be followed.
struct FieldRay {
    field: SeveralHoles,
    x: DVec3,
    /// Unit vector.
    direction: DVec3,
    center: DVec3,
    r_out: f64,
}

impl FieldRay {
    fn new(cells: &Cells, accuracy: &Accuracy) -> Result<Self, InputError> {
        FORM.check(accuracy.stepper)?;
        if accuracy.precision == Precision::F32 {
            return Err(InputError {
                input: Input::Precision,
                cause: "rays among several holes are followed in f64".to_owned(),
                remedy: "take f64".to_owned(),
            });
        }
        let lengths = Lengths::of(accuracy.precision);
        let vector = |first: usize| DVec3::from_slice(&cells.needed[first..first + 3]);
        let (x, direction, center, r_out) = (vector(0), vector(3), vector(6), cells.last());
        lengths.check(Input::Columns(&DIRECTION), "the length of the direction", direction.length())?;
        lengths.check(Input::Columns(&SPHERE), "the radius of the sphere", r_out)?;
        let holes = holes(&cells.optional, &lengths)?;
        for hole in &holes {
            let what = "the distance of the start from a hole";
            lengths.check(Input::Columns(&START), what, x.distance(hole.center))?;
        }
        Ok(Self { field: SeveralHoles::new(&holes), x, direction: direction.normalize(), center, r_out })
    }

    /// Follows the ray in `direction`; with the coordinate time on request.
    fn follow(&self, direction: DVec3, accuracy: &Accuracy, time: Option<&mut f64>) -> FieldJourney {
        match accuracy.stepper {
            StepperKind::Dop853 => self.follow_by(&Dop853, direction, accuracy.tolerance, time),
            // The form has no others.
            _ => self.follow_by(&Rkn6, direction, accuracy.tolerance, time),
        }
    }

    fn follow_by(
        &self,
        stepper: &impl Stepper,
        direction: DVec3,
        tolerance: f64,
        mut time: Option<&mut f64>,
    ) -> FieldJourney {
        let Self { field, x, center, r_out, .. } = self;
        let control = FieldControl::new(field, 0.0, tolerance, f64::INFINITY);
        let start = FieldRays::new(field, &alone(*x), &alone(direction));
        let each = |start: &FieldRays<1>, step: &FieldStep<1>, h: f64| {
            if let Some(time) = &mut time {
                **time += elapsed_in_field(field, start, step, h);
            }
        };
        follow_field(field, stepper, &control, start, (*center, *r_out), each)
    }

    fn arrival(&self, accuracy: &Accuracy) -> Arrival {
        let FieldJourney { end, steps } = self.follow(self.direction, accuracy, None);
        let crossing = if let FieldEnd::Crosses(x, d) = end { Some((x, d)) } else { None };
        Arrival { status: status(end), crossing, steps }
    }

    fn traced(&self, accuracy: &Accuracy) -> Traced {
        let mut time = 0.0;
        let FieldJourney { end, steps } = self.follow(self.direction, accuracy, Some(&mut time));
        let crossing = if let FieldEnd::Crosses(position, direction) = end {
            let beside = |direction| match self.follow(direction, &BESIDE, None).end {
                FieldEnd::Crosses(x, d) => Some((x, d)),
                FieldEnd::Falls(_) | FieldEnd::Misses | FieldEnd::StepLimit | FieldEnd::NonFinite => None,
            };
            let sens = sensitivity(self.direction, self.r_out, beside);
            Some(SphereCrossing { position, direction, sens })
        } else {
            None
        };
        let hole = if let FieldEnd::Falls(hole) = end { Cell::Integer(hole as i64 + 1) } else { Cell::Empty };
        let at = |value: fn(&SphereCrossing) -> f64| Cell::from(crossing.as_ref().map(value));
        let cells = vec![
            hole,
            at(|c| c.position.x),
            at(|c| c.position.y),
            at(|c| c.position.z),
            at(|c| c.direction.x),
            at(|c| c.direction.y),
            at(|c| c.direction.z),
            Cell::from(crossing.map(|_| time)),
            Cell::from(self.axial_momentum()),
            at(|c| c.sens),
        ];
        Traced { status: status(end), crossing, cells, steps }
    }

    /// Angular momentum about the axis of two holes, which is conserved.
    fn axial_momentum(&self) -> Option<f64> {
        let [first, second] = self.field.holes() else { return None };
        let axis = (second.center - first.center).normalize();
        let potential = self.field.potential(self.x);
        let momentum = potential * potential * self.direction;
        Some(axis.dot((self.x - first.center).cross(momentum)))
    }
}

fn status(end: FieldEnd) -> FreeRayEnd {
    match end {
        FieldEnd::Crosses(..) => FreeRayEnd::Escaped,
        FieldEnd::Falls(_) => FreeRayEnd::Captured,
        FieldEnd::Misses => FreeRayEnd::Missed,
        FieldEnd::StepLimit => FreeRayEnd::StepLimit,
        FieldEnd::NonFinite => FreeRayEnd::NonFinite,
    }
}
