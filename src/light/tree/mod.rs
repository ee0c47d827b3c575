//! A tree over many emitters, from which one is chosen about as likely as it lights a point.
//!
//! References: \[C\] Conty Estevez, Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting",
//! HPG; \[P\] Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., 12.6.3.
//!
//! A cluster is known by a sphere around it, its power and the cone of its normals. From the root on, one of two
//! children is chosen by their importance: power × bound of both cosines / squared distance. As the cosines are bounds
//! over everything in the cluster, what can contribute along a straight line is never left out. A cluster may look as
//! if it could contribute where none of its emitters does; the choice then ends without an emitter.

mod build;
mod cone;
#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};

use build::Cluster;

/// What the tree knows of one emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Least corner of the world bounds.
    pub min: DVec3,
    /// Greatest corner of the world bounds.
    pub max: DVec3,
    /// Radiant power, any unit, not negative.
    pub power: f64,
    /// Unit vector in the middle of the normals.
    pub axis: DVec3,
    /// Cosine of the half-angle of the cone of normals around the axis; −1: all directions, as of a sphere.
    pub cos_normals: f64,
    /// Cosine of the half-angle around each normal into which it emits, in [0, 1]; 0: a hemisphere, as of a Lambertian
    /// emitter.
    pub cos_emission: f64,
    /// Whether it emits against its normals as well.
    pub both_sides: bool,
}

/// A binary tree of emitters.
#[derive(Default)]
pub struct Tree {
    /// `None` if no emitter has power.
    root: Option<Link>,
    /// Everything but the root, which is never compared with anything. Siblings are neighbours: they are read together.
    nodes: Vec<Node>,
    /// Of each emitter, the way from the root: the lowest bit is the first turn, 1 is right, and the highest bit set
    /// ends it. 0 for an emitter that is not in the tree.
    trails: Vec<u64>,
    /// The middle of everything, to which nodes are relative: f32 is then fine enough far from the world's origin too.
    origin: DVec3,
    floor: f64,
}

/// A cluster in f32: the cost of a choice is that of reading nodes, and every rounding makes the cluster larger.
#[derive(Clone, Copy)]
struct Node {
    /// Sphere around the bounds.
    middle: Vec3,
    radius: f32,
    axis: Vec3,
    cos_normals: f32,
    sin_normals: f32,
    cos_emission: f32,
    /// Relative to the brightest emitter's, positive.
    power: f32,
    link: Link,
    both_sides: bool,
}

/// What a node stands for.
#[derive(Clone, Copy)]
enum Link {
    /// One emitter, by index.
    Emitter(u32),
    /// Two nodes, by the index of the first.
    Pair(u32),
}

/// Where light is wanted, relative to the tree's origin.
struct Receiver {
    x: DVec3,
    normal: Option<DVec3>,
}

/// Cosines of a node are this inexact: its axis and angles are rounded.
const COSINE_ERROR: f64 = 1e-6;
/// A cluster's distance is at least this much of its radius: within it, its middle says little about where its emitters
/// are. 1/3 measures best of 1 (half the diagonal), 1/√2, 1/√3, 1/3 and 1/√30: among 10 000 small triangles in a cube,
/// in a wall, or on 200 spheres the variance is 9, 5 and 3 times lower than with 1.
const NEAREST: f64 = 1.0 / 3.0;
/// Squared distances below this are taken for it, so that the importance of a point stays finite at the point.
const SMALLEST_SQUARE: f64 = 1e-60;

impl Tree {
    /// Chooses an emitter for light at `x` on the side of a surface to which the unit `normal` points (`None`: no
    /// surface, or one unknown) by `u` in [0, 1): the emitter's index, its probability, and `u` rescaled to [0, 1) for reuse.
    ///
    /// `None` if nothing can contribute, or nothing in the cluster that was chosen: zero is then an unbiased estimate.
    /// With a positive floor an emitter is always found if there is one.
    pub fn sample(&self, x: DVec3, normal: Option<DVec3>, mut u: f64) -> Option<(u32, f64, f64)> {
        let receiver = self.receiver(x, normal);
        let (mut link, mut probability) = (self.root?, 1.0);
        loop {
            let first = match link {
                Link::Emitter(emitter) => return Some((emitter, probability, u)),
                Link::Pair(first) => first,
            };
            let [left, right] = self.chances(first, &receiver)?;
            let goes_right = u >= left;
            let (below, chance) = if goes_right { (left, 1.0 - left) } else { (0.0, left) };
            u = ((u - below) / chance).min(1f64.next_down());
            probability *= if goes_right { right } else { left };
            link = self.nodes[first as usize + usize::from(goes_right)].link;
        }
    }

