//! Choice by family of spacetimes, for what studies have one of for each.

use glam::DVec3;

use crate::spacetime::{
    ConformallyFlat, Entry, IndexField, KerrNewman, Listed, Mouths, Placement, SpacetimeVisitor,
};

/// One thing for each family.
pub(super) struct ByFamily<T> {
    /// Static, spherical spacetimes, and flat space.
    pub(super) central: T,
    pub(super) wormhole: T,
    pub(super) several_holes: T,
    pub(super) spinning: T,
}

impl<T> ByFamily<T> {
    /// That of the family of an entry.
    pub(super) fn of(self, entry: &Entry) -> T {
        match entry.listed {
            Some(Listed::Holes) => self.several_holes,
            Some(Listed::Lenses) | None => entry.example().visit(self),
        }
    }
}

impl<T> SpacetimeVisitor for ByFamily<T> {
    type Output = T;

    fn flat(self) -> T {
        self.central
    }

    fn spherical<M: ConformallyFlat>(self, _: DVec3, _: M) -> T {
        self.central
    }

    fn wormhole<M: ConformallyFlat>(self, _: Mouths, _: M) -> T {
        self.wormhole
    }

    fn indexed<F: IndexField>(self, _: &F) -> T {
        self.several_holes
    }

    fn spinning(self, _: Placement, _: KerrNewman) -> T {
        self.spinning
    }
}
