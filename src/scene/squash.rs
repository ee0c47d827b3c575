//! Meshes that a scale of 0 flattens: the flat ones get an invertible transform, what has no area is left out.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3, Vec3};
use hecs::Entity;

use super::components::{MeshHandle, MeshShape, WorldTransform};
use super::error::Fault;
use super::systems::invertible;
use super::world::World;
use crate::geometry::{Attributes, Mesh};

/// Area of a flattened square, relative to that of one over its longest side, below which it is a line.
const THIN: f64 = 1e-9;

/// Most vertices of flat copies: a file can ask for a copy of a large mesh with each of its nodes.
const MOST_COPIED: usize = 1 << 24;

/// A transform onto a plane in two steps: along `normal` onto the plane through the origin, then by an invertible map.
struct Flattening {
    /// Unit vector in entity space, which the transform makes zero.
    normal: DVec3,
    /// Entity space → world.
    to_world: DAffine3,
}

/// Replaces meshes under transforms that flatten them by flat ones; those that become a line or a point are left out
/// with a warning.
///
/// # Errors
/// The flat meshes would be too large.
pub(super) fn squash(world: &mut World) -> Result<(), Fault> {
    let mut flattened: Vec<(Entity, DAffine3, MeshShape)> = world
        .entities
        .query::<(Entity, &WorldTransform, &MeshShape)>()
        .iter()
        .filter(|(_, to_world, _)| to_world.0.is_finite() && invertible(to_world.0).is_none())
        .map(|(entity, to_world, shape)| (entity, to_world.0, shape.clone()))
        .collect();
    flattened.sort_by_key(|(entity, ..)| entity.id());
    let mut known = HashMap::new();
    let mut copied = 0;
    let mut left_out = Vec::new();
    for (entity, to_world, MeshShape(mut parts)) in flattened {
        let flattening = Flattening::of(to_world);
        if let Some(Flattening { normal, to_world }) = flattening {
            for (mesh, _) in &mut parts {
                let key = (*mesh, normal.to_array().map(f64::to_bits));
                *mesh = *known.entry(key).or_insert_with(|| {
                    copied += world.meshes.get(mesh.0 as usize).map_or(0, |mesh| mesh.positions.len());
                    if copied <= MOST_COPIED { flat_copy(world, *mesh, normal) } else { *mesh }
                });
            }
            if copied > MOST_COPIED {
                return Err(world.fault(
                    entity,
                    "it and other large meshes are flattened along too many directions",
                    "apply their scales of 0 in the modelling program, or remove them",
                ));
            }
            parts.retain(|(mesh, _)| !is_empty(world, *mesh));
            // The entity came from the query above, so inserting cannot fail.
            let _ = world.entities.insert_one(entity, WorldTransform(to_world));
        } else {
            parts.clear();
        }
        if parts.is_empty() {
            left_out.push(world.name(entity));
            let _ = world.entities.remove_one::<MeshShape>(entity);
        } else {
            let _ = world.entities.insert_one(entity, MeshShape(parts));
        }
    }
    world.warn_of_names("left out, since scales of 0 leave no area", &left_out);
    Ok(())
}

impl Flattening {
    /// `None` if the transform maps onto a line or a point.
    fn of(to_world: DAffine3) -> Option<Self> {
        let m = to_world.matrix3;
        let (normal, image_normal) = (canonical(null_vector(m.transpose())?), null_vector(m)?);
        let size = m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length());
        // As if the scale that is 0 were a little above: the front stays the front.
        let raised = [1.0, -1.0].map(|sign| m + outer(sign * size * image_normal, normal));
        let matrix3 = raised.into_iter().find(|m| m.determinant() > 0.0)?;
        let to_world = invertible(DAffine3 { matrix3, ..to_world })?;
        Some(Self { normal, to_world })
    }
}

/// The one of ±`normal` whose first coordinate that is not 0 is positive, rounded, so that rounding makes no two copies
/// of a mesh that is scaled by 0 along the same axis.
fn canonical(normal: DVec3) -> DVec3 {
    const ROUNDING: f64 = (1u64 << 40) as f64;
    let rounded = (normal * ROUNDING).round() / ROUNDING;
    let first = rounded.to_array().into_iter().find(|value| *value != 0.0);
    // Adding 0 makes −0 a 0.
    first.map_or(rounded, |first| rounded * first.signum() + 0.0)
}

