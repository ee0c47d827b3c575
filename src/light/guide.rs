//! Guide: directions of light through mirrors and glass, learned from photons.
//!
//! No formula aims a ray through glass at a lamp. Photons know: they are sent out by the lamps, and where one lands
//! after mirrors and glass, light from there came back the same way. Photons that came the same way to the same
//! neighbourhood are summed up by a lobe of directions, whose middle moves with the place: a linear fit; or by several
//! where they come from several directions, as under a ball of glass, whose caustics cross. A ray chosen from these lobes
//! has a density known in closed form, so that light found with it can be shared with light found by BSDF sampling, however
//! well or badly the lobes fit.
//!
//! Reference for guiding by photons: Jensen 1995, "Importance Driven Path Tracing using the Photon Map".

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::{DMat2, DVec2, DVec3};

use crate::math::concentric::concentric;
use crate::math::frame::tangents;
use crate::math::rescale::rescale;
use crate::math::sin_cos_turns;
use crate::spacetime::Side;

/// A photon where it landed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// Side of a wormhole on which it landed.
    pub side: Side,
    /// World position.
    pub position: DVec3,
    /// Unit normal on the side that it came from.
    pub normal: DVec3,
    /// Unit direction in which it is looked back at.
    pub direction: DVec3,
    /// The way that it came: its emitter, what it met, where it landed. `None` if it came straight from the emitter.
    pub way: Option<u64>,
}

/// Directions of light through mirrors and glass, by place.
#[derive(Clone, Debug, Default)]
pub struct Guide {
    nodes: Vec<GuideNode>,
    leaves: Vec<GuideLeaf>,
    lobes: Vec<GuideLobe>,
}

/// A node of a k-d tree.
#[derive(Clone, Copy, Debug)]
enum GuideNode {
    /// Below `at` along `axis` the next node, else the node `above`.
    Split { axis: usize, at: f64, above: u32 },
    /// An index into the leaves.
    Leaf(u32),
}

/// A neighbourhood.
#[derive(Clone, Copy, Debug)]
struct GuideLeaf {
    /// Middle of its photons.
    middle: DVec3,
    /// Distance from the middle at which the lobes are not to be trusted.
    reach: f64,
    /// Its lobes.
    first: u32,
    count: u32,
    /// Share of light samples that are to go through mirrors and glass.
    share: f64,
}

/// A lobe of directions.
#[derive(Clone, Copy, Debug)]
struct GuideLobe {
    /// Share of the leaf's light.
    weight: f64,
    /// Centre of the fit.
    origin: DVec3,
    /// Unit vectors in the surface.
    across: [DVec3; 2],
    /// The mean direction, unit, and two unit vectors across it: directions are given by where they meet the plane at
    /// unit distance.
    axis: DVec3,
    plane: [DVec3; 2],
    /// The middle of the lobe there, at the origin.
    middle: DVec2,
    /// Gradient of the middle over places.
    gradient: DMat2,
    /// A disk of radius 1 → the lobe's size and shape: lower triangular.
    shape: DMat2,
}

/// Most photons of a leaf.
const LEAF: usize = 96;
/// Photons below which a lobe's middle is not fitted but taken as constant.
const FEWEST_TO_FIT: usize = 6;
/// Least gain of two lobes over one, in the mean logarithm of the density of their photons.
const GAIN: f64 = 0.3;
/// Size of a lobe relative to the deviation of its photons: an even disk has a radius of two deviations, and most of the
/// lobe should be within.
const SIZE: f64 = 2.5;
/// Smallest size of a lobe, radians.
const SMALLEST: f64 = 1e-4;
/// Size of the lobe of a single photon, radians.
const LONELY: f64 = 0.05;
/// Shares of light samples that go through mirrors and glass where they can, at least and at most.
const SHARES: (f64, f64) = (0.05, 0.6);
/// Weight of light through mirrors and glass beside direct light: it is found less surely.
const CAUTION: f64 = 1.5;

