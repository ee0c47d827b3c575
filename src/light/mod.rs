//! Emitters and how to find them.
//!
//! A light sample is a direction, chosen where light may come from, with its density in solid angle. [`Sight`] knows the
//! rays of the spacetime; everything else is the same in flat and in curved space:
//!
//! 1. the kind of light, then an emitter by the light tree, or a direction of the sky by its luminance;
//! 2. a point on the emitter;
//! 3. which way round the centre;
//! 4. the ray to that point, and its spread dΩ/dA, which turns the density over the area into one in solid angle.
//!
//! A ray that a surface sent out and that happens on an emitter asks for the density with which it could have been
//! sampled: both ways of finding light are then weighted by [`Heuristic`].
//!
#![doc = include_str!("sampling.md")]

mod emitter;
mod guide;
mod mis;
mod punctual;
mod sight;
mod sky;
mod tree;

use std::collections::HashMap;

use glam::{DVec3, Vec3};

pub use emitter::{Cap, Emitter, Form, Spot, Standpoint, View};
pub use guide::{Guide, Neighbourhood, Photon};
pub use mis::Heuristic;
pub use punctual::Punctual;
pub use sight::{Lensed, Link, Place, Sight, Straight};
pub use sky::Sky;
pub use tree::{Emission, Tree};

use crate::geometry::{Geometry, PrimitiveId};
use crate::shade::{Environment, Material};

/// All light that can be sampled.
pub struct Lights {
    /// Surfaces.
    emitters: Vec<Emitter>,
    /// Index of the emitter that a primitive is.
    by_primitive: HashMap<PrimitiveId, u32>,
    /// Lights without extent that are somewhere.
    points: Vec<Punctual>,
    /// Lights without extent at infinity.
    distant: Vec<Punctual>,
    /// A bright picture at infinity.
    sky: Option<Sky>,
    /// Over `emitters`, then `points`.
    tree: Tree,
    /// Least orientation factor of the tree.
    floor: f64,
}

/// What a light sample is aimed at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Target {
    /// Nothing.
    #[default]
    Nothing,
    /// A point of a primitive.
    Surface(PrimitiveId, DVec3),
    /// Whatever emits behind mirrors and glass.
    Bent,
    /// Infinity.
    Infinity,
    /// A point in the world, by its place among the lights without extent.
    Point(u32),
}

/// A direction in which light may come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit direction.
    pub direction: DVec3,
    /// Where the ray must end to bring it.
    pub target: Target,
    /// What it brings.
    pub light: Incoming,
}

/// Light of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Incoming {
    /// Radiance, and the density of its direction in solid angle: rays of a surface can find it, too.
    Radiance(Vec3, f64),
    /// Radiance of the sky in a unit direction at infinity, and the density of the direction here in solid angle.
    Sky(DVec3, f64),
    /// Irradiance on a surface that faces it, divided by the probability of the sample: of lights without extent.
    Irradiance(Vec3),
}

/// A surface that is lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// The point.
    pub place: Place,
    /// Unit normal on the side that is lit.
    pub normal: DVec3,
    /// The primitive that the point lies on.
    pub on: PrimitiveId,
}

impl Lights {
    /// The lights of a scene; `floor` is the tree's: 0 where rays are straight.
    pub fn new(
        geometry: &Geometry,
        materials: &[Material],
        environment: &Environment,
        punctual: &[Punctual],
        floor: f64,
    ) -> Self {
        let material = |surface: u32| &materials[surface as usize];
        let shapes = geometry.shapes(|surface| material(surface.material).emits());
        let emitters: Vec<Emitter> = shapes
            .into_iter()
            .map(|(primitive, shape, surface)| {
                let &Material { emission, emits_both_sides, .. } = material(surface.material);
                let form = Form::Whole(shape);
                Emitter { primitive, form, radiance: emission, both_sides: emits_both_sides }
            })
            .collect();
        let (distant, points): (Vec<_>, Vec<_>) =
            punctual.iter().partition(|light| light.position().is_none());
        let sky = match environment {
            Environment::Image(image) => Sky::new(image),
            _ => None,
        };
        let (by_primitive, tree) = (HashMap::new(), Tree::default());
        let mut lights = Self { emitters, by_primitive, points, distant, sky, tree, floor };
        lights.build_tree();
        let indices = lights.emitters.iter().zip(0..);
        // Afterwards: what the tree is built from is as large.
        lights.by_primitive = indices.map(|(emitter, index)| (emitter.primitive, index)).collect();
        lights
    }

