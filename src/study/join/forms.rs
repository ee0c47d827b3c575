//! Table of all forms: each family of spacetimes has one line.

use glam::DVec3;

use super::form::JoinForm;
use super::{central, several_holes, spinning};
use crate::spacetime::{
    ConformallyFlat, Entry, IndexField, KerrNewman, Listed, Mouths, Placement, SpacetimeVisitor,
};

impl JoinForm {
    /// Form of the tables of pairs in a spacetime.
    pub(crate) fn of(entry: &Entry) -> &'static Self {
        match entry.listed {
            Some(Listed::Holes) => return &several_holes::FORM,
            Some(Listed::Lenses) | None => {}
        }
        entry.example().visit(JoinFormVisitor)
    }
}

/// Visitor that finds the form of a family.
struct JoinFormVisitor;

impl SpacetimeVisitor for JoinFormVisitor {
    type Output = &'static JoinForm;

    fn flat(self) -> &'static JoinForm {
        &central::FORM
    }

    fn spherical<M: ConformallyFlat>(self, _: DVec3, _: M) -> &'static JoinForm {
        &central::FORM
    }

    fn wormhole<M: ConformallyFlat>(self, _: Mouths, _: M) -> &'static JoinForm {
        &central::FORM
    }

    fn indexed<F: IndexField>(self, _: &F) -> &'static JoinForm {
        &several_holes::FORM
    }

    fn spinning(self, _: Placement, _: KerrNewman) -> &'static JoinForm {
        &spinning::FORM
    }
}
