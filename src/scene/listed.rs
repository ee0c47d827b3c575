//! Spacetimes that are lists of things: several holes, lenses.

use glam::DVec3;
use toml::Spanned;

use super::check;
use super::error::Fault;
use super::file::{HoleTable, LensName, LensTable, Number, SpacetimeTable};
use crate::spacetime::{GradedLens, Hole, IndexMedium, Lenses, Listed, SeveralHoles, SpacetimeKind};

/// Least index of refraction that lenses leave.
const LEAST_INDEX: f64 = 0.05;

/// The spacetime of a list in a table, which takes its byte range from `span`.
pub(super) fn spacetime(
    table: &SpacetimeTable,
    listed: Listed,
    span: std::ops::Range<usize>,
) -> Result<SpacetimeKind, Fault> {
    let missing = |what: &str, key: &str, keys: &str| {
        let problem = format!("a spacetime of kind {} needs {what}", table.kind.name);
        Err(Fault::at(span.clone(), problem, format!("add `[[spacetime.{key}]]` with {keys}")))
    };
    let medium = match listed {
        Listed::Holes if table.hole.is_empty() => return missing("holes", "hole", "`center` and `mass`"),
        Listed::Lenses if table.lens.is_empty() => {
            return missing("lenses", "lens", "`kind` and `center`");
        }
        Listed::Holes => IndexMedium::SeveralHoles(holes(&table.hole)?),
        Listed::Lenses => IndexMedium::Lenses(lenses(&table.lens)?),
    };
    Ok(SpacetimeKind::Indexed(medium))
}

fn holes(tables: &[Spanned<HoleTable>]) -> Result<SeveralHoles, Fault> {
    let mut holes: Vec<Hole> = Vec::with_capacity(tables.len());
    for table in tables {
        let HoleTable { center, mass } = table.get_ref();
        let place = check::finite_vector(center, "center")?;
        let mass = check::positive(mass, "mass")?;
        if holes.iter().any(|hole| hole.center.distance(place) <= CLOSEST * hole.mass.max(mass)) {
            let problem = format!("a second hole is at {:?}", place.to_array());
            return Err(Fault::at(
                center.span(),
                problem,
                "move one away, or make it one hole of both masses",
            ));
        }
        holes.push(Hole { center: place, mass });
    }
    Ok(SeveralHoles::new(&holes))
}

/// Least distance between holes, relative to the larger mass: closer ones count as one.
const CLOSEST: f64 = 1e-6;

fn lenses(tables: &[Spanned<LensTable>]) -> Result<Lenses, Fault> {
    let mut lenses: Vec<GradedLens> = Vec::with_capacity(tables.len());
    let mut least = 1.0;
    for table in tables {
        let lens = lens(table)?;
        if let GradedLens::Gaussian { amplitude, .. } = lens {
            least += amplitude.min(0.0);
        }
        if least < LEAST_INDEX {
            let problem =
                format!("the index of refraction may fall to {least}, and must be {LEAST_INDEX} or more");
            return Err(Fault::at(table.span(), problem, "use a larger `amplitude`"));
        }
        let is_luneburg = |lens: &GradedLens| matches!(lens, GradedLens::Luneburg { .. });
        let touches = |other: &&GradedLens| {
            (is_luneburg(&lens) || is_luneburg(other))
                && lens.center().distance(other.center()) <= lens.support() + other.support()
        };
        if let Some(other) = lenses.iter().find(touches) {
            let place: DVec3 = other.center();
            let problem = format!("the lens touches that at {:?}", place.to_array());
            let help = "move one away: a Luneburg lens must be apart from others, and a Gaussian one reaches 9 widths";
            return Err(Fault::at(table.span(), problem, help));
        }
        lenses.push(lens);
    }
    Ok(Lenses::new(&lenses))
}

fn lens(table: &Spanned<LensTable>) -> Result<GradedLens, Fault> {
    let span = table.span();
    let LensTable { kind, center, width, amplitude, radius } = table.get_ref();
    let center = check::finite_vector(center, "center")?;
    let needed = |value: &Option<Number>, key: &str| {
        value.clone().ok_or_else(|| {
            let problem = format!("a {} lens needs `{key}`", kind.name());
            Fault::at(span.clone(), problem, format!("add `{key} = ...`"))
        })
    };
    let unknown = |value: &Option<Number>, key: &str| {
        let Some(value) = value else { return Ok(()) };
        let problem = format!("a {} lens has no `{key}`", kind.name());
        Err(Fault::at(value.span(), problem, "take it out"))
    };
    match kind {
        LensName::Gaussian => {
            unknown(radius, "radius")?;
            let width = check::positive(&needed(width, "width")?, "width")?;
            let amplitude = check::finite(&needed(amplitude, "amplitude")?, "amplitude")?;
            Ok(GradedLens::Gaussian { center, width, amplitude })
        }
        LensName::Luneburg => {
            unknown(width, "width")?;
            unknown(amplitude, "amplitude")?;
            let radius = check::positive(&needed(radius, "radius")?, "radius")?;
            Ok(GradedLens::Luneburg { center, radius })
        }
    }
}
