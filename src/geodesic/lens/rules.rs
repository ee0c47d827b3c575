//! Gauss–Legendre rules in groups of nodes that are worked on together.

use crate::math::quadrature::gauss_legendre;

/// Numbers of nodes, multiples of [`LANES`].
pub(super) const RULES: [usize; 10] = [4, 8, 12, 16, 24, 32, 48, 64, 96, 128];
/// Nodes that are worked on together.
pub(super) const LANES: usize = 4;
pub(super) type Lanes = [f64; LANES];

/// `count` nodes and weights in groups.
pub(super) fn rule(count: usize) -> Vec<(Lanes, Lanes)> {
    let nodes = gauss_legendre(count);
    let group = |group: &[(f64, f64); LANES]| (group.map(|node| node.0), group.map(|node| node.1));
    nodes.as_chunks().0.iter().map(group).collect()
}
