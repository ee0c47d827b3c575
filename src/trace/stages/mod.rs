//! The kernels of the pipeline, one stage a file; each works on one path and is run by either schedule.
//!
//! | stage | reads | writes |
//! |---|---|---|
//! | [`generate`] | camera, film point | a path, a ray |
//! | advance ([`Transport::advance`]) | ray | move |
//! | [`intersect`] | move, geometry | what is found |
//! | settle ([`Transport::settle`]) | ray, move, found | ray, or how it ended |
//! | [`absorb`] | move, what is found, material around | throughput |
//! | [`escape`] | direction at infinity, environment | radiance |
//! | [`emit`] | landing, material | radiance |
//! | [`look_up`] | landing, textures | material, shading normal |
//! | [`pass`] | landing, material | a ray behind the surface |
//! | [`deposit`] | source of light | radiance |
//! | [`draw`] | path | random numbers |
//! | [`scatter`] | landing, material | throughput, a ray |
//! | [`shade`] | landing | the three at a surface: [`record`], [`emit`], [`scatter`] |
//! | [`record`] | camera ray | first-hit planes, only those asked for |
//!
//! [`Transport::advance`]: super::transport::Transport::advance
//! [`Transport::settle`]: super::transport::Transport::settle

pub mod absorb;
pub mod deposit;
pub mod draw;
pub mod emit;
pub mod escape;
pub mod generate;
pub mod intersect;
pub mod light;
pub mod look_up;
pub mod meet;
pub mod pass;
pub mod record;
pub mod scatter;
pub mod shade;
