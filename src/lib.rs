//! Warpfront: a path tracer for real scenes in warped spacetime.
//!
//! A hole before a white sky, with a lamp beside it, built in code and rendered:
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//!
//! use glam::{DVec3, Vec3};
//! use warpfront::geometry::{Geometry, Primitives, Sphere, Surface};
//! use warpfront::scene::{Baked, Camera, Settings};
//! use warpfront::shade::{Environment, Material};
//! use warpfront::spacetime::SpacetimeKind;
//! use warpfront::trace::{Run, render};
//!
//! let lamp = Sphere { center: DVec3::new(3.0, 0.0, 0.0), radius: 0.5 };
//! let scene = Baked {
//!     spacetime: SpacetimeKind::black_hole(DVec3::ZERO, 1.0),
//!     camera: Camera::new(DVec3::new(0.0, 0.0, 12.0), DVec3::NEG_Z, DVec3::Y, 0.8, 0.0).expect("a view"),
//!     geometry: Geometry::build(Primitives {
//!         spheres: vec![(lamp, Surface { material: 0, entity: 0 })],
//!         ..Primitives::default()
//!     }),
//!     materials: vec![Material { emission: Vec3::splat(5.0), ..Material::default() }],
//!     entities: vec!["lamp".to_owned()],
//!     environment: Environment::Constant(Vec3::ONE),
//!     settings: Settings { width: 32, height: 24, spp: 4, ..Settings::default() },
//!     ..Baked::default()
//! };
//! let picture = render(&scene, &Run::default(), &AtomicBool::new(false), &|_| ()).image;
//! let red = picture.channel("R").expect("a colour");
//! // The hole's shadow in the middle, the sky in a corner.
//! assert_eq!((red[12 * 32 + 16], red[0]), (0.0, 1.0));
//! ```
//!
//! Scenes from files come from [`scene::load`]; a render that stops and goes on is a [`trace::Session`], which also
//! takes a spacetime of your own ([`trace::Session::around`]).
//!
//! # Conventions
//!
//! - G = c = 1. Lengths are scene units; a hole is given by its Schwarzschild radius `r_s = 2M` in the same units.
//! - Metric signature (−+++). Right-handed axes, +Y up, as glTF.
//! - Radians inside; degrees only in scene files and on the command line.
//! - Linear RGB, Rec. 709 primaries; radiance per channel.
//! - Rays are traced from the camera into the past.
//! - Chart: the Cartesian coordinates in which geometry is placed. Flat and Schwarzschild spacetimes use isotropic
//!   coordinates, in which the spatial metric is conformally flat, so that coordinate angles are true angles.
//! - A direction at a camera or a surface is the direction in the local static frame.
//!
//! # Symbols
//!
//! | symbol | meaning |
//! |---|---|
//! | `x` | position in the chart |
//! | `rho` | isotropic radius: distance from the spacetime's centre in the chart |
//! | `n` | optical index Ψ/N of a static, conformally flat spacetime |
//! | `p` | momentum dx/dσ, with \|p\| = n on a null ray (energy 1) |
//! | `sigma` | ray parameter: dσ = dl/n, dl coordinate length; coordinate time dt = n² dσ |
//! | `b` | impact parameter \|L\|/E = \|x × p\| |
//! | `w` | inverse radius 1/ρ |
//! | `psi` | orbit parameter: dψ = dσ/ρ², in which the swept angle is bψ |
//! | `v` | dw/dψ, minus the radial momentum |
//! | `xi` | parameter of one step: ξ = tan(bψ)/b from its start |
//! | `g`, `pull` | ½ d(n²)/dw |
//! | `r_s` | Schwarzschild radius |
//!
//! # Module map
//!
//! Data flows one way: files → [`scene`] world → baked tables → [`trace`] stages → [`film`] → EXR.
//! Dependencies point one way too:
//! `cli → study → plot → film, trace → scene → asset → light → shade → geometry → geodesic → spacetime → math`; all
//! that says something uses `text`.
//!
#![doc = include_str!("paper.md")]
#![warn(clippy::all)]
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod asset;
#[cfg(feature = "cli")]
pub mod cli;
pub mod film;
pub mod geodesic;
pub mod geometry;
pub mod light;
pub mod math;
#[cfg(feature = "cli")]
mod plot;
pub mod scene;
pub mod shade;
pub mod spacetime;
#[cfg(feature = "cli")]
pub mod study;
mod text;
pub mod trace;

/// The README, whose Rust blocks are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
