//! Nodes without mesh, light or camera: one that is named `BlackHole` places a hole, others may be what an exporter
//! left of a light.

use crate::asset::flaw::Flaw;
use crate::asset::model::ModelHole;
use crate::asset::notes::Notes;

/// Custom properties of a node (`extras`): the Schwarzschild radius, and the spin a/M.
const RADIUS: &str = "schwarzschild_radius";
const SPIN: &str = "spin";

/// The hole that a node places. Its radius, in the node's units of length, is what the custom property says, or else 1,
/// the size at which an Empty is shown that is not scaled; it spins only if there is a property for that.
pub(super) fn hole(node: &gltf::Node, name: &str, notes: &mut Notes) -> Result<Option<ModelHole>, Flaw> {
    let is_empty = node.mesh().is_none() && node.camera().is_none() && node.light().is_none();
    if !is_named(name, "blackhole") {
        let is_leaf = node.children().len() == 0 && node.skin().is_none();
        let named = name.strip_suffix("_Orientation").unwrap_or(name);
        if is_empty && is_leaf && LIGHTS.iter().any(|light| is_named(named, light)) {
            notes.add(
                "there is no light (glTF has no area lights, and others are exported only with Punctual Lights on; \
                 give lamps a mesh that emits) at node",
                name,
            );
        }
        return Ok(None);
    }
    if !is_empty {
        notes.add("only an Empty places a black hole, not a node with a mesh, light or camera", name);
        return Ok(None);
    }
    let values = node.extras().as_ref().map(|extras| gltf::json::deserialize::from_str(extras.get()));
    let values: gltf::json::Value = values.and_then(Result::ok).unwrap_or_default();
    let number = |key: &str, default: f64, good: fn(f64) -> bool, bounds: &str, help: &str| match values
        .get(key)
    {
        None => Ok(default),
        Some(value) => value.as_f64().filter(|number| good(*number)).ok_or_else(|| {
            Flaw::new(format!("the custom property {key} must be a number {bounds}, but is {value}"), help)
        }),
    };
    let help = "set it to the Schwarzschild radius, in the node's units of length";
    let radius = number(RADIUS, 1.0, |radius| radius >= 0.0, "of at least 0", help)?;
    let spin = number(SPIN, 0.0, |spin| spin.abs() <= 1.0, "from -1 to 1", "set it to the spin a/M")?;
    Ok(Some(ModelHole { radius, spin }))
}

/// Names that Blender gives to lights; its older exporters turn them by a child, `Area_Orientation`.
const LIGHTS: [&str; 7] = ["area", "arealight", "light", "lamp", "point", "spot", "sun"];

/// True if a name is `plain`, in any case, with separators, or numbered as Blender does it: `Black Hole.001`.
fn is_named(name: &str, plain: &str) -> bool {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let letters = stem.chars().filter(|c| !matches!(c, ' ' | '_' | '-' | '.'));
    letters.flat_map(char::to_lowercase).eq(plain.chars())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_known_with_numbers_and_in_any_case() {
        for name in ["BlackHole", "blackhole", "BLACKHOLE", "BlackHole.001", "Black Hole", "black_hole-2"] {
            assert!(is_named(name, "blackhole"), "{name}");
        }
        for name in ["Blackholes", "A BlackHole", "Black", "", "42"] {
            assert!(!is_named(name, "blackhole"), "{name}");
        }
    }
}
