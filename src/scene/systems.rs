//! Systems, which compute from components: world transforms, world-space shapes, the camera, the scene's extent.

use glam::{DAffine3, DVec3};
use hecs::Entity;

use super::Camera;
use super::check::LARGEST;
use super::components::{
    CameraLens, DiskShape, LightShape, LocalTransform, Parent, SphereShape, WorldTransform,
};
use super::error::Fault;
use super::optics::changed;
use super::world::World;
use crate::geometry::{Disk, Mesh, Primitives, Sphere};
use crate::light::Punctual;

/// Relative deviation from a uniform scale that rounding may cause.
const SCALE_TOLERANCE: f64 = 1e-5;
/// Determinant, relative to the product of the axes' lengths, below which a transform counts as singular.
const SINGULAR: f64 = 1e-9;
/// Vertical field of view of a camera that frames the scene, degrees.
const FRAMING_FOV: f64 = 40.0;
/// From the middle of the scene towards a camera that frames it: to the right, above, in front.
const FRAMING_DIRECTION: DVec3 = DVec3::new(0.55, 0.4, 0.8);

/// Gives every placed entity its [`WorldTransform`].
///
/// Parents are spawned before their children, so the order of spawning is a topological one.
pub(super) fn propagate_transforms(world: &mut World) {
    let mut placed: Vec<(Entity, DAffine3, Option<Entity>)> = world
        .entities
        .query::<(Entity, &LocalTransform, Option<&Parent>)>()
        .iter()
        .map(|(entity, local, parent)| (entity, local.0, parent.map(|parent| parent.0)))
        .collect();
    placed.sort_by_key(|(entity, ..)| entity.id());
    for (entity, local, parent) in placed {
        let above = parent.and_then(|parent| world.entities.get::<&WorldTransform>(parent).ok().map(|t| t.0));
        let to_world = above.unwrap_or(DAffine3::IDENTITY) * local;
        // The entity came from the query above, so inserting cannot fail.
        let _ = world.entities.insert_one(entity, WorldTransform(to_world));
    }
}

/// The transform, if it is finite and invertible.
pub(super) fn invertible(to_world: DAffine3) -> Option<DAffine3> {
    let m = to_world.matrix3;
    let volume = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    let relative = m.determinant().abs() / volume;
    (to_world.is_finite() && volume.is_finite() && relative > SINGULAR).then_some(to_world)
}

/// The scale of a similarity transform (rotation, uniform scale, mirroring, translation).
fn uniform_scale(to_world: &DAffine3) -> Option<f64> {
    let m = to_world.matrix3;
    let scale = m.x_axis.length();
    let tolerance = SCALE_TOLERANCE * scale;
    let equal =
        (m.y_axis.length() - scale).abs() <= tolerance && (m.z_axis.length() - scale).abs() <= tolerance;
    let skew =
        m.x_axis.dot(m.y_axis).abs().max(m.y_axis.dot(m.z_axis).abs()).max(m.z_axis.dot(m.x_axis).abs());
    (equal && skew <= tolerance * scale).then_some(scale)
}

/// The sphere in the world; `None` if it would become an ellipsoid.
pub(super) fn sphere_in_world(SphereShape(sphere): SphereShape, to_world: &DAffine3) -> Option<Sphere> {
    let scale = uniform_scale(to_world)?;
    Some(Sphere { center: to_world.transform_point3(sphere.center), radius: sphere.radius * scale })
}

/// The disk in the world; `None` if it would become elliptic.
pub(super) fn disk_in_world(DiskShape(disk): DiskShape, to_world: &DAffine3) -> Option<Disk> {
    let scale = uniform_scale(to_world)?;
    Some(Disk {
        center: to_world.transform_point3(disk.center),
        normal: to_world.transform_vector3(disk.normal).try_normalize()?,
        inner: disk.inner * scale,
        outer: disk.outer * scale,
    })
}

/// The light in the world, as bright as in entity space whatever the scale (as in `KHR_lights_punctual`); `None` if it
/// is too far away or its direction is lost.
pub(super) fn light_in_world(LightShape(light): LightShape, to_world: &DAffine3) -> Option<Punctual> {
    let place = |position| {
        let position = to_world.transform_point3(position);
        is_representable(position).then_some(position)
    };
    let turn = |direction| to_world.transform_vector3(direction).try_normalize();
    Some(match light {
        Punctual::Point { position, intensity } => Punctual::Point { position: place(position)?, intensity },
        Punctual::Spot { position, direction, intensity, cos_inner, cos_outer } => Punctual::Spot {
            position: place(position)?,
            direction: turn(direction)?,
            intensity,
            cos_inner,
            cos_outer,
        },
        Punctual::Distant { direction, irradiance } => {
            Punctual::Distant { direction: turn(direction)?, irradiance }
        }
    })
}

