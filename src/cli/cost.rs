//! What a render will cost, before it is started.

use crate::scene::Baked;

/// The estimated cost of rendering `scene` as its settings say, in words; `None` where it cannot be told.
pub(super) fn estimate(_scene: &Baked) -> Option<String> {
    None
}
