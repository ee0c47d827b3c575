//! Which stages a render of a scene runs, and why.

use serde::Serialize;

use super::units::plural;
use crate::scene::{Baked, SpacetimeKind, StepperKind, flag_name};

/// One stage.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Stage {
    pub(super) name: &'static str,
    pub(super) runs: bool,
    pub(super) why: String,
}

/// The stages in the order in which a ray meets them.
pub(super) fn of(scene: &Baked) -> Vec<Stage> {
    vec![
        advance(scene),
        intersect(scene),
        capture(scene),
        escape(scene),
        emit(scene),
        scatter(scene),
        lights(scene),
        aovs(),
    ]
}

fn stage(name: &'static str, runs: bool, why: impl Into<String>) -> Stage {
    Stage { name, runs, why: why.into() }
}

fn advance(scene: &Baked) -> Stage {
    match scene.spacetime {
        SpacetimeKind::Flat => stage("advance", false, "flat: straight rays, one query per ray; no marching"),
        SpacetimeKind::Schwarzschild { .. } => {
            let settings = &scene.settings;
            let stepper = flag_name(settings.stepper);
            stage("advance", true, format!("curved: {stepper} steps of tolerance {:e}", settings.tolerance))
        }
    }
}

fn intersect(scene: &Baked) -> Stage {
    let counts = scene.geometry.counts();
    let primitives = counts.spheres + counts.disks + counts.instanced_triangles;
    match (primitives, scene.spacetime) {
        (0, _) => stage("intersect", false, "no geometry: nothing to meet"),
        (_, SpacetimeKind::Flat) => stage(
            "intersect",
            true,
            format!("lines against {}", plural(primitives, "primitive", "primitives")),
        ),
        _ => {
            let searched = match scene.settings.stepper {
                StepperKind::Rk4Paper => "lines",
                _ => "arcs",
            };
            let primitives = plural(primitives, "primitive", "primitives");
            stage("intersect", true, format!("{searched} against {primitives}"))
        }
    }
}

fn capture(scene: &Baked) -> Stage {
    match scene.spacetime {
        SpacetimeKind::Flat => stage("capture", false, "flat: no horizon"),
        SpacetimeKind::Schwarzschild { .. } => {
            stage("capture", true, "rays that fall to the horizon end black")
        }
    }
}

fn escape(scene: &Baked) -> Stage {
    if scene.environment.is_black() {
        stage("escape", false, "black environment: rays that leave bring no light")
    } else {
        stage("escape", true, "rays that leave bring the environment's light")
    }
}

fn emit(scene: &Baked) -> Stage {
    match scene.materials.iter().filter(|material| material.emits()).count() {
        0 => stage("emit", false, "no material emits"),
        emitting => stage("emit", true, format!("light from {}", plural(emitting, "material", "materials"))),
    }
}

fn scatter(scene: &Baked) -> Stage {
    match scene.settings.max_depth {
        0 | 1 => stage("scatter", false, "max depth 1: only what the camera sees directly"),
        depth => stage("scatter", true, format!("paths of up to {depth} segments")),
    }
}

fn lights(scene: &Baked) -> Stage {
    let lit = !scene.environment.is_black()
        || scene.materials.iter().any(|material| material.emits())
        || scene.punctual.iter().any(|light| light.emits());
    if !lit {
        stage("light", false, "no lights: the picture will be black")
    } else {
        stage("light", true, "paths that meet light count it")
    }
}

fn aovs() -> Stage {
    stage("AOVs", false, "none asked for")
}

#[cfg(test)]
pub(super) mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::geometry::{Geometry, Primitives};
    use crate::scene::{Camera, Settings};
    use crate::shade::{Environment, Material};

    /// Nothing in front of a camera in a white room.
    pub(in crate::cli) fn empty_scene(spacetime: SpacetimeKind) -> Baked {
        let camera = Camera::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z, DVec3::Y, 0.7, 0.0).unwrap();
        Baked {
            spacetime,
            camera,
            geometry: Geometry::build(Primitives::default()),
            materials: vec![Material::default()],
            entities: Vec::new(),
            environment: Environment::Constant(Vec3::ONE),
            punctual: Vec::new(),
            settings: Settings::default(),
            warnings: Vec::new(),
        }
    }

    fn find(scene: &Baked, name: &str) -> Stage {
        of(scene).into_iter().find(|stage| stage.name == name).unwrap()
    }

    #[test]
    fn flat_space_does_not_march() {
        let scene = empty_scene(SpacetimeKind::Flat);
        let advance = find(&scene, "advance");
        assert!(!advance.runs && advance.why.contains("no marching"));
        assert!(!find(&scene, "capture").runs);
    }

    #[test]
    fn a_hole_marches_and_captures() {
        let hole = SpacetimeKind::Schwarzschild { center: DVec3::ZERO, schwarzschild_radius: 1.0 };
        let scene = empty_scene(hole);
        assert_eq!(find(&scene, "advance").why, "curved: rkn6 steps of tolerance 1e-5");
        assert!(find(&scene, "capture").runs);
    }

    #[test]
    fn a_scene_without_light_says_so() {
        let mut scene = empty_scene(SpacetimeKind::Flat);
        assert!(find(&scene, "light").runs);
        scene.environment = Environment::Black;
        assert!(find(&scene, "light").why.contains("no lights"));
        scene.materials[0].emission = Vec3::ONE;
        assert!(find(&scene, "light").runs && find(&scene, "emit").runs);
    }
}