    fn build_tree(&mut self) {
        let points: Vec<Emission> = self.points.iter().filter_map(Punctual::emission).collect();
        let surfaces = self.emitters.len();
        let emission = |index: u32| match self.emitters.get(index as usize) {
            Some(emitter) => emitter.emission(),
            None => points[index as usize - surfaces],
        };
        self.tree = Tree::build((surfaces + points.len()) as u32, emission, self.floor);
    }

    /// Limits the points on spheres to the parts `cap` gives for them, if any.
    pub fn limit(&mut self, cap: impl Fn(&Emitter) -> Option<Cap>) {
        let mut is_limited = false;
        for emitter in &mut self.emitters {
            if let Some(sphere) = emitter.sphere()
                && let Some(cap) = cap(emitter)
            {
                emitter.form = Form::Cap(sphere, cap);
                is_limited = true;
            }
        }
        if is_limited {
            self.build_tree();
        }
    }

    /// Whether there is nothing to sample.
    pub fn is_empty(&self) -> bool {
        self.tree.is_empty() && self.distant.is_empty() && self.sky.is_none()
    }

    /// Surfaces that emit.
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// Whether light from infinity is sampled that rays can find, too.
    pub fn has_sky(&self) -> bool {
        self.sky.is_some()
    }

    /// Whether there are lights without extent that rays are aimed at.
    pub fn has_points(&self) -> bool {
        !self.points.is_empty()
    }

    /// Position of the light that [`Target::Point`] names.
    pub fn point(&self, index: u32) -> Option<DVec3> {
        self.points.get(index as usize)?.position()
    }

    /// Probabilities of the kinds of light: somewhere, distant, the sky.
    fn shares(&self) -> [f64; 3] {
        let is_there = [!self.tree.is_empty(), !self.distant.is_empty(), self.sky.is_some()];
        let share = 1.0 / is_there.iter().filter(|is_there| **is_there).count().max(1) as f64;
        is_there.map(|is_there| if is_there { share } else { 0.0 })
    }

    /// A light sample for `receiver`, from four numbers in [0, 1); `None` if this one finds no light.
    pub fn sample(&self, sight: &dyn Sight, receiver: &Receiver, u: [f64; 4]) -> Option<LightSample> {
        let [somewhere, distant, sky] = self.shares();
        let kind = u[0];
        if kind < somewhere {
            return self.sample_somewhere(sight, receiver, [kind / somewhere, u[1], u[2], u[3]], somewhere);
        }
        let (to, light) = if kind < somewhere + distant {
            let count = self.distant.len();
            let index = (((kind - somewhere) / distant * count as f64) as usize).min(count - 1);
            let light = &self.distant[index];
            let direction = -light.direction()?;
            let irradiance = light.intensity_towards(-direction) * (count as f64 / distant) as f32;
            (direction, Incoming::Irradiance(irradiance))
        } else {
            let (direction, density) = self.sky.as_ref()?.sample(u[2], u[3])?;
            (direction, Incoming::Sky(direction, density * sky))
        };
        let place = sight.infinity(to);
        let (winding, odds) = choose_winding(sight, &receiver.place, &place, u[1])?;
        let link = sight.link(&receiver.place, &place, winding)?;
        let light = match light {
            Incoming::Sky(at_infinity, density) => Incoming::Sky(at_infinity, density * odds / link.spread),
            Incoming::Radiance(radiance, density) => {
                Incoming::Radiance(radiance, density * odds / link.spread)
            }
            Incoming::Irradiance(light) => Incoming::Irradiance(light * (link.spread / odds) as f32),
        };
        Some(LightSample { direction: link.direction, target: Target::Infinity, light })
    }

    fn sample_somewhere(
        &self,
        sight: &dyn Sight,
        receiver: &Receiver,
        u: [f64; 4],
        share: f64,
    ) -> Option<LightSample> {
        let x = &receiver.place;
        let (index, chance, _) = self.tree.sample(x.position, Some(receiver.normal), u[0])?;
        let Some(emitter) = self.emitters.get(index as usize) else {
            return self.sample_point(sight, x, index, u[1], share * chance);
        };
        let middle = sight.place(emitter.middle());
        let (winding, odds) = choose_winding(sight, x, &middle, u[1])?;
        let standpoint = emitter.standpoint(receiver);
        let view = view(sight, (emitter, standpoint), x, &middle, winding);
        let spot = emitter.sample(&view, u[2], u[3])?;
        let link = sight.link(x, &sight.place(spot.position), winding)?;
        let cos = -link.arrival.dot(spot.normal);
        if !emitter.is_lit_by(cos, standpoint) {
            return None;
        }
        let density = share * chance * odds * spot.density / (link.spread * cos.abs());
        Some(LightSample {
            direction: link.direction,
            target: Target::Surface(emitter.primitive, spot.position),
            light: Incoming::Radiance(emitter.radiance, density),
        })
    }

