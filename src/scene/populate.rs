//! Scene file → world: checks every value and spawns the entities.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use toml::Spanned;

use super::bare_model::bare_name;
use super::camera::Camera;
use super::check;
use super::components::{CameraLens, DiskShape, LightShape, MaterialHandle, SphereShape};
use super::error::{Fault, suggestion};
use super::file::{
    CameraTable, DiskTable, EntityTable, EnvironmentTable, FilmTable, RenderTable, Rotation, SceneFile,
    SkyName, SpacetimeTable, SphereTable, Text, TransformTable, Vector,
};
use super::foreign;
use super::light::light;
use super::listed;
use super::material::material;
use super::optics::projection;
use super::settings::{MAX_PIXELS, MAX_SEGMENTS, MAX_SIDE, MAX_SPP, MAX_WINDING, Settings};
use super::sun_sky;
use super::world::{ModelFormat, ModelOverrides, World};
use crate::asset::{Files, Picture, load_image};
use crate::geometry::{Disk, Sphere};
use crate::math::rotation;
use crate::shade::{Environment, LatLong, Material};
use crate::spacetime::{Entry, Listed, Parameter, Placement, Range, Side, SpacetimeKind};

/// Factor on the lights of a glTF file that does not say: candela to W/sr at 683 lm/W, with which Blender multiplies
/// the power of lights, but not the emission of materials.
const DEFAULT_LIGHT_SCALE: f64 = 1.0 / 683.0;

/// Source of the files that a scene file names.
pub(super) struct AssetSource<'a> {
    /// The folder that paths are relative to.
    pub folder: &'a Path,
    /// The model that the scene file was made up for.
    pub bare: Option<&'a Path>,
    /// Reads them.
    pub files: &'a Files,
    /// Goes over `light_scale`.
    pub light_scale: Option<f64>,
    /// Moment of the animations, seconds.
    pub time: f64,
}

impl AssetSource<'_> {
    /// The file that a scene file names.
    fn path(&self, name: &str) -> PathBuf {
        match self.bare.filter(|path| bare_name(path) == name) {
            Some(path) => path.to_owned(),
            None => self.folder.join(name),
        }
    }
}

/// Builds the world of a scene file; its files are read from `source`.
pub(super) fn populate(file: SceneFile, source: &AssetSource) -> Result<World, Fault> {
    let mut warnings = Vec::new();
    let spacetime =
        file.spacetime.as_ref().map_or(Ok(SpacetimeKind::Flat), |table| spacetime(table, &mut warnings))?;
    let near = match &file.environment {
        Some(table) => environment(table, source, &mut warnings)?,
        None => Environment::Black,
    };
    let far = file.environment.as_ref().and_then(|table| table.get_ref().far.as_deref());
    let far_environment = match far {
        Some(table) => environment(table, source, &mut warnings)?,
        None => Environment::Black,
    };
    let mut world = World::new(spacetime, near, settings(&file.film, &file.render)?);
    world.far_environment = far_environment;
    world.warnings = warnings;
    world.has_own_spacetime = file.spacetime.is_some();
    world.has_own_size = file.film.width.is_some() || file.film.height.is_some();
    if let Some(table) = &file.camera
        && let Some(position) = &table.get_ref().position
    {
        let (placement, lens) = camera(table, position, &mut world.warnings)?;
        let entity = world.spawn_authored(table.span(), Some("camera".to_owned()), placement);
        // The entity was spawned on the line above, so inserting cannot fail.
        let _ = world.entities.insert_one(entity, lens);
        world.put(
            entity,
            table.get_ref().side.as_ref().map_or(Side::Near, |side| Side::from(*side.get_ref())),
        );
        world.camera = Some(entity);
    } else if let Some(table) = file.camera {
        check_changes(table.get_ref())?;
        world.camera_changes = Some(table);
    }
    let mut names = HashMap::new();
    for table in &file.material {
        let handle = world.add_material(material(table)?);
        if names.insert(table.name.get_ref().clone(), handle).is_some() {
            let problem = format!("a second material is named `{}`", table.name.get_ref());
            return Err(Fault::at(table.name.span(), problem, "give each material its own name"));
        }
    }
    for (index, mut table) in file.entity.into_iter().enumerate() {
        name_shape(table.get_mut(), index);
        spawn(&mut world, table, &names, source)?;
    }
    Ok(world)
}

