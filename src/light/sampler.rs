//! Light sampling: a direction from which light may come, and its density in solid angle.
//!
//! Steps, alike in flat and in curved space, as only the [`Aim`] knows rays:
//!
//! 1. a light: by the kind, then an emitter by the light tree;
//! 2. its place as the aim knows it, and the winding number of a ray to it;
//! 3. a point on it;
//! 4. the ray to that point;
//! 5. its density, from the probabilities of the choices and the geometry factor dΩ/dA.

use glam::DVec3;

use super::aim::{Aim, Link};
use super::emitter::{Emitter, Form, Standpoint, View};
use super::lights::{Choosing, ChosenLight, Lights, OtherLight};
use super::punctual::Punctual;
use super::receiver::Receiver;
use super::sample::{EmitterHit, Incoming, LightQuery, LightRayEnd, LightSample, Target};
use super::sky::{Sky, SkySample};
use super::spots::{
    SphereParts, SpherePartsBlock, SpherePoints, Spot, SpotBlock, SpotQueue, TrianglePoints, UnitSquare,
    UnitSquareBlock, ViewedTriangle,
};
use crate::geometry::Shape;
use crate::math::columns::{LANES, Row};
use crate::math::kernel::map;
use crate::math::rescale::rescale;
use crate::spacetime::{AtInfinity, Side};

/// Weight of rays that go around more than once, beside that of the near way.
const REMOTE: f64 = 0.01;

/// Sampling of lights, with some [`Aim`] or otherwise, compiled for each and chosen once per light sample: renders need
/// not be generic over it.
pub trait LightSampler: Send + Sync {
    /// A light sample for `receiver`, from two numbers in [0, 1); `None` if this one finds no light.
    fn sample(&self, lights: &Lights, receiver: &Receiver, numbers: [f64; 2]) -> Option<LightSample>;

    /// [`Self::sample`] for many receivers.
    fn sample_all(
        &self,
        lights: &Lights,
        queries: &[LightQuery],
        _: &mut Sampling,
        samples: &mut Vec<Option<LightSample>>,
    ) {
        let sample = |query: &LightQuery| self.sample(lights, &query.receiver, query.numbers);
        samples.extend(queries.iter().map(sample));
    }

    /// Density with which [`Self::sample`] chooses the ray that leaves `receiver` in `direction` and ends on an
    /// emitter.
    fn surface_density(
        &self,
        lights: &Lights,
        receiver: &Receiver,
        direction: DVec3,
        hit: &EmitterHit,
    ) -> f64;

    /// Density with which [`Self::sample`] chooses the ray that leaves `receiver` in `direction` and goes to infinity
    /// `there`.
    fn sky_density(&self, lights: &Lights, receiver: &Receiver, direction: DVec3, there: AtInfinity) -> f64;

    /// True if a light ray that lands there has reached its target.
    fn reaches(&self, lights: &Lights, target: Target, end: &LightRayEnd) -> bool;

    /// True if the sky is sampled, too.
    fn samples_sky(&self) -> bool;
}

/// Memory of light sampling for many receivers.
#[derive(Default)]
pub struct Sampling {
    choosing: Choosing,
    triangles: SpotQueue<ViewedTriangle>,
    spheres: SpotQueue<SphereParts>,
}

impl<A: Aim> LightSampler for A {
    fn sample(&self, lights: &Lights, receiver: &Receiver, [u, v]: [f64; 2]) -> Option<LightSample> {
        let (choice, u) = lights.choose(receiver, u)?;
        let x = self.place(receiver.on.side(), receiver.position);
        match choice {
            ChosenLight::Surface(emitter, pmf) => {
                let (aimed, view, v) = aim_at_emitter(self, (&x, receiver), (emitter, pmf), v)?;
                aimed.sample(self, &x, &emitter.sample(&view, u, v)?)
            }
            ChosenLight::Other(light) => sample_other(self, &x, light, [u, v]),
        }
    }

