//! Transport for a scene: by the family of its spacetime, its stepper and its precision.

use glam::DVec3;

use super::curved::march::march;
use super::curved::{Curved, Lane};
use super::paper::PaperMarch;
use super::straight::Straight;
use super::transport::TransportVisitor;
use crate::geodesic::{Arc, Control};
use crate::light::Punctual;
use crate::scene::{Baked, Precision};
use crate::spacetime::{Chart, ConformallyFlat, KerrNewman, Placement, SpacetimeVisitor};

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

/// True if directions at infinity are needed: only an environment asks for them.
fn has_sky(scene: &Baked) -> bool {
    !scene.environment.is_black()
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

    fn spinning(self, _: Placement, _: KerrNewman) -> E::Output {
        self.flat()
    }

    fn spherical<M: ConformallyFlat>(self, center: DVec3, medium: M) -> E::Output {
        let Self { scene, core, sky, visitor } = self;
        let (nearest, farthest) = scene.geometry.radii(center).unwrap_or((f64::INFINITY, 0.0));
        // Nothing tells a light ray that it has passed a punctual light that it was not followed to.
        let lights = scene.punctual.iter().filter(|light| light.emits()).filter_map(Punctual::position);
        let nearest = lights.map(|light| light.distance(center)).fold(nearest.min(core), f64::min);
        let place = Place { medium, center, sky, chart: Chart::new(&medium, nearest, farthest) };
        match scene.settings.precision {
            Precision::F32 => place.run::<f32, E>(scene, visitor),
            Precision::F64 => place.run::<f64, E>(scene, visitor),
        }
    }
}

/// A spacetime in its place.
struct Place<M> {
    medium: M,
    center: DVec3,
    /// True if the directions of escaped rays at infinity matter.
    sky: bool,
    chart: Chart,
}

impl<M: ConformallyFlat> Place<M> {
    fn run<R: Lane, E: TransportVisitor>(&self, scene: &Baked, visitor: E) -> E::Output {
        match self.curved::<R>(scene) {
            Some(curved) => visitor.run(curved),
            None => visitor.run(PaperMarch { medium: self.medium, center: self.center, chart: self.chart }),
        }
    }

    /// Rays on orbits; `None` if the stepper knows none.
    fn curved<R: Lane>(&self, scene: &Baked) -> Option<Curved<M, R>> {
        let arc_tolerance = scene.arc_tolerance_around(self.center);
        let (low, high) = scene.geometry.bounds().unwrap_or((DVec3::INFINITY, DVec3::NEG_INFINITY));
        let control = Control::new(&self.medium, scene.settings.tolerance, arc_tolerance);
        let outer = R::of(self.chart.outer);
        Some(Curved {
            medium: self.medium,
            march: march(self.medium, scene.settings.stepper, control, outer)?,
            control,
            tolerance: scene.settings.tolerance,
            arc_tolerance,
            center: self.center,
            sky: self.sky,
            chart: self.chart,
            longest_sagitta: if scene.geometry.is_small::<Arc>() {
                f64::INFINITY
            } else {
                (4.0 * arc_tolerance).max(SAGITTA * scene.geometry.typical_extent())
            },
            longest_chord: CHORD * low.distance(high),
            bounds: (low, high),
        })
    }
}

/// Longest chord of a searched arc, relative to the diagonal of the geometry.
const CHORD: f64 = 8.0;
/// Largest sagitta of a searched arc, relative to the median primitive.
const SAGITTA: f64 = 1.0;