fn spacetime(table: &Spanned<SpacetimeTable>, warnings: &mut Vec<String>) -> Result<SpacetimeKind, Fault> {
    let (span, table) = (table.span(), table.get_ref());
    let center = table.center.as_ref().map_or(Ok(DVec3::ZERO), |at| check::finite_vector(at, "center"))?;
    let Entry { name, parameters, .. } = table.kind;
    let mut placement = Placement::from(center);
    if let Some(axis) = &table.axis {
        placement.axis = check::direction(axis, "axis")?;
        if !table.kind.has_axis {
            warnings.push(format!("spacetime.axis has no effect, since spacetime.kind is {name}"));
        }
    }
    placement.far_center = match &table.far_center {
        Some(at) => check::finite_vector(at, "far_center")?,
        None => center,
    };
    if let Some(rotation) = &table.far_rotate {
        placement.far_rotation = DMat3::from_quat(turned(rotation)?);
    }
    if !table.kind.has_far_side && (table.far_center.is_some() || table.far_rotate.is_some()) {
        warnings.push(format!(
            "spacetime.far_center and far_rotate have no effect, since spacetime.kind is {name}"
        ));
    }
    for (key, value) in &table.parameters {
        if parameters.iter().all(|parameter| parameter.key != *key) && *value.get_ref() != 0.0 {
            warnings.push(format!("spacetime.{key} has no effect, since spacetime.kind is {name}"));
        }
    }
    let is_listed = |listed| table.kind.listed == Some(listed);
    let no_effect = [
        ("center", table.center.is_some() && table.kind.listed.is_some()),
        ("hole", !table.hole.is_empty() && !is_listed(Listed::Holes)),
        ("lens", !table.lens.is_empty() && !is_listed(Listed::Lenses)),
    ];
    for (key, _) in no_effect.iter().filter(|(_, is_given)| *is_given) {
        warnings.push(format!("spacetime.{key} has no effect, since spacetime.kind is {name}"));
    }
    if let Some(listed) = table.kind.listed {
        return listed::spacetime(table, listed, span);
    }
    let mut values = Vec::with_capacity(parameters.len());
    for Parameter { key, noun, range, .. } in *parameters {
        let Some(value) = table.parameters.get(key) else {
            let help = format!(
                "add `{key} = ...`{}",
                if matches!(range, Range::Length | Range::Extent) { ", in scene units" } else { "" }
            );
            return Err(Fault::at(span, format!("a spacetime of kind {name} needs {noun}"), help));
        };
        values.push(match *range {
            Range::Length | Range::Extent => check::non_negative(value, key)?,
            Range::Ratio { least, most, why } => check::within(value, least..=most, key, why)?,
        });
    }
    if let Some((problem, help)) = table.kind.conflict(&values) {
        return Err(Fault::at(span, problem, help));
    }
    Ok(table.kind.with(placement, &values))
}

fn environment(
    table: &Spanned<EnvironmentTable>,
    source: &AssetSource,
    warnings: &mut Vec<String>,
) -> Result<Environment, Fault> {
    let (span, table) = (table.span(), table.get_ref());
    let sources = [table.kind.is_some(), table.color.is_some(), table.image.is_some()];
    if sources.iter().filter(|given| **given).count() > 1 {
        return Err(Fault::at(
            span,
            "`kind`, `color` and `image` exclude each other",
            "keep one; `strength` scales it",
        ));
    }
    if let Some(beyond) = table.far.as_ref().and_then(|far| far.get_ref().far.as_ref()) {
        return Err(Fault::at(
            beyond.span(),
            "a wormhole has two sides, and a third is described",
            "remove it",
        ));
    }
    if let (Some(rotation), None) = (&table.rotation, &table.image) {
        let help = match table.kind {
            Some(SkyName::SunSky) => "write `sun_azimuth`",
            Some(SkyName::Sky) | None => "remove it",
        };
        return Err(Fault::at(rotation.span(), "`rotation` is for an `image`", help));
    }
    sun_sky::check_absent(table)?;
    let strength = match &table.strength {
        Some(strength) => check::non_negative(strength, "strength")? as f32,
        None => 1.0,
    };
    if let Some(image) = &table.image {
        let degrees = table.rotation.as_ref().map_or(Ok(0.0), |angle| check::finite(angle, "rotation"))?;
        let error_at = |error| Fault::Asset { span: image.span(), error };
        let picture = load_image(&source.path(image.get_ref()), source.files).map_err(error_at)?;
        return Ok(panorama(picture, strength, degrees, warnings));
    }
    match (&table.kind, &table.color, &table.strength) {
        (Some(SkyName::Sky), ..) => Ok(sky(strength)),
        (Some(SkyName::SunSky), ..) => sun_sky::sun_sky(table, strength).map(Environment::SunSky),
        (None, Some(colour), _) => Ok(Environment::Constant(check::colour(colour, "color")? * strength)),
        (None, None, Some(_)) => Ok(Environment::Constant(Vec3::splat(strength))),
        (None, None, None) => Ok(Environment::Black),
    }
}