impl Guide {
    /// Learns from `photons`, of which one that came through mirrors or glass stands for the light of `weight` of the others;
    /// `None` if none did.
    pub fn new(photons: &[Photon], weight: f64) -> Option<Self> {
        let mut specular: Vec<Photon> =
            photons.iter().filter(|photon| photon.way.is_some()).copied().collect();
        if specular.is_empty() {
            return None;
        }
        let mut guide = Self::default();
        let mut counts = Vec::new();
        guide.split(&mut specular, &mut counts);
        let mut direct = vec![0usize; guide.leaves.len()];
        for photon in photons.iter().filter(|photon| photon.way.is_none()) {
            if let Some(leaf) = guide.leaf_index(photon.position) {
                direct[leaf] += 1;
            }
        }
        for ((leaf, specular), direct) in guide.leaves.iter_mut().zip(counts).zip(direct) {
            let specular = CAUTION * weight * specular as f64;
            leaf.share = (specular / (specular + direct as f64)).clamp(SHARES.0, SHARES.1);
        }
        Some(guide)
    }

    /// Neighbourhood of `x`; `None` if no photon landed near it.
    pub fn around(&self, x: DVec3) -> Option<Neighbourhood<'_>> {
        let leaf = self.leaves[self.leaf_index(x)?];
        let lobes = &self.lobes[leaf.first as usize..][..leaf.count as usize];
        Some(Neighbourhood { share: leaf.share, lobes })
    }

    /// The leaf around `x`, if its photons are near.
    fn leaf_index(&self, x: DVec3) -> Option<usize> {
        let mut node = 0;
        loop {
            match self.nodes[node] {
                GuideNode::Split { axis, at, above } => {
                    // Not by a branch: both ways are as likely.
                    node = [above as usize, node + 1][usize::from(x[axis] < at)];
                }
                GuideNode::Leaf(leaf) => {
                    let GuideLeaf { middle, reach, .. } = self.leaves[leaf as usize];
                    return (x.distance_squared(middle) <= reach * reach).then_some(leaf as usize);
                }
            }
        }
    }

    /// Appends the tree of `photons`, and the number of each leaf's photons to `counts`.
    fn split(&mut self, photons: &mut [Photon], counts: &mut Vec<usize>) {
        let (low, high) =
            photons.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), photon| {
                (low.min(photon.position), high.max(photon.position))
            });
        let axis = (high - low).max_position();
        if photons.len() <= LEAF || low[axis] == high[axis] {
            counts.push(photons.len());
            self.nodes.push(GuideNode::Leaf(self.leaves.len() as u32));
            self.add_leaf(photons, 0.5 * (low + high), low.distance(high));
            return;
        }
        let middle = photons.len() / 2;
        let order = |a: &Photon, b: &Photon| a.position[axis].total_cmp(&b.position[axis]);
        let at = photons.select_nth_unstable_by(middle, order).1.position[axis];
        let node = self.nodes.len();
        self.nodes.push(GuideNode::Leaf(0));
        let (below, above) = photons.split_at_mut(middle);
        self.split(below, counts);
        self.nodes[node] = GuideNode::Split { axis, at, above: self.nodes.len() as u32 };
        self.split(above, counts);
    }

    fn add_leaf(&mut self, photons: &[Photon], middle: DVec3, diagonal: f64) {
        let mut ways: BTreeMap<Option<u64>, Vec<&Photon>> = BTreeMap::new();
        for photon in photons {
            ways.entry(photon.way).or_default().push(photon);
        }
        let first = self.lobes.len() as u32;
        for way in ways.values() {
            if let Some(lobe) = GuideLobe::fit(way, way.len() as f64 / photons.len() as f64) {
                self.add_lobes(lobe, way);
            }
        }
        let count = self.lobes.len() as u32 - first;
        self.leaves.push(GuideLeaf { middle, reach: diagonal, first, count, share: 0.0 });
    }

    /// Appends the lobe of photons that came the same way, or those of parts of them.
    fn add_lobes(&mut self, lobe: GuideLobe, photons: &[&Photon]) {
        let Some(halves) = lobe.halves(photons) else { return self.lobes.push(lobe) };
        for (lobe, photons) in halves {
            self.add_lobes(lobe, &photons);
        }
    }
}

