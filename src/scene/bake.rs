//! World → the flat tables that the tracer reads.

use std::collections::HashMap;

use glam::{DAffine3, DVec3, Vec3};
use hecs::Entity;

use super::StepperKind;
use super::advice;
use super::baked::{Baked, FarLights};
use super::camera::Camera;
use super::check::LARGEST;
use super::components::{DiskShape, LightShape, MaterialHandle, MeshShape, SphereShape, WorldTransform};
use super::ergosphere;
use super::error::Fault;
use super::hole::place_hole;
use super::settings::MAX_SIDE;
use super::squash::squash;
use super::systems::{
    Bounds, camera, disk_in_world, framing_camera, invertible, is_aimless, light_in_world, primitive_bounds,
    propagate_transforms, sphere_in_world,
};
use super::world::World;
use crate::geometry::{Geometry, Instance, Mesh, Primitives, Surface};
use crate::light::Punctual;
use crate::spacetime::{ConformallyFlat, Side, SpacetimeKind};

/// Dissolves the entities into tables and builds the BVH.
///
/// # Errors
/// A shape that its transform makes singular, elliptic or too large; a light that is too far or too bright, or whose
/// direction its transform loses; an unusable camera or one behind the horizon; a scene in which there is nothing to
/// see.
pub(super) fn bake(mut world: World, wanted_camera: Option<&str>) -> Result<Baked, Fault> {
    let ([mut near, mut far], shaped) = flatten(&mut world)?;
    warn_of_doubles(&mut world, near.drop_doubles() + far.drop_doubles());
    if shaped.is_empty() && world.environment.is_black() && world.far_environment.is_black() {
        return Err(Fault::whole(
            "the scene is empty: nothing has a surface, and the environment is black",
            "add an [[entity]] that has a surface, or light with [environment]",
        ));
    }
    let (boxes, far_boxes) = (primitive_bounds(&near), primitive_bounds(&far));
    check_extent(&world, &boxes, &shaped)?;
    check_extent(&world, &far_boxes, &shaped)?;
    place_hole(&mut world)?;
    ergosphere::check(&world, &near, &shaped)?;
    let camera = choose_camera(&mut world, wanted_camera, [&boxes, &far_boxes])?;
    check_outside_horizon(&world, &camera)?;
    let punctual = lights(&mut world)?;
    if !punctual.is_empty() {
        world.warnings.extend(advice::of_aim(&world.spacetime).map(str::to_owned));
    }
    world.warnings.extend(advice::of_sun(&world.spacetime, &world.environment).map(str::to_owned));
    warn_if_dark(&mut world, [&near, &far], &punctual, &boxes);
    if world.guesses_light_scale {
        world.notes.push(
            "lights of glTF files are divided by 683 lm/W, with which Blender's Lighting Mode Standard multiplies them; \
             --light-scale 1 takes them as they are"
                .to_owned(),
        );
    }
    let aspect = world.settings.aspect();
    let around = match camera.side {
        Side::Near => &boxes,
        Side::Far => &far_boxes,
    };
    world.notes.extend(advice::of_holes(&world.spacetime, &camera, aspect, around));
    let mut geometry = Geometry::build(near);
    if world.spacetime.wormhole().is_some() {
        geometry = geometry.with_far(Geometry::build(far));
        check_outside_throat(&world, &geometry, &shaped)?;
        if world.settings.stepper == StepperKind::Rk4Paper {
            world.warnings.push("rk4-paper knows no wormhole: rays are followed by rkn6".to_owned());
        }
    } else {
        warn_of_far_side(&mut world, &shaped);
    }
    let [punctual, far_punctual] = Side::BOTH.map(|side| {
        punctual.iter().filter(|(of, _)| *of == side).map(|(_, light)| *light).collect::<Vec<_>>()
    });
    Ok(Baked {
        spacetime: world.spacetime.clone(),
        camera,
        entities: shaped.iter().map(|entity| world.name(*entity)).collect(),
        geometry,
        materials: world
            .materials
            .iter()
            .map(|material| material.with_multiscatter(world.settings.multiscatter))
            .collect(),
        textures: world.textures,
        punctual,
        environment: world.environment,
        far: FarLights { punctual: far_punctual, environment: world.far_environment },
        settings: world.settings,
        warnings: world.warnings,
        notes: world.notes,
    })
}

