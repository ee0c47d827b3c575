//! From emitters to a tree.

use glam::DVec3;
use rayon::prelude::*;

use super::Tree;
use super::cluster::Cluster;
use super::cone::Cone;
use super::emission::Emission;
use super::node::{LightTreeNode, NarrowCluster, Subtree};

/// Levels below the root, at most: a trail holds one bit for each and one that ends it.
const DEEPEST: u32 = u64::BITS - 1;
/// Intervals per axis between which splits are tried.
const BINS: usize = 12;
/// Clusters of more emitters than this are worth a thread of their own.
const MANY: usize = 4096;
/// Emitters of a cluster that are asked where to cut it, at most: among 40 000 small triangles in a cube, below a
/// ceiling, or on a bumpy sphere, the variance is the same for 32, 64, 1024 or all, within 5 %.
const SAMPLE: usize = 64;

impl Tree {
    /// Builds the tree over so many emitters, in the order in which `sample` and `probability` number them, on all
    /// threads.
    ///
    /// `emission` tells of each; it is asked again and again, as a list of the answers would be larger than the tree.
    /// `floor` in [0, 1]: least orientation factor, relative to head-on. 0 in flat space, where an emitter that faces
    /// away gives nothing; positive in curved space, where light bends and the straight direction is a guess.
    ///
    /// Emitters without power are never chosen. Numbers are finite, distances within f32's range.
    pub fn build(count: u32, emission: impl Fn(u32) -> Emission + Sync, floor: f64) -> Self {
        let shining = || {
            let all = (0..count).into_par_iter().map(|emitter| (emitter, emission(emitter)));
            all.filter(|(_, emission)| emission.power > 0.0)
        };
        let extents = shining().map(|(_, Emission { min, max, power, .. })| (min, max, power));
        let whole = extents.reduce_with(|a, b| (a.0.min(b.0), a.1.max(b.1), a.2.max(b.2)));
        let mut tree = Tree {
            root: None,
            nodes: Vec::new(),
            polylines: vec![0; count as usize],
            origin: DVec3::ZERO,
            floor,
        };
        let Some((min, max, brightest)) = whole else { return tree };
        tree.origin = 0.5 * min + 0.5 * max;
        let mut origin_prim: Vec<Leaf> = shining()
            .map(|(emitter, Emission { min, max, .. })| Leaf { middle: 0.5 * min + 0.5 * max, emitter })
            .collect();
        let builder = Builder { emission, brightest, origin: tree.origin };
        // Every place is overwritten: a binary tree of n leaves has n − 1 pairs of children.
        let placeholder = LightTreeNode { cluster: NarrowCluster::default(), subtree: Subtree::Emitter(0) };
        tree.nodes = vec![placeholder; 2 * origin_prim.len() - 2];
        let (root, _) = builder.grow(&mut origin_prim, &mut tree.nodes, 0, 0);
        tree.root = Some(root);
        tree.lay_trails(root);
        tree
    }

    /// Writes down the way to every leaf.
    fn lay_trails(&mut self, root: Subtree) {
        let mut pending = vec![(root, 0, 0)];
        while let Some((subtree, way, depth)) = pending.pop() {
            match subtree {
                Subtree::Emitter(emitter) => self.polylines[emitter as usize] = way | 1 << depth,
                Subtree::Pair(first) => {
                    let child = |right: u32| self.nodes[(first + right) as usize].subtree;
                    pending.push((child(0), way, depth + 1));
                    pending.push((child(1), way | 1 << depth, depth + 1));
                }
            }
        }
    }
}

/// One emitter.
struct Leaf {
    /// Of its bounds.
    middle: DVec3,
    emitter: u32,
}

/// Source of all nodes.
struct Builder<E> {
    emission: E,
    /// Greatest power.
    brightest: f64,
    origin: DVec3,
}

impl<E: Fn(u32) -> Emission + Sync> Builder<E> {
    fn cluster(&self, leaf: &Leaf) -> Cluster {
        let emission = (self.emission)(leaf.emitter);
        let Emission { min, max, power, .. } = emission;
        Cluster { min, max, power: power / self.brightest, cone: Cone::new(&emission) }
    }

    /// Fills `nodes`, which start at index `at` of the tree, with all nodes below the one that holds `leaves`: first
    /// its two children, then what is below each.
    fn grow(
        &self,
        origin_prim: &mut [Leaf],
        nodes: &mut [LightTreeNode],
        at: u32,
        depth: u32,
    ) -> (Subtree, Cluster) {
        if let [leaf] = origin_prim {
            return (Subtree::Emitter(leaf.emitter), self.cluster(leaf));
        }
        let count = origin_prim.len();
        let cut = self.split(origin_prim, depth);
        let (left, right) = origin_prim.split_at_mut(cut);
        let (pair, below) = nodes.split_at_mut(2);
        let (below_left, below_right) = below.split_at_mut(2 * cut - 2);
        let (at_left, at_right) = (at + 2, at + 2 * cut as u32);
        let mut grow_left = || self.grow(left, below_left, at_left, depth + 1);
        let mut grow_right = || self.grow(right, below_right, at_right, depth + 1);
        let (left, right) =
            if count > MANY { rayon::join(grow_left, grow_right) } else { (grow_left(), grow_right()) };
        for (node, (subtree, cluster)) in pair.iter_mut().zip([left, right]) {
            *node = LightTreeNode { cluster: NarrowCluster::new(&cluster, self.origin), subtree };
        }
        (Subtree::Pair(at), left.1.union(right.1))
    }

