//! The way of camera rays from outside to the edge of all geometry, in closed form.

use super::entrance::Entrance;
use super::flight::{CurvedFlight, Lane};
use super::rays::Curved;
use super::worlds::Worlds;
use crate::geodesic::Phase;
use crate::math::kernel::Kernel;
use crate::spacetime::{ConformallyFlat, Fate};
use crate::trace::flight_status::FlightStatus;

/// Takes rays that come from outside to the entrance; those that never come near any geometry leave.
pub struct Entering<'a, M, R, W> {
    /// The rays' spacetime.
    pub curved: &'a Curved<M, R, W>,
    /// The entrance.
    pub entrance: &'a Entrance<R>,
    /// Order of the stepper's estimate.
    pub order: u32,
}

impl<M: ConformallyFlat, R: Lane, W: Worlds<M>> Kernel for Entering<'_, M, R, W> {
    type A = CurvedFlight<R>;
    type B = ();
    type Out = CurvedFlight<R>;

    #[inline(always)]
    fn run(&self, ray: &CurvedFlight<R>, (): &()) -> CurvedFlight<R> {
        let Self { curved: Curved { medium, chart, control, .. }, entrance, order } = self;
        let Entrance { bending, radial: Phase { w: at, v: index, pull } } = entrance;
        let (b, w, v) = (ray.b.value(), ray.w.value(), ray.v.value());
        let is_left =
            (ray.fate == Fate::Escapes) & (chart.is_left(ray.fate, w, v) | chart.is_passed_by(b, w));
        let per_index = 1.0 / (v * v + (b * w) * (b * w)).sqrt();
        let ([cos, sin], cosine, is_known) = bending.swept(b, w * per_index, v * per_index);
        let enters = !is_left & (w < at.value()) & is_known;
        let radial = cos * ray.radial + sin * ray.along;
        let phase = Phase { w: *at, v: R::of(cosine) * *index, pull: *pull };
        let h = self.curved.within(control.first_step(medium, *order, ray.b, &phase), ray.b, &phase);
        let entered = CurvedFlight {
            position: radial * (1.0 / at.value()),
            radial,
            along: cos * ray.along - sin * ray.radial,
            w: phase.w,
            v: phase.v,
            pull: phase.pull,
            h,
            ..*ray
        };
        let status = if is_left { FlightStatus::Leaves } else { ray.status };
        if enters { entered } else { CurvedFlight { status, ..*ray } }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use crate::geometry::PrimitiveId;
    use crate::scene::{Baked, load};
    use crate::trace::choice::with_transport;
    use crate::trace::transport::{Outcome, Start, Transport, TransportVisitor};

    /// A disk around a hole, and a ball.
    const SCENE: &str = r#"
        [spacetime]
        KIND
        [camera]
        position = [0, 14, 92]
        look_at = [0, 1, 0]
        vertical_fov = 50
        [environment]
        color = 1
        [[material]]
        name = "gas"
        albedo = 0.5
        [[entity]]
        disk = { center = [0, 0, 0], normal = [0, 1, 0], inner = 10, outer = 30 }
        material = "gas"
        [[entity]]
        sphere = { center = [9, 12, 14], radius = 4 }
        material = "gas"
    "#;

    /// Largest differences between rays that enter and rays that step there: of directions, of positions over the distance
    /// of the camera, of lengths over themselves; and the share of rays that meet something else.
    struct Comparing<'a>(&'a Baked);

    impl TransportVisitor for Comparing<'_> {
        type Output = ([f64; 3], f64);

        fn run<T: Transport + 'static>(self, transport: T) -> Self::Output {
            const SIDE: usize = 40;
            let geometry = &self.0.geometry;
            let follow = |mut flight: T::Flight, mut length: f64| loop {
                let step = transport.advance(&flight);
                let found = transport.search(&flight, &step, |segment, origin_prim| {
                    let hit = geometry.intersect(segment, origin_prim)?;
                    let point = crate::geometry::Segment::point(segment, hit.s);
                    Some(crate::geometry::Found { point, primitive: hit.primitive })
                });
                length += transport.length(&flight, &step, found.map(|found| found.point));
                match transport.settle(Some(geometry), &flight, &step, found).0 {
                    Outcome::Flying(next) => flight = next,
                    end => return (end, length),
                }
            };
            let (mut worst, mut others) = ([0.0; 3], 0);
            for i in 0..SIDE * SIDE {
                let at = DVec2::new((i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5) / SIDE as f64;
                let (position, direction) = self.0.camera.ray(at, 1.3, DVec2::ZERO).unwrap();
                let carried = T::Carried::default();
                let start = Start { position, direction, origin_prim: PrimitiveId::NONE, carried };
                let stepped = follow(transport.launch(&start), 0.0);
                let entered = match transport.enter(&start) {
                    Outcome::Flying(flight) => follow(flight, transport.length_before(&start, &flight)),
                    end => (end, 0.0),
                };
                let mut differ = |place: usize, difference: f64| {
                    worst[place] = difference.max(worst[place]);
                };
                match (stepped, entered) {
                    ((Outcome::Escaped(a), _), (Outcome::Escaped(b), _)) => {
                        differ(0, a.direction.distance(b.direction));
                    }
                    ((Outcome::Landed(a), length), (Outcome::Landed(b), entered))
                        if a.primitive == b.primitive =>
                    {
                        differ(0, a.direction.distance(b.direction));
                        differ(1, a.position.distance(b.position) / position.length());
                        differ(2, (entered / length - 1.0).abs());
                    }
                    ((Outcome::Captured, _), (Outcome::Captured, _)) => {}
                    _ => others += 1,
                }
            }
            (worst, f64::from(others) / (SIDE * SIDE) as f64)
        }
    }

    #[test]
    fn camera_rays_that_start_at_the_entrance_end_where_those_that_step_there_do() {
        let folder = tempfile::tempdir().unwrap();
        for (name, kind) in [
            ("hole", "kind = \"schwarzschild\"\nschwarzschild_radius = 5"),
            ("charged", "kind = \"reissner-nordstrom\"\nschwarzschild_radius = 5\ncharge = 0.9"),
        ] {
            let path = folder.path().join(format!("{name}.toml"));
            std::fs::write(&path, SCENE.replace("KIND", kind)).unwrap();
            let mut scene = load(&path, &[]).unwrap();
            for tolerance in [1e-4, 1e-6, 1e-8] {
                scene.settings.tolerance = tolerance;
                let ([direction, place, length], others) = with_transport(&scene, Comparing(&scene));
                // Both keep to the tolerance, where they do not land at grazing angles.
                assert!(direction < 4.0 * tolerance, "{name} to {tolerance}: {direction}");
                assert!(place < 20.0 * tolerance, "{name} to {tolerance}: {place}");
                assert!(length < 20.0 * tolerance + 1e-5, "{name} to {tolerance}: {length}");
                assert!(others <= 2e-3, "{name} to {tolerance}: {others}");
            }
        }
    }
}