/// True if a light has a direction that a scale of 0 loses.
pub(super) fn is_aimless(LightShape(light): &LightShape, to_world: &DAffine3) -> bool {
    match light {
        Punctual::Point { .. } => false,
        Punctual::Spot { direction, .. } | Punctual::Distant { direction, .. } => {
            to_world.matrix3 * *direction == DVec3::ZERO
        }
    }
}

/// True if a scale of 0 loses the direction or the upright of a camera.
fn is_blind(to_world: &DAffine3) -> bool {
    to_world.matrix3.y_axis.cross(to_world.matrix3.z_axis) == DVec3::ZERO
}

/// An axis-aligned box in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    /// Least corner.
    pub min: DVec3,
    /// Greatest corner.
    pub max: DVec3,
}

impl Bounds {
    /// Around all boxes.
    pub fn of_all(boxes: &[(Bounds, u32)]) -> Option<Self> {
        Self::of(boxes.iter().flat_map(|(bounds, _)| [bounds.min, bounds.max]))
    }

    fn of(points: impl Iterator<Item = DVec3>) -> Option<Self> {
        points.fold(None, |bounds, point| {
            let Bounds { min, max } = bounds.unwrap_or(Bounds { min: point, max: point });
            Some(Bounds { min: min.min(point), max: max.max(point) })
        })
    }

    /// A box around a ball.
    fn around(center: DVec3, radius: f64) -> Self {
        Self { min: center - radius, max: center + radius }
    }

    fn corners(self) -> [DVec3; 8] {
        let Bounds { min, max } = self;
        [0u8, 1, 2, 3, 4, 5, 6, 7].map(|corner| {
            let pick = |axis: u8, low: f64, high: f64| if corner >> axis & 1 == 0 { low } else { high };
            DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
        })
    }

    /// True if all coordinates are finite and small enough to compute with in 32 bits.
    pub fn is_representable(self) -> bool {
        [self.min, self.max].iter().all(|corner| is_representable(*corner))
    }
}

/// True if a point has finite coordinates, small enough to compute with in 32 bits.
pub(super) fn is_representable(point: DVec3) -> bool {
    point.is_finite() && point.abs().max_element() <= LARGEST
}

/// Bounds of each mesh in its own space.
fn mesh_bounds(mesh: &Mesh) -> Option<Bounds> {
    Bounds::of(mesh.positions.iter().map(|position| glam::Vec3::from(*position).as_dvec3()))
}

/// Bounds of each primitive with the index of its entity.
pub(super) fn primitive_bounds(primitives: &Primitives) -> Vec<(Bounds, u32)> {
    let meshes: Vec<Option<Bounds>> = primitives.meshes.iter().map(mesh_bounds).collect();
    let spheres =
        primitives.spheres.iter().map(|(s, surface)| (Bounds::around(s.center, s.radius), surface.entity));
    let disks =
        primitives.disks.iter().map(|(d, surface)| (Bounds::around(d.center, d.outer), surface.entity));
    let instances = primitives.instances.iter().filter_map(|(instance, surface)| {
        let bounds = (*meshes.get(instance.mesh as usize)?)?;
        let corners = bounds.corners().map(|corner| instance.to_world.transform_point3(corner));
        Some((Bounds::of(corners.into_iter())?, surface.entity))
    });
    spheres.chain(disks).chain(instances).collect()
}

