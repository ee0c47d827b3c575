//! Table of all forms: each family of spacetimes has one line.

use super::super::by_family::ByFamily;
use super::table_form::TableForm;
use super::{isotropic, several_holes, spinning, through_throat};
use crate::spacetime::Entry;

impl TableForm {
    /// Form of the tables of a spacetime's rays.
    pub fn of(entry: &Entry) -> &'static Self {
        let forms = ByFamily {
            central: &isotropic::FORM,
            wormhole: &through_throat::FORM,
            several_holes: &several_holes::FORM,
            spinning: &spinning::FORM,
        };
        forms.of(entry)
    }
}
