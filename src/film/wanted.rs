//! Set of planes that a render makes.

use super::plane::{Aov, Needs};

/// A set of planes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted([bool; Aov::ALL.len()]);

impl Wanted {
    /// `aovs`, and the variance if `noise` says that it is needed to decide when to stop.
    pub fn new(aovs: &[Aov], noise: bool) -> Self {
        let mut wanted = Self::default();
        for &plane in aovs.iter().chain(noise.then_some(&Aov::Variance)) {
            wanted.0[plane as usize] = true;
        }
        wanted
    }

    /// Its planes, in the order in which an image keeps them.
    pub fn planes(self) -> impl Iterator<Item = Aov> {
        Aov::ALL.iter().copied().filter(move |&plane| self.0[plane as usize])
    }

    /// Records that they need of a render.
    pub fn needs(self) -> Needs {
        self.planes().fold(Needs::NOTHING, |needs, plane| needs.and(plane.definition().needs))
    }
}