    fn sample_point(
        &self,
        sight: &dyn Sight,
        x: &Place,
        index: u32,
        u: f64,
        chance: f64,
    ) -> Option<LightSample> {
        let point = index - self.emitters.len() as u32;
        let light = &self.points[point as usize];
        let place = sight.place(light.position()?);
        let (winding, odds) = choose_winding(sight, x, &place, u)?;
        let link = sight.link(x, &place, winding)?;
        // Intensities are those of the light's own frame.
        let spread = link.spread / sight.area_scale(&place);
        let irradiance = light.intensity_towards(-link.arrival) * (spread / (chance * odds)) as f32;
        Some(LightSample {
            direction: link.direction,
            target: Target::Point(point),
            light: Incoming::Irradiance(irradiance),
        })
    }

    /// The density with which [`Self::sample`] chooses the ray that leaves `receiver` in `direction` and meets `primitive`
    /// at `position`, where the unit normal to its front is `normal`, travelling along `arrival`.
    pub fn surface_density(
        &self,
        sight: &dyn Sight,
        receiver: &Receiver,
        direction: DVec3,
        (primitive, position, normal, arrival): (PrimitiveId, DVec3, DVec3, DVec3),
    ) -> f64 {
        let Some(&index) = self.by_primitive.get(&primitive) else { return 0.0 };
        let emitter = &self.emitters[index as usize];
        let x = &receiver.place;
        let (cos, standpoint) = (-arrival.dot(normal), emitter.standpoint(receiver));
        if !emitter.is_lit_by(cos, standpoint) {
            return 0.0;
        }
        let chance = self.tree.probability(index, x.position, Some(receiver.normal));
        let Some((winding, spread)) = sight.ray(x, direction, &sight.place(position), arrival) else {
            return 0.0;
        };
        if chance == 0.0 || winding >= sight.windings() {
            return 0.0;
        }
        let middle = sight.place(emitter.middle());
        let odds = sight.odds(x, &middle, winding);
        let view = view(sight, (emitter, standpoint), x, &middle, winding);
        let density = emitter.density(&view, normal);
        let density = self.shares()[0] * chance * odds * density / (spread * cos.abs());
        if density.is_finite() { density } else { 0.0 }
    }

    /// The density with which [`Self::sample`] chooses the ray that leaves `receiver` in `direction` and goes to infinity
    /// in the direction `at_infinity`.
    pub fn sky_density(
        &self,
        sight: &dyn Sight,
        receiver: &Receiver,
        direction: DVec3,
        at_infinity: DVec3,
    ) -> f64 {
        let Some(sky) = &self.sky else { return 0.0 };
        let (x, y) = (&receiver.place, &sight.infinity(at_infinity));
        match sight.ray(x, direction, y, at_infinity) {
            Some((winding, spread)) if winding < sight.windings() => {
                let density =
                    self.shares()[2] * sky.density(at_infinity) * sight.odds(x, y, winding) / spread;
                if density.is_finite() { density } else { 0.0 }
            }
            _ => 0.0,
        }
    }
}

/// A winding number and its probability.
fn choose_winding(sight: &dyn Sight, x: &Place, y: &Place, u: f64) -> Option<(u32, f64)> {
    let mut below = 0.0;
    for winding in 0..sight.windings() {
        let odds = sight.odds(x, y, winding);
        below += odds;
        if u < below {
            return Some((winding, odds));
        }
    }
    None
}

/// How `x` looks at an emitter whose middle is at `middle`.
fn view(
    sight: &dyn Sight,
    (emitter, standpoint): (&Emitter, Standpoint),
    x: &Place,
    middle: &Place,
    winding: u32,
) -> View {
    if !emitter.needs_view() || standpoint != Standpoint::Apart {
        return View::Everywhere;
    }
    View::Outside {
        distance: sight.distance(x, middle, winding),
        direction: sight.aim(x, middle, winding),
        is_exact: sight.is_straight(),
    }
}
