//! Rays around a spinning hole: future-directed photons in ingoing Cartesian Kerr–Schild coordinates, the spin along z.

use glam::DVec3;

use super::super::input_error::{Input, InputError};
use super::super::lengths::{Lengths, check_together};
use super::super::table::Cell;
use super::sensitivity::sensitivity;
use super::{Accuracy, Arrival, Cells, FreeRayEnd, SphereCrossing, TableForm, Traced};
use crate::geodesic::kerr::{
    KerrEnd, KerrLaunch, KerrPhoton, PhotonEnd, UnitHole, elapsed, follow, follow_photon,
};
use crate::scene::{Precision, StepperKind};
use crate::spacetime::{KerrNewman, SpacetimeKind};

/// Columns of a ray's start, of its covariant momentum, which is scaled so that p_t = −1, and of the spheroidal radius of
/// its sphere.
const START: [&str; 3] = ["x0", "y0", "z0"];
const MOMENTUM: [&str; 3] = ["px0", "py0", "pz0"];
const SPHERE: [&str; 1] = ["r_out"];

/// Form of the tables.
pub(super) static FORM: TableForm = TableForm {
    needed: &["x0", "y0", "z0", "px0", "py0", "pz0", "r_out"],
    optional: &[],
    results: &["x1", "y1", "z1", "px1", "py1", "pz1", "t", "Lz", "Q", "r_turn", "sens"],
    crossing: ["x1", "y1", "z1", "px1", "py1", "pz1", "sens"],
    steppers: &[StepperKind::Series, StepperKind::Dop853],
    stepper: Some(StepperKind::Series),
    radius: |_, cells| cells.last(),
    trace: |spacetime, cells, accuracy| Ok(PhotonRay::new(spacetime, cells, accuracy)?.traced(accuracy)),
    arrive: |spacetime, cells, accuracy| Ok(PhotonRay::new(spacetime, cells, accuracy)?.arrival(accuracy)),
};

/// A ray about to be followed, in units of the hole's mass.
struct PhotonRay {
    hole: UnitHole,
    mass: f64,
    x: DVec3,
    /// Unit vector of the momentum.
    direction: DVec3,
    r_out: f64,
}

/// A ray, followed, in units of the hole's mass.
struct Followed {
    status: FreeRayEnd,
    crossing: Option<KerrPhoton>,
    /// Lz and Q; `None` where the energy is not positive.
    constants: Option<[f64; 2]>,
    /// Least radius, if the ray passed one.
    periastron: Option<f64>,
    steps: u32,
}

/// Distance from the sphere, relative to its radius, at which a start counts as on it.
const ON_SPHERE: f64 = 4.0 * f64::EPSILON;
/// Accuracy with which the rays beside a ray are followed, for its sensitivity.
const BESIDE: Accuracy =
    Accuracy { stepper: StepperKind::Series, tolerance: 1e-13, precision: Precision::F64 };

impl PhotonRay {
    fn new(spacetime: &SpacetimeKind, cells: &Cells, accuracy: &Accuracy) -> Result<Self, InputError> {
        FORM.check(accuracy.stepper)?;
        if accuracy.precision == Precision::F32 {
            return Err(InputError {
                input: Input::Precision,
                cause: "rays around a spinning hole are followed in f64".to_owned(),
                remedy: "take f64".to_owned(),
            });
        }
        let lengths = Lengths::of(accuracy.precision);
        let kerr_newman = spinning_hole(spacetime)?;
        let mass = kerr_newman.mass();
        let hole = UnitHole::new(kerr_newman.spin(), kerr_newman.charge());
        let ray = &cells.needed;
        let (x, p) = (DVec3::from_slice(&ray[0..3]) / mass, DVec3::from_slice(&ray[3..6]));
        let r_out = ray[6] / mass;
        lengths.check(Input::Columns(&MOMENTUM), "the length of the momentum", p.length())?;
        lengths.check(Input::Columns(&SPHERE), "the radius of the sphere over the mass", r_out)?;
        lengths.check(Input::Columns(&START), "the distance of the start over the mass", x.length())?;
        let (r, horizon) = (hole.spheroidal(x).0, 1.0 / hole.horizon);
        if r <= horizon * (1.0 + ON_SPHERE) || r.is_nan() {
            let (r, horizon) = (r * mass, horizon * mass);
            return Err(InputError {
                input: Input::Columns(&START),
                cause: format!(
                    "the ray starts at the spheroidal radius {r}, but the horizon is at {horizon}"
                ),
                remedy: "start outside the horizon".to_owned(),
            });
        }
        Ok(Self { hole, mass, x, direction: p.normalize(), r_out })
    }