/// The camera that is wanted by name, else that of the scene file, else the first of its models; `None` if there is
/// none. With it its name, and the width over height that its picture should have.
pub(super) fn camera(
    world: &mut World,
    wanted: Option<&str>,
) -> Result<Option<(Camera, String, Option<f64>)>, Fault> {
    let mut found: Vec<(Entity, DAffine3, CameraLens)> = world
        .entities
        .query::<(Entity, &WorldTransform, &CameraLens)>()
        .iter()
        .map(|(entity, to_world, lens)| (entity, to_world.0, *lens))
        .collect();
    found.sort_by_key(|(entity, ..)| entity.id());
    let blind: Vec<String> = found
        .extract_if(.., |(_, to_world, _)| is_blind(to_world))
        .map(|(entity, ..)| world.name(entity))
        .collect();
    world.warn_of_names("cameras left out, since scales of 0 leave them no direction", &blind);
    let names: Vec<String> = found.iter().map(|(entity, ..)| world.name(*entity)).collect();
    let index = match wanted {
        Some(wanted) => find_camera(&names, wanted)?,
        None => 0,
    };
    let changes = world.camera_changes.take();
    let (Some((entity, to_world, lens)), Some(name)) = (found.get(index).copied(), names.get(index)) else {
        return changes.map_or(Ok(None), |table| {
            let problem = "no glTF file brings a camera that this could change";
            Err(Fault::at(table.span(), problem, "add `position` and `look_at`"))
        });
    };
    let lens = changes.map_or(Ok(lens), |table| changed(lens, &table, &mut world.warnings))?;
    if wanted.is_none() && world.camera.is_none() {
        let used = format!("camera `{name}` is used, the first; --camera NAME takes another; ignored");
        world.warn_of_names(&used, names.get(1..).unwrap_or_default());
    }
    let forward = to_world.transform_vector3(DVec3::NEG_Z);
    let up = to_world.transform_vector3(DVec3::Y);
    let camera = Camera::with(lens.projection, to_world.translation, forward, up, lens.near);
    let camera = camera
        .filter(|_| is_representable(to_world.translation))
        .map(|camera| Camera { side: world.side(entity), ..camera });
    camera.map(|camera| Some((camera, name.clone(), lens.aspect))).ok_or_else(|| {
        world.fault(
            entity,
            "the camera's position or direction is not usable",
            "place it no farther than 1e18 from the origin, with scales that are not huge",
        )
    })
}

/// Index of the camera with this name: the whole one, or that in its own file.
fn find_camera(names: &[String], wanted: &str) -> Result<usize, Fault> {
    let whole = names.iter().position(|name| name == wanted);
    let own = || names.iter().position(|name| name.rsplit('/').next() == Some(wanted));
    whole.or_else(own).ok_or_else(|| {
        let listed = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let help = match names {
            [] => "the scene has no camera; leave --camera out, and one frames the scene".to_owned(),
            _ => format!("the cameras of the scene are {listed}"),
        };
        Fault::whole(format!("there is no camera `{wanted}`"), help)
    })
}

/// A camera that sees the whole bounding ball of `boxes` from the front, a little from the right and above.
pub(super) fn framing_camera(boxes: &[(Bounds, u32)], aspect: f64) -> Option<Camera> {
    let Bounds { min, max } = Bounds::of_all(boxes)?;
    let (middle, radius) = (0.5 * (min + max), 0.5 * (max - min).length());
    let fov = FRAMING_FOV.to_radians();
    let half_angle = (0.5 * fov).min(libm::atan(libm::tan(0.5 * fov) * aspect));
    let towards_camera = FRAMING_DIRECTION.normalize();
    let position = middle + towards_camera * (radius / libm::sin(half_angle));
    Camera::new(position, -towards_camera, DVec3::Y, fov, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DQuat};

    #[test]
    fn similarity_is_told_from_shear_and_stretch() {
        let rotation = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 1.0, -2.0);
        let similar =
            DAffine3::from_scale_rotation_translation(DVec3::new(2.0, -2.0, 2.0), rotation, DVec3::X);
        assert!((uniform_scale(&similar).unwrap() - 2.0).abs() < 1e-12);
        let stretched = DAffine3::from_scale(DVec3::new(1.0, 1.0, 1.01));
        assert_eq!(uniform_scale(&stretched), None);
        let sheared = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::new(0.6, 0.8, 0.0), DVec3::Z));
        assert_eq!(uniform_scale(&sheared), None);
    }

    #[test]
    fn flattened_and_infinite_transforms_are_not_invertible() {
        assert!(invertible(DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))).is_none());
        assert!(invertible(DAffine3::from_scale(DVec3::splat(f64::INFINITY))).is_none());
        assert!(invertible(DAffine3::from_scale(DVec3::splat(1e-6))).is_some());
    }

    #[test]
    fn the_framing_camera_sees_all_corners() {
        let bounds = Bounds { min: DVec3::new(-1.0, 0.0, 2.0), max: DVec3::new(3.0, 5.0, 4.0) };
        for aspect in [4.0 / 3.0, 0.5] {
            let camera = framing_camera(&[(bounds, 0)], aspect).unwrap();
            for corner in bounds.corners() {
                assert!((corner - camera.position).dot(camera.forward) > 0.0);
                assert!(camera.sees_ball(corner, 0.0, aspect), "{corner}");
            }
        }
    }
}
