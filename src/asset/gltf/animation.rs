//! Animations: properties of nodes at one moment.

use std::collections::HashMap;

use glam::DVec4;
use gltf::accessor::Dimensions;
use gltf::animation::{Interpolation, Property};
use gltf::json::animation::{Animation, Channel};
use gltf::json::validation::Checked;

use super::accessor::Column;
use super::buffers::Buffers;
use super::deform::MOST_TARGETS;
use crate::asset::flaw::Flaw;
use crate::asset::notes::Notes;

/// Cosine of the angle between quaternions beyond which they are so close that a straight line serves.
const CLOSE: f64 = 0.9995;

/// Animated properties of nodes at one moment; all animations of a file run at once.
#[derive(Default)]
pub(super) struct Moment {
    translations: HashMap<usize, [f32; 3]>,
    rotations: HashMap<usize, [f32; 4]>,
    scales: HashMap<usize, [f32; 3]>,
    weights: HashMap<usize, Vec<f32>>,
}

impl Moment {
    /// The properties `time` seconds after the start. What cannot be evaluated is left as it is stored, with a note.
    ///
    /// Goes by the JSON, since nothing has checked the indices.
    pub fn new(gltf: &gltf::Gltf, time: f64, buffers: &Buffers, notes: &mut Notes) -> Self {
        let mut moment = Self::default();
        for animation in &gltf.document.as_json().animations {
            for channel in &animation.channels {
                if let Err(flaw) = moment.evaluate(gltf, animation, channel, time, buffers, notes) {
                    let name = animation.name.as_deref().unwrap_or("unnamed");
                    notes.add(format!("animation is ignored where {}, in", flaw.problem), name);
                }
            }
        }
        moment
    }

    fn evaluate(
        &mut self,
        gltf: &gltf::Gltf,
        animation: &Animation,
        channel: &Channel,
        time: f64,
        buffers: &Buffers,
        notes: &mut Notes,
    ) -> Result<(), Flaw> {
        let node =
            gltf.nodes().nth(channel.target.node.value()).ok_or_else(|| broken("there is no such node"))?;
        let sampler = animation.samplers.get(channel.sampler.value());
        let sampler = sampler.ok_or_else(|| broken("there is no such sampler"))?;
        let (Checked::Valid(path), Checked::Valid(interpolation)) =
            (channel.target.path, sampler.interpolation)
        else {
            return Err(broken("the property or the interpolation is unknown"));
        };
        let accessor =
            |index: usize| gltf.accessors().nth(index).ok_or_else(|| broken("there is no such accessor"));
        let (input, output) = (accessor(sampler.input.value())?, accessor(sampler.output.value())?);
        let key = Keyframe::find(
            &Column::of_vectors(&input, &[Dimensions::Scalar], buffers)?,
            time,
            interpolation,
        )?;
        let values = |dimensions| {
            let values = Column::of_vectors(&output, &[dimensions], buffers)?;
            let needed = key.count.saturating_mul(key.each());
            if values.len() < needed { Err(broken("there are fewer values than keys")) } else { Ok(values) }
        };
        let index = node.index();
        let is_new = match path {
            Property::Translation => {
                let [x, y, z, _] = key.mix(&values(Dimensions::Vec3)?, DVec4::lerp).as_vec4().to_array();
                self.translations.insert(index, [x, y, z]).is_none()
            }
            Property::Scale => {
                let [x, y, z, _] = key.mix(&values(Dimensions::Vec3)?, DVec4::lerp).as_vec4().to_array();
                self.scales.insert(index, [x, y, z]).is_none()
            }
            Property::Rotation => {
                let rotation = key.mix(&values(Dimensions::Vec4)?, along_arc);
                self.rotations.insert(index, rotation.as_vec4().to_array()).is_none()
            }
            Property::MorphTargetWeights => {
                let primitives = node.mesh().into_iter().flat_map(|mesh| mesh.primitives());
                let targets = primitives.map(|primitive| primitive.morph_targets().len()).max().unwrap_or(0);
                if targets > MOST_TARGETS {
                    return Err(broken("there are too many morph targets"));
                }
                let values = values(Dimensions::Scalar)?;
                let each = values.len() / (key.count * key.each());
                let weight = |target| key.mix_one(&values, each, target);
                self.weights.insert(index, (0..targets.min(each)).map(weight).collect()).is_none()
            }
        };
        if !is_new {
            let name = node.name().unwrap_or("unnamed");
            notes.add("of several animations of one property the last is taken, of node", name);
        }
        Ok(())
    }