    fn sample_all(
        &self,
        lights: &Lights,
        queries: &[LightQuery],
        sampling: &mut Sampling,
        samples: &mut Vec<Option<LightSample>>,
    ) {
        if A::SIDE_BY_SIDE {
            sample_side_by_side(self, (lights, queries), sampling, samples);
        } else {
            sample_spots_side_by_side(self, (lights, queries), sampling, samples);
        }
    }

    fn surface_density(
        &self,
        lights: &Lights,
        receiver: &Receiver,
        direction: DVec3,
        hit: &EmitterHit,
    ) -> f64 {
        let Some((emitter, index)) = lights.emitter(hit.primitive) else { return 0.0 };
        let (cos, standpoint) = (-hit.arrival.dot(hit.normal), emitter.standpoint(receiver));
        if !emitter.is_lit_by(cos, standpoint) {
            return 0.0;
        }
        let pmf = lights.emitter_pmf(index, receiver);
        if pmf == 0.0 {
            return 0.0;
        }
        let side = hit.primitive.side();
        let (x, y) = (self.place(receiver.on.side(), receiver.position), self.place(side, hit.position));
        let Some((winding, geometry_factor)) = classify(self, &x, direction, &y, hit.arrival) else {
            return 0.0;
        };
        let middle = self.place(side, emitter.middle());
        let winding_pmf = winding_pmf(self.windings(), self.around(&x, &middle), winding);
        let view = view(self, (emitter, standpoint), &x, &middle, winding);
        finite(
            pmf * winding_pmf * emitter.density(&view, hit.position, hit.normal)
                / (geometry_factor * cos.abs()),
        )
    }

    fn sky_density(&self, lights: &Lights, receiver: &Receiver, direction: DVec3, there: AtInfinity) -> f64 {
        let Some((sky, pmf)) = lights.sky(there.side) else { return 0.0 };
        let (x, y) = (self.place(receiver.on.side(), receiver.position), self.infinity(there));
        let Some((winding, geometry_factor)) = classify(self, &x, direction, &y, there.direction) else {
            return 0.0;
        };
        finite(
            pmf * sky.density(there.direction) * winding_pmf(self.windings(), self.around(&x, &y), winding)
                / geometry_factor,
        )
    }

    fn reaches(&self, _: &Lights, target: Target, end: &LightRayEnd) -> bool {
        let Target::Surface(wanted, at) = target else { return false };
        end.primitive == wanted && self.is_reached(wanted.side(), at, end.position)
    }

    fn samples_sky(&self) -> bool {
        true
    }
}

/// [`LightSampler::sample_all`] of an aim that finds rays one by one: only points on emitters are chosen side by side.
#[inline(always)]
fn sample_spots_side_by_side<A: Aim>(
    aim: &A,
    (lights, queries): (&Lights, &[LightQuery]),
    Sampling { choosing, triangles, spheres }: &mut Sampling,
    samples: &mut Vec<Option<LightSample>>,
) {
    triangles.reserve(queries.len());
    spheres.reserve(queries.len());
    let first = samples.len();
    let place_of = |receiver: &Receiver| aim.place(receiver.on.side(), receiver.position);
    // Triangles along straight lines, of which there is one each.
    let mut on_triangles: Vec<(usize, &Emitter, f64)> = Vec::with_capacity(queries.len());
    let mut on_spheres: Vec<(usize, EmitterTarget)> = Vec::new();
    lights.choose_all(queries, choosing, |place, choice| {
        let LightQuery { receiver, numbers: [_, v] } = &queries[place];
        samples.push(choice.and_then(|(choice, u)| {
            let x = place_of(receiver);
            let (emitter, pmf) = match choice {
                ChosenLight::Surface(emitter, pmf) => (emitter, pmf),
                ChosenLight::Other(light) => return sample_other(aim, &x, light, [u, *v]),
            };
            if let Form::Whole(Shape::Triangle([a, b, c])) = emitter.form
                && let Some(x) = aim.straight_from(&x)
            {
                triangles.push(ViewedTriangle { a, b, c, x }, [u, *v]);
                on_triangles.push((place, emitter, pmf));
                return None;
            }
            let (aimed, view, v) = aim_at_emitter(aim, (&x, receiver), (emitter, pmf), *v)?;
            if let Some(parts) = emitter.sphere_parts(&view) {
                spheres.push(parts, [u, v]);
                on_spheres.push((place, aimed));
                return None;
            }
            aimed.sample(aim, &x, &emitter.sample(&view, u, v)?)
        }));
    });
    triangles.choose(&TrianglePoints, |number, spot| {
        let (place, emitter, pmf) = on_triangles[number];
        let aimed = EmitterTarget { emitter, standpoint: Standpoint::Apart, winding: 0, pmf };
        samples[first + place] = aimed.sample(aim, &place_of(&queries[place].receiver), &spot);
    });
    spheres.choose(&SpherePoints, |number, spot| {
        let (place, aimed) = &on_spheres[number];
        samples[first + place] = aimed.sample(aim, &place_of(&queries[*place].receiver), &spot);
    });
}