/// Unit vector perpendicular to the columns of `m`, which lie in a plane; `None` if they lie on a line.
fn null_vector(m: DMat3) -> Option<DVec3> {
    let columns = [m.x_axis, m.y_axis, m.z_axis];
    let longest = columns.map(DVec3::length).into_iter().fold(0.0, f64::max);
    let [x, y, z] = columns.map(|column| column / longest);
    let crosses = [y.cross(z), z.cross(x), x.cross(y)];
    let largest = crosses.into_iter().max_by(|a, b| a.length().total_cmp(&b.length()))?;
    if largest.length() > THIN { largest.try_normalize() } else { None }
}

/// a bᵀ.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// A copy of a mesh, projected along `normal`, without the triangles that lose their area.
fn flat_copy(world: &mut World, mesh: MeshHandle, normal: DVec3) -> MeshHandle {
    let Some(mesh) = world.meshes.get(mesh.0 as usize) else {
        return mesh;
    };
    let project = |position: &[f32; 3]| {
        let position = Vec3::from(*position).as_dvec3();
        (position - position.dot(normal) * normal).as_vec3().to_array()
    };
    let positions: Vec<[f32; 3]> = mesh.positions.iter().map(project).collect();
    let corner =
        |index: u32| positions.get(index as usize).map_or(Vec3::ZERO, |at| Vec3::from(*at)).as_dvec3();
    let has_area = |[a, b, c]: [DVec3; 3]| {
        let (ab, ac) = (b - a, c - a);
        let area = ab.cross(ac).length();
        area > THIN * ab.length_squared().max(ac.length_squared())
    };
    let triangles =
        mesh.triangles.iter().filter(|triangle| has_area(triangle.map(corner))).copied().collect();
    // Those of triangles are not those of the others any more.
    let attributes = Attributes { tangents: Vec::new(), ..mesh.attributes.clone() };
    world.meshes.push(Mesh { positions, normals: Vec::new(), triangles, attributes });
    MeshHandle((world.meshes.len() - 1) as u32)
}

fn is_empty(world: &World, mesh: MeshHandle) -> bool {
    world.meshes.get(mesh.0 as usize).is_none_or(|mesh| mesh.triangles.is_empty())
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    #[test]
    fn a_flattening_is_a_projection_and_an_invertible_map() {
        let rotation = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 1.0, -2.0);
        let twist = DQuat::from_euler(glam::EulerRot::XYZ, -1.3, 0.2, 0.7);
        for scale in [DVec3::new(2.0, 1.0, 0.0), DVec3::new(0.0, 1e-4, 3.0), DVec3::new(1e6, 0.0, 1e3)] {
            let map = |turn: DQuat| {
                DAffine3::from_scale_rotation_translation(scale, rotation, DVec3::X)
                    * DAffine3::from_quat(turn)
            };
            for to_world in [map(DQuat::IDENTITY), map(twist)] {
                let flattening = Flattening::of(to_world).unwrap();
                for point in [DVec3::X, DVec3::new(0.3, -2.0, 1.0)] {
                    let projected = point - point.dot(flattening.normal) * flattening.normal;
                    let image = flattening.to_world.transform_point3(projected);
                    let error = image.distance(to_world.transform_point3(point));
                    assert!(error <= 1e-9 * scale.max_element(), "{scale}: {error}");
                }
                assert!(flattening.to_world.matrix3.determinant() > 0.0);
            }
        }
        let card = Flattening::of(DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0))).unwrap();
        assert_eq!(
            card.to_world.transform_vector3(DVec3::Z).normalize(),
            DVec3::Z,
            "the front stays in front"
        );
    }

    #[test]
    fn lines_and_points_are_no_flattening() {
        for scale in [DVec3::ZERO, DVec3::X, DVec3::new(0.0, 5.0, 1e-20)] {
            assert!(Flattening::of(DAffine3::from_scale(scale)).is_none(), "{scale}");
        }
    }
}
