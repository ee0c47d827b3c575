//! The edge of all geometry, where rays from outside start that nothing is in the way of until there.

use super::departure::BENDING;
use super::flight::Lane;
use crate::geodesic::{InwardBending, Phase};
use crate::spacetime::{Chart, ConformallyFlat};

/// Inverse radius of the entrance at most, as a part of that which bounds the geometry: there, no ray that comes near any
/// is about to turn.
const EDGE: f64 = 0.97;
/// Inverse radii that are tried one after the other, as a part of the one before, and their number.
const FARTHER: f64 = 0.7;
const MOST: usize = 8;

/// Sphere around all geometry on which rays from outside start.
#[derive(Clone, Debug)]
pub struct Entrance<R> {
    /// Bending of rays on their way there.
    pub bending: InwardBending,
    /// Phase there of a ray that runs inwards along the radius, whose rate is the index.
    pub radial: Phase<R>,
}

impl<R: Lane> Entrance<R> {
    /// The entrance to a `chart` for rays of a `tolerance` in radians, if bending is known in closed form out there.
    pub fn new<M: ConformallyFlat>(medium: &M, chart: &Chart, tolerance: f64) -> Option<Self> {
        let bending = BENDING * tolerance;
        std::iter::successors(Some(EDGE * chart.outer), |w| Some(FARTHER * w)).take(MOST).find_map(|w| {
            let bending = InwardBending::new(medium, w, bending)?;
            Some(Self { bending, radial: Phase::new(medium, R::of(w), R::of(medium.index(w))) })
        })
    }
}
