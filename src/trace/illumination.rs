//! Light sampling as a scene asks for it: its lights, the aim at them, and the heuristic that shares found light.

use glam::Vec3;

use super::transport::{Landing, Transport};
use super::vertex::Vertex;
use crate::light::{
    EmitterHit, Guide, Heuristic, Incoming, LightQuery, LightRayEnd, LightSample, LightSampler, Lights,
    Neighbourhood, Receiver, Sampling, StraightAim, Target, Transmission,
};
use crate::scene::{Baked, LightSampling};
use crate::shade::Environment;
use crate::spacetime::{AtInfinity, ConformallyFlat, Side};

/// State of light sampling: lights, sampler, guide, heuristic.
pub struct Illumination {
    /// The lights.
    pub lights: Lights,
    /// Sampling with the aim of the scene's transport, or a straight one on request.
    sampler: Box<dyn LightSampler>,
    /// Directions of light through mirrors and glass by side, near and far, once they are learned.
    pub guides: [Option<Guide>; 2],
    /// Heuristic that shares light; `None`: all of it belongs to light sampling, as in the paper, nothing is learned.
    pub heuristic: Option<Heuristic>,
    /// Least probability of a light ray.
    least_chance: f64,
}

/// Memory of light sampling for many receivers.
#[derive(Default)]
pub struct GuidedSampling {
    sampling: Sampling,
    /// Places of the queries for light that comes directly, with the probabilities of that.
    direct: Vec<(usize, f64)>,
    /// Places of the others, with their samples.
    specular: Vec<(usize, Option<LightSample>)>,
}

/// Way by which light is looked for.
enum ChosenWay {
    /// Through mirrors and glass: a sample of such light.
    ThroughSpecular(Option<LightSample>),
    /// Directly, which had this probability, from two numbers in [0, 1).
    Direct(f64, [f64; 2]),
}

/// End of a ray that found light.
#[derive(Clone, Copy, Debug)]
pub enum LightEnd {
    /// A surface.
    Surface(EmitterHit),
    /// At infinity.
    AtInfinity(AtInfinity),
}

/// Least probability of a light ray where rays are not straight, so that it costs a few of those that are.
const LEAST_CHANCE: f64 = 0.1;
/// Ratio of that probability to the throughput: 1 leaves a tenth more variance beside a hole, 4 hardly less for more time.
const CHANCE: f64 = 2.0;
/// Least orientation factor of lights where the straight direction to them is a guess.
const FLOOR: f64 = 0.1;

/// Summary of a scene's light sampling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightSummary {
    /// Surfaces that emit.
    pub surfaces: usize,
    /// Punctual lights.
    pub punctual: usize,
    /// True if directions of a sky are sampled.
    pub sky: bool,
    /// True if rays are guided through mirrors and glass.
    pub is_guided: bool,
}

/// Presence of mirrors or glass for light to go through.
pub fn has_specular(scene: &Baked) -> bool {
    scene.materials.iter().any(|material| material.is_specular())
}

impl Illumination {
    /// Light sampling for `scene` along the rays of `transport`; `None` where it is off or of no use.
    pub fn of<T: Transport>(scene: &Baked, transport: &T) -> Option<Self> {
        let settings = &scene.settings;
        let has_diffuse =
            scene.materials.iter().any(|material| material.spreads_light()) && settings.max_depth > 1;
        if settings.light_sampling == LightSampling::Off || !has_diffuse {
            return None;
        }
        let straight = settings.light_sampling == LightSampling::Straight;
        let sampler: Box<dyn LightSampler> =
            if straight { Box::new(StraightAim) } else { transport.sampler(settings.max_winding)? };
        let floor = if T::IS_STRAIGHT { 0.0 } else { FLOOR };
        let environment = if sampler.samples_sky() { &scene.environment } else { &Environment::Black };
        let lights = Lights::new(
            &scene.geometry,
            (&scene.materials, &scene.textures),
            environment,
            &scene.punctual,
            floor,
        )
        .with_far(&scene.far.environment, &scene.far.punctual);
        let lights = match scene.spacetime.wormhole() {
            Some((mouths, metric)) => lights.through(Transmission {
                mouths,
                radius: metric.throat(),
                critical: metric.critical_impact_parameter(),
            }),
            None => lights,
        };
        let least_chance = if T::IS_STRAIGHT { 1.0 } else { LEAST_CHANCE };
        let heuristic = (!straight).then_some(settings.heuristic);
        (!lights.is_empty()).then_some(Self {
            lights,
            sampler,
            guides: [None, None],
            heuristic,
            least_chance,
        })
    }

    /// Summarizes it for `scene`, which it is of.
    pub fn summary(&self, scene: &Baked) -> LightSummary {
        let surfaces = self.lights.emitters().len();
        LightSummary {
            surfaces,
            punctual: scene.punctual.len() + scene.far.punctual.len(),
            sky: self.lights.has_sky(),
            is_guided: self.heuristic.is_some() && surfaces > 0 && has_specular(scene),
        }
    }

    /// Probability with which a path of this throughput sends out a light ray: where light rays are dear, few are worth
    /// their time if the throughput is small.
    #[inline]
    pub fn chance(&self, throughput: Vec3) -> f64 {
        (CHANCE * f64::from(throughput.max_element())).clamp(self.least_chance, 1.0)
    }