/// A picture all around, `degrees` about +Y.
pub(super) fn panorama(
    picture: Picture,
    strength: f32,
    degrees: f64,
    warnings: &mut Vec<String>,
) -> Environment {
    warnings.extend(picture.warnings);
    Environment::Image(LatLong {
        width: picture.width,
        height: picture.height,
        pixels: picture.pixels.into_iter().map(|pixel| pixel * strength).collect(),
        from_world: DMat3::from_quat(rotation::about(DVec3::Y, -degrees.to_radians())),
    })
}

/// A clear sky over pale ground.
pub(super) fn sky(strength: f32) -> Environment {
    Environment::Gradient {
        ground: Vec3::new(0.25, 0.23, 0.21) * strength,
        horizon: Vec3::new(0.95, 0.97, 1.0) * strength,
        zenith: Vec3::new(0.35, 0.55, 0.95) * strength,
    }
}

fn settings(film: &FilmTable, render: &RenderTable) -> Result<Settings, Fault> {
    let default = Settings::default();
    let settings = Settings {
        width: side(film.width.as_ref(), "width", default.width)?,
        height: side(film.height.as_ref(), "height", default.height)?,
        filter: film.filter.unwrap_or(default.filter),
        background: film.background.unwrap_or(default.background),
        exposure: film
            .exposure
            .as_ref()
            .map_or(Ok(default.exposure), |stops| check::finite(stops, "exposure"))?,
        spp: samples(render.spp.as_ref(), default.spp)?,
        max_depth: segments(render.max_depth.as_ref(), default.max_depth)?,
        roulette_depth: render.roulette_depth.unwrap_or(default.roulette_depth),
        seed: render.seed.unwrap_or(default.seed),
        stepper: render.stepper.unwrap_or(default.stepper),
        precision: render.precision.unwrap_or(default.precision),
        schedule: render.schedule.unwrap_or(default.schedule),
        sampler: render.sampler.unwrap_or(default.sampler),
        light_sampling: render.light_sampling.unwrap_or(default.light_sampling),
        max_winding: winding(render.max_winding.as_ref(), default.max_winding)?,
        heuristic: render.mis.unwrap_or(default.heuristic),
        multiscatter: render.multiscatter.unwrap_or(default.multiscatter),
        tolerance: match &render.tolerance {
            Some(tolerance) => check::between(tolerance, 0.0, 1.0, "tolerance")?,
            None => default.tolerance,
        },
        arc_tolerance: match &render.arc_tolerance {
            Some(tolerance) => Some(check::positive(tolerance, "arc_tolerance")?),
            None => default.arc_tolerance,
        },
        arc_tolerance_factor: default.arc_tolerance_factor,
    };
    if settings.width.saturating_mul(settings.height) > MAX_PIXELS {
        let problem = format!("an image of {} × {} pixels is too large", settings.width, settings.height);
        let span = film.width.as_ref().or(film.height.as_ref()).map(Spanned::span);
        return Err(Fault::maybe_at(span, problem, format!("at most {MAX_PIXELS} pixels fit")));
    }
    Ok(settings)
}

fn side(pixels: Option<&Spanned<usize>>, what: &str, default: usize) -> Result<usize, Fault> {
    let Some(pixels) = pixels else {
        return Ok(default);
    };
    match *pixels.get_ref() {
        side @ 1..=MAX_SIDE => Ok(side),
        side => Err(Fault::at(
            pixels.span(),
            format!("{what} must be between 1 and {MAX_SIDE} pixels, not {side}"),
            "choose another size",
        )),
    }
}