    /// Follows the ray whose momentum has the direction `direction`; with the coordinate time on request.
    fn follow(&self, direction: DVec3, accuracy: &Accuracy, with_time: bool) -> Followed {
        let Self { hole, x, r_out, .. } = self;
        let Some(photon) = KerrPhoton::new(hole, *x, direction) else {
            return Followed {
                status: FreeRayEnd::Captured,
                crossing: None,
                constants: None,
                periastron: None,
                steps: 0,
            };
        };
        let launch = KerrLaunch::with_momentum(hole, photon.x, photon.p);
        let KerrLaunch { constants, state } = launch;
        let (end, periastron, steps) = if accuracy.stepper == StepperKind::Dop853 {
            let fate = constants.fate(state.u, state.v);
            let journey = follow_photon(hole, photon, Some(fate), accuracy.tolerance, *r_out);
            (journey.end, journey.periastron, journey.steps)
        } else {
            let mut t = 0.0;
            let on_sphere = (state.u * r_out - 1.0).abs() <= ON_SPHERE;
            let u_out = if on_sphere { state.u } else { 1.0 / r_out };
            let journey = follow(hole, &launch, accuracy.tolerance, u_out, |h, at| {
                if with_time {
                    t += elapsed(hole, &constants, h, at);
                }
            });
            let end = match journey.end {
                KerrEnd::Crosses(state) => {
                    PhotonEnd::Crosses(KerrPhoton { t, ..state.photon(hole, &constants) })
                }
                KerrEnd::Falls => PhotonEnd::Falls,
                KerrEnd::Misses => PhotonEnd::Misses,
                KerrEnd::StepLimit => PhotonEnd::StepLimit,
                KerrEnd::NonFinite => PhotonEnd::NonFinite,
            };
            (end, journey.periastron.map(|u| 1.0 / u), journey.steps)
        };
        let (status, crossing) = match end {
            PhotonEnd::Crosses(photon) => (FreeRayEnd::Escaped, Some(photon)),
            PhotonEnd::Falls => (FreeRayEnd::Captured, None),
            PhotonEnd::Misses => (FreeRayEnd::Missed, None),
            PhotonEnd::StepLimit => (FreeRayEnd::StepLimit, None),
            PhotonEnd::NonFinite => (FreeRayEnd::NonFinite, None),
        };
        let constants = Some([constants.l, constants.j2 - constants.l * constants.l]);
        Followed { status, crossing, constants, periastron, steps }
    }

    fn arrival(&self, accuracy: &Accuracy) -> Arrival {
        let Followed { status, crossing, steps, .. } = self.follow(self.direction, accuracy, false);
        let crossing = crossing.map(|photon| (self.mass * photon.x, photon.p.normalize()));
        Arrival { status, crossing, steps }
    }

    fn traced(&self, accuracy: &Accuracy) -> Traced {
        let mass = self.mass;
        let Followed { status, crossing, constants, periastron, steps } =
            self.follow(self.direction, accuracy, true);
        let sens = crossing.map(|_| self.sens());
        let at = |value: fn(&KerrPhoton) -> f64| crossing.as_ref().map(value);
        let cells = vec![
            Cell::from(at(|photon| photon.x.x).map(|x| mass * x)),
            Cell::from(at(|photon| photon.x.y).map(|y| mass * y)),
            Cell::from(at(|photon| photon.x.z).map(|z| mass * z)),
            Cell::from(at(|photon| photon.p.x)),
            Cell::from(at(|photon| photon.p.y)),
            Cell::from(at(|photon| photon.p.z)),
            Cell::from(at(|photon| photon.t).map(|t| mass * t)),
            Cell::from(constants.map(|[l, _]| mass * l)),
            Cell::from(constants.map(|[_, q]| mass * mass * q)),
            Cell::from(periastron.map(|r| mass * r)),
            Cell::from(sens),
        ];
        let crossing = crossing.zip(sens).map(|(photon, sens)| SphereCrossing {
            position: mass * photon.x,
            direction: photon.p.normalize(),
            sens,
        });
        Traced { status, crossing, cells, steps }
    }

    /// Sensitivity of the end, position and momentum, to the direction of the momentum at the start.
    fn sens(&self) -> f64 {
        sensitivity(self.direction, self.r_out, |direction| {
            self.follow(direction, &BESIDE, false).crossing.map(|photon| (photon.x, photon.p))
        })
    }
}

/// The hole of a spinning spacetime whose parameters may be together.
pub(in crate::study) fn spinning_hole(spacetime: &SpacetimeKind) -> Result<KerrNewman, InputError> {
    Lengths::of(Precision::F64).check_parameters(spacetime)?;
    let SpacetimeKind::Spinning { hole, .. } = spacetime else {
        return Err(InputError {
            input: Input::Parameter("rs"),
            cause: "the Schwarzschild radius is 0".to_owned(),
            remedy: "give a length above 0; rays of flat space are in tables of --spacetime flat".to_owned(),
        });
    };
    check_together(spacetime, Input::Columns(&["a", "q"]))?;
    Ok(*hole)
}