/// [`LightSampler::sample_all`] of an aim that finds places and rays side by side, too. (As one with the other, straight rays
/// would be a tenth slower: they cost less than what is kept of each between stages.)
#[inline(always)]
fn sample_side_by_side<A: Aim>(
    aim: &A,
    (lights, queries): (&Lights, &[LightQuery]),
    Sampling { choosing, .. }: &mut Sampling,
    samples: &mut Vec<Option<LightSample>>,
) {
    let first = samples.len();
    let mut chosen = Vec::with_capacity(queries.len());
    lights.choose_all(queries, choosing, |place, choice| {
        let LightQuery { receiver, numbers: [_, v] } = &queries[place];
        samples.push(choice.and_then(|(choice, u)| match choice {
            ChosenLight::Surface(emitter, pmf) => {
                chosen.push((place, emitter, pmf, u));
                None
            }
            ChosenLight::Other(light) => {
                let x = aim.place(receiver.on.side(), receiver.position);
                sample_other(aim, &x, light, [u, *v])
            }
        }));
    });
    for some in chosen.chunks(LANES) {
        // Lanes to spare repeat the last.
        let block: [_; LANES] = std::array::from_fn(|lane| {
            let (place, emitter, pmf, u) = some[lane.min(some.len() - 1)];
            (&queries[place], emitter, pmf, u)
        });
        for ((place, ..), light) in some.iter().zip(sample_emitters(aim, (&block, some.len()))) {
            samples[first + place] = light;
        }
    }
}

