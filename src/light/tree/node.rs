//! Nodes of a light tree and their importance for a receiver.
//!
//! References: as for the [tree](super).

use glam::{DVec3, Vec3};

use super::cluster::Cluster;
use crate::math::columns::columns;
use crate::math::kernel::Kernel;

/// A cluster and what is below it.
#[derive(Clone, Copy)]
pub struct LightTreeNode {
    /// The cluster.
    pub cluster: NarrowCluster,
    /// Emitters below it.
    pub subtree: Subtree,
}

columns! {
    /// A cluster in f32: the cost of a choice is that of reading nodes, and every rounding makes the cluster larger.
    pub struct NarrowCluster => NarrowClusterBlock {
        /// Middle of a sphere around the bounds, relative to the tree's origin.
        middle: Vec3,
        /// Radius of that sphere.
        radius: f32,
        /// Axis of the cone of normals, unit.
        axis: Vec3,
        /// Cosine of its half-angle.
        cos_normals: f32,
        /// Sine of its half-angle.
        sin_normals: f32,
        /// Cosine of the largest angle to a normal at which light leaves.
        cos_emission: f32,
        /// Relative to the brightest emitter's, positive.
        power: f32,
        /// True if backs emit, too.
        both_sides: bool,
    }
}

/// Emitters below a node.
#[derive(Clone, Copy)]
pub enum Subtree {
    /// One emitter, by index.
    Emitter(u32),
    /// Two nodes, by the index of the first.
    Pair(u32),
}

/// The only side of a surface that is lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitSide {
    /// Unit normal.
    pub normal: DVec3,
    /// Share of light that comes head-on for which light that grazes it counts.
    pub grazing: f32,
}

impl LitSide {
    /// Side for which light counts by its cosine.
    pub fn flat(normal: DVec3) -> Self {
        Self { normal, grazing: 0.0 }
    }
}

columns! {
    /// Receiver of light, relative to the tree's origin.
    pub struct LocalReceiver => LocalReceiverBlock {
        /// Position.
        x: DVec3,
        /// Unit normal on the side that is lit; 0 if there is no surface, or one unknown.
        normal: DVec3,
        /// Least factor for the angle to it; 1 if there is none.
        grazing: f64,
    }
}

columns! {
    /// Probabilities of two siblings; not numbers if neither can contribute.
    pub struct Chances => ChancesBlock {
        /// Of the first.
        left: f64,
        /// Of the second.
        right: f64,
    }
}

impl Chances {
    /// Those of siblings by their importance.
    #[inline(always)]
    fn of(left: f64, right: f64) -> Self {
        let sum = left + right;
        Self { left: left / sum, right: right / sum }
    }
}

/// Two siblings, as the kernel of the choice between them.
pub struct Siblings<'a> {
    /// The clusters.
    pub clusters: [&'a NarrowCluster; 2],
    /// Least factor of each orientation.
    pub floor: f64,
}

impl Kernel for Siblings<'_> {
    type A = LocalReceiver;
    type B = ();
    type Out = Chances;

    #[inline(always)]
    fn run(&self, receiver: &LocalReceiver, (): &()) -> Chances {
        // Written out: a closure over both would be called, and lanes would not run side by side.
        let [left, right] = self.clusters;
        Chances::of(left.importance(receiver, self.floor), right.importance(receiver, self.floor))
    }
}

columns! {
    /// Importance of a cluster for a receiver.
    pub struct Importance => ImportanceBlock {
        /// Finite and at least 0.
        value: f64,
    }
}

impl Importance {
    /// Chances of siblings of these importances.
    #[inline(always)]
    pub fn chances([left, right]: [Importance; 2]) -> Chances {
        Chances::of(left.value, right.value)
    }
}

/// Kernel that finds the importance of a cluster for a receiver.
pub struct Weighing {
    /// Least factor of each orientation.
    pub floor: f64,
}

impl Kernel for Weighing {
    type A = LocalReceiver;
    type B = NarrowCluster;
    type Out = Importance;

    #[inline(always)]
    fn run(&self, receiver: &LocalReceiver, cluster: &NarrowCluster) -> Importance {
        Importance { value: cluster.importance(receiver, self.floor) }
    }
}