fn winding(count: Option<&Spanned<u32>>, default: u32) -> Result<u32, Fault> {
    match count.map(|count| (*count.get_ref(), count.span())) {
        None => Ok(default),
        Some((count @ 0..=MAX_WINDING, _)) => Ok(count),
        Some((count, span)) => Err(Fault::at(
            span,
            format!("max_winding must be at most {MAX_WINDING}, not {count}"),
            "each half turn more brings 23 times less light; 1 is good for pictures",
        )),
    }
}

fn segments(count: Option<&Spanned<u32>>, default: u32) -> Result<u32, Fault> {
    match count.map(|count| (*count.get_ref(), count.span())) {
        None => Ok(default),
        Some((count @ 1..=MAX_SEGMENTS, _)) => Ok(count),
        Some((count, span)) => {
            let problem = format!("max_depth must be between 1 and {MAX_SEGMENTS}, not {count}");
            Err(Fault::at(span, problem, "16 is good for pictures, 64 for much glass"))
        }
    }
}

fn samples(count: Option<&Spanned<u64>>, default: u32) -> Result<u32, Fault> {
    let Some(count) = count else { return Ok(default) };
    let samples = u32::try_from(*count.get_ref()).ok().filter(|samples| (1..=MAX_SPP).contains(samples));
    samples.ok_or_else(|| {
        let problem = format!("spp must be between 1 and {MAX_SPP}, not {}", count.get_ref());
        Fault::at(count.span(), problem, "ask for many samples and stop with --time-limit or --noise")
    })
}

fn camera(
    table: &Spanned<CameraTable>,
    position: &Vector,
    warnings: &mut Vec<String>,
) -> Result<(DAffine3, CameraLens), Fault> {
    let (span, table) = (table.span(), table.get_ref());
    let position = check::finite_vector(position, "position")?;
    let forward = match (&table.look_at, &table.direction) {
        (Some(target), None) => {
            let offset = check::finite_vector(target, "look_at")? - position;
            let same = || Fault::at(target.span(), "look_at equals position", "look at another point");
            offset.try_normalize().ok_or_else(same)?
        }
        (None, Some(direction)) => check::direction(direction, "direction")?,
        (Some(_), Some(_)) => {
            return Err(Fault::at(span, "both `look_at` and `direction` are given", "remove one of them"));
        }
        (None, None) => {
            return Err(Fault::at(
                span,
                "the camera has no view direction",
                "add `look_at = [x, y, z]` or `direction = [x, y, z]`",
            ));
        }
    };
    let up = table.up.as_ref().map_or(Ok(DVec3::Y), |up| check::direction(up, "up"))?;
    let near = table.near.as_ref().map_or(Ok(0.0), |near| check::non_negative(near, "near"))?;
    let projection = projection(table, &span, None, warnings)?;
    let basis = Camera::with(projection, position, forward, up, near).ok_or_else(|| {
        let help = "choose an `up` that is not parallel to the view direction";
        Fault::at(span, "the camera looks along its own `up`", help)
    })?;
    let axes = DMat3::from_cols(basis.right, basis.up, -basis.forward);
    let lens = CameraLens { projection, near, aspect: projection.own_aspect() };
    Ok((DAffine3::from_mat3_translation(axes, position), lens))
}

/// Fails if keys that go with `position` are given to change a camera.
fn check_changes(table: &CameraTable) -> Result<(), Fault> {
    let vector = |key, vector: &Option<Vector>| Some((key, vector.as_ref()?.span()));
    let placing = vector("look_at", &table.look_at)
        .or_else(|| vector("direction", &table.direction))
        .or_else(|| vector("up", &table.up))
        .or_else(|| Some(("side", table.side.as_ref()?.span())));
    placing.map_or(Ok(()), |(key, span)| {
        let help =
            "add `position = [x, y, z]`; without it, [camera] changes the lens of a glTF file's camera";
        Err(Fault::at(span, format!("`{key}` needs `position`"), help))
    })
}