/// Directions of light through mirrors and glass in a neighbourhood.
#[derive(Clone, Copy, Debug)]
pub struct Neighbourhood<'a> {
    /// Share of light samples that are to be taken from here.
    pub share: f64,
    lobes: &'a [GuideLobe],
}

impl Neighbourhood<'_> {
    /// A unit direction at `x` and its density in solid angle, from two numbers in [0, 1).
    pub fn sample(&self, x: DVec3, [u, v]: [f64; 2]) -> Option<(DVec3, f64)> {
        let mut below = 0.0;
        let lobe = self.lobes.iter().find(|lobe| {
            let is_chosen = u < below + lobe.weight;
            below += if is_chosen { 0.0 } else { lobe.weight };
            is_chosen
        });
        // Weights add up to 1 but for rounding.
        let lobe = lobe.or(self.lobes.last())?;
        let direction = lobe.sample(x, rescale(u, below, lobe.weight), v);
        let density = self.density(x, direction);
        (density > 0.0).then_some((direction, density))
    }

    /// Density of a unit direction at `x`.
    pub fn density(&self, x: DVec3, direction: DVec3) -> f64 {
        self.lobes.iter().map(|lobe| lobe.weight * lobe.density(x, direction)).sum()
    }
}

impl GuideLobe {
    /// The lobe of photons that came the same way; `None` if they come from all around.
    fn fit(photons: &[&Photon], weight: f64) -> Option<Self> {
        let count = photons.len() as f64;
        let mean =
            |f: &dyn Fn(&Photon) -> DVec3| photons.iter().map(|photon| f(photon)).sum::<DVec3>() / count;
        let origin = mean(&|photon| photon.position);
        let axis = mean(&|photon| photon.direction).try_normalize()?;
        let (t1, t2) = tangents(mean(&|photon| photon.normal).try_normalize()?);
        let (e1, e2) = tangents(axis);
        let mut lobe = Self {
            weight,
            origin,
            across: [t1, t2],
            axis,
            plane: [e1, e2],
            middle: DVec2::ZERO,
            gradient: DMat2::ZERO,
            shape: DMat2::from_diagonal(DVec2::splat(LONELY)),
        };
        let points: Vec<(DVec2, DVec2)> = photons
            .iter()
            .filter_map(|photon| Some((lobe.place(photon.position), lobe.project(photon.direction)?.0)))
            .collect();
        if points.len() < 2 {
            return Some(lobe);
        }
        let used = points.len() as f64;
        lobe.middle = points.iter().map(|(_, y)| y).sum::<DVec2>() / used;
        if points.len() >= FEWEST_TO_FIT {
            lobe.gradient = slope(&points, lobe.middle);
        }
        let mut scatter = DMat2::ZERO;
        for (p, y) in &points {
            let off = y - lobe.middle - lobe.gradient * p;
            scatter += DMat2::from_cols(off.x * off, off.y * off);
        }
        let freedom = if points.len() >= FEWEST_TO_FIT { used - 3.0 } else { used - 1.0 };
        lobe.shape = root(scatter * (SIZE * SIZE / freedom), SMALLEST);
        Some(lobe)
    }