    /// Puts at least two leaves in two parts, neither empty; how many are in the first.
    fn split(&self, origin_prim: &mut [Leaf], depth: u32) -> usize {
        // A split may leave all but one on one side, and from there halving must reach the leaves.
        let levels_left = DEEPEST - depth;
        let may_be_uneven = origin_prim.len() > 2 && log2_up(origin_prim.len() - 1) < levels_left;
        let (low, high) =
            origin_prim.iter().fold((origin_prim[0].middle, origin_prim[0].middle), |(low, high), leaf| {
                (low.min(leaf.middle), high.max(leaf.middle))
            });
        let cut = if may_be_uneven { self.cheapest_cut(origin_prim, low, high) } else { None };
        if let Some(cut) = cut {
            return partition(origin_prim, |leaf| cut.is_left(leaf));
        }
        let (half, axis) = (origin_prim.len() / 2, (high - low).max_position());
        origin_prim.select_nth_unstable_by(half, |a, b| a.middle[axis].total_cmp(&b.middle[axis]));
        half
    }

    /// The cheapest cut along any axis; `None` if all middles, within `low` and `high`, are in one place.
    fn cheapest_cut(&self, origin_prim: &[Leaf], low: DVec3, high: DVec3) -> Option<BinSplit> {
        let extent = high - low;
        let axes = [0, 1, 2].map(|axis| BinSplit {
            axis,
            low: low[axis],
            scale: BINS as f64 / extent[axis],
            first_right: 0,
        });
        let mut bins: [[Option<Cluster>; BINS]; 3] = [[None; BINS]; 3];
        for leaf in origin_prim.iter().step_by(origin_prim.len().div_ceil(SAMPLE)) {
            let cluster = self.cluster(leaf);
            for (bins, axis) in bins.iter_mut().zip(&axes).filter(|(_, cut)| extent[cut.axis] > 0.0) {
                let bin = &mut bins[axis.bin(leaf)];
                *bin = Some(bin.map_or(cluster, |bin| bin.union(cluster)));
            }
        }
        let mut best: Option<(f64, BinSplit)> = None;
        for (bins, axis) in bins.iter().zip(axes) {
            // [C]: thin slices of long clusters are not worth what their cones say.
            let slimness = extent.max_element() / extent[axis.axis];
            let Some((cost, first_right)) = cheapest_bins(bins) else { continue };
            if best.as_ref().is_none_or(|(least, _)| slimness * cost < *least) {
                best = Some((slimness * cost, BinSplit { first_right, ..axis }));
            }
        }
        best.map(|(_, cut)| cut)
    }
}

fn log2_up(n: usize) -> u32 {
    n.next_power_of_two().trailing_zeros()
}

/// Puts the leaves that `is_first` accepts before the others; how many they are.
fn partition(origin_prim: &mut [Leaf], is_first: impl Fn(&Leaf) -> bool) -> usize {
    let mut first = 0;
    for i in 0..origin_prim.len() {
        if is_first(&origin_prim[i]) {
            origin_prim.swap(first, i);
            first += 1;
        }
    }
    first
}

/// A cut between two bins along an axis.
struct BinSplit {
    axis: usize,
    low: f64,
    /// Bins per length.
    scale: f64,
    /// First bin of the right side.
    first_right: usize,
}

impl BinSplit {
    fn bin(&self, leaf: &Leaf) -> usize {
        (((leaf.middle[self.axis] - self.low) * self.scale) as usize).min(BINS - 1)
    }

    fn is_left(&self, leaf: &Leaf) -> bool {
        self.bin(leaf) < self.first_right
    }
}

/// The least sum of both sides' costs and the first bin of the right side; `None` if only one bin is filled.
fn cheapest_bins(bins: &[Option<Cluster>; BINS]) -> Option<(f64, usize)> {
    let mut right_costs = [None; BINS];
    let (mut right, mut right_cost) = (None, None);
    for i in (1..BINS).rev() {
        if let Some(bin) = bins[i] {
            let all = right.map_or(bin, |right| bin.union(right));
            (right, right_cost) = (Some(all), Some(all.cost()));
        }
        right_costs[i] = right_cost;
    }
    let mut best: Option<(f64, usize)> = None;
    let mut left: Option<Cluster> = None;
    for cut in 1..BINS {
        // After an empty bin the cut is the one before it again.
        let Some(bin) = bins[cut - 1] else { continue };
        let all = left.map_or(bin, |left| left.union(bin));
        left = Some(all);
        let Some(right_cost) = right_costs[cut] else { break };
        let cost = all.cost() + right_cost;
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, cut));
        }
    }
    best
}
