//! Lobes: one file each and one line in [`lobes!`].

mod dielectric;
mod diffuse;
mod mirror;
mod model;

use glam::{DVec3, Vec3};

pub use dielectric::{Dielectric, fresnel};
pub use diffuse::{Diffuse, sample_cosine};
pub use mirror::Mirror;
pub use model::Bsdf;

use super::incidence::{Bounce, Incidence};

macro_rules! lobes {
    ($($name:ident),* $(,)?) => {
        /// Scattering lobe of a surface.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Lobe {
            $(
                /// The lobe of this name.
                $name($name),
            )*
        }

        impl Lobe {
            /// Names of all lobes.
            pub const NAMES: &'static [&'static str] = &[$($name::NAME),*];

            /// Name in scene files and reports.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$name(_) => $name::NAME,)* }
            }

            /// True if light from one direction leaves in one or two: a mirror, glass.
            pub fn is_specular(&self) -> bool {
                match self { $(Self::$name(_) => $name::IS_SPECULAR,)* }
            }

            /// Samples a continuation: [`Bsdf::sample`].
            #[inline(always)]
            pub fn sample(
                &self,
                incidence: &Incidence,
                eta: impl FnOnce() -> f64,
                u: [f32; 4],
            ) -> Option<Bounce> {
                match self { $(Self::$name(lobe) => lobe.sample(incidence, eta, u),)* }
            }

            /// BSDF × cosine and density towards a direction: [`Bsdf::evaluate`].
            #[inline(always)]
            pub fn evaluate(&self, incidence: &Incidence, out: DVec3) -> Option<(Vec3, f64)> {
                match self { $(Self::$name(lobe) => lobe.evaluate(incidence, out),)* }
            }

            /// Colour in the albedo plane.
            pub fn albedo(&self) -> Vec3 {
                match self { $(Self::$name(lobe) => lobe.albedo(),)* }
            }

            /// Index of refraction relative to vacuum, if light goes through.
            pub fn ior(&self) -> Option<f32> {
                match self { $(Self::$name(lobe) => lobe.ior(),)* }
            }
        }
    };
}

lobes! {
    Diffuse,
    Mirror,
    Dielectric,
}