/// All primitives in world space, near and far, and the entities that have one, in the order of spawning; takes the
/// world's meshes.
pub(super) fn flatten(world: &mut World) -> Result<([Primitives; 2], Vec<Entity>), Fault> {
    propagate_transforms(world);
    squash(world)?;
    let ([mut near, mut far], shaped) = collect(world)?;
    near.meshes = std::mem::take(&mut world.meshes);
    far.meshes = meshes_of_far(&near.meshes, &mut far.instances);
    Ok(([near, far], shaped))
}

/// Copies of the meshes that instances on the far side place, which are renumbered.
fn meshes_of_far(meshes: &[Mesh], instances: &mut [(Instance, Surface)]) -> Vec<Mesh> {
    let (mut copies, mut numbers) = (Vec::new(), HashMap::new());
    for (Instance { mesh, .. }, _) in instances {
        *mesh = *numbers.entry(*mesh).or_insert_with(|| {
            copies.push(meshes[*mesh as usize].clone());
            (copies.len() - 1) as u32
        });
    }
    copies
}

/// Primitives (without meshes) of all shapes, near and far, in the order of spawning, and the entities that have one.
fn collect(world: &World) -> Result<([Primitives; 2], Vec<Entity>), Fault> {
    type Shapes<'a> =
        (Option<&'a SphereShape>, Option<&'a DiskShape>, Option<&'a MeshShape>, Option<&'a MaterialHandle>);
    let mut query = world.entities.query::<(Entity, &WorldTransform, Shapes)>();
    let mut placed: Vec<_> = query
        .iter()
        .filter(|(_, _, (sphere, disk, mesh, _))| sphere.is_some() || disk.is_some() || mesh.is_some())
        .collect();
    placed.sort_by_key(|(entity, ..)| entity.id());
    let [mut near, mut far] = [Primitives::default(), Primitives::default()];
    let mut shaped = Vec::with_capacity(placed.len());
    for (entity, to_world, (sphere, disk, mesh, material)) in placed {
        let to_world = checked_transform(world, entity, to_world.0)?;
        let primitives = match world.side(entity) {
            Side::Near => &mut near,
            Side::Far => &mut far,
        };
        let index = shaped.len() as u32;
        let surface = |material: MaterialHandle| Surface { material: material.0, entity: index };
        let elliptic = |what: &str| {
            let problem = format!("a {what} cannot be scaled differently along its axes");
            world.fault(entity, &problem, "scale it by a single number, or use a mesh instead")
        };
        if let (Some(sphere), Some(material)) = (sphere, material) {
            let sphere = sphere_in_world(*sphere, &to_world).ok_or_else(|| elliptic("sphere"))?;
            primitives.spheres.push((sphere, surface(*material)));
        }
        if let (Some(disk), Some(material)) = (disk, material) {
            let disk = disk_in_world(*disk, &to_world).ok_or_else(|| elliptic("disk"))?;
            primitives.disks.push((disk, surface(*material)));
        }
        for (mesh, material) in mesh.iter().flat_map(|mesh| mesh.0.iter()) {
            primitives.instances.push((Instance { mesh: mesh.0, to_world }, surface(*material)));
        }
        shaped.push(entity);
    }
    Ok(([near, far], shaped))
}

/// The punctual lights with their sides in the order of spawning; those whose direction a scale of 0 loses, and those that
/// no light leaves, since they are in a black hole, are left out with a warning.
fn lights(world: &mut World) -> Result<Vec<(Side, Punctual)>, Fault> {
    let mut query = world.entities.query::<(Entity, &WorldTransform, &LightShape)>();
    let mut placed: Vec<(Entity, DAffine3, LightShape)> =
        query.iter().map(|(entity, to_world, light)| (entity, to_world.0, *light)).collect();
    drop(query);
    placed.sort_by_key(|(entity, ..)| entity.id());
    let (aimless, placed): (Vec<_>, Vec<_>) =
        placed.into_iter().partition(|(_, to_world, light)| is_aimless(light, to_world));
    let aimless: Vec<String> = aimless.iter().map(|(entity, ..)| world.name(*entity)).collect();
    world.warn_of_names("lights left out, since scales of 0 leave them no direction", &aimless);
    let (mut lights, mut hidden) = (Vec::with_capacity(placed.len()), Vec::new());
    for (entity, to_world, light) in placed {
        let light = checked_light(world, entity, to_world, &light)?;
        let side = world.side(entity);
        if light.position().is_some_and(|position| world.spacetime.is_in_throat(side, position)) {
            return Err(in_throat(world, entity));
        }
        if light.position().is_some_and(|position| world.spacetime.hides(position)) {
            hidden.push(world.name(entity));
        } else {
            lights.push((side, light));
        }
    }
    world.warn_of_names(
        "lights inside the horizon or ergosphere of a hole, from where no light is seen",
        &hidden,
    );
    Ok(lights)
}

