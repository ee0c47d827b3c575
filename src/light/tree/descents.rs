//! Descents of many receivers, side by side.

use std::ops::RangeInclusive;

use super::Tree;
use super::descent::Descent;
use super::node::{Chances, Importance, LocalReceiver, NarrowCluster, Subtree, Weighing};
use crate::math::columns::Columns;
use crate::math::kernel::{NOTHING, map};

/// Memory of descents of many receivers.
#[derive(Default)]
pub struct Descents {
    /// Chances of the two below the root, by lane.
    chances: Columns<Chances>,
    /// Chances of each pair of a small tree, by lane.
    of_pairs: Vec<Columns<Chances>>,
    /// Lanes that have come to no emitter yet, with the first of the pair below.
    under_way: Vec<(usize, u32, Descent)>,
    /// Of those, what looks at each pair, the pair, and what it looks like.
    receivers: Columns<LocalReceiver>,
    left: Columns<NarrowCluster>,
    right: Columns<NarrowCluster>,
    left_importance: Columns<Importance>,
    right_importance: Columns<Importance>,
}

/// Pairs of a small tree: all receivers compare all of them, as it takes longer to sort out which compare what.
const FEW_PAIRS: RangeInclusive<usize> = 2..=4;

impl Tree {
    /// [`Tree::sample`] for many receivers, each with a number in [0, 1) or not at all, a level of the tree at a time: what
    /// each finds, by lane.
    pub fn sample_all(
        &self,
        receivers: &Columns<LocalReceiver>,
        numbers: &[Option<f64>],
        descents: &mut Descents,
        found: &mut Vec<Option<(u32, f64, f64)>>,
    ) {
        if FEW_PAIRS.contains(&(self.nodes.len() / 2)) {
            return self.sample_few(receivers, numbers, &mut descents.of_pairs, found);
        }
        let lanes = numbers.len();
        found.clear();
        found.resize(lanes, None);
        let Some(root) = self.root else { return };
        let Descents { chances, under_way, .. } = descents;
        chances.grow(lanes);
        if let Subtree::Pair(first) = root {
            // All compare the same two.
            map(&self.siblings(first), receivers.blocks(lanes), NOTHING, chances.blocks_mut(lanes));
        }
        under_way.clear();
        for (lane, u) in numbers.iter().enumerate() {
            let Some(u) = *u else { continue };
            let start = Descent::new(root, u);
            let below = match start.end() {
                Ok(emitter) => {
                    found[lane] = Some(emitter);
                    continue;
                }
                Err(first) => start.turn(self.pair(first), chances.get(lane)),
            };
            match below.map(|descent| (descent, descent.end())) {
                Some((_, Ok(emitter))) => found[lane] = Some(emitter),
                Some((descent, Err(first))) => under_way.push((lane, first, descent)),
                None => {}
            }
        }
        while !descents.under_way.is_empty() {
            self.compare(receivers, descents);
            let Descents { under_way, left_importance, right_importance, .. } = &mut *descents;
            let mut place = 0;
            under_way.retain_mut(|(lane, first, descent)| {
                let chances = Importance::chances([left_importance.get(place), right_importance.get(place)]);
                place += 1;
                let Some(below) = descent.turn(self.pair(*first), chances) else { return false };
                match below.end() {
                    Ok(emitter) => {
                        found[*lane] = Some(emitter);
                        false
                    }
                    Err(next) => {
                        (*first, *descent) = (next, below);
                        true
                    }
                }
            });
        }
    }

    /// [`Self::sample_all`] in a small tree.
    fn sample_few(
        &self,
        receivers: &Columns<LocalReceiver>,
        numbers: &[Option<f64>],
        of_pairs: &mut Vec<Columns<Chances>>,
        found: &mut Vec<Option<(u32, f64, f64)>>,
    ) {
        let (lanes, pairs) = (numbers.len(), self.nodes.len() / 2);
        of_pairs.resize_with(pairs.max(of_pairs.len()), Columns::default);
        for (first, chances) in (0..).step_by(2).zip(&mut of_pairs[..pairs]) {
            chances.grow(lanes);
            map(&self.siblings(first), receivers.blocks(lanes), NOTHING, chances.blocks_mut(lanes));
        }
        let chances = |first: u32, lane: usize| of_pairs[first as usize / 2].get(lane);
        let sample = |(lane, u): (usize, &Option<f64>)| self.descend((*u)?, |first| chances(first, lane));
        found.clear();
        found.extend(numbers.iter().enumerate().map(sample));
    }

    /// Weighs the pairs that descents under way choose from.
    fn compare(&self, of: &Columns<LocalReceiver>, descents: &mut Descents) {
        let Descents { under_way, receivers, left, right, left_importance, right_importance, .. } = descents;
        let lanes = under_way.len();
        receivers.grow(lanes);
        for clusters in [&mut *left, &mut *right] {
            clusters.grow(lanes);
        }
        for (place, &(lane, first, _)) in under_way.iter().enumerate() {
            let pair = self.pair(first);
            receivers.set(place, of.get(lane));
            left.set(place, pair[0].cluster);
            right.set(place, pair[1].cluster);
        }
        for (clusters, importances) in [(left, left_importance), (right, right_importance)] {
            importances.grow(lanes);
            let (receivers, clusters) = (receivers.blocks(lanes), clusters.blocks(lanes));
            map(&Weighing { floor: self.floor }, receivers, clusters, importances.blocks_mut(lanes));
        }
    }
}
