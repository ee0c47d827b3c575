//! Spacetimes: one file each and one line in `kind.rs`, and the fates of rays in them.
//!
//! # Adding a static, spherically symmetric spacetime
//!
//! Write its line element as ds² = −N(ρ)² dt² + Ψ(ρ)² dx² in isotropic coordinates and implement
//! [`ConformallyFlat`] with n = Ψ/N, as a function of the inverse radius w = 1/ρ. A weak lens of index n² = 1 + k w²:
//!
//! ```
//! use warpfront::math::real::Real;
//! use warpfront::spacetime::ConformallyFlat;
//!
//! #[derive(Clone, Copy)]
//! struct Weak { k: f64 }
//!
//! impl ConformallyFlat for Weak {
//!     fn index_squared<R: Real>(&self, w: R) -> R { R::of(1.0) + R::of(self.k) * w * w }
//!     fn pull<R: Real>(&self, w: R) -> R { R::of(self.k) * w } // ½ d(n²)/dw
//!     fn horizon(&self) -> f64 { 0.0 }
//!     fn photon_sphere(&self) -> f64 { 0.0 }
//!     fn critical_impact_parameter(&self) -> f64 { self.k.sqrt() }
//! }
//! assert_eq!(Weak { k: 2.0 }.index_squared(0.5), 1.5);
//! ```
//!
//! Then give it a name and parameters by implementing [`Named`], and its place in `media!` of `kind.rs`: scene files,
//! `--spacetime`, `info`, meshes, light sampling and all studies follow. A wormhole is the same with a
//! [`throat`](ConformallyFlat::throat), beyond which ρ → throat²/ρ is the other side: [`Mouths`] glues the two.
//!
//! # Adding one without symmetry
//!
//! A static index n(x) in three dimensions implements [`IndexField`], and gets a line in [`IndexMedium`].

mod chart;
mod conformally_flat;
mod ellis;
mod flare;
mod index_field;
mod interstellar;
mod kerr;
mod kerr_newman;
mod kind;
mod lenses;
mod mouths;
mod named;
mod parameter;
mod placement;
mod proper_length;
mod reissner_nordstrom;
mod rest_frame;
mod schwarzschild;
mod several_holes;
mod side;
mod static_hole;

pub use chart::{Chart, Fate};
pub use conformally_flat::ConformallyFlat;
pub use ellis::Ellis;
pub(crate) use index_field::dot;
pub use index_field::{FieldSurvey, IndexField, Lanes, Sink, Vectors, Viewpoint};
pub use interstellar::Interstellar;
pub use kerr_newman::KerrNewman;
pub use kind::{
    Entry, IndexMedium, LISTED, Listed, Metric, SPACETIMES, SpacetimeKind, SpacetimeVisitor, Wormhole,
};
pub use lenses::{GradedLens, Lenses};
pub use mouths::Mouths;
pub use named::Named;
pub use parameter::{Parameter, Range};
pub use placement::Placement;
pub use reissner_nordstrom::ReissnerNordstrom;
pub use rest_frame::{RestFrame, Stretch};
pub use schwarzschild::Schwarzschild;
pub use several_holes::{Hole, SeveralHoles};
pub use side::{AtInfinity, Side};
pub use static_hole::StaticHole;