/// Samples of emitters that were chosen with a probability for the receivers in the first `used` lanes of a block, each from
/// a number in [0, 1) and the second one of its query.
#[inline(always)]
fn sample_emitters<A: Aim>(
    aim: &A,
    (block, used): (&[(&LightQuery, &Emitter, f64, f64); LANES], usize),
) -> [Option<LightSample>; LANES] {
    let x = aim.places(|lane| {
        let receiver = &block[lane].0.receiver;
        (receiver.on.side(), receiver.position)
    });
    let middles = aim.places(|lane| (block[lane].1.primitive.side(), block[lane].1.middle()));
    let around = aim.arounds(&x, &middles);
    let windings: [_; LANES] = std::array::from_fn(|lane| {
        let (LightQuery { numbers: [_, v], .. }, ..) = block[lane];
        winding_from(aim.windings(), around[lane], *v)
    });
    let standpoints = block.map(|(LightQuery { receiver, .. }, emitter, ..)| emitter.standpoint(receiver));
    let approaches = aim.approaches(&x, &middles, |lane| {
        let is_asked = lane < used && is_seen_from_outside(block[lane].1, standpoints[lane]);
        windings[lane].filter(|_| is_asked).map(|(winding, ..)| winding)
    });
    let mut spots = [None; LANES];
    let (mut spheres, mut numbers) = (SpherePartsBlock::default(), UnitSquareBlock::default());
    for lane in 0..used {
        let (_, emitter, _, u) = block[lane];
        let Some((_, _, v)) = windings[lane] else { continue };
        let view = approaches[lane].map_or_else(|| view_of_whole(aim, emitter, &x[lane]), View::Outside);
        match emitter.sphere_parts(&view) {
            Some(parts) => {
                SphereParts::set(&mut spheres, lane, parts);
                UnitSquare::set(&mut numbers, lane, UnitSquare { u, v });
            }
            None => spots[lane] = emitter.sample(&view, u, v),
        }
    }
    let mut on_spheres = SpotBlock::default();
    map(&SpherePoints, &[spheres], &[numbers], std::slice::from_mut(&mut on_spheres));
    for lane in 0..used {
        let is_sphere = windings[lane].is_some() && block[lane].1.sphere().is_some();
        let spot = Spot::get(&on_spheres, lane);
        if is_sphere && spot.density > 0.0 {
            spots[lane] = Some(spot);
        }
    }
    let at = |lane: usize| spots[lane].map_or(block[lane].1.middle(), |spot| spot.position);
    let ends = aim.places(|lane| (block[lane].1.primitive.side(), at(lane)));
    let (mut pairs, mut lanes, mut count) = ([(x[0], ends[0], 0); LANES], [0; LANES], 0);
    for lane in 0..used {
        if let (Some((winding, ..)), Some(_)) = (windings[lane], spots[lane]) {
            (pairs[count], lanes[count]) = ((x[lane], ends[lane], winding), lane);
            count += 1;
        }
    }
    let mut lights = [None; LANES];
    for (link, &lane) in aim.links(&pairs[..count]).iter().zip(&lanes[..count]) {
        let ((_, emitter, pmf, _), standpoint) = (block[lane], standpoints[lane]);
        lights[lane] = windings[lane].and_then(|(winding, winding_pmf, _)| {
            let aimed = EmitterTarget { emitter, standpoint, winding, pmf: pmf * winding_pmf };
            aimed.light(&spots[lane]?, link.as_ref()?)
        });
    }
    lights
}

/// An emitter that a ray is aimed at.
#[derive(Clone, Copy)]
struct EmitterTarget<'a> {
    emitter: &'a Emitter,
    /// Side of it on which the receiver is.
    standpoint: Standpoint,
    /// Winding number of the ray.
    winding: u32,
    /// Probability of emitter and winding number.
    pmf: f64,
}

/// Chooses how a ray winds to an emitter that was chosen with a probability, from a number in [0, 1): with it come the view
/// that tells of points on the emitter, and the number for use again.
#[inline(always)]
fn aim_at_emitter<'a, A: Aim>(
    aim: &A,
    (x, receiver): (&A::Place, &Receiver),
    (emitter, pmf): (&'a Emitter, f64),
    v: f64,
) -> Option<(EmitterTarget<'a>, View, f64)> {
    let middle = aim.place(emitter.primitive.side(), emitter.middle());
    let (winding, winding_pmf, v) = choose_winding(aim, x, &middle, v)?;
    let standpoint = emitter.standpoint(receiver);
    let view = view(aim, (emitter, standpoint), x, &middle, winding);
    Some((EmitterTarget { emitter, standpoint, winding, pmf: pmf * winding_pmf }, view, v))
}

impl EmitterTarget<'_> {
    /// Side and position of a spot on the emitter.
    #[inline(always)]
    fn side_and_position(&self, spot: &Spot) -> (Side, DVec3) {
        (self.emitter.primitive.side(), spot.position)
    }

    /// The sample at a spot for a receiver at `x`.
    #[inline(always)]
    fn sample<A: Aim>(&self, aim: &A, x: &A::Place, spot: &Spot) -> Option<LightSample> {
        let (side, position) = self.side_and_position(spot);
        self.light(spot, &aim.link(x, &aim.place(side, position), self.winding)?)
    }

    /// Light of a spot along a link.
    #[inline(always)]
    fn light(&self, spot: &Spot, link: &Link) -> Option<LightSample> {
        let &Self { emitter, standpoint, pmf, .. } = self;
        let cos = -link.arrival.dot(spot.normal);
        if !emitter.is_lit_by(cos, standpoint) {
            return None;
        }
        let density = pmf * spot.density / (link.geometry_factor * cos.abs());
        Some(LightSample {
            direction: link.direction,
            target: Target::Surface(emitter.primitive, spot.position),
            light: emitter.incoming(density),
        })
    }
}

