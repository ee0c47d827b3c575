//! Tables of pairs of points, by family of spacetimes: which columns describe a pair, which are found, and by what code.

use glam::DVec3;

use super::super::input_error::{Input, InputError};
use super::lens_cache::LensCache;
use crate::spacetime::SpacetimeKind;

/// Columns of the points of a pair.
pub(crate) const POINTS: [&str; 6] = ["x0", "x1", "x2", "y0", "y1", "y2"];
/// Columns of its first point.
pub(super) const X: [&str; 3] = ["x0", "x1", "x2"];
/// Columns of its second point.
pub(super) const Y: [&str; 3] = ["y0", "y1", "y2"];
/// Distance of points that are one, and sine of an angle that is 0, relative to their distance from the centre.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Form of the tables of pairs of a family of spacetimes.
pub(crate) struct JoinForm {
    /// Columns that describe a pair where a table has them; cells may be empty.
    pub optional: &'static [&'static str],
    /// Columns that are found.
    pub results: &'static [&'static str],
    /// Finds the rays between the points of a pair of winding numbers up to the highest.
    pub join: fn(&LensCache, &PointPair, u32) -> Result<Joints, InputError>,
}

/// Two points in a spacetime about the origin.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PointPair {
    /// The spacetime, as far as its parameters tell.
    pub spacetime: SpacetimeKind,
    /// One point, in the chart of its tables.
    pub x: DVec3,
    /// The other.
    pub y: DVec3,
    /// Cells of the columns [`JoinForm::optional`]; `None` in an empty cell and without the column.
    pub optional: Vec<Option<f64>>,
}

/// The rays between two points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Joints {
    /// Cells of the columns [`JoinForm::results`] for each of them; numbers read back exactly.
    pub found: Vec<Vec<String>>,
    /// Number of further rays, which rounding hides.
    pub hidden: usize,
}

impl PointPair {
    /// Refuses points that are one.
    pub(super) fn check_apart(&self) -> Result<(), InputError> {
        let &Self { x, y, .. } = self;
        if x.distance(y) > ROUNDING * x.length().max(y.length()) {
            return Ok(());
        }
        let cause = "the points are the same to rounding".to_owned();
        Err(InputError { input: Input::Both, cause, remedy: "give two points".to_owned() })
    }
}
