//! All lights of a scene, and the choice of one of them.

use std::collections::HashMap;
use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::emitter::{Cap, Emitter, Form};
use super::mean_radiance::mean_radiance;
use super::punctual::Punctual;
use super::receiver::Receiver;
use super::sample::LightQuery;
use super::sky::Sky;
use super::tree::{Descents, Emission, LocalReceiver, Tree};
use crate::geometry::{Geometry, PrimitiveId, Shape};
use crate::math::columns::Columns;
use crate::math::rescale::rescale;
use crate::shade::{Environment, Material, Texture};
use crate::spacetime::{AtInfinity, Mouths, Side};

/// All light that can be sampled.
pub struct Lights {
    /// Surfaces.
    emitters: Vec<Emitter>,
    /// True if the radiance of some varies.
    some_vary: bool,
    /// Index of the emitter that a primitive is.
    by_primitive: HashMap<PrimitiveId, u32>,
    /// Punctual lights in the world, with their sides.
    points: Vec<(Side, Punctual)>,
    /// Punctual lights at infinity.
    distant: Vec<(Side, Punctual)>,
    /// Bright pictures at infinity.
    skies: Vec<(Side, Sky)>,
    /// Over `emitters`, then `points`.
    tree: Tree,
    /// The same for receivers on the far side of a wormhole.
    far_tree: Tree,
    /// Throat through which the lights of the other side are seen.
    throat: Option<Transmission>,
    /// Least orientation factor of the tree.
    floor: f64,
}

/// Throat of a wormhole, as a light tree sees it.
#[derive(Clone, Copy, Debug)]
pub struct Transmission {
    /// Its centres on both sides.
    pub mouths: Mouths,
    /// Isotropic radius.
    pub radius: f64,
    /// Impact parameter below which rays pass.
    pub critical: f64,
}

impl Transmission {
    /// The emission of the other side as it comes out of the mouth on `side`. A pencil of radial rays from R to R′ beyond
    /// spreads to (π R R′/b_c)² times its solid angle.
    fn transmits(&self, side: Side, emission: Emission) -> Emission {
        let (center, beyond) = (self.mouths.center(side), self.mouths.center(side.other()));
        let distance = (0.5 * (emission.min + emission.max)).distance(beyond).max(self.radius);
        let power = emission.power * (self.critical / (PI * distance)).powi(2);
        let (min, max) = (center - self.radius, center + self.radius);
        Emission { min, max, power, axis: DVec3::Z, cos_normals: -1.0, ..emission }
    }
}

