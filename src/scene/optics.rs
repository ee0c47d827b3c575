//! Keys of `[camera]` that decide which rays a point of the film stands for.

use std::ops::Range;

use glam::DVec3;
use toml::Spanned;

use super::check;
use super::components::CameraLens;
use super::error::Fault;
use super::file::{CameraTable, ProjectionName};
use super::projection::{Fisheye, Orthographic, Perspective, Projection, ThinLens};

/// Degrees across the disk of a fisheye that does not say: half of all directions, as on a dome.
const DEFAULT_FOV: f64 = 180.0;
/// Greatest radius of a lens relative to the distance in focus: far beyond all lenses, and directions stay exact.
const STEEPEST: f64 = 1e6;

/// The lens of a model's camera with what a scene file changes about it.
pub(super) fn changed(
    lens: CameraLens,
    table: &Spanned<CameraTable>,
    warnings: &mut Vec<String>,
) -> Result<CameraLens, Fault> {
    let (span, table) = (table.span(), table.get_ref());
    let near = table.near.as_ref().map_or(Ok(lens.near), |near| check::non_negative(near, "near"))?;
    let projection = projection(table, &span, Some(&lens.projection), warnings)?;
    let aspect =
        if projection.name() == lens.projection.name() { lens.aspect } else { projection.own_aspect() };
    Ok(CameraLens { projection, near, aspect })
}

/// Checks the projection of a camera and reads it; warns of keys that it does not have. What is not given is that of the
/// projection that is changed, if there is one.
pub(super) fn projection(
    table: &CameraTable,
    span: &Range<usize>,
    changed: Option<&Projection>,
    warnings: &mut Vec<String>,
) -> Result<Projection, Fault> {
    let name = table.projection.or_else(|| changed.map(name_of)).unwrap_or_default();
    let projection = match name {
        ProjectionName::Perspective => Projection::Perspective(perspective(table, span, changed)?),
        ProjectionName::Orthographic => Projection::Orthographic(orthographic(table, span, changed)?),
        ProjectionName::Equirectangular => Projection::Equirectangular,
        ProjectionName::Fisheye => Projection::Fisheye(fisheye(table)?),
    };
    let keys = [
        ("vertical_fov", table.vertical_fov.is_some(), ProjectionName::Perspective),
        ("aperture", table.aperture.is_some(), ProjectionName::Perspective),
        ("focus_distance", table.focus_distance.is_some(), ProjectionName::Perspective),
        ("blades", table.blades.is_some(), ProjectionName::Perspective),
        ("blade_rotation", table.blade_rotation.is_some(), ProjectionName::Perspective),
        ("height", table.height.is_some(), ProjectionName::Orthographic),
        ("fov", table.fov.is_some(), ProjectionName::Fisheye),
    ];
    for (key, ..) in keys.iter().filter(|(_, is_given, of)| *is_given && *of != name) {
        warnings
            .push(format!("camera.{key} has no effect, since camera.projection is {}", projection.name()));
    }
    Ok(projection)
}

fn name_of(projection: &Projection) -> ProjectionName {
    match projection {
        Projection::Perspective(_) => ProjectionName::Perspective,
        Projection::Orthographic(_) => ProjectionName::Orthographic,
        Projection::Equirectangular => ProjectionName::Equirectangular,
        Projection::Fisheye(_) => ProjectionName::Fisheye,
    }
}

fn perspective(
    table: &CameraTable,
    span: &Range<usize>,
    changed: Option<&Projection>,
) -> Result<Perspective, Fault> {
    let pinhole = match (&table.vertical_fov, changed) {
        (Some(vertical_fov), _) => {
            let degrees = check::between(vertical_fov, 0.0, 180.0, "vertical_fov")?;
            Perspective::new(degrees.to_radians()).ok_or_else(|| {
                Fault::at(vertical_fov.span(), "no ray can be so steep", "write a usual vertical_fov")
            })?
        }
        (None, Some(Projection::Perspective(changed))) => *changed,
        (None, _) => {
            let problem = "a perspective camera needs `vertical_fov`";
            let help = "add `vertical_fov = 40`, in degrees, or another `projection`";
            return Err(Fault::at(span.clone(), problem, help));
        }
    };
    Ok(Perspective { lens: lens(table)?, ..pinhole })
}

fn lens(table: &CameraTable) -> Result<Option<ThinLens>, Fault> {
    let focus_distance = match &table.focus_distance {
        Some(distance) => Some(check::positive(distance, "focus_distance")?),
        None => table.look_at.as_ref().zip(table.position.as_ref()).map(|(target, position)| {
            let [to, from] = [target, position].map(|point| DVec3::from(*point.get_ref()));
            to.distance(from)
        }),
    };
    let blades = match table.blades.as_ref().map(|blades| (*blades.get_ref(), blades.span())) {
        Some((blades @ 1..=2, span)) => {
            let problem = format!("{blades} blades leave no opening");
            return Err(Fault::at(span, problem, "write 3 or more, or 0 for a round opening"));
        }
        Some((blades, _)) => blades,
        None => 0,
    };
    let degrees =
        table.blade_rotation.as_ref().map_or(Ok(0.0), |turn| check::finite(turn, "blade_rotation"))?;
    let Some(aperture) = &table.aperture else { return Ok(None) };
    let radius = check::non_negative(aperture, "aperture")?;
    if radius == 0.0 {
        return Ok(None);
    }
    let focus_distance = focus_distance.ok_or_else(|| {
        Fault::at(
            aperture.span(),
            "a lens needs the distance that is in focus",
            "add `focus_distance = ...`, in scene units, or `position` and `look_at`",
        )
    })?;
    if radius > STEEPEST * focus_distance {
        let problem = format!("a lens of radius {radius} cannot focus on what is {focus_distance} away");
        let help = "use a smaller `aperture` or a greater `focus_distance`";
        return Err(Fault::at(aperture.span(), problem, help));
    }
    Ok(Some(ThinLens { radius, focus_distance, blades, rotation: degrees.to_radians() }))
}

fn orthographic(
    table: &CameraTable,
    span: &Range<usize>,
    changed: Option<&Projection>,
) -> Result<Orthographic, Fault> {
    match (&table.height, changed) {
        (Some(height), _) => Ok(Orthographic { half_height: 0.5 * check::positive(height, "height")? }),
        (None, Some(Projection::Orthographic(changed))) => Ok(*changed),
        (None, _) => {
            let problem = "an orthographic camera needs `height`";
            let help = "add `height = ...`: that of what it sees, in scene units";
            Err(Fault::at(span.clone(), problem, help))
        }
    }
}

fn fisheye(table: &CameraTable) -> Result<Fisheye, Fault> {
    let why = "a picture shows at most all directions";
    let degrees =
        table.fov.as_ref().map_or(Ok(DEFAULT_FOV), |fov| check::within(fov, 0.01..=360.0, "fov", why))?;
    Ok(Fisheye { half_fov: 0.5 * degrees.to_radians() })
}
