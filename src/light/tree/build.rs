//! From emitters to a tree.

use glam::DVec3;

use super::cone::Cone;
use super::{Emission, Link, Node, Tree};

/// Levels below the root, at most: a trail holds one bit for each and one that ends it.
const DEEPEST: u32 = u64::BITS - 1;
/// Intervals per axis between which splits are tried.
const BINS: usize = 12;
/// Clusters of more emitters than this are worth a thread of their own.
const MANY: usize = 4096;

impl Tree {
    /// Builds the tree over emitters in the order in which `sample` and `probability` number them, on all threads.
    ///
    /// `floor` in [0, 1]: least orientation factor, relative to head-on. 0 in flat space, where an emitter that faces
    /// away gives nothing; positive in curved space, where light bends and the straight direction is a guess.
    ///
    /// Emitters without power are never chosen. Numbers are finite, distances within f32's range.
    pub fn build(emissions: &[Emission], floor: f64) -> Self {
        let brightest = emissions.iter().map(|emission| emission.power).fold(0.0, f64::max);
        let shining = emissions.iter().zip(0..).filter(|(emission, _)| emission.power > 0.0);
        let mut leaves: Vec<Leaf> = shining.map(|(emission, i)| Leaf::new(emission, brightest, i)).collect();
        let mut tree = Tree {
            root: None,
            nodes: Vec::new(),
            trails: vec![0; emissions.len()],
            origin: DVec3::ZERO,
            floor,
        };
        let Some(first) = leaves.first() else { return tree };
        let (min, max) = leaves.iter().fold((first.cluster.min, first.cluster.max), |(min, max), leaf| {
            (min.min(leaf.cluster.min), max.max(leaf.cluster.max))
        });
        tree.origin = 0.5 * min + 0.5 * max;
        // Every place is overwritten: a binary tree of n leaves has n − 1 pairs of children.
        let placeholder = Node::new(&first.cluster, tree.origin, Link::Emitter(0));
        tree.nodes = vec![placeholder; 2 * leaves.len() - 2];
        let (root, _) = grow(&mut leaves, &mut tree.nodes, 0, 0, tree.origin);
        tree.root = Some(root);
        tree.lay_trails(root);
        tree
    }

    /// Writes down the way to every leaf.
    fn lay_trails(&mut self, root: Link) {
        let mut pending = vec![(root, 0, 0)];
        while let Some((link, way, depth)) = pending.pop() {
            match link {
                Link::Emitter(emitter) => self.trails[emitter as usize] = way | 1 << depth,
                Link::Pair(first) => {
                    let child = |right: u32| self.nodes[(first + right) as usize].link;
                    pending.push((child(0), way, depth + 1));
                    pending.push((child(1), way | 1 << depth, depth + 1));
                }
            }
        }
    }
}

/// Emitters seen as one.
#[derive(Clone, Copy)]
pub struct Cluster {
    /// World bounds.
    pub min: DVec3,
    /// World bounds.
    pub max: DVec3,
    /// Power relative to the brightest emitter's.
    pub power: f64,
    /// Where it shines.
    pub cone: Cone,
}

impl Cluster {
    fn union(self, other: Cluster) -> Cluster {
        Cluster {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            power: self.power + other.power,
            cone: self.cone.union(other.cone),
        }
    }

    /// How often it is in doubt, times what is at stake: the surface-area-orientation heuristic of \[C\], with
    /// the area of the sphere around the bounds, which is all that the importance knows of them. (A box around emitters
    /// in a row has no area.)
    fn cost(&self) -> f64 {
        self.power * self.min.distance_squared(self.max) * self.cone.measure()
    }
}

/// One emitter.
struct Leaf {
    cluster: Cluster,
    middle: DVec3,
    emitter: u32,
}

impl Leaf {
    fn new(emission: &Emission, brightest: f64, emitter: u32) -> Self {
        let &Emission { min, max, power, .. } = emission;
        let cluster = Cluster { min, max, power: power / brightest, cone: Cone::new(emission) };
        Self { cluster, middle: 0.5 * min + 0.5 * max, emitter }
    }
}