fn spawn(
    world: &mut World,
    table: Spanned<EntityTable>,
    materials: &HashMap<String, MaterialHandle>,
    source: &AssetSource,
) -> Result<(), Fault> {
    let span = table.span();
    let table = table.into_inner();
    check_one_shape(&table, span.clone())?;
    check_company(&table)?;
    let overrides = model_overrides(&table, materials, source.light_scale)?;
    let placement =
        table.transform.as_ref().map_or(Ok(DAffine3::IDENTITY), |given| transform(given.get_ref()))?;
    let entity = world.spawn_authored(span, table.name, placement);
    world.put(entity, table.side.map_or(Side::Near, Side::from));
    for (path, format) in [(&table.mesh, ModelFormat::Obj), (&table.gltf, ModelFormat::Gltf)] {
        if let Some(path) = path {
            check_format(path, format)?;
            let error_at = |error| Fault::Asset { span: path.span(), error };
            let path = source.path(path.get_ref());
            world
                .spawn_model(&path, format, entity, overrides, (source.files, source.time))
                .map_err(error_at)?;
        }
    }
    // The entity was spawned above, so inserting cannot fail.
    if let Some(table) = &table.sphere {
        let shape = (SphereShape(sphere(table)?), own_material(world, overrides));
        let _ = world.entities.insert(entity, shape);
    }
    if let Some(table) = &table.disk {
        let shape = (DiskShape(disk(table)?), own_material(world, overrides));
        let _ = world.entities.insert(entity, shape);
    }
    if let Some(table) = &table.light {
        let _ = world.entities.insert_one(entity, LightShape(light(table)?));
    }
    Ok(())
}

/// Fails if the extension is that of another kind of file.
fn check_format(path: &Text, format: ModelFormat) -> Result<(), Fault> {
    let file = Path::new(path.get_ref());
    let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
    let reads = match format {
        ModelFormat::Obj => "`mesh` reads OBJ files",
        ModelFormat::Gltf => "`gltf` reads glTF files",
    };
    let fault = |problem: String, help: &str| Err(Fault::at(path.span(), problem, help));
    match (format, extension.to_str(), foreign::known(file)) {
        (ModelFormat::Obj, Some("gltf" | "glb"), _) => fault(reads.to_owned(), "write `gltf = ...` instead"),
        (ModelFormat::Gltf, Some("obj"), _) => fault(reads.to_owned(), "write `mesh = ...` instead"),
        (_, _, Some((what, remedy))) => fault(format!("{reads}, and this is {what}"), remedy),
        _ => Ok(()),
    }
}

/// Names a sphere, disk or light without name by its place in the file; models bring the names of their nodes.
fn name_shape(table: &mut EntityTable, index: usize) {
    let kind = match (&table.sphere, &table.disk, &table.light) {
        (Some(_), ..) => "sphere",
        (None, Some(_), _) => "disk",
        (None, None, Some(_)) => "light",
        (None, None, None) => return,
    };
    table.name.get_or_insert_with(|| format!("{kind} {index}"));
}

fn check_one_shape(table: &EntityTable, span: std::ops::Range<usize>) -> Result<(), Fault> {
    let shapes = [
        table.sphere.is_some(),
        table.disk.is_some(),
        table.mesh.is_some(),
        table.gltf.is_some(),
        table.light.is_some(),
    ];
    let problem = match shapes.iter().filter(|given| **given).count() {
        0 => "the entity has no shape",
        1 => return Ok(()),
        _ => "the entity has more than one shape",
    };
    Err(Fault::at(span, problem, "give it exactly one of `sphere`, `disk`, `mesh`, `gltf`, `light`"))
}

/// Fails if there is a key that does not go with the entity's shape.
fn check_company(table: &EntityTable) -> Result<(), Fault> {
    if let (Some(scale), None) = (&table.light_scale, &table.gltf) {
        return Err(Fault::at(scale.span(), "`light_scale` is for a `gltf`", "remove it"));
    }
    if table.light.is_none() {
        return Ok(());
    }
    if let Some(material) = &table.material {
        return Err(Fault::at(
            material.span(),
            "a `light` has no surface, so no `material`",
            "remove it, or use a `sphere` or `disk` that emits",
        ));
    }
    match &table.emission {
        None => Ok(()),
        Some(emission) => Err(Fault::at(
            emission.span(),
            "a `light` has no surface, so no `emission`",
            "remove it; a light has an `intensity`, or an `irradiance` if it is distant",
        )),
    }
}

