//! Rays through wormholes, in isotropic coordinates: of both sides, glued antipodally, where a table has the centres of
//! both; else of the near side alone, in which the far one is within the throat.

use glam::{DMat3, DVec3};

use super::super::input_error::{Input, InputError};
use super::super::lengths::{Lengths, check_together};
use super::super::table::Cell;
use super::isotropic::{self, Answer, Exit, FreeRay};
use super::table_form::other_chart;
use super::{Accuracy, Arrival, Cells, SphereCrossing, TableForm, Traced};
use crate::scene::StepperKind;
use crate::spacetime::{
    ConformallyFlat, IndexField, KerrNewman, Mouths, Placement, Side, SpacetimeKind, SpacetimeVisitor,
};

/// Columns of a ray's start and of its direction, of any length.
const START: [&str; 3] = ["x0", "y0", "z0"];
/// Columns of a start by its proper radius l, below 0 on the far side, and its direction from the centre, of any length.
const PROPER_START: [&str; 4] = ["l0", "nx0", "ny0", "nz0"];
const DIRECTION: [&str; 3] = ["dx0", "dy0", "dz0"];
/// Columns of its sphere: its isotropic radius, or the proper radius l on either side.
const SPHERE: [&str; 2] = ["r_out", "L"];
/// Columns of the centres.
const CENTERS: [&str; 6] = ["cnx", "cny", "cnz", "cfx", "cfy", "cfz"];

/// Form of the tables.
pub(super) static FORM: TableForm = TableForm {
    needed: &["dx0", "dy0", "dz0"],
    optional: &[
        "x0", "y0", "z0", "l0", "nx0", "ny0", "nz0", "r_out", "L", "cnx", "cny", "cnz", "cfx", "cfy", "cfz",
    ],
    results: &[
        "side", "x1", "y1", "z1", "nx1", "ny1", "nz1", "dx1", "dy1", "dz1", "t", "phi", "h", "eps", "l_turn",
        "sens", "drift_h",
    ],
    crossing: ["x1", "y1", "z1", "dx1", "dy1", "dz1", "sens"],
    steppers: &StepperKind::OF_ORBITS,
    stepper: None,
    radius: |spacetime, cells| ThroatRay::of(spacetime, cells).map_or(f64::NAN, |ray| ray.radius(spacetime)),
    trace: |spacetime, cells, accuracy| {
        let ray = ThroatRay::of(spacetime, cells)?;
        let (way, exit) = ray.follow::<Exit>(spacetime, accuracy)?;
        Ok(traced(&way, &exit, spacetime))
    },
    arrive: |spacetime, cells, accuracy| {
        let ray = ThroatRay::of(spacetime, cells)?;
        let (way, (arrival, passes)) = ray.follow::<(Arrival, bool)>(spacetime, accuracy)?;
        let crossing = arrival.crossing.map(|(x, d)| way.end(passes, x, d));
        Ok(Arrival { crossing: crossing.map(|(_, x, d)| (x, d)), ..arrival })
    },
};

/// A ray as a row describes it.
struct ThroatRay {
    start: DVec3,
    direction: DVec3,
    r_out: Option<f64>,
    l: Option<f64>,
    /// Both charts, if the table has them.
    mouths: Option<Mouths>,
}

/// Chart of a ray's start, and what its end is told in.
struct WayThrough {
    side: Side,
    mouths: Option<Mouths>,
    /// Isotropic radius of the throat, 0 in flat space.
    throat: f64,
}

