//! Lobes: one file each and one line in [`lobes!`]. Hits are scattered one by one, or sorted by lobe and then side by
//! side, to the same bits.

mod albedo_table;
mod coat;
mod dielectric;
mod diffuse;
mod ggx;
mod interface;
mod lacquered;
mod local_frame;
mod mirror;
mod model;
mod principled;
mod schlick;
mod sheen;
mod sorted;
mod specular;
mod thin_film;
mod variation;

use glam::{DVec3, Vec3};

pub use dielectric::{Dielectric, fresnel};
pub use diffuse::{Diffuse, sample_cosine};
pub use lacquered::Lacquered;
pub use mirror::Mirror;
pub use model::Bsdf;
pub use principled::Principled;
use sorted::{HitLanes, HitRows};
pub use variation::Variation;

use super::incidence::{Bounce, Incidence, Response};

macro_rules! lobes {
    ($($hits:ident: $kind:ident<$name:ident>),* $(,)?) => {
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

            /// True if light from one direction leaves in one or two and no others: a mirror, glass.
            pub fn is_specular(&self) -> bool {
                match self { $(Self::$name(lobe) => lobe.is_specular(),)* }
            }

            /// True if light leaves on the other side as well.
            pub fn transmits(&self) -> bool {
                match self { $(Self::$name(lobe) => lobe.transmits(),)* }
            }

            /// Samples a continuation: [`Bsdf::sample`].
            #[inline]
            pub fn sample(&self, incidence: &Incidence, u: [f32; 4]) -> Bounce {
                match self { $(Self::$name(lobe) => lobe.sample(incidence, u),)* }
            }

            /// BSDF × cosine and density towards a direction: [`Bsdf::evaluate`].
            #[inline]
            pub fn evaluate(&self, incidence: &Incidence, out: DVec3) -> Response {
                match self { $(Self::$name(lobe) => lobe.evaluate(incidence, out),)* }
            }

            /// The lobe as it is at a point of a surface: [`Bsdf::varied`].
            pub fn varied(&self, by: &Variation) -> Self {
                match self { $(Self::$name(lobe) => Self::$name(lobe.varied(by)),)* }
            }

            /// Colour in the albedo plane.
            pub fn albedo(&self) -> Vec3 {
                match self { $(Self::$name(lobe) => lobe.albedo(),)* }
            }

            /// How little light that it scatters goes by the cosine at which it came: [`Bsdf::gloss`].
            #[inline]
            pub fn gloss(&self) -> f32 {
                match self { $(Self::$name(lobe) => lobe.gloss(),)* }
            }

            /// Index of refraction relative to vacuum, if light enters what is beyond.
            pub fn ior(&self) -> Option<f32> {
                match self { $(Self::$name(lobe) => lobe.ior(),)* }
            }
        }

        /// Hits sorted by lobe, each lobe's to be scattered side by side.
        #[derive(Default)]
        pub struct SortedHits {
            $($hits: $kind<$name>,)*
            count: usize,
        }

        impl SortedHits {
            /// Takes a hit on a lobe; hits are numbered as they come.
            #[inline(always)]
            pub fn push(&mut self, lobe: &Lobe, incidence: &Incidence, u: [f32; 4]) {
                let number = self.count;
                self.count += 1;
                match lobe { $(Lobe::$name(lobe) => self.$hits.push(number, lobe, incidence, u),)* }
            }

            /// What [`Lobe::sample`] and [`Lobe::evaluate`] towards the directions `out` by number make of the hits, lobe after
            /// lobe; forgets these.
            pub fn scatter(
                &mut self,
                out: impl Fn(usize) -> DVec3,
                mut each: impl FnMut(usize, &Bounce, &Response),
            ) {
                $(self.$hits.scatter(&out, &mut each);)*
                self.count = 0;
            }
        }
    };
}

lobes! {
    diffuse: HitLanes<Diffuse>,
    mirror: HitLanes<Mirror>,
    dielectric: HitRows<Dielectric>,
    principled: HitRows<Principled>,
    lacquered: HitRows<Lacquered>,
}
