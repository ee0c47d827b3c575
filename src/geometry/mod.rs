//! Primitives, their intersection with segments of rays, and the BVH over them.
//!
//! The files `sphere`, `triangle` and `disk` each hold one intersection with a line and one with an arc; [`Segment`] is
//! what the BVH asks of either.
//!
#![doc = include_str!("search.md")]

mod attributes;
mod build;
mod bvh;
mod coincident;
mod cross_section;
mod cull;
mod disk;
mod distance;
mod facets;
mod found;
mod line;
mod mesh;
mod mesh_point;
mod nearest;
mod primitives;
mod query;
mod scene;
mod search;
mod segment;
mod shape;
mod shortlist;
mod skim;
mod small_scene;
mod smooth;
mod sphere;
mod triangle;
mod vertex_normals;

pub use attributes::Attributes;
pub use cross_section::{CrossSection, Plane};
pub use found::{Finds, Found};
pub use line::Line;
pub use mesh::{Instance, Mesh};
pub use mesh_point::MeshPoint;
pub use primitives::{Disk, Primitives, Sphere, Surface};
pub use query::{Need, Query, Sought};
use scene::SharedMesh;
pub use scene::{Counts, Geometry, Hit, PrimitiveId, SupportingSurface, SurfacePoint};
pub use search::Search;
pub use segment::{Chord, Segment};
pub use shape::Shape;
pub use skim::Skim;
pub use small_scene::SideBySide;
pub use smooth::SurfacesMet;
pub use triangle::Triangle;
