//! Emitters and how to find them.
//!
//! A light sample is a direction, chosen where light may come from, with its density in solid angle. [`Lights`] chooses
//! the light, an [`Aim`] finds the rays to it, and a [`LightSampler`] makes a sample of both; around a spinning hole, where
//! no formula joins two places, [`Regions`] of directions take the place of rays, among several holes and through lenses
//! [`FieldRegions`].
//!
//! A ray found by BSDF sampling that ends on an emitter asks for the density with which it could have been sampled:
//! both ways of finding light are then weighted by [`Heuristic`].
//!
#![doc = include_str!("sampling.md")]

mod aim;
mod emitter;
mod field_regions;
mod guide;
mod lights;
mod mean_radiance;
mod mis;
mod punctual;
mod receiver;
mod regions;
mod sample;
mod sampler;
mod sky;
mod sky_tiles;
mod spherical_triangle;
mod spots;
mod tree;

pub use aim::beams::{BeamRay, Beams};
pub use aim::field::{FieldAim, FieldWay};
pub use aim::lensed::Lensed;
pub use aim::straight::StraightAim;
pub use aim::{Aim, Approach, Link};
pub use emitter::{Cap, Emitter, Extent, Form, Standpoint, View};
pub use field_regions::FieldRegions;
pub use guide::{Guide, Neighbourhood, Photon};
pub use lights::{Lights, Transmission};
pub use mis::Heuristic;
pub use punctual::Punctual;
pub use receiver::Receiver;
pub use regions::Regions;
pub use sample::{EmitterHit, Incoming, LightQuery, LightRayEnd, LightSample, Target};
pub use sampler::{LightSampler, Sampling};
pub use sky::{Sky, SkySample};
pub use spots::Spot;
pub use tree::{Emission, LitSide, Tree};
