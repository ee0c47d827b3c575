//! The black hole that an Empty of a model places.

use glam::{DAffine3, DVec3};
use hecs::Entity;

use super::check::LARGEST;
use super::components::{HoleMark, WorldTransform};
use super::error::Fault;
use super::systems::is_representable;
use super::world::World;
use crate::asset::ModelHole;
use crate::spacetime::{Placement, SpacetimeKind};

/// Puts a hole where the first mark is, unless the scene or an option says what spacetime there is.
pub(super) fn place_hole(world: &mut World) -> Result<(), Fault> {
    let mut marks: Vec<(Entity, DAffine3, HoleMark)> = world
        .entities
        .query::<(Entity, &WorldTransform, &HoleMark)>()
        .iter()
        .map(|(entity, to_world, mark)| (entity, to_world.0, *mark))
        .collect();
    marks.sort_by_key(|(entity, ..)| entity.id());
    let Some((entity, to_world, HoleMark(ModelHole { radius, spin }))) = marks.first().copied() else {
        return Ok(());
    };
    let name = world.name(entity);
    if world.has_own_spacetime {
        world
            .notes
            .push(format!("`{name}` places no hole, since the scene or --black-hole says what there is"));
        return Ok(());
    }
    let others: Vec<String> = marks.iter().skip(1).map(|(entity, ..)| world.name(*entity)).collect();
    world.warn_of_names(&format!("there can be only one black hole yet, at `{name}`; ignored"), &others);
    let [x, y, z] = [to_world.matrix3.x_axis, to_world.matrix3.y_axis, to_world.matrix3.z_axis];
    let radius = radius * (x.length() + y.length() + z.length()) / 3.0;
    let center = to_world.translation;
    if !(is_representable(center) && radius <= LARGEST) {
        return Err(world.fault(
            entity,
            "the black hole is too large or too far away",
            "place it no farther than 1e18 from the origin, with a smaller radius and scale",
        ));
    }
    // An up axis that a scale of 0 has lost is the world's.
    let axis = y.try_normalize().unwrap_or(DVec3::Y);
    world.spacetime = SpacetimeKind::spinning(Placement { axis, ..center.into() }, radius, spin);
    if world.spacetime.is_flat() {
        world.warnings.push(format!("`{name}` places no hole, since its radius is 0"));
    } else {
        let [x, y, z] = center.to_array().map(|value| value as f32);
        let radius = radius as f32;
        let turning = if spin == 0.0 { String::new() } else { format!(" and spin {}", spin as f32) };
        world.notes.push(format!(
            "`{name}` places a black hole of Schwarzschild radius {radius}{turning} at {x},{y},{z}"
        ));
    }
    Ok(())
}