    /// Its photons on either side of the middle, across where the lobe is longest, with a lobe of each; `None` if these would
    /// hardly be denser.
    fn halves<'a>(&self, photons: &[&'a Photon]) -> Option<[(Self, Vec<&'a Photon>); 2]> {
        let across = longest_axis(self.shape);
        let is_below = |photon: &&Photon| {
            self.project(photon.direction).is_some_and(|(y, _)| (y - self.middle).dot(across) < 0.0)
        };
        let (below, above) = photons.iter().copied().partition::<Vec<_>, _>(is_below);
        let mut gain = libm::log(self.shape.determinant());
        let mut half = |part: Vec<&'a Photon>| {
            if part.len() < FEWEST_TO_FIT {
                return None;
            }
            let share = part.len() as f64 / photons.len() as f64;
            let lobe = Self::fit(&part, self.weight * part.len() as f64 / photons.len() as f64)?;
            gain -= share * libm::log(lobe.shape.determinant() / share);
            Some((lobe, part))
        };
        let halves = [half(below)?, half(above)?];
        (gain > GAIN).then_some(halves)
    }

    /// A place in the surface, relative to the origin.
    fn place(&self, x: DVec3) -> DVec2 {
        let offset = x - self.origin;
        DVec2::new(offset.dot(self.across[0]), offset.dot(self.across[1]))
    }

    /// A direction on the plane, and its cosine to the axis; `None` where it does not meet the plane.
    fn project(&self, direction: DVec3) -> Option<(DVec2, f64)> {
        let cos = direction.dot(self.axis);
        let point = DVec2::new(direction.dot(self.plane[0]), direction.dot(self.plane[1]));
        (cos > 1e-3).then(|| (point / cos, cos))
    }

    fn middle_at(&self, x: DVec3) -> DVec2 {
        self.middle + self.gradient * self.place(x)
    }

    /// A direction at a distance t from the middle, in lobe sizes, whose density falls as 1/(1 + t²)³: three quarters of all
    /// are within 1, and none is out of reach.
    fn sample(&self, x: DVec3, u: f64, v: f64) -> DVec3 {
        let [square, turns] = concentric(u, v);
        let t = (1.0 / (1.0 - square).sqrt() - 1.0).sqrt();
        let (sin, cos) = sin_cos_turns::sin_cos(turns);
        let y = self.middle_at(x) + self.shape * (t * DVec2::new(cos, sin));
        (self.axis + y.x * self.plane[0] + y.y * self.plane[1]).normalize()
    }

    /// Density of [`Self::sample`] in solid angle.
    fn density(&self, x: DVec3, direction: DVec3) -> f64 {
        let Some((y, cos)) = self.project(direction) else { return 0.0 };
        let off = y - self.middle_at(x);
        let (a, b, c) = (self.shape.x_axis.x, self.shape.x_axis.y, self.shape.y_axis.y);
        let first = off.x / a;
        let t2 = first * first + ((off.y - b * first) / c).powi(2);
        // dω = cos³ dy on the plane at unit distance.
        2.0 / (PI * a * c * (1.0 + t2) * (1.0 + t2) * (1.0 + t2) * cos * cos * cos)
    }
}

/// The matrix A for which y ≈ `middle` + A p in the least squares, held back where the places p hardly differ.
fn slope(points: &[(DVec2, DVec2)], middle: DVec2) -> DMat2 {
    let (mut pp, mut yp) = (DMat2::ZERO, DMat2::ZERO);
    for (p, y) in points {
        pp += DMat2::from_cols(p.x * p, p.y * p);
        yp += DMat2::from_cols(p.x * (y - middle), p.y * (y - middle));
    }
    let ridge = 1e-3 * (pp.x_axis.x + pp.y_axis.y);
    let solved = yp * (pp + DMat2::from_diagonal(DVec2::splat(ridge))).inverse();
    if solved.is_finite() { solved } else { DMat2::ZERO }
}

/// The lower triangular root of a covariance, no axis shorter than `smallest`.
fn root(covariance: DMat2, smallest: f64) -> DMat2 {
    let a = covariance.x_axis.x.sqrt().max(smallest);
    let b = covariance.x_axis.y / a;
    let c = (covariance.y_axis.y - b * b).max(0.0).sqrt().max(smallest);
    DMat2::from_cols(DVec2::new(a, b), DVec2::new(0.0, c))
}

/// Unit vector along the longest axis of the ellipse that a matrix makes of a circle.
fn longest_axis(shape: DMat2) -> DVec2 {
    let squared = shape * shape.transpose();
    let half = 0.5 * (squared.x_axis.x - squared.y_axis.y);
    let root = libm::hypot(half, squared.x_axis.y);
    let axis = if half > 0.0 {
        DVec2::new(half + root, squared.x_axis.y)
    } else {
        DVec2::new(squared.x_axis.y, root - half)
    };
    axis.try_normalize().unwrap_or(DVec2::X)
}
