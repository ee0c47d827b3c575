//! Rays on their way to infinity, where nothing is in it, whatever the stepper of the march: in closed form where they
//! keep away from the photon sphere, else by series, of which infinity is an ordinary root.

use std::marker::PhantomData;

use super::flight::{CurvedFlight, Lane};
use crate::geodesic::{ArealSeries, Control, Lens, OrbitStepper, Phase, UsePowers, WeakBending, with_powers};
use crate::math::columns::{LANES, Row, columns};
use crate::math::kernel::{Kernel, NOTHING, update};
use crate::spacetime::{ConformallyFlat, ReissnerNordstrom, StaticHole};
use crate::trace::flight_status::FlightStatus;

/// Tolerance of what is known in closed form, in that of rays.
pub const BENDING: f64 = 0.1;
/// Most steps to infinity, before a ray is followed there by itself.
const MOST_STEPS: usize = 64;

columns! {
    /// A ray on its way to infinity.
    pub struct Departure<R> => DepartureBlock {
        /// Impact parameter.
        b: R,
        /// Inverse radius.
        w: R,
        /// dw/dψ.
        v: R,
        /// ½ dn²/dw.
        pull: R,
        /// Sine of the angle swept since it left.
        sin: f64,
        /// Its cosine.
        cos: f64,
        /// `Flies` on the way, `Leaves` at infinity, else the ray is to be followed by itself.
        status: FlightStatus,
    }
}

impl<R: Lane> Departure<R> {
    /// The start of the way.
    pub fn of(flight: &CurvedFlight<R>) -> Self {
        let &CurvedFlight { b, w, v, pull, .. } = flight;
        Self { b, w, v, pull, sin: 0.0, cos: 1.0, status: FlightStatus::Flies }
    }

    /// Phase of the ray on its orbit.
    #[inline(always)]
    pub fn phase(&self) -> Phase<R> {
        Phase { w: self.w, v: self.v, pull: self.pull }
    }
}

/// The way to infinity in a spacetime.
pub trait WayOut<R: Lane>: Send + Sync {
    /// Follows blocks of rays to infinity.
    fn depart_all(&self, departures: &mut [<Departure<R> as Row>::Block]);

    /// Follows a ray to infinity.
    fn depart(&self, departure: Departure<R>) -> Departure<R>;
}

/// The way to infinity around `medium` to a `tolerance` in radians, if that is a hole.
pub fn way_out<M: ConformallyFlat, R: Lane>(medium: &M, tolerance: f64) -> Option<Box<dyn WayOut<R>>> {
    let hole = medium.as_hole()?;
    let control = Control::new(&ReissnerNordstrom::of(hole), tolerance, f64::INFINITY);
    let bending = Lens::new(medium, BENDING * tolerance).and_then(|lens| lens.weak_bending().cloned());
    Some(with_powers(tolerance, AroundHole { hole, control, tolerance, bending }))
}

/// What series are made from.
struct AroundHole<R> {
    hole: StaticHole,
    control: Control<R>,
    tolerance: f64,
    bending: Option<WeakBending>,
}

impl<R: Lane> UsePowers for AroundHole<R> {
    type Output = Box<dyn WayOut<R>>;

    fn with<const P: usize>(self) -> Box<dyn WayOut<R>> {
        let series = ArealSeries::<P>::new(&self.hole, self.tolerance);
        let departing = Departing { series, control: series.control(&self.control) };
        Box::new(AtOnceOrStepwise { bending: self.bending, departing })
    }
}

/// Steps to infinity.
struct Departing<const P: usize, R> {
    series: ArealSeries<P>,
    control: Control<R>,
}

impl<const P: usize, R: Lane> Kernel for Departing<P, R> {
    type A = Departure<R>;
    type B = ();
    type Out = Departure<R>;

    #[inline(always)]
    fn run(&self, ray: &Departure<R>, (): &()) -> Departure<R> {
        let (step, arrives) = self.series.outwards(ray.b, ray.phase());
        let accepted = self.series.judge(&self.control, &step, R::of(0.0), R::of(1.0)).accepted;
        let zero = R::of(0.0);
        let flies = accepted & (step.end.w > zero);
        let status = if flies { FlightStatus::Flies } else { FlightStatus::NonFinite };
        let status = if arrives { FlightStatus::Leaves } else { status };
        let moves = ray.status == FlightStatus::Flies;
        let pick = |end: R, start: R| if moves { end } else { start };
        let (sin, cos) = (step.sin.value(), step.cos.value());
        let turned = |end: f64, start: f64| if moves { end } else { start };
        Departure {
            b: ray.b,
            w: pick(step.end.w, ray.w),
            v: pick(step.end.v, ray.v),
            pull: pick(step.end.pull, ray.pull),
            sin: turned(ray.sin * cos + ray.cos * sin, ray.sin),
            cos: turned(ray.cos * cos - ray.sin * sin, ray.cos),
            status: if moves { status } else { ray.status },
        }
    }
}

/// The way to infinity in closed form.
struct Bending<'a, R>(&'a WeakBending, PhantomData<R>);

impl<R: Lane> Kernel for Bending<'_, R> {
    type A = Departure<R>;
    type B = ();
    type Out = Departure<R>;

    #[inline(always)]
    fn run(&self, ray: &Departure<R>, (): &()) -> Departure<R> {
        let (b, w, v) = (ray.b.value(), ray.w.value(), ray.v.value());
        let across = b * w;
        let per_index = 1.0 / (v * v + across * across).sqrt();
        let ([cos, sin], is_known) =
            self.0.to_infinity(b, w * per_index, [-v * per_index, across * per_index]);
        if is_known { Departure { sin, cos, status: FlightStatus::Leaves, ..*ray } } else { *ray }
    }
}

/// The way to infinity: in closed form if that is good enough, else in steps.
struct AtOnceOrStepwise<const P: usize, R> {
    bending: Option<WeakBending>,
    departing: Departing<P, R>,
}

impl<const P: usize, R: Lane> WayOut<R> for AtOnceOrStepwise<P, R> {
    fn depart_all(&self, departures: &mut [<Departure<R> as Row>::Block]) {
        if let Some(bending) = &self.bending {
            update(&Bending(bending, PhantomData), departures, NOTHING);
        }
        for block in departures.chunks_mut(1) {
            for _ in 0..MOST_STEPS {
                if (0..LANES).all(|i| Departure::get(&block[0], i).status != FlightStatus::Flies) {
                    break;
                }
                update(&self.departing, block, NOTHING);
            }
        }
    }

    fn depart(&self, mut departure: Departure<R>) -> Departure<R> {
        if let Some(bending) = &self.bending {
            departure = Bending(bending, PhantomData).run(&departure, &());
        }
        for _ in 0..MOST_STEPS {
            if departure.status != FlightStatus::Flies {
                break;
            }
            departure = self.departing.run(&departure, &());
        }
        departure
    }
}
