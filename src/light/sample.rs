//! Light samples: a direction, the target of its ray, and the light that it brings.

use glam::{DVec3, Vec3};

use super::receiver::Receiver;
use crate::geometry::PrimitiveId;
use crate::spacetime::{AtInfinity, Side};

/// End that a light ray must have to bring its light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Target {
    /// Nowhere.
    #[default]
    Nothing,
    /// A point of a primitive.
    Surface(PrimitiveId, DVec3),
    /// Any emitter behind mirrors and glass.
    ThroughSpecular,
    /// Infinity on a side.
    Infinity(Side),
    /// The tile of a side's sky with this index.
    SkyTile(Side, u32),
    /// A punctual light in the world, by its index.
    Point(u32),
}

/// Receiver that light is sampled for, with two numbers in [0, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightQuery {
    /// The receiver.
    pub receiver: Receiver,
    /// The numbers.
    pub numbers: [f64; 2],
}

/// A direction in which light may come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit direction.
    pub direction: DVec3,
    /// End that the ray must have.
    pub target: Target,
    /// Light that it brings.
    pub light: Incoming,
}

impl LightSample {
    /// The sample, where sampling at all was a choice of this probability.
    #[inline(always)]
    pub fn chosen_with(self, probability: f64) -> Self {
        let light = match self.light {
            Incoming::Radiance(radiance, density) => Incoming::Radiance(radiance, probability * density),
            Incoming::Sky(there, density) => Incoming::Sky(there, probability * density),
            Incoming::Seen(density) => Incoming::Seen(probability * density),
            Incoming::Irradiance(irradiance) => Incoming::Irradiance(irradiance / probability as f32),
        };
        Self { light, ..self }
    }
}

/// Light of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Incoming {
    /// Radiance, and the density of its direction in solid angle: BSDF sampling can find it, too.
    Radiance(Vec3, f64),
    /// Radiance of the sky at a point at infinity, and the density of the direction here in solid angle.
    Sky(AtInfinity, f64),
    /// What the ray sees where it ends, of the sky or of a textured surface, and the density of its direction in solid angle.
    Seen(f64),
    /// Irradiance of a punctual light on a surface that faces it, divided by the probability of the sample.
    Irradiance(Vec3),
}

/// Landing of a light ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightRayEnd {
    /// The primitive.
    pub primitive: PrimitiveId,
    /// World position.
    pub position: DVec3,
    /// Unit direction of travel.
    pub direction: DVec3,
}

/// An emitter that a ray found by BSDF sampling ends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmitterHit {
    /// The primitive.
    pub primitive: PrimitiveId,
    /// World position.
    pub position: DVec3,
    /// Unit normal, towards the front.
    pub normal: DVec3,
    /// Unit direction of travel.
    pub arrival: DVec3,
}
