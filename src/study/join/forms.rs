//! Table of all forms: each family of spacetimes has one line.

use super::super::by_family::ByFamily;
use super::form::JoinForm;
use super::{central, several_holes, spinning};
use crate::spacetime::Entry;

impl JoinForm {
    /// Form of the tables of pairs in a spacetime.
    pub(crate) fn of(entry: &Entry) -> &'static Self {
        let forms = ByFamily {
            central: &central::FORM,
            wormhole: &central::FORM,
            several_holes: &several_holes::FORM,
            spinning: &spinning::FORM,
        };
        forms.of(entry)
    }
}