    pub fn translation(&self, node: usize) -> Option<[f32; 3]> {
        self.translations.get(&node).copied()
    }

    pub fn rotation(&self, node: usize) -> Option<[f32; 4]> {
        self.rotations.get(&node).copied()
    }

    pub fn scale(&self, node: usize) -> Option<[f32; 3]> {
        self.scales.get(&node).copied()
    }

    pub fn weights(&self, node: usize) -> Option<&[f32]> {
        self.weights.get(&node).map(Vec::as_slice)
    }
}

/// Place of a moment among the keys of a sampler.
struct Keyframe {
    /// Number of keys.
    count: usize,
    /// The key at or before the moment, and the next one; equal outside the keys.
    before: usize,
    after: usize,
    /// Part of the way from one to the other.
    part: f64,
    /// Seconds from one to the other.
    span: f64,
    interpolation: Interpolation,
}

impl Keyframe {
    fn find(times: &Column, time: f64, interpolation: Interpolation) -> Result<Self, Flaw> {
        let count = times.len_in_full()?;
        if count == 0 {
            return Err(broken("there are no keys"));
        }
        let at = |key: u32| f64::from(times.vector::<1>(key)[0]);
        let (mut low, mut high) = (0, count);
        while low < high {
            let middle = low + (high - low) / 2;
            if at(middle) <= time {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        let (before, after) = (low.saturating_sub(1), low.min(count - 1));
        let span = at(after) - at(before);
        let part = if span > 0.0 { ((time - at(before)) / span).clamp(0.0, 1.0) } else { 0.0 };
        let (before, after) = (before as usize, after as usize);
        Ok(Self { count: count as usize, before, after, part, span, interpolation })
    }

    /// Values for each key: of a spline there are tangents before and after each.
    fn each(&self) -> usize {
        match self.interpolation {
            Interpolation::Linear | Interpolation::Step => 1,
            Interpolation::CubicSpline => 3,
        }
    }

    /// The value of a vector; `between` is how linear interpolation goes.
    fn mix(&self, values: &Column, between: fn(DVec4, DVec4, f64) -> DVec4) -> DVec4 {
        let value = |index: usize| DVec4::from(values.vector::<4>(index as u32).map(f64::from));
        self.combine(value, between)
    }

    /// One of `each` numbers.
    fn mix_one(&self, values: &Column, each: usize, number: usize) -> f32 {
        let value = |index: usize| DVec4::splat(values.vector::<1>((each * index + number) as u32)[0].into());
        self.combine(value, DVec4::lerp).x as f32
    }

    fn combine(&self, value: impl Fn(usize) -> DVec4, between: fn(DVec4, DVec4, f64) -> DVec4) -> DVec4 {
        let (u, before, after) = (self.part, self.before, self.after);
        match self.interpolation {
            Interpolation::Step => value(before),
            Interpolation::Linear if before == after => value(before),
            Interpolation::Linear => between(value(before), value(after), u),
            // Cubic Hermite spline (glTF 2.0, appendix C): its ends, and their tangents per second.
            Interpolation::CubicSpline => {
                let (u2, u3) = (u * u, u * u * u);
                let ends = (2.0 * u3 - 3.0 * u2 + 1.0) * value(3 * before + 1)
                    + (3.0 * u2 - 2.0 * u3) * value(3 * after + 1);
                let slopes = (u3 - 2.0 * u2 + u) * value(3 * before + 2) + (u3 - u2) * value(3 * after);
                ends + self.span * slopes
            }
        }
    }
}

/// Spherical linear interpolation of quaternions along the shorter arc.
fn along_arc(from: DVec4, to: DVec4, part: f64) -> DVec4 {
    let (from, to) = (from.normalize_or_zero(), to.normalize_or_zero());
    let cosine = from.dot(to);
    let to = if cosine < 0.0 { -to } else { to };
    if cosine.abs() > CLOSE {
        return from.lerp(to, part);
    }
    let angle = libm::acos(cosine.abs());
    (libm::sin((1.0 - part) * angle) * from + libm::sin(part * angle) * to) / libm::sin(angle)
}

fn broken(what: &str) -> Flaw {
    Flaw::new(what, "export the animation again")
}
