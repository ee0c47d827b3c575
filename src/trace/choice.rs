//! Transport for a scene: by the family of its spacetime, its stepper and its precision.

use glam::DVec3;

use super::arc_sweep::ArcSweep;
use super::curved::departure::way_out;
use super::curved::march::{March, march, march_by};
use super::curved::worlds::{OneWorld, TwoWorlds};
use super::curved::{Curved, Entrance, Lane};
use super::field::FieldTransport;
use super::paper::PaperMarch;
use super::spinning::Spinning;
use super::straight::Straight;
use super::transport::TransportVisitor;
use crate::geodesic::{Control, Rkn6};
use crate::light::Punctual;
use crate::scene::{Baked, Precision, StepperKind};
use crate::spacetime::{
    Chart, ConformallyFlat, IndexField, KerrNewman, Mouths, Placement, Side, SpacetimeVisitor,
};

/// Runs `visitor` with the transport of a render.
pub fn with_render_transport<E: TransportVisitor>(scene: &Baked, visitor: E) -> E::Output {
    with_transport_to(scene, f64::INFINITY, has_sky(scene), visitor)
}

/// Like [`with_render_transport`], in `medium` about `center` whatever the scene says of spacetime.
pub fn with_medium<M: ConformallyFlat, E: TransportVisitor>(
    scene: &Baked,
    (center, medium): (DVec3, M),
    visitor: E,
) -> E::Output {
    Choice { scene, core: f64::INFINITY, sky: has_sky(scene), visitor }.spherical(center, medium)
}

/// True if directions at infinity are needed: only an environment that is not the same all around asks for them.
fn has_sky(scene: &Baked) -> bool {
    Side::BOTH.into_iter().any(|side| scene.environment(side).varies())
}

/// Runs `visitor` with the transport that the scene's spacetime and settings call for.
pub fn with_transport<E: TransportVisitor>(scene: &Baked, visitor: E) -> E::Output {
    with_transport_to(scene, f64::INFINITY, true, visitor)
}

/// Like [`with_transport`], with falling rays followed at least to the isotropic radius `core`, geometry or not, and
/// leaving ones to infinity only for a `sky`.
pub fn with_transport_to<E: TransportVisitor>(scene: &Baked, core: f64, sky: bool, visitor: E) -> E::Output {
    scene.spacetime.visit(Choice { scene, core, sky, visitor })
}

/// Positions of punctual lights: nothing tells a light ray that it has passed one that it was not followed to.
fn positions(scene: &Baked) -> impl Iterator<Item = DVec3> {
    scene.punctual.iter().filter(|light| light.emits()).filter_map(Punctual::position)
}

/// The choice that [`with_transport_to`] makes, a family of spacetimes each.
struct Choice<'a, E> {
    scene: &'a Baked,
    core: f64,
    sky: bool,
    visitor: E,
}