fn model_overrides(
    table: &EntityTable,
    materials: &HashMap<String, MaterialHandle>,
    light_scale: Option<f64>,
) -> Result<ModelOverrides, Fault> {
    let material = table.material.as_ref().map(|name| {
        materials.get(name.get_ref()).copied().ok_or_else(|| {
            let help = suggestion(name.get_ref(), materials.keys().map(String::as_str))
                .unwrap_or_else(|| "add a [[material]] with this name".to_owned());
            Fault::at(name.span(), format!("no material is named `{}`", name.get_ref()), help)
        })
    });
    let emission = table.emission.as_ref().map(|rgb| check::colour(rgb, "emission"));
    let own_scale = table.light_scale.as_ref().map(|scale| check::non_negative(scale, "light_scale"));
    let light_scale = light_scale.or(own_scale.transpose()?);
    Ok(ModelOverrides {
        material: material.transpose()?,
        emission: emission.transpose()?,
        light_scale: light_scale.unwrap_or(DEFAULT_LIGHT_SCALE) as f32,
        guesses_light_scale: light_scale.is_none(),
    })
}

/// The material of a sphere or disk: the named one or the default, with the entity's own emission.
fn own_material(world: &mut World, overrides: ModelOverrides) -> MaterialHandle {
    match overrides {
        ModelOverrides { material: Some(handle), emission: None, .. } => handle,
        ModelOverrides { material, emission, .. } => {
            let base = material.map_or_else(Material::default, |handle| world.material(handle));
            world.add_material(emission.map_or(base, |emission| base.emitting(emission)))
        }
    }
}

fn sphere(table: &SphereTable) -> Result<Sphere, Fault> {
    Ok(Sphere {
        center: check::finite_vector(&table.center, "center")?,
        radius: check::positive(&table.radius, "radius")?,
    })
}

fn disk(table: &DiskTable) -> Result<Disk, Fault> {
    let inner = table.inner.as_ref().map_or(Ok(0.0), |radius| check::non_negative(radius, "inner"))?;
    let outer = check::positive(&table.outer, "outer")?;
    if inner >= outer {
        let problem = format!("the inner radius {inner} is not less than the outer one, {outer}");
        return Err(Fault::at(table.outer.span(), problem, "make `outer` greater than `inner`"));
    }
    Ok(Disk {
        center: check::finite_vector(&table.center, "center")?,
        normal: check::direction(&table.normal, "normal")?,
        inner,
        outer,
    })
}

fn transform(table: &TransformTable) -> Result<DAffine3, Fault> {
    let translation = table
        .translate
        .as_ref()
        .map_or(Ok(DVec3::ZERO), |offset| check::finite_vector(offset, "translate"))?;
    let rotation = table.rotate.as_ref().map_or(Ok(DQuat::IDENTITY), turned)?;
    let scale = table.scale.as_ref().map_or(Ok(DVec3::ONE), |scale| {
        let factors = DVec3::from(scale.get_ref().0);
        let usable = factors.is_finite() && factors.cmpne(DVec3::ZERO).all();
        let problem = || format!("scale must be finite and not 0, but is {:?}", factors.to_array());
        if usable {
            Ok(factors)
        } else {
            Err(Fault::at(
                scale.span(),
                problem(),
                "a mesh scaled to nothing has no surface; remove the entity",
            ))
        }
    })?;
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation, translation))
}

fn turned(given: &Spanned<Rotation>) -> Result<DQuat, Fault> {
    let fault = |problem: &str| Fault::at(given.span(), problem, "write finite degrees about a nonzero axis");
    match *given.get_ref() {
        Rotation::Euler(degrees) => {
            let angles = DVec3::from(degrees) * 1f64.to_radians();
            if !angles.is_finite() {
                return Err(fault("the angles must be finite"));
            }
            Ok(rotation::about_fixed_axes(angles))
        }
        Rotation::AxisAngle { axis, angle } => {
            let axis = DVec3::from(axis).try_normalize().filter(|_| angle.is_finite());
            let axis = axis.ok_or_else(|| fault("the axis has no direction or the angle is not finite"))?;
            Ok(rotation::about(axis, angle.to_radians()))
        }
    }
}