/// Fills `nodes`, which start at index `at` of the tree, with all nodes below the one that holds `leaves`: first its
/// two children, then what is below each.
fn grow(leaves: &mut [Leaf], nodes: &mut [Node], at: u32, depth: u32, origin: DVec3) -> (Link, Cluster) {
    if let [leaf] = leaves {
        return (Link::Emitter(leaf.emitter), leaf.cluster);
    }
    let count = leaves.len();
    let cut = split(leaves, depth);
    let (left, right) = leaves.split_at_mut(cut);
    let (pair, below) = nodes.split_at_mut(2);
    let (below_left, below_right) = below.split_at_mut(2 * cut - 2);
    let (at_left, at_right) = (at + 2, at + 2 * cut as u32);
    let mut grow_left = || grow(left, below_left, at_left, depth + 1, origin);
    let mut grow_right = || grow(right, below_right, at_right, depth + 1, origin);
    let (left, right) =
        if count > MANY { rayon::join(grow_left, grow_right) } else { (grow_left(), grow_right()) };
    for (node, (link, cluster)) in pair.iter_mut().zip([left, right]) {
        *node = Node::new(&cluster, origin, link);
    }
    (Link::Pair(at), left.1.union(right.1))
}

/// Puts at least two leaves in two parts, neither empty; how many are in the first.
fn split(leaves: &mut [Leaf], depth: u32) -> usize {
    // A split may leave all but one on one side, and from there halving must reach the leaves.
    let levels_left = DEEPEST - depth;
    let may_be_uneven = leaves.len() > 2 && log2_up(leaves.len() - 1) < levels_left;
    let (low, high) = leaves.iter().fold((leaves[0].middle, leaves[0].middle), |(low, high), leaf| {
        (low.min(leaf.middle), high.max(leaf.middle))
    });
    let binned = if may_be_uneven { Binning::cheapest(leaves, low, high) } else { None };
    if let Some(binning) = binned {
        return partition(leaves, |leaf| binning.is_left(leaf));
    }
    let (half, axis) = (leaves.len() / 2, (high - low).max_position());
    leaves.select_nth_unstable_by(half, |a, b| a.middle[axis].total_cmp(&b.middle[axis]));
    half
}

fn log2_up(n: usize) -> u32 {
    n.next_power_of_two().trailing_zeros()
}

/// Puts the leaves that `is_first` accepts before the others; how many they are.
fn partition(leaves: &mut [Leaf], is_first: impl Fn(&Leaf) -> bool) -> usize {
    let mut first = 0;
    for i in 0..leaves.len() {
        if is_first(&leaves[i]) {
            leaves.swap(first, i);
            first += 1;
        }
    }
    first
}

/// A cut between two bins along an axis.
struct Binning {
    axis: usize,
    low: f64,
    /// Bins per length.
    scale: f64,
    /// First bin of the right side.
    cut: usize,
}

impl Binning {
    fn bin(&self, leaf: &Leaf) -> usize {
        (((leaf.middle[self.axis] - self.low) * self.scale) as usize).min(BINS - 1)
    }

    fn is_left(&self, leaf: &Leaf) -> bool {
        self.bin(leaf) < self.cut
    }

    /// The cheapest cut along any axis; `None` if all middles, within `low` and `high`, are in one place.
    fn cheapest(leaves: &[Leaf], low: DVec3, high: DVec3) -> Option<Self> {
        let extent = high - low;
        let mut best: Option<(f64, Self)> = None;
        for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
            let mut binning = Self { axis, low: low[axis], scale: BINS as f64 / extent[axis], cut: 0 };
            let mut bins = [None; BINS];
            for leaf in leaves {
                let bin = &mut bins[binning.bin(leaf)];
                *bin = union(*bin, Some(leaf.cluster));
            }
            // [C]: thin slices of long clusters are not worth what their cones say.
            let slimness = extent.max_element() / extent[axis];
            let Some((cost, cut)) = cheapest_cut(&bins) else { continue };
            if best.as_ref().is_none_or(|(least, _)| slimness * cost < *least) {
                binning.cut = cut;
                best = Some((slimness * cost, binning));
            }
        }
        best.map(|(_, binning)| binning)
    }
}

/// The least sum of both sides' costs and the first bin of the right side; `None` if only one bin is filled.
fn cheapest_cut(bins: &[Option<Cluster>; BINS]) -> Option<(f64, usize)> {
    let mut right_costs = [None; BINS];
    let mut right = None;
    for i in (1..BINS).rev() {
        right = union(bins[i], right);
        right_costs[i] = right.map(|cluster: Cluster| cluster.cost());
    }
    let mut best: Option<(f64, usize)> = None;
    let mut left = None;
    for cut in 1..BINS {
        left = union(left, bins[cut - 1]);
        // After an empty bin the cut is the one before it again.
        let (Some(left), Some(right), Some(_)) = (left, right_costs[cut], bins[cut - 1]) else { continue };
        let cost = left.cost() + right;
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, cut));
        }
    }
    best
}

fn union(a: Option<Cluster>, b: Option<Cluster>) -> Option<Cluster> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(b)),
        (a, b) => a.or(b),
    }
}