impl<E: TransportVisitor> SpacetimeVisitor for Choice<'_, E> {
    type Output = E::Output;

    fn flat(self) -> E::Output {
        self.visitor.run(Straight::new(self.scene.geometry.bounds()))
    }

    fn spinning(self, placement: Placement, hole: KerrNewman) -> E::Output {
        let Self { scene, core, sky, visitor } = self;
        let lights = positions(scene).map(|light| light.distance(placement.center));
        let core = lights.fold(core, f64::min);
        visitor.run(Spinning::new(scene, (placement, hole), core, sky))
    }

    fn indexed<F: IndexField>(self, field: &F) -> E::Output {
        let Self { scene, core, sky, visitor } = self;
        let lights: Vec<DVec3> = positions(scene).collect();
        visitor.run(FieldTransport::new(scene, field, core, &lights, sky))
    }

    fn spherical<M: ConformallyFlat>(self, center: DVec3, medium: M) -> E::Output {
        let Self { scene, core, sky, visitor } = self;
        let (nearest, farthest) = scene.geometry.radii(center).unwrap_or((f64::INFINITY, 0.0));
        let lights = positions(scene).map(|light| light.distance(center));
        let nearest = lights.fold(nearest.min(core), f64::min);
        let chart = Chart::new(&medium, nearest, farthest);
        let arc_tolerance = scene.arc_tolerance_around(center);
        let worlds = OneWorld { center, sweep: ArcSweep::new(scene, arc_tolerance) };
        let place = CenteredMedium { medium, worlds, sky, chart, arc_tolerance };
        match scene.settings.precision {
            Precision::F32 => place.run::<f32, E>(scene, visitor),
            Precision::F64 => place.run::<f64, E>(scene, visitor),
        }
    }

    fn wormhole<M: ConformallyFlat>(self, mouths: Mouths, medium: M) -> E::Output {
        let Self { scene, sky, visitor, .. } = self;
        let arc_tolerance = scene.arc_tolerance();
        let reach = |side| scene.geometry.of(side)?.radii(mouths.center(side));
        let farthest = Side::BOTH.into_iter().filter_map(reach).fold(0.0, |most, (_, r)| r.max(most));
        let world = |side| OneWorld {
            center: mouths.center(side),
            sweep: ArcSweep::among(scene.geometry.of(side), arc_tolerance),
        };
        let (near, far) = (world(Side::Near), world(Side::Far));
        let worlds = TwoWorlds { near, far, mouths, throat: medium.throat() };
        let place =
            CenteredMedium { medium, worlds, sky, chart: Chart::to_throat(&medium, farthest), arc_tolerance };
        match scene.settings.precision {
            Precision::F32 => visitor.run(place.through::<f32>(scene)),
            Precision::F64 => visitor.run(place.through::<f64>(scene)),
        }
    }
}

/// Stepper of a scene, and its tolerance.
fn by(scene: &Baked) -> (StepperKind, f64) {
    (scene.settings.stepper, scene.settings.tolerance)
}

/// A spacetime in its place.
struct CenteredMedium<M, W> {
    medium: M,
    worlds: W,
    /// True if the directions of escaped rays at infinity matter.
    sky: bool,
    chart: Chart,
    /// Largest distance between an arc and the curve.
    arc_tolerance: f64,
}

impl<M: ConformallyFlat> CenteredMedium<M, OneWorld> {
    fn run<R: Lane, E: TransportVisitor>(self, scene: &Baked, visitor: E) -> E::Output {
        let (medium, center, chart) = (self.medium, self.worlds.center, self.chart);
        let control = self.control::<R>(scene);
        match march(medium, by(scene), control, chart) {
            Some(march) => visitor.run(self.curved(scene, march)),
            None => visitor.run(PaperMarch { medium, center, chart }),
        }
    }
}

impl<M: ConformallyFlat> CenteredMedium<M, TwoWorlds> {
    /// Rays through a throat; the paper's scheme, which knows none, gives way to rkn6.
    fn through<R: Lane>(self, scene: &Baked) -> Curved<M, R, TwoWorlds> {
        let control = self.control::<R>(scene);
        let march = march(self.medium, by(scene), control, self.chart)
            .unwrap_or_else(|| march_by(Rkn6, self.medium, control, self.chart));
        self.curved(scene, march)
    }
}

impl<M: ConformallyFlat, W> CenteredMedium<M, W> {
    fn control<R: Lane>(&self, scene: &Baked) -> Control<R> {
        Control::new(&self.medium, scene.settings.tolerance, self.arc_tolerance)
    }

    /// Rays on orbits.
    fn curved<R: Lane>(self, scene: &Baked, march: Box<dyn March<R>>) -> Curved<M, R, W> {
        let Self { medium, worlds, sky, chart, arc_tolerance } = self;
        let (tolerance, control) = (scene.settings.tolerance, march.control());
        let way_out = if sky { way_out(&medium, tolerance) } else { None };
        let entrance = Entrance::new(&medium, &chart, tolerance);
        Curved { medium, march, worlds, entrance, way_out, sky, chart, control, tolerance, arc_tolerance }
    }
}