    /// The probability with which `sample` chooses `emitter`, the same to the last bit; 0 if it is none of the tree's.
    pub fn probability(&self, emitter: u32, x: DVec3, normal: Option<DVec3>) -> f64 {
        let receiver = self.receiver(x, normal);
        let mut trail = self.trails.get(emitter as usize).copied().unwrap_or(0);
        let Some(mut link) = self.root.filter(|_| trail != 0) else { return 0.0 };
        let mut probability = 1.0;
        while let Link::Pair(first) = link {
            let Some(chances) = self.chances(first, &receiver) else { return 0.0 };
            let turn = (trail & 1) as usize;
            probability *= chances[turn];
            link = self.nodes[first as usize + turn].link;
            trail >>= 1;
        }
        probability
    }

    /// Whether no emitter has power.
    pub fn is_empty(&self) -> bool {
        self.root.is_none()
    }

    fn receiver(&self, x: DVec3, normal: Option<DVec3>) -> Receiver {
        Receiver { x: x - self.origin, normal }
    }

    /// Probabilities of two siblings; `None` if neither can contribute.
    #[inline]
    fn chances(&self, first: u32, receiver: &Receiver) -> Option<[f64; 2]> {
        let first = first as usize;
        let importances = [first, first + 1].map(|i| self.nodes[i].importance(receiver, self.floor));
        let sum = importances[0] + importances[1];
        (sum > 0.0).then(|| importances.map(|importance| importance / sum))
    }
}

impl Node {
    fn new(cluster: &Cluster, origin: DVec3, link: Link) -> Self {
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
            link,
            both_sides: cone.both_sides,
        }
    }

    /// Importance \[C, P\], finite and at least 0; 0 only where nothing in the cluster can contribute.
    #[inline]
    fn importance(&self, receiver: &Receiver, floor: f64) -> f64 {
        let from = receiver.x - self.middle.as_dvec3();
        let (square, radius2) = (from.length_squared(), f64::from(self.radius) * f64::from(self.radius));
        let intensity = f64::from(self.power) / square.max(NEAREST * NEAREST * radius2).max(SMALLEST_SQUARE);
        if square <= radius2 {
            return intensity;
        }
        // Roots of squares, none of another root: half the time of a choice is the wait for them.
        let inverse2 = square.recip();
        let inverse = inverse2.sqrt();
        let sin2 = radius2 * inverse2;
        let subtended = Angle { cos: (1.0 - sin2).max(0.0).sqrt(), sin: sin2.sqrt() };
        let to = |unit: DVec3, both_ways: bool| {
            let along = unit.dot(from);
            let along = if both_ways { along.abs() } else { along };
            let sin2 = 1.0 - along * along * inverse2;
            Angle { cos: along * inverse, sin: sin2.max(0.0).sqrt() }
        };
        let normals = Angle { cos: self.cos_normals.into(), sin: self.sin_normals.into() };
        let cos = to(self.axis.as_dvec3(), self.both_sides).less(normals).less(subtended).cos;
        let shines = cos > f64::from(self.cos_emission) - COSINE_ERROR;
        let emitted = if shines { cos.max(COSINE_ERROR) } else { 0.0 };
        let received = match receiver.normal {
            Some(normal) => {
                let cos = to(-normal, false).less(subtended).cos;
                if cos > -COSINE_ERROR { cos.max(COSINE_ERROR) } else { 0.0 }
            }
            None => 1.0,
        };
        intensity * emitted.max(floor) * received.max(floor)
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
    #[inline]
    fn less(self, other: Angle) -> Angle {
        let cos = self.cos * other.cos + self.sin * other.sin;
        let sin = self.sin * other.cos - self.cos * other.sin;
        // Two choices of numbers, not one of ways: which it is cannot be predicted.
        let smaller = self.cos >= other.cos;
        Angle { cos: if smaller { 1.0 } else { cos }, sin: if smaller { 0.0 } else { sin } }
    }
}

/// The nearest f32 that is not above `v`.
fn down(v: f64) -> f32 {
    let narrow = v as f32;
    if f64::from(narrow) > v { narrow.next_down() } else { narrow }
}