    /// True if light through mirrors and glass is sampled.
    pub fn is_guided(&self) -> bool {
        self.guides.iter().any(Option::is_some)
    }

    /// A direction in which light may come to `receiver`, from two numbers in [0, 1): densities and probabilities are
    /// those of the whole choice.
    pub fn sample(&self, receiver: &Receiver, numbers: [f64; 2]) -> Option<LightSample> {
        match self.choose_way(receiver, numbers) {
            ChosenWay::ThroughSpecular(light) => light,
            ChosenWay::Direct(share, numbers) => {
                Some(self.sampler.sample(&self.lights, receiver, numbers)?.chosen_with(share))
            }
        }
    }

    /// [`Self::sample`] for many receivers; afterwards `queries` are those for light that comes directly.
    pub fn sample_all(
        &self,
        queries: &mut Vec<LightQuery>,
        GuidedSampling { sampling, direct, specular }: &mut GuidedSampling,
        samples: &mut Vec<Option<LightSample>>,
    ) {
        samples.clear();
        if !self.is_guided() {
            return self.sampler.sample_all(&self.lights, queries, sampling, samples);
        }
        direct.clear();
        let mut asked = 0;
        queries.retain_mut(|query| {
            let place = asked;
            asked += 1;
            match self.choose_way(&query.receiver, query.numbers) {
                ChosenWay::ThroughSpecular(light) => {
                    specular.push((place, light));
                    false
                }
                ChosenWay::Direct(share, numbers) => {
                    query.numbers = numbers;
                    direct.push((place, share));
                    true
                }
            }
        });
        self.sampler.sample_all(&self.lights, queries, sampling, samples);
        samples.resize(asked, None);
        // From the last on, so that none is overwritten before it is in its place.
        for (number, &(place, share)) in direct.iter().enumerate().rev() {
            samples[place] = samples[number].take().map(|light| light.chosen_with(share));
        }
        for (place, light) in specular.drain(..) {
            samples[place] = light;
        }
    }

    /// Chooses whether light comes to `receiver` through mirrors and glass or directly, from two numbers in [0, 1).
    #[inline(always)]
    fn choose_way(&self, receiver: &Receiver, [u, v]: [f64; 2]) -> ChosenWay {
        let near = self.near(receiver);
        let specular = near.map_or(0.0, |near| near.share);
        if u < specular {
            let sample = |near: Neighbourhood| near.sample(receiver.position, [u / specular, v]);
            return ChosenWay::ThroughSpecular(near.and_then(sample).map(|(direction, density)| {
                let light = Incoming::Radiance(Vec3::ONE, specular * density);
                LightSample { direction, target: Target::ThroughSpecular, light }
            }));
        }
        let direct = 1.0 - specular;
        ChosenWay::Direct(direct, [((u - specular) / direct).min(1f64.next_down()), v])
    }

    /// The density with which [`Self::sample`] chooses the ray that left `vertex` and found light at its end.
    pub fn density(&self, vertex: &Vertex, end: LightEnd) -> f64 {
        let receiver = Receiver {
            position: vertex.position,
            normal: vertex.normal,
            grazing: vertex.grazing,
            both_sides: vertex.both_sides,
            on: vertex.origin_prim,
        };
        let near = self.near(&receiver);
        if vertex.after_specular {
            let density = |near: Neighbourhood| near.share * near.density(vertex.position, vertex.direction);
            return near.map_or(0.0, density);
        }
        let (lights, out) = (&self.lights, vertex.direction);
        let density = match end {
            LightEnd::Surface(hit) => self.sampler.surface_density(lights, &receiver, out, &hit),
            LightEnd::AtInfinity(there) => self.sampler.sky_density(lights, &receiver, out, there),
        };
        (1.0 - near.map_or(0.0, |near| near.share)) * density
    }

    /// Neighbourhood of a receiver in the guide; `None` if no light through mirrors and glass is known there.
    fn near(&self, receiver: &Receiver) -> Option<Neighbourhood<'_>> {
        let [near, far] = &self.guides;
        let guide = match receiver.on.side() {
            Side::Near => near,
            Side::Far => far,
        };
        guide.as_ref()?.around(receiver.position)
    }

    /// True if a light ray that lands has reached its target.
    #[inline]
    pub fn reaches(&self, target: Target, landing: &Landing) -> bool {
        let &Landing { primitive, position, direction, .. } = landing;
        // Most rays that do not meet what they are aimed at are known at a glance.
        if !matches!(target, Target::Surface(wanted, _) if wanted == primitive) {
            return false;
        }
        self.sampler.reaches(&self.lights, target, &LightRayEnd { primitive, position, direction })
    }

    /// Weight of a light sample of pdf `sampled` whose light BSDF sampling would find with pdf `found`.
    #[inline]
    pub fn share_of_sample(&self, sampled: f64, found: f64) -> f64 {
        self.heuristic.map_or(1.0, |heuristic| heuristic.share(sampled, found))
    }

    /// Share of light that a surface found with density `found` and light sampling would with density `sampled`.
    #[inline]
    pub fn share_of_find(&self, sampled: f64, found: f64) -> f64 {
        match self.heuristic {
            Some(heuristic) => heuristic.share(found, sampled),
            None => f64::from(u8::from(sampled == 0.0)),
        }
    }
}
