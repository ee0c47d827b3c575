//! Parameters of a spacetime: their names in scene files and tables of rays, and which values they may have.

/// A number that describes a spacetime.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Key under `[spacetime]` in a scene file.
    pub key: &'static str,
    /// Column in a table of rays.
    pub column: &'static str,
    /// Symbol in descriptions.
    pub symbol: &'static str,
    /// Noun phrase for messages, with its article.
    pub noun: &'static str,
    /// Values that it may have.
    pub range: Range,
    /// Value in a table of rays that has no such column; `None`: the column is needed.
    pub in_tables: Option<f64>,
    /// Value where the column has 1.
    pub per_column: f64,
}

/// Values of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// A length in scene units, of a mass or a radius; 0 leaves flat space.
    Length,
    /// A length in scene units that may be 0 in a curved space.
    Extent,
    /// A pure number between two bounds, which it may reach.
    Ratio {
        /// Lower bound.
        least: f64,
        /// Upper bound.
        most: f64,
        /// Reason for the bounds, a clause.
        why: &'static str,
    },
}

impl Parameter {
    /// Problem with `value` and its remedy, if it is out of bounds; lengths are for the caller to bound.
    pub fn out_of_bounds(&self, value: f64) -> Option<(String, String)> {
        match self.range {
            Range::Length => None,
            Range::Extent => (!(0.0..f64::INFINITY).contains(&value))
                .then(|| (format!("{} is {value}", self.noun), "give a length of 0 or more".to_owned())),
            Range::Ratio { least, most, why } => (!(least..=most).contains(&value)).then(|| {
                (format!("{} is {value}: {why}", self.noun), format!("give a number from {least} to {most}"))
            }),
        }
    }
}

/// r_s = 2M: the length scale of every hole.
pub(super) const SCHWARZSCHILD_RADIUS: Parameter = Parameter {
    key: "schwarzschild_radius",
    column: "rs",
    symbol: "r_s",
    noun: "the Schwarzschild radius",
    range: Range::Length,
    in_tables: None,
    per_column: 1.0,
};

/// b₀: the least areal radius of a wormhole.
pub(super) const THROAT_RADIUS: Parameter = Parameter {
    key: "throat_radius",
    column: "b0",
    symbol: "b₀",
    noun: "the throat radius",
    range: Range::Length,
    in_tables: None,
    per_column: 1.0,
};
