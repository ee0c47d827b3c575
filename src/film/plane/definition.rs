//! Definition of a plane: its channels, its value of a sample, and the rule by which samples become a pixel.

use glam::DVec3;

use crate::film::sample::Sample;

/// All that there is to say about a plane.
#[derive(Debug)]
pub struct Definition {
    /// One line for the command line's help.
    pub about: &'static str,
    /// Names of the channels in an EXR, in the order in which the image keeps them; all hold 32-bit floats, indices
    /// (`ID`) and counts (`N`) too, since an f32 holds integers below 2²⁴ exactly.
    pub channels: &'static [&'static str],
    /// Records that it needs of each path beside its radiance.
    pub needs: Needs,
    /// Value of one sample.
    pub value: Value,
    /// Rule by which the values of a pixel's samples become one.
    pub average: Average,
}

/// Records of each path beside its radiance: nothing that no plane needs is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// End of the camera ray, without its length.
    pub camera_ray: bool,
    /// Length of the camera ray.
    pub length: bool,
    /// March steps.
    pub steps: bool,
}

impl Needs {
    /// The radiance is enough.
    pub const NOTHING: Self = Self { camera_ray: false, length: false, steps: false };
    /// End of the camera ray.
    pub const CAMERA_RAY: Self = Self { camera_ray: true, ..Self::NOTHING };
    /// End and length of the camera ray.
    pub const LENGTH: Self = Self { length: true, ..Self::CAMERA_RAY };
    /// March steps.
    pub const STEPS: Self = Self { steps: true, ..Self::NOTHING };

    /// Needs of two planes together.
    pub fn and(self, other: Self) -> Self {
        Self {
            camera_ray: self.camera_ray || other.camera_ray,
            length: self.length || other.length,
            steps: self.steps || other.steps,
        }
    }
}

/// Value of one sample; `None` where it has none.
#[derive(Debug)]
pub enum Value {
    /// Of a plane with one channel.
    Number(fn(&Sample) -> Option<f64>),
    /// Of a plane with three channels.
    Vector(fn(&Sample) -> Option<DVec3>),
}

impl Value {
    /// Values of the channels; those that the plane lacks are 0.
    pub fn of(&self, sample: &Sample) -> Option<[f64; 3]> {
        match self {
            Self::Number(number) => number(sample).map(|number| [number, 0.0, 0.0]),
            Self::Vector(vector) => vector(sample).map(|vector| vector.to_array()),
        }
    }
}

/// Rule by which the values of a pixel's samples become one.
#[derive(Debug)]
pub enum Average {
    /// Mean over all samples; those without a value count as 0.
    Samples,
    /// Mean over the samples that have a value.
    Present {
        /// Value of a pixel none of whose samples has one.
        otherwise: f32,
    },
    /// Value of the first sample, 0 if it has none: identities have no mean.
    First,
    /// Variance of the mean over all samples, from [runs](crate::film::runs) of them.
    VarianceOfMean,
}
