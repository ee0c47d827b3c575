//! Regions: light sampling around a spinning hole, where no formula joins two places.
//!
//! For each winding number, an aim that is exact to first order in the spin, from a table of orbits, tells about where a
//! light is seen: a region of directions around that, from which one is drawn evenly. The regions are a function of the
//! receiver and the light alone, so that a ray found by BSDF sampling has the density with which it could have been
//! drawn; what they miss, and lamps that fill the view, is left to BSDF sampling. Whatever ray ends on the light counts,
//! from wherever it comes.
//!
//! A sky is tiles, each a light at infinity. Point, spot and distant lights are found by true connections.

mod connected;
pub(super) mod shape;
mod sight;
mod view;

use glam::DVec3;

use super::aim::Link;
use super::lights::{ChosenLight, Lights, OtherLight};
use super::receiver::Receiver;
use super::sample::{EmitterHit, Incoming, LightRayEnd, LightSample, Target};
use super::sampler::{
    LightSampler, distant_sample, point_sample, reaches_emitter, region_density, region_sample,
};
use crate::geodesic::kerr::{KerrPlace, OrbitTable, PlacedHole};
use crate::spacetime::{AtInfinity, RestFrame};
use connected::{light_at_infinity, light_place};
use view::RegionView;

/// Light sampling by regions of directions.
pub struct Regions {
    place: PlacedHole,
    frame: RestFrame,
    table: OrbitTable,
    /// True if rays that go around the hole are looked for, too: further windings dilute the samples more than they
    /// help.
    goes_around: bool,
}

impl Regions {
    /// Regions around the hole in its `place`, whose frame at rest is `frame`, for winding numbers up to `max_winding`.
    pub fn new(place: PlacedHole, frame: RestFrame, max_winding: u32) -> Self {
        let table = OrbitTable::new(&place.hole);
        Self { place, frame, table, goes_around: max_winding > 0 }
    }

    /// A ray to a punctual light, and its probability.
    fn link(&self, receiver: &Receiver, to: &KerrPlace, u: f64) -> Option<(Link, f64)> {
        connected::link(&self.place, receiver.position, to, self.goes_around, u)
    }
}

impl LightSampler for Regions {
    fn sample(&self, lights: &Lights, receiver: &Receiver, [u, v]: [f64; 2]) -> Option<LightSample> {
        let (choice, u) = lights.choose(receiver, u)?;
        match choice {
            ChosenLight::Surface(emitter, pmf) => {
                let view = RegionView::new(&self.place, &self.table, receiver, emitter, self.goes_around)?;
                let (direction, density) = view.sample([u, v])?;
                Some(region_sample(emitter, self.place.outwards(direction), pmf * density))
            }
            ChosenLight::Other(OtherLight::Point(_, light, index, pmf)) => {
                let to = light_place(&self.place, light.position()?)?;
                let (link, ray_pmf) = self.link(receiver, &to, v)?;
                Some(point_sample((light, index), &link, pmf * ray_pmf))
            }
            ChosenLight::Other(OtherLight::Distant(side, light, inverse_pmf)) => {
                let to = light_at_infinity(&self.place, -light.direction()?);
                let (link, ray_pmf) = self.link(receiver, &to, v)?;
                Some(distant_sample((side, light, inverse_pmf), &link, ray_pmf))
            }
            ChosenLight::Other(OtherLight::Sky(side, sky, pmf)) => {
                let (index, tile, u) = sky.choose_tile(u)?;
                let view = RegionView::of_sky(&self.place, &self.table, receiver, &tile, self.goes_around)?;
                let (direction, density) = view.sample([u, v])?;
                Some(LightSample {
                    direction: self.place.outwards(direction),
                    target: Target::SkyTile(side, index),
                    light: Incoming::Seen(pmf * tile.pmf * density),
                })
            }
        }
    }

    fn surface_density(
        &self,
        lights: &Lights,
        receiver: &Receiver,
        direction: DVec3,
        hit: &EmitterHit,
    ) -> f64 {
        region_density(lights, receiver, hit, |emitter| {
            let view = RegionView::new(&self.place, &self.table, receiver, emitter, self.goes_around);
            view.map_or(0.0, |view| view.density(self.place.inwards(direction)))
        })
    }

    fn sky_density(&self, lights: &Lights, receiver: &Receiver, direction: DVec3, there: AtInfinity) -> f64 {
        let Some((sky, pmf)) = lights.sky(there.side) else { return 0.0 };
        let (_, tile) = sky.tile_of(there.direction);
        let view = RegionView::of_sky(&self.place, &self.table, receiver, &tile, self.goes_around);
        view.map_or(0.0, |view| pmf * tile.pmf * view.density(self.place.inwards(direction)))
    }

    fn reaches(&self, lights: &Lights, target: Target, end: &LightRayEnd) -> bool {
        reaches_emitter(lights, target, end, |normal| {
            let [normal] = self.frame.normals(end.position, [normal]);
            normal
        })
    }

    fn samples_sky(&self) -> bool {
        true
    }
}