fn checked_light(
    world: &World,
    entity: Entity,
    to_world: DAffine3,
    light: &LightShape,
) -> Result<Punctual, Fault> {
    let light = light_in_world(*light, &to_world).ok_or_else(|| {
        world.fault(
            entity,
            "the light's position or direction is not usable",
            "place it no farther than 1e18 from the origin, with scales that are not huge",
        )
    })?;
    if light.peak().cmple(Vec3::splat(LARGEST as f32)).all() {
        return Ok(light);
    }
    Err(world.fault(entity, "the light is brighter than 1e18", "use a smaller intensity or `light_scale`"))
}

fn checked_transform(world: &World, entity: Entity, to_world: DAffine3) -> Result<DAffine3, Fault> {
    invertible(to_world).ok_or_else(|| {
        world.fault(
            entity,
            "its transform flattens it or is not finite",
            "use scales that are neither 0 nor huge, here and in the nodes above it",
        )
    })
}

fn check_extent(world: &World, boxes: &[(Bounds, u32)], shaped: &[Entity]) -> Result<(), Fault> {
    let outside = boxes.iter().find(|(bounds, _)| !bounds.is_representable());
    match outside.and_then(|(_, index)| shaped.get(*index as usize)) {
        None => Ok(()),
        Some(entity) => Err(world.fault(
            *entity,
            "it reaches farther than 1e18 scene units from the origin",
            "use a smaller unit of length or a smaller scale",
        )),
    }
}

fn choose_camera(
    world: &mut World,
    wanted: Option<&str>,
    [near, far]: [&[(Bounds, u32)]; 2],
) -> Result<Camera, Fault> {
    if let Some((camera, name, aspect)) = camera(world, wanted)? {
        if let Some(aspect) = aspect.filter(|_| !world.has_own_size) {
            shape_picture(world, &name, aspect);
        }
        return Ok(camera);
    }
    let aspect = world.settings.aspect();
    let beyond = || framing_camera(far, aspect).map(|camera| Camera { side: Side::Far, ..camera });
    let framed = framing_camera(near, aspect).or_else(beyond).ok_or_else(|| {
        Fault::whole(
            "there is no camera, and nothing to frame one around",
            "add a [camera] with `position`, `look_at` and `vertical_fov`",
        )
    })?;
    world.notes.push("there is no camera, so one frames the whole scene".to_owned());
    Ok(framed)
}

/// Gives the picture the shape that its camera is meant for, at the usual height.
fn shape_picture(world: &mut World, camera: &str, aspect: f64) {
    let settings = &mut world.settings;
    let width = (settings.height as f64 * aspect).round().clamp(1.0, MAX_SIDE as f64) as usize;
    if width != settings.width {
        settings.width = width;
        let height = settings.height;
        world.notes.push(format!(
            "the picture is {width}x{height} pixels, in the shape of camera `{camera}`; --size WxH changes it"
        ));
    }
}

/// Rays start between the camera and its near plane, or all over a lens or picture plane: all must be outside.
fn check_outside_horizon(world: &World, camera: &Camera) -> Result<(), Fault> {
    let middle = [camera.position, camera.position + camera.near * camera.forward];
    let centers = match world.spacetime.wormhole() {
        Some((mouths, _)) => vec![mouths.center(camera.side)],
        None => world.spacetime.shadows().into_iter().map(|(center, _)| center).collect(),
    };
    let aspect = world.settings.aspect();
    let starts: Vec<DVec3> = centers.iter().map(|center| camera.nearest_start(*center, aspect)).collect();
    let fault = |(problem, help): (String, &str)| match world.camera {
        Some(entity) => world.fault(entity, &problem, help),
        None => Fault::whole(problem, help),
    };
    let unusable = |points: &[DVec3], subject| unusable_start(&world.spacetime, camera.side, points, subject);
    let found = unusable(&middle, "the camera is").or_else(|| unusable(&starts, "rays of the camera start"));
    found.map_or(Ok(()), |found| Err(fault(found)))
}

