//! Nested dielectrics that a path is inside of.

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

/// Media from and into which light goes through faces of dielectrics that lie upon each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InterfaceCrossing {
    /// The innermost dielectric before, if any; none where light goes through nothing.
    pub from: Option<u32>,
    /// All dielectrics after.
    pub into: Media,
}

impl InterfaceCrossing {
    /// Light in `media` that goes through nothing.
    pub fn none(media: Media) -> Self {
        Self { from: None, into: media }
    }

    /// Light in `media` that goes through `faces`: their materials, and whether it enters them. What it enters it may
    /// leave at once: a sheet without thickness.
    pub fn of(media: Media, faces: impl Iterator<Item = (u32, bool)> + Clone) -> Self {
        let entered = faces.clone().filter(|(_, enters)| *enters);
        let into = entered.fold(media, |into, (material, _)| into.entering(material));
        let left = faces.filter(|(_, enters)| !enters);
        left.fold(Self { from: media.current(), into }, |Self { from, into }, (material, _)| {
            let after = into.leaving(material);
            // A path that starts inside leaves what it never entered.
            let from = if after == into { from.or(Some(material)) } else { from };
            Self { from, into: after }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_that_are_crossed_together_leave_no_medium_behind() {
        let crossing = |media, faces: &[(u32, bool)]| InterfaceCrossing::of(media, faces.iter().copied());
        let glass = Media::VACUUM.entering(3);
        // From one block of glass into the next; through two that coincide, and out; through a sheet without thickness.
        assert_eq!(
            crossing(glass, &[(3, false), (7, true)]),
            InterfaceCrossing { from: Some(3), into: Media::VACUUM.entering(7) }
        );
        let both = crossing(Media::VACUUM, &[(3, true), (7, true)]);
        assert_eq!(both, InterfaceCrossing { from: None, into: glass.entering(7) });
        assert_eq!(crossing(both.into, &[(3, false), (7, false)]).into, Media::VACUUM);
        for sheet in [[(3, true), (3, false)], [(3, false), (3, true)]] {
            assert_eq!(crossing(Media::VACUUM, &sheet), InterfaceCrossing::none(Media::VACUUM));
        }
        // From a camera in glass.
        assert_eq!(crossing(Media::VACUUM, &[(3, false)]).from, Some(3));
    }

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