/// A sample of a light that is no surface, from two numbers in [0, 1).
#[inline(always)]
fn sample_other<A: Aim>(aim: &A, x: &A::Place, light: OtherLight, [u, v]: [f64; 2]) -> Option<LightSample> {
    match light {
        OtherLight::Point(side, light, index, pmf) => sample_point(aim, x, (side, light, index, pmf), v),
        OtherLight::Distant(side, light, inverse_pmf) => {
            sample_distant(aim, x, (side, light, inverse_pmf), v)
        }
        OtherLight::Sky(side, sky, pmf) => sample_sky(aim, x, (side, sky, pmf), [u, v]),
    }
}

fn sample_point<A: Aim>(
    aim: &A,
    x: &A::Place,
    (side, light, index, pmf): (Side, &Punctual, u32, f64),
    u: f64,
) -> Option<LightSample> {
    let y = aim.place(side, light.position()?);
    let (link, winding_pmf) = choose_link(aim, x, &y, u)?;
    // Intensities are those of the light's own frame.
    let link = Link { geometry_factor: link.geometry_factor / aim.area_scale(&y), ..link };
    Some(point_sample((light, index), &link, pmf * winding_pmf))
}

/// Light of a punctual light with its index along a link, whose geometry factor is by proper area, chosen with a
/// probability.
pub(super) fn point_sample((light, index): (&Punctual, u32), link: &Link, pmf: f64) -> LightSample {
    let irradiance = light.intensity_towards(-link.arrival) * (link.geometry_factor / pmf) as f32;
    let light = Incoming::Irradiance(irradiance);
    LightSample { direction: link.direction, target: Target::Point(index), light }
}

/// Light of an emitter from a direction of this density, the choice of the emitter included, that is drawn without a
/// point on it.
pub(super) fn region_sample(emitter: &Emitter, direction: DVec3, density: f64) -> LightSample {
    LightSample {
        direction,
        target: Target::Surface(emitter.primitive, emitter.middle()),
        light: emitter.incoming(density),
    }
}

/// Density of a direction that meets an emitter, where `density` is that for the emitter once it is chosen.
pub(super) fn region_density(
    lights: &Lights,
    receiver: &Receiver,
    hit: &EmitterHit,
    density: impl FnOnce(&Emitter) -> f64,
) -> f64 {
    let Some((emitter, index)) = lights.emitter(hit.primitive) else { return 0.0 };
    let pmf = lights.emitter_pmf(index, receiver);
    if pmf == 0.0 { 0.0 } else { pmf * density(emitter) }
}

/// True if a ray to an emitter ends on it, wherever, on a side that shines: `at_rest` makes of its normal that at rest.
pub(super) fn reaches_emitter(
    lights: &Lights,
    target: Target,
    end: &LightRayEnd,
    at_rest: impl FnOnce(DVec3) -> DVec3,
) -> bool {
    let Target::Surface(wanted, _) = target else { return false };
    let emitter = lights.emitter(end.primitive).filter(|_| end.primitive == wanted);
    emitter.is_some_and(|(emitter, _)| {
        emitter.both_sides || end.direction.dot(at_rest(emitter.normal_at(end.position))) < 0.0
    })
}

fn sample_distant<A: Aim>(
    aim: &A,
    x: &A::Place,
    (side, light, inverse_pmf): (Side, &Punctual, f64),
    u: f64,
) -> Option<LightSample> {
    let travel = light.direction()?;
    let (link, winding_pmf) = choose_link(aim, x, &aim.infinity(AtInfinity { side, direction: -travel }), u)?;
    Some(distant_sample((side, light, inverse_pmf), &link, winding_pmf))
}

/// Light of a light at infinity along a link that is chosen with a probability.
pub(super) fn distant_sample(
    (side, light, inverse_pmf): (Side, &Punctual, f64),
    link: &Link,
    pmf: f64,
) -> LightSample {
    let irradiance = light.peak() * inverse_pmf as f32;
    let light = Incoming::Irradiance(irradiance * (link.geometry_factor / pmf) as f32);
    LightSample { direction: link.direction, target: Target::Infinity(side), light }
}