/// Problem of `points`, if rays cannot start there, and remedy.
fn unusable_start(
    spacetime: &SpacetimeKind,
    side: Side,
    points: &[DVec3],
    subject: &str,
) -> Option<(String, &'static str)> {
    let is_far = side == Side::Far && spacetime.wormhole().is_none();
    if is_far || points.iter().any(|at| spacetime.is_in_throat(side, *at)) {
        let place = if is_far {
            "on the far side, and the spacetime has none"
        } else {
            "within the throat of the wormhole, which is in neither world"
        };
        let help = "move it out of there, or choose another throat_radius";
        return Some((format!("{subject} {place}"), help));
    }
    if !points.iter().any(|point| spacetime.drags(*point)) {
        return None;
    }
    let center = spacetime.center().unwrap_or_default();
    let distance = points.iter().map(|point| point.distance(center)).fold(f64::INFINITY, f64::min);
    let place = match spacetime {
        SpacetimeKind::Flat | SpacetimeKind::Spherical { .. } | SpacetimeKind::Wormhole { .. } => {
            let horizon = spacetime.horizon();
            format!("inside the black hole: {distance} from its center, where the horizon is at {horizon}")
        }
        SpacetimeKind::Spinning { .. } => {
            format!("in the ergosphere, where nothing can be at rest: {distance} from the hole's center")
        }
        SpacetimeKind::Indexed(_) => "at the horizon of a hole".to_owned(),
    };
    let help = match spacetime {
        SpacetimeKind::Indexed(_) => "move the camera away",
        SpacetimeKind::Flat
        | SpacetimeKind::Spherical { .. }
        | SpacetimeKind::Wormhole { .. }
        | SpacetimeKind::Spinning { .. } => "move the camera away, or use a smaller schwarzschild_radius",
    };
    Some((format!("{subject} {place}"), help))
}

fn warn_of_doubles(world: &mut World, count: usize) {
    if count > 0 {
        let objects = if count == 1 { "object lies" } else { "objects lie" };
        let what = format!("{count} {objects} exactly where another does: of such doubles the first counts");
        world.warnings.push(what);
    }
}

/// Geometry within the throat is in neither world.
fn check_outside_throat(world: &World, geometry: &Geometry, shaped: &[Entity]) -> Result<(), Fault> {
    let Some((mouths, metric)) = world.spacetime.wormhole() else { return Ok(()) };
    let within = |side| geometry.of(side)?.entity_within(mouths.center(side), metric.throat());
    match Side::BOTH.into_iter().find_map(within).and_then(|index| shaped.get(index as usize)) {
        Some(&entity) => Err(in_throat(world, entity)),
        None => Ok(()),
    }
}

fn in_throat(world: &World, entity: Entity) -> Fault {
    let side = world.side(entity);
    let (center, radius) = match world.spacetime.wormhole() {
        Some((mouths, metric)) => (mouths.center(side), metric.throat()),
        None => Default::default(),
    };
    let problem = format!(
        "it reaches into the throat of the wormhole: within {radius} of {center}, where neither world is"
    );
    world.fault(entity, &problem, "move it away, or use a smaller throat_radius")
}

/// Without a wormhole nobody sees what is on the far side.
fn warn_of_far_side(world: &mut World, shaped: &[Entity]) {
    let far = shaped.iter().filter(|entity| world.side(**entity) == Side::Far);
    let far: Vec<String> = far.map(|entity| world.name(*entity)).collect();
    world.warn_of_names("left out, since the spacetime has no far side", &far);
}

fn warn_if_dark(
    world: &mut World,
    primitives: [&Primitives; 2],
    punctual: &[(Side, Punctual)],
    boxes: &[(Bounds, u32)],
) {
    let surfaces = primitives.into_iter().flat_map(|primitives| {
        let shapes = primitives.spheres.iter().map(|(_, surface)| surface);
        let shapes = shapes.chain(primitives.disks.iter().map(|(_, surface)| surface));
        shapes.chain(primitives.instances.iter().map(|(_, surface)| surface))
    });
    let shines = surfaces
        .filter_map(|surface| world.materials.get(surface.material as usize))
        .any(|material| material.emits());
    let punctual: Vec<Punctual> = punctual.iter().map(|(_, light)| *light).collect();
    let lit = shines || punctual.iter().any(Punctual::emits);
    if !world.environment.is_black() || !world.far_environment.is_black() {
        return;
    }
    if !lit {
        world.warnings.push("nothing emits light: the picture will be black".to_owned());
    } else if world.guesses_light_scale && !shines && advice::is_dim(&punctual, boxes) {
        world.warnings.push(
            "the lights are so weak that the picture will be nearly black; if Blender exported them with Lighting \
             Mode Unitless, use --light-scale 1"
                .to_owned(),
        );
    }
}
