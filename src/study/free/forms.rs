//! Table of all forms: each family of spacetimes has one line.

use glam::DVec3;

use super::table_form::TableForm;
use super::{isotropic, several_holes, spinning, through_throat};
use crate::spacetime::{
    ConformallyFlat, Entry, IndexField, KerrNewman, Listed, Mouths, Placement, SpacetimeVisitor,
};

impl TableForm {
    /// Form of the tables of a spacetime's rays.
    pub fn of(entry: &Entry) -> &'static Self {
        match entry.listed {
            Some(Listed::Holes) => return &several_holes::FORM,
            Some(Listed::Lenses) | None => {}
        }
        entry.example().visit(TableFormVisitor)
    }
}

/// Visitor that finds the form of a family.
struct TableFormVisitor;

impl SpacetimeVisitor for TableFormVisitor {
    type Output = &'static TableForm;

    fn flat(self) -> &'static TableForm {
        &isotropic::FORM
    }

    fn spherical<M: ConformallyFlat>(self, _: DVec3, _: M) -> &'static TableForm {
        &isotropic::FORM
    }

    fn wormhole<M: ConformallyFlat>(self, _: Mouths, _: M) -> &'static TableForm {
        &through_throat::FORM
    }

    fn indexed<F: IndexField>(self, _: &F) -> &'static TableForm {
        &several_holes::FORM
    }

    fn spinning(self, _: Placement, _: KerrNewman) -> &'static TableForm {
        &spinning::FORM
    }
}
