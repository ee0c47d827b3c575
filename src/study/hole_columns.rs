//! Holes of a table's row: masses and positions in columns.

use glam::DVec3;

use super::input_error::{Input, InputError};
use super::lengths::Lengths;
use crate::spacetime::Hole;

/// Columns of the holes: mass and position each, empty where there is none.
pub(super) const HOLES: [&str; 32] = [
    "m1", "hx1", "hy1", "hz1", "m2", "hx2", "hy2", "hz2", "m3", "hx3", "hy3", "hz3", "m4", "hx4", "hy4",
    "hz4", "m5", "hx5", "hy5", "hz5", "m6", "hx6", "hy6", "hz6", "m7", "hx7", "hy7", "hz7", "m8", "hx8",
    "hy8", "hz8",
];

/// The holes of a row, at different places.
pub(super) fn holes(cells: &[Option<f64>], lengths: &Lengths) -> Result<Vec<Hole>, InputError> {
    let refuse = |cause: String, remedy: &str| {
        Err(InputError { input: Input::Columns(&HOLES), cause, remedy: remedy.to_owned() })
    };
    let mut holes: Vec<Hole> = Vec::new();
    for cells in cells.chunks(4) {
        let hole = match *cells {
            [None, None, None, None] => continue,
            [Some(mass), Some(x), Some(y), Some(z)] => Hole { mass, center: DVec3::new(x, y, z) },
            _ => {
                return refuse(
                    "a hole has not all of its cells".to_owned(),
                    "give mass and position, or nothing",
                );
            }
        };
        lengths.check(Input::Columns(&HOLES), "the mass of a hole", hole.mass)?;
        if let Some(other) = holes.iter().find(|other| other.center.distance(hole.center) == 0.0) {
            return refuse(format!("two holes are at {}", other.center), "give each a place of its own");
        }
        holes.push(hole);
    }
    if holes.is_empty() {
        return refuse("there is no hole".to_owned(), "give `m1`, `hx1`, `hy1` and `hz1`");
    }
    Ok(holes)
}