/// A light that was chosen, and the probability of the choice.
pub(super) enum ChosenLight<'a> {
    /// A surface.
    Surface(&'a Emitter, f64),
    /// Another light.
    Other(OtherLight<'a>),
}

/// A light that is no surface and was chosen, and the probability of the choice.
pub(super) enum OtherLight<'a> {
    /// A punctual light in the world, with its index.
    Point(Side, &'a Punctual, u32, f64),
    /// A punctual light at infinity; the inverse of the probability.
    Distant(Side, &'a Punctual, f64),
    /// A picture at infinity.
    Sky(Side, &'a Sky, f64),
}

/// Memory of choices of lights for many receivers.
#[derive(Default)]
pub(super) struct Choosing {
    receivers: Columns<LocalReceiver>,
    /// Numbers for the tree, of those that take a light from it.
    numbers: Vec<Option<f64>>,
    descents: Descents,
    found: Vec<Option<(u32, f64, f64)>>,
}

impl Lights {
    /// The lights of a scene, surfaces of both sides of a wormhole and what else is on the near one; `floor` is the tree's:
    /// 0 where rays are straight.
    pub fn new(
        geometry: &Geometry,
        (materials, textures): (&[Material], &[Texture]),
        environment: &Environment,
        punctual: &[Punctual],
        floor: f64,
    ) -> Self {
        let material = |surface: u32| &materials[surface as usize];
        let shapes = geometry.shapes(|surface| material(surface.material).emits());
        let emitters: Vec<Emitter> = shapes
            .into_par_iter()
            .map(|(primitive, shape, surface)| {
                let material = material(surface.material);
                let varies = material.emission_varies();
                let radiance = if varies {
                    mean_radiance(geometry, (material, textures), primitive, &shape)
                } else {
                    material.emission
                };
                let (form, both_sides) = (Form::Whole(shape), material.emits_both_sides);
                Emitter { primitive, form, radiance, varies, both_sides }
            })
            .filter(|emitter| emitter.radiance != Vec3::ZERO)
            .collect();
        let some_vary = emitters.iter().any(|emitter| emitter.varies);
        let (by_primitive, tree, far_tree) = (HashMap::new(), Tree::default(), Tree::default());
        let (points, distant, skies) = (Vec::new(), Vec::new(), Vec::new());
        let throat = None;
        let mut lights =
            Self { emitters, some_vary, by_primitive, points, distant, skies, tree, far_tree, throat, floor };
        lights.add(Side::Near, environment, punctual);
        lights.build_tree();
        let indices = lights.emitters.iter().zip(0..);
        // Afterwards: what the tree is built from is as large.
        lights.by_primitive = indices.map(|(emitter, index)| (emitter.primitive, index)).collect();
        lights
    }

    /// Adds the sky and the punctual lights of a wormhole's far side.
    pub fn with_far(mut self, environment: &Environment, punctual: &[Punctual]) -> Self {
        if self.add(Side::Far, environment, punctual) {
            self.build_tree();
        }
        self
    }

    /// The lights of two worlds that a throat joins.
    pub fn through(self, throat: Transmission) -> Self {
        let mut lights = Self { throat: Some(throat), ..self };
        lights.build_tree();
        lights
    }

    /// Adds a sky and punctual lights; true if some are for the tree.
    fn add(&mut self, side: Side, environment: &Environment, punctual: &[Punctual]) -> bool {
        let (distant, points): (Vec<Punctual>, Vec<_>) =
            punctual.iter().partition(|light| light.position().is_none());
        self.distant.extend(distant.into_iter().map(|light| (side, light)));
        self.skies.extend(Sky::of(environment).map(|sky| (side, sky)));
        let before = self.points.len();
        self.points.extend(points.into_iter().map(|light| (side, light)));
        self.points.len() > before
    }

    fn build_tree(&mut self) {
        let points: Vec<(Side, Emission)> =
            self.points.iter().filter_map(|(side, light)| Some((*side, light.emission()?))).collect();
        let surfaces = self.emitters.len();
        let emission = |index: u32| match self.emitters.get(index as usize) {
            Some(emitter) => (emitter.primitive.side(), emitter.emission()),
            None => points[index as usize - surfaces],
        };
        let count = (surfaces + points.len()) as u32;
        let Some(throat) = self.throat else {
            self.tree = Tree::build(count, |index| emission(index).1, self.floor);
            return;
        };
        let seen_from = |side| {
            let emission = |index| match emission(index) {
                (of, emission) if of == side => emission,
                (_, emission) => throat.transmits(side, emission),
            };
            Tree::build(count, emission, self.floor)
        };
        (self.tree, self.far_tree) = (seen_from(Side::Near), seen_from(Side::Far));
    }

    /// The tree for receivers on a side.
    fn tree(&self, side: Side) -> &Tree {
        match (side, self.throat) {
            (Side::Far, Some(_)) => &self.far_tree,
            (Side::Near, _) | (Side::Far, None) => &self.tree,
        }
    }

    /// Limits the points on spheres to the parts `cap` gives for them; without one they are all over the sphere.
    pub fn limit(&mut self, cap: impl Fn(&Emitter) -> Option<Cap>) {
        let mut has_changed = false;
        for emitter in &mut self.emitters {
            let Some(sphere) = emitter.sphere() else { continue };
            let form = match cap(emitter) {
                Some(cap) => Form::Cap(sphere, cap),
                None => Form::Whole(Shape::Sphere(sphere)),
            };
            has_changed |= form != emitter.form;
            emitter.form = form;
        }
        if has_changed {
            self.build_tree();
        }
    }

    /// True if a primitive is an emitter whose radiance varies.
    #[inline]
    pub fn varies(&self, primitive: PrimitiveId) -> bool {
        self.some_vary && self.emitter(primitive).is_some_and(|(emitter, _)| emitter.varies)
    }

    /// True if there is nothing to sample.
    pub fn is_empty(&self) -> bool {
        self.tree.is_empty() && self.distant.is_empty() && self.skies.is_empty()
    }

    /// Surfaces that emit.
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// True if a sky is sampled, which BSDF sampling can find, too.
    pub fn has_sky(&self) -> bool {
        !self.skies.is_empty()
    }

    /// True if there are punctual lights in the world.
    pub fn has_points(&self) -> bool {
        !self.points.is_empty()
    }

    /// Side and position of the punctual light with this index.
    pub fn point(&self, index: u32) -> Option<(Side, DVec3)> {
        let (side, light) = self.points.get(index as usize)?;
        Some((*side, light.position()?))
    }

    /// Probabilities of the kinds of light: in the world, distant, the skies.
    fn shares(&self) -> [f64; 3] {
        let is_there = [!self.tree.is_empty(), !self.distant.is_empty(), !self.skies.is_empty()];
        let share = 1.0 / is_there.iter().filter(|is_there| **is_there).count().max(1) as f64;
        is_there.map(|is_there| if is_there { share } else { 0.0 })
    }

    /// A light for `receiver`, from a number in [0, 1), and that number for use again; `None` if none that was looked at
    /// can contribute.
    pub(super) fn choose(&self, receiver: &Receiver, u: f64) -> Option<(ChosenLight<'_>, f64)> {
        let [in_world, ..] = self.shares();
        if u < in_world {
            let tree = self.tree(receiver.on.side());
            let u = rescale(u, 0.0, in_world);
            return Some(self.in_tree(in_world, tree.sample(receiver.position, receiver.lit_side(), u)?));
        }
        self.choose_beyond(u)
    }

    /// [`Self::choose`] for many receivers: `each` is called with the place of each, in order.
    pub(super) fn choose_all<'a>(
        &'a self,
        queries: &[LightQuery],
        choosing: &mut Choosing,
        mut each: impl FnMut(usize, Option<(ChosenLight<'a>, f64)>),
    ) {
        if self.throat.is_some() {
            for (place, LightQuery { receiver, numbers: [u, _] }) in queries.iter().enumerate() {
                each(place, self.choose(receiver, *u));
            }
            return;
        }
        let Choosing { receivers, numbers, descents, found } = choosing;
        let [in_world, ..] = self.shares();
        receivers.grow(queries.len());
        numbers.clear();
        for (lane, &LightQuery { ref receiver, numbers: [u, _] }) in queries.iter().enumerate() {
            receivers.set(lane, self.tree.receiver(receiver.position, receiver.lit_side()));
            numbers.push((u < in_world).then(|| rescale(u, 0.0, in_world)));
        }
        self.tree.sample_all(receivers, numbers, descents, found);
        for (lane, &LightQuery { numbers: [u, _], .. }) in queries.iter().enumerate() {
            let in_tree = |chosen| self.in_tree(in_world, chosen);
            each(lane, if u < in_world { found[lane].map(in_tree) } else { self.choose_beyond(u) });
        }
    }

    /// The light of a choice by a tree, which was itself chosen with probability `in_world`.
    #[inline(always)]
    fn in_tree(&self, in_world: f64, (index, pmf, u): (u32, f64, f64)) -> (ChosenLight<'_>, f64) {
        let pmf = in_world * pmf;
        let light = match self.emitters.get(index as usize) {
            Some(emitter) => ChosenLight::Surface(emitter, pmf),
            None => {
                let point = index - self.emitters.len() as u32;
                let (side, light) = &self.points[point as usize];
                ChosenLight::Other(OtherLight::Point(*side, light, point, pmf))
            }
        };
        (light, u)
    }

    /// A light that is in no tree.
    fn choose_beyond(&self, u: f64) -> Option<(ChosenLight<'_>, f64)> {
        let [in_world, distant, sky] = self.shares();
        let among = |count: usize, u: f64| {
            let index = ((u * count as f64) as usize).min(count - 1);
            (index, rescale(u * count as f64, index as f64, 1.0))
        };
        if u < in_world + distant {
            let count = self.distant.len();
            let (index, u) = among(count, rescale(u, in_world, distant));
            let (side, light) = &self.distant[index];
            let light = OtherLight::Distant(*side, light, count as f64 / distant);
            return Some((ChosenLight::Other(light), u));
        }
        let count = self.skies.len();
        if count == 0 {
            return None;
        }
        let (index, u) = among(count, rescale(u, in_world + distant, sky));
        let (side, picture) = &self.skies[index];
        Some((ChosenLight::Other(OtherLight::Sky(*side, picture, sky / count as f64)), u))
    }

    /// The emitter that a primitive is, with its index.
    pub(super) fn emitter(&self, primitive: PrimitiveId) -> Option<(&Emitter, u32)> {
        let &index = self.by_primitive.get(&primitive)?;
        Some((&self.emitters[index as usize], index))
    }

    /// Probability with which [`Self::choose`] chooses the emitter with this index.
    pub(super) fn emitter_pmf(&self, index: u32, receiver: &Receiver) -> f64 {
        let tree = self.tree(receiver.on.side());
        self.shares()[0] * tree.probability(index, receiver.position, receiver.lit_side())
    }

    /// True if a point at infinity is in the tile of its side's sky with this index.
    pub fn is_in_tile(&self, there: AtInfinity, tile: u32) -> bool {
        self.sky(there.side).is_some_and(|(sky, _)| sky.tile_of(there.direction).0 == tile)
    }

    /// The sky of a side, with the probability with which [`Self::choose`] chooses it.
    pub(super) fn sky(&self, side: Side) -> Option<(&Sky, f64)> {
        let (_, sky) = self.skies.iter().find(|(of, _)| *of == side)?;
        Some((sky, self.shares()[2] / self.skies.len() as f64))
    }
}