impl ThroatRay {
    fn of(spacetime: &SpacetimeKind, cells: &Cells) -> Result<Self, InputError> {
        let [x, y, z, l0, nx, ny, nz, r_out, l, centers @ ..] = &cells.optional[..] else {
            return Err(incomplete(&SPHERE, "the row has no sphere", "give it a radius"));
        };
        let start = match ([x, y, z], [nx, ny, nz], l0) {
            ([Some(x), Some(y), Some(z)], [None, None, None], _) => DVec3::new(*x, *y, *z),
            ([None, None, None], [Some(x), Some(y), Some(z)], Some(l0)) => {
                let radial = DVec3::new(*x, *y, *z).try_normalize().ok_or_else(|| {
                    incomplete(&PROPER_START, "the direction from the centre is 0", "give its direction")
                })?;
                chart_radius(spacetime, *l0) * radial
            }
            _ => {
                return Err(incomplete(
                    &START,
                    "the ray needs one start",
                    "give `x0`, `y0`, `z0`, or `l0`, `nx0`, `ny0`, `nz0`",
                ));
            }
        };
        if r_out.is_some() == l.is_some() {
            return Err(incomplete(
                &SPHERE,
                "the sphere needs one radius",
                "give its isotropic radius `r_out`, or its proper radius `L`",
            ));
        }
        let given: Vec<f64> = centers.iter().filter_map(|center| *center).collect();
        let mouths = match given.len() {
            0 => None,
            6 => Some(Mouths {
                near: DVec3::from_slice(&given[0..3]),
                far: DVec3::from_slice(&given[3..6]),
                rotation: DMat3::IDENTITY,
            }),
            _ => return Err(incomplete(&CENTERS, "some of the centres are missing", "give all or none")),
        };
        Ok(Self { start, direction: DVec3::from_slice(&cells.needed), r_out: *r_out, l: *l, mouths })
    }

    /// Isotropic radius of the sphere, on either side.
    fn radius(&self, spacetime: &SpacetimeKind) -> f64 {
        let proper = |l: f64| spacetime.wormhole().map_or(l, |(_, metric)| metric.isotropic_radius(l));
        self.r_out.or(self.l.map(proper)).unwrap_or(f64::NAN)
    }

    /// Follows the ray, in the chart of the side on which it starts.
    fn follow<A: Answer>(
        &self,
        spacetime: &SpacetimeKind,
        accuracy: &Accuracy,
    ) -> Result<(WayThrough, A), InputError> {
        let lengths = Lengths::of(accuracy.precision);
        lengths.check_parameters(spacetime)?;
        check_together(spacetime, Input::Spacetime)?;
        let throat = throat(spacetime);
        let x = self.start - self.mouths.map_or(DVec3::ZERO, |mouths| mouths.near);
        let is_far = self.mouths.is_none() && x.length() < throat;
        let (side, (x, direction)) = if is_far {
            (Side::Far, inverted(throat, x, self.direction))
        } else {
            (Side::Near, (x, self.direction))
        };
        let ray = FreeRay { start: x, direction, r_out: self.radius(spacetime) };
        lengths.check(Input::Columns(&DIRECTION), "the length of the direction", direction.length())?;
        lengths.check(Input::Columns(&SPHERE), "the radius of the sphere", ray.r_out)?;
        lengths.check(Input::Columns(&START), "the distance of the start from the centre", x.length())?;
        if x.length() < throat * (1.0 - 4.0 * f64::EPSILON) {
            return Err(incomplete(
                &START,
                "the ray starts within the throat, in neither world",
                "start outside of it, or leave the columns of the centres out",
            ));
        }
        let answer = spacetime.visit(Through { ray: &ray, accuracy, answer: std::marker::PhantomData })?;
        Ok((WayThrough { side, mouths: self.mouths, throat }, answer))
    }
}

fn incomplete(columns: &'static [&'static str], cause: &str, remedy: &str) -> InputError {
    InputError { input: Input::Columns(columns), cause: cause.to_owned(), remedy: remedy.to_owned() }
}

/// Isotropic radius of the throat, 0 in flat space.
fn throat(spacetime: &SpacetimeKind) -> f64 {
    spacetime.wormhole().map_or(0.0, |(_, metric)| metric.throat())
}

/// Radius of the proper radius `l`, below 0 on the far side, in the chart of the near side.
fn chart_radius(spacetime: &SpacetimeKind, l: f64) -> f64 {
    let radius = spacetime.wormhole().map_or(l.abs(), |(_, metric)| metric.isotropic_radius(l.abs()));
    if l < 0.0 { throat(spacetime).powi(2) / radius } else { radius }
}