fn sample_sky<A: Aim>(
    aim: &A,
    x: &A::Place,
    (side, sky, pmf): (Side, &Sky, f64),
    [u, v]: [f64; 2],
) -> Option<LightSample> {
    let SkySample { direction, density, left } = sky.sample(u, v)?;
    let there = AtInfinity { side, direction };
    let (link, winding_pmf) = choose_link(aim, x, &aim.infinity(there), left)?;
    let light = Incoming::Sky(there, density * pmf * winding_pmf / link.geometry_factor);
    Some(LightSample { direction: link.direction, target: Target::Infinity(side), light })
}

/// Probability with which a winding number below `windings` is chosen, given the weight of rays that go around once; the sum
/// over all is 1.
#[inline(always)]
fn winding_pmf(windings: u32, around: f64, winding: u32) -> f64 {
    let weight = |winding: u32| match winding {
        0 => 1.0,
        1 => around,
        _ => REMOTE,
    };
    weight(winding) / (0..windings).map(weight).sum::<f64>()
}

/// A winding number below `windings`, its probability, and `u` for use again, given the weight of rays that go around once.
#[inline(always)]
fn winding_from(windings: u32, around: f64, u: f64) -> Option<(u32, f64, f64)> {
    let mut below = 0.0;
    for winding in 0..windings {
        let pmf = winding_pmf(windings, around, winding);
        if u < below + pmf {
            return Some((winding, pmf, rescale(u, below, pmf)));
        }
        below += pmf;
    }
    None
}

/// A winding number, its probability, and `u` for use again.
fn choose_winding<A: Aim>(aim: &A, x: &A::Place, y: &A::Place, u: f64) -> Option<(u32, f64, f64)> {
    winding_from(aim.windings(), aim.around(x, y), u)
}

/// A ray to a place that is a point, and the probability of its winding number.
fn choose_link<A: Aim>(aim: &A, x: &A::Place, y: &A::Place, u: f64) -> Option<(Link, f64)> {
    let (winding, pmf, _) = choose_winding(aim, x, y, u)?;
    Some((aim.link(x, y, winding)?, pmf))
}

/// View of an emitter, whose middle is at `middle`, from `x`.
fn view<A: Aim>(
    aim: &A,
    (emitter, standpoint): (&Emitter, Standpoint),
    x: &A::Place,
    middle: &A::Place,
    winding: u32,
) -> View {
    match is_seen_from_outside(emitter, standpoint) {
        true => View::Outside(aim.approach(x, middle, winding)),
        false => view_of_whole(aim, emitter, x),
    }
}

/// True of an emitter that is seen along a ray to its middle.
#[inline(always)]
fn is_seen_from_outside(emitter: &Emitter, standpoint: Standpoint) -> bool {
    matches!(emitter.form, Form::Whole(Shape::Sphere(_))) && standpoint == Standpoint::Apart
}

/// View of another emitter.
#[inline(always)]
fn view_of_whole<A: Aim>(aim: &A, emitter: &Emitter, x: &A::Place) -> View {
    match emitter.form {
        Form::Whole(Shape::Triangle(_)) => aim.straight_from(x).map_or(View::Everywhere, View::Straight),
        Form::Whole(Shape::Sphere(_) | Shape::Disk(_)) | Form::Cap(..) => View::Everywhere,
    }
}

/// Winding number and geometry factor of a ray; `None` if it winds too often to be sampled.
fn classify<A: Aim>(
    aim: &A,
    x: &A::Place,
    direction: DVec3,
    y: &A::Place,
    arrival: DVec3,
) -> Option<(u32, f64)> {
    aim.classify(x, direction, y, arrival).filter(|(winding, _)| *winding < aim.windings())
}

/// A density, or 0 on caustics, where images merge and the geometry factor is infinite or not a number.
fn finite(density: f64) -> f64 {
    if density.is_finite() { density } else { 0.0 }
}
