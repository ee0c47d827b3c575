//! Lens of the last spacetime, kept: everything scales with the spacetime's length, so one serves all pairs whose spacetimes
//! differ in nothing else.

use std::sync::{Arc, Mutex, PoisonError};

use crate::geodesic::Lens;
use crate::spacetime::{ConformallyFlat, SpacetimeKind};

/// Lens of the last spacetime.
#[derive(Debug, Default)]
pub(crate) struct LensCache(Mutex<Option<(SpacetimeKind, Arc<Lens>)>>);

impl LensCache {
    /// The lens of a spacetime in its own unit, whose medium is given too; `None` if it has no photon sphere.
    pub(super) fn of(&self, kind: &SpacetimeKind, medium: &impl ConformallyFlat) -> Option<Arc<Lens>> {
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, lens)) = last.as_ref().filter(|(of, _)| of == kind) {
            return Some(lens.clone());
        }
        let lens = Arc::new(Lens::new(medium, f64::EPSILON)?);
        *last = Some((kind.clone(), lens.clone()));
        Some(lens)
    }
}
