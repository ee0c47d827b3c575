//! All lights of a scene, and the choice of one of them.

use std::collections::HashMap;

use glam::DVec3;

use super::emitter::{Cap, Emitter, Form};
use super::punctual::Punctual;
use super::receiver::Receiver;
use super::sky::Sky;
use super::tree::{Emission, Tree};
use crate::geometry::{Geometry, PrimitiveId};
use crate::shade::{Environment, Material};

/// All light that can be sampled.
pub struct Lights {
    /// Surfaces.
    emitters: Vec<Emitter>,
    /// Index of the emitter that a primitive is.
    by_primitive: HashMap<PrimitiveId, u32>,
    /// Punctual lights in the world.
    points: Vec<Punctual>,
    /// Punctual lights at infinity.
    distant: Vec<Punctual>,
    /// A bright picture at infinity.
    sky: Option<Sky>,
    /// Over `emitters`, then `points`.
    tree: Tree,
    /// Least orientation factor of the tree.
    floor: f64,
}

/// A light that was chosen, and the probability of the choice.
pub(super) enum ChosenLight<'a> {
    /// A surface.
    Surface(&'a Emitter, f64),
    /// A punctual light in the world, with its index.
    Point(&'a Punctual, u32, f64),
    /// A punctual light at infinity; the inverse of the probability.
    Distant(&'a Punctual, f64),
    /// The picture at infinity.
    Sky(&'a Sky, f64),
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

    /// True if there is nothing to sample.
    pub fn is_empty(&self) -> bool {
        self.tree.is_empty() && self.distant.is_empty() && self.sky.is_none()
    }

    /// Surfaces that emit.
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// True if a sky is sampled, which BSDF sampling can find, too.
    pub fn has_sky(&self) -> bool {
        self.sky.is_some()
    }

    /// True if there are punctual lights in the world.
    pub fn has_points(&self) -> bool {
        !self.points.is_empty()
    }

    /// Position of the punctual light with this index.
    pub fn point(&self, index: u32) -> Option<DVec3> {
        self.points.get(index as usize)?.position()
    }

    /// Probabilities of the kinds of light: in the world, distant, the sky.
    fn shares(&self) -> [f64; 3] {
        let is_there = [!self.tree.is_empty(), !self.distant.is_empty(), self.sky.is_some()];
        let share = 1.0 / is_there.iter().filter(|is_there| **is_there).count().max(1) as f64;
        is_there.map(|is_there| if is_there { share } else { 0.0 })
    }

    /// A light for `receiver`, from a number in [0, 1); `None` if none that was looked at can contribute.
    pub(super) fn choose(&self, receiver: &Receiver, u: f64) -> Option<ChosenLight<'_>> {
        let [in_world, distant, sky] = self.shares();
        if u < in_world {
            let (index, pmf, _) = self.tree.sample(receiver.position, Some(receiver.normal), u / in_world)?;
            let pmf = in_world * pmf;
            return Some(match self.emitters.get(index as usize) {
                Some(emitter) => ChosenLight::Surface(emitter, pmf),
                None => {
                    let point = index - self.emitters.len() as u32;
                    ChosenLight::Point(&self.points[point as usize], point, pmf)
                }
            });
        }
        if u < in_world + distant {
            let count = self.distant.len();
            let index = (((u - in_world) / distant * count as f64) as usize).min(count - 1);
            return Some(ChosenLight::Distant(&self.distant[index], count as f64 / distant));
        }
        Some(ChosenLight::Sky(self.sky.as_ref()?, sky))
    }

    /// The emitter that a primitive is, with its index.
    pub(super) fn emitter(&self, primitive: PrimitiveId) -> Option<(&Emitter, u32)> {
        let &index = self.by_primitive.get(&primitive)?;
        Some((&self.emitters[index as usize], index))
    }

    /// Probability with which [`Self::choose`] chooses the emitter with this index.
    pub(super) fn emitter_pmf(&self, index: u32, receiver: &Receiver) -> f64 {
        self.shares()[0] * self.tree.probability(index, receiver.position, Some(receiver.normal))
    }

    /// The sky, with the probability with which [`Self::choose`] chooses it.
    pub(super) fn sky(&self) -> Option<(&Sky, f64)> {
        Some((self.sky.as_ref()?, self.shares()[2]))
    }
}