/// A place and a direction in the chart of one side, relative to its centre, in that of the other.
fn inverted(throat: f64, x: DVec3, direction: DVec3) -> (DVec3, DVec3) {
    let radial = x.normalize();
    (-(throat * throat) * x / x.length_squared(), 2.0 * radial.dot(direction) * radial - direction)
}

impl WayThrough {
    /// Side, position and direction of an end, from what it is if nothing is inverted.
    fn end(&self, passes: bool, x: DVec3, direction: DVec3) -> (Side, DVec3, DVec3) {
        // Half a turn in the plane of the orbit.
        let (side, x, direction) =
            if passes { (self.side.other(), -x, -direction) } else { (self.side, x, direction) };
        match (self.mouths, side) {
            (Some(mouths), _) => (side, mouths.center(side) + x, direction),
            (None, Side::Near) => (side, x, direction),
            (None, Side::Far) => {
                let (x, direction) = inverted(self.throat, x, direction);
                (side, x, direction)
            }
        }
    }
}

/// Follows a ray around the centre of a spacetime, which is where its chart has it.
struct Through<'a, A> {
    ray: &'a FreeRay,
    accuracy: &'a Accuracy,
    answer: std::marker::PhantomData<A>,
}

impl<A: Answer> SpacetimeVisitor for Through<'_, A> {
    type Output = Result<A, InputError>;

    fn flat(self) -> Self::Output {
        Ok(A::known(isotropic::straight(self.ray.start, self.ray)))
    }

    fn spherical<M: ConformallyFlat>(self, _: DVec3, _: M) -> Self::Output {
        Err(other_chart("a wormhole's"))
    }

    fn wormhole<M: ConformallyFlat>(self, _: Mouths, medium: M) -> Self::Output {
        isotropic::curved(&medium, self.ray.start, DVec3::ZERO, self.ray, self.accuracy)
    }

    fn indexed<F: IndexField>(self, _: &F) -> Self::Output {
        Err(other_chart("a wormhole's"))
    }

    fn spinning(self, _: Placement, _: KerrNewman) -> Self::Output {
        Err(other_chart("a wormhole's"))
    }
}

/// Cells of an exit.
fn traced(way: &WayThrough, exit: &Exit, spacetime: &SpacetimeKind) -> Traced {
    let end = exit.crossing.map(|crossing| {
        let (side, position, direction) = way.end(exit.passes, crossing.position, crossing.direction);
        (side, SphereCrossing { position, direction, sens: crossing.sens })
    });
    let (position, direction) = (end.map(|(_, end)| end.position), end.map(|(_, end)| end.direction));
    let turn = |rho: f64| spacetime.wormhole().map_or(rho, |(_, metric)| metric.proper_radius(rho));
    let radial = position.map(|x| match way.mouths {
        Some(mouths) => x - mouths.center(end.map_or(Side::Near, |(side, _)| side)),
        None => x,
    });
    let radial = radial.map(DVec3::normalize);
    let sign = end.map(|(side, _)| match side {
        Side::Near => Cell::Integer(1),
        Side::Far => Cell::Integer(-1),
    });
    let cells = vec![
        sign.unwrap_or(Cell::Empty),
        Cell::from(position.map(|x| x.x)),
        Cell::from(position.map(|x| x.y)),
        Cell::from(position.map(|x| x.z)),
        Cell::from(radial.map(|n| n.x)),
        Cell::from(radial.map(|n| n.y)),
        Cell::from(radial.map(|n| n.z)),
        Cell::from(direction.map(|d| d.x)),
        Cell::from(direction.map(|d| d.y)),
        Cell::from(direction.map(|d| d.z)),
        Cell::from(exit.crossing.map(|crossing| crossing.time)),
        Cell::from(exit.crossing.map(|crossing| crossing.swept)),
        Cell::from(Some(exit.b)),
        Cell::from(exit.eps),
        Cell::from(exit.r_min.map(turn)),
        Cell::from(end.map(|(_, end)| end.sens)),
        Cell::from(exit.crossing.map(|crossing| crossing.drift_h)),
    ];
    Traced { status: exit.status, crossing: end.map(|(_, end)| end), cells, steps: exit.steps }
}
