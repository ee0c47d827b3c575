//! Which dielectrics a path is inside of, nested.

/// Dielectrics entered and not left, innermost last, by material index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Media {
    entered: [u32; Self::DEEPEST],
}

impl Default for Media {
    fn default() -> Self {
        Self::VACUUM
    }
}

impl Media {
    /// Deepest nesting that is told apart; surfaces entered beyond it do not refract.
    pub const DEEPEST: usize = 4;
    const EMPTY: u32 = u32::MAX;

    /// In no dielectric.
    pub const VACUUM: Media = Media { entered: [Self::EMPTY; Self::DEEPEST] };

    /// The innermost dielectric.
    pub fn current(&self) -> Option<u32> {
        self.entered.iter().rev().copied().find(|&m| m != Self::EMPTY)
    }

    /// After entering `material`.
    pub fn entering(mut self, material: u32) -> Media {
        if let Some(free) = self.entered.iter_mut().find(|m| **m == Self::EMPTY) {
            *free = material;
        }
        self
    }

    /// After leaving `material` (its innermost occurrence); unchanged if it was never entered.
    pub fn leaving(mut self, material: u32) -> Media {
        if let Some(at) = self.entered.iter().rposition(|&m| m == material) {
            self.entered.copy_within(at + 1.., at);
            self.entered[Self::DEEPEST - 1] = Self::EMPTY;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_media_come_back_in_order() {
        let outer = Media::VACUUM.entering(3);
        let inner = outer.entering(7);
        assert_eq!(inner.current(), Some(7));
        assert_eq!(inner.leaving(7), outer);
        assert_eq!(inner.leaving(3).current(), Some(7));
        assert_eq!(outer.leaving(3), Media::VACUUM);
        assert_eq!(Media::VACUUM.leaving(3), Media::VACUUM);
        let full = (0..6).fold(Media::VACUUM, Media::entering);
        assert_eq!(full.current(), Some(3));
    }
}