/// Cosines of a node are this inexact: its axis and angles are rounded.
pub(super) const COSINE_ERROR: f64 = 1e-6;
/// A cluster's distance is at least this much of its radius: within it, its middle says little about where its emitters
/// are. 1/3 measures best of 1 (half the diagonal), 1/√2, 1/√3, 1/3 and 1/√30: among 10 000 small triangles in a cube,
/// in a wall, or on 200 spheres the variance is 9, 5 and 3 times lower than with 1.
const NEAREST: f64 = 1.0 / 3.0;
/// Squared distances below this are taken for it, so that the importance of a point stays finite at the point.
const SMALLEST_SQUARE: f64 = 1e-60;

impl NarrowCluster {
    /// A cluster relative to the middle of everything.
    pub fn new(cluster: &Cluster, origin: DVec3) -> Self {
        let &Cluster { min, max, power, cone } = cluster;
        let exact = 0.5 * min + 0.5 * max - origin;
        let middle = exact.as_vec3();
        let radius = 0.5 * min.distance(max) + exact.distance(middle.as_dvec3());
        let cos_normals = down(libm::cos(cone.normals)).max(-1.0);
        Self {
            middle,
            radius: -down(-radius),
            axis: cone.axis.as_vec3(),
            cos_normals,
            sin_normals: (1.0 - cos_normals * cos_normals).sqrt(),
            cos_emission: down(libm::cos(cone.emission)),
            power: (power as f32).max(f32::MIN_POSITIVE),
            both_sides: cone.both_sides,
        }
    }

    /// Importance \[C, P\], finite and at least 0; 0 only where nothing in the cluster can contribute.
    ///
    /// Choices are factors and bounds: as choices of what is computed they would become branches.
    #[inline(always)]
    fn importance(&self, receiver: &LocalReceiver, floor: f64) -> f64 {
        let from = receiver.x - self.middle.as_dvec3();
        let (square, radius2) = (from.length_squared(), f64::from(self.radius) * f64::from(self.radius));
        let intensity = f64::from(self.power) / square.max(NEAREST * NEAREST * radius2).max(SMALLEST_SQUARE);
        // Roots of squares, none of another root: half the time of a choice is the wait for them.
        let inverse2 = square.recip();
        let inverse = inverse2.sqrt();
        let sin2 = (radius2 * inverse2).min(1.0);
        let subtended = Angle { cos: (1.0 - sin2).max(0.0).sqrt(), sin: sin2.sqrt() };
        let to = |unit: DVec3, both_ways: bool| {
            let along = unit.dot(from);
            let along = if both_ways { along.abs() } else { along };
            let sin2 = 1.0 - along * along * inverse2;
            Angle { cos: along * inverse, sin: sin2.max(0.0).sqrt() }
        };
        let normals = Angle { cos: self.cos_normals.into(), sin: self.sin_normals.into() };
        let cos = to(self.axis.as_dvec3(), self.both_sides).less(normals).less(subtended).cos;
        let one_if = |yes: bool| if yes { 1.0 } else { 0.0 };
        let shines = cos > f64::from(self.cos_emission) - COSINE_ERROR;
        let emitted = one_if(shines) * cos.max(COSINE_ERROR);
        let cos = to(-receiver.normal, false).less(subtended).cos;
        let received = one_if(cos > -COSINE_ERROR) * cos.max(receiver.grazing);
        let oriented = emitted.max(floor) * received.max(floor);
        intensity * oriented.max(one_if(square <= radius2))
    }
}

/// An angle in [0, π].
#[derive(Clone, Copy)]
struct Angle {
    cos: f64,
    sin: f64,
}

impl Angle {
    /// The difference, at least 0.
    #[inline(always)]
    fn less(self, other: Angle) -> Angle {
        let cos = self.cos * other.cos + self.sin * other.sin;
        let sin = self.sin * other.cos - self.cos * other.sin;
        let (least, share) = if self.cos >= other.cos { (1.0, 0.0) } else { (-1.0, 1.0) };
        Angle { cos: cos.max(least), sin: share * sin }
    }
}

/// The nearest f32 that is not above `v`.
fn down(v: f64) -> f32 {
    let narrow = v as f32;
    if f64::from(narrow) > v { narrow.next_down() } else { narrow }
}
