//! Stages that a render of a scene runs, and why.

use serde::Serialize;

use super::units::plural;
use crate::film::Aov;
use crate::scene::{Background, Baked, LightSampling, StepperKind, flag_name};
use crate::shade::Material;
use crate::spacetime::{Side, SpacetimeKind};
use crate::trace::LightSummary;

/// One stage.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Stage {
    pub(super) name: &'static str,
    pub(super) runs: bool,
    pub(super) why: String,
}

/// The stages in the order in which a ray meets them; `sampling` is what light sampling will do, if anything.
pub(super) fn of(scene: &Baked, sampling: Option<LightSummary>, planes: &[Aov]) -> Vec<Stage> {
    vec![
        advance(scene),
        intersect(scene),
        capture(scene),
        escape(scene),
        emit(scene),
        scatter(scene),
        lights(scene, sampling),
        aovs(planes),
    ]
}

fn stage(name: &'static str, runs: bool, why: impl Into<String>) -> Stage {
    Stage { name, runs, why: why.into() }
}

fn advance(scene: &Baked) -> Stage {
    if scene.spacetime.is_flat() {
        return stage("advance", false, "flat: straight rays, one query per ray; no marching");
    }
    let settings = &scene.settings;
    let stepper = flag_name(settings.stepper.around(&scene.spacetime));
    stage("advance", true, format!("curved: {stepper} steps of tolerance {:e}", settings.tolerance))
}

fn intersect(scene: &Baked) -> Stage {
    let counts = scene.geometry.counts();
    let primitives = counts.spheres + counts.disks + counts.instanced_triangles;
    match (primitives, scene.spacetime.is_flat()) {
        (0, _) => stage("intersect", false, "no geometry: nothing to meet"),
        (_, true) => stage(
            "intersect",
            true,
            format!("lines against {}", plural(primitives, "primitive", "primitives")),
        ),
        (_, false) => {
            let searched = match scene.settings.stepper.around(&scene.spacetime) {
                StepperKind::Rk4Paper => "lines",
                _ => "arcs",
            };
            let primitives = plural(primitives, "primitive", "primitives");
            stage("intersect", true, format!("{searched} against {primitives}"))
        }
    }
}

fn capture(scene: &Baked) -> Stage {
    if scene.spacetime.is_flat() {
        stage("capture", false, "flat: no horizon")
    } else if scene.spacetime.wormhole().is_some() {
        stage("capture", false, "no horizon: rays that reach the throat go on on the other side")
    } else {
        stage("capture", true, "rays that fall to the horizon end black")
    }
}

fn escape(scene: &Baked) -> Stage {
    let is_black = Side::BOTH.into_iter().all(|side| scene.environment(side).is_black());
    match (is_black, scene.settings.background) {
        (true, _) => stage("escape", false, "black environment: rays that leave bring no light"),
        (false, Background::Opaque) => stage("escape", true, "rays that leave bring the environment's light"),
        (false, Background::Transparent) => stage(
            "escape",
            true,
            "rays from surfaces bring the environment's light, the camera's bring nothing",
        ),
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

fn lights(scene: &Baked, sampling: Option<LightSummary>) -> Stage {
    let lit = Side::BOTH.into_iter().any(|side| !scene.environment(side).is_black())
        || scene.materials.iter().any(|material| material.emits())
        || scene.punctual().any(|(_, light)| light.emits());
    if !lit {
        return stage("light", false, "no lights: the picture will be black");
    }
    let settings = &scene.settings;
    let Some(lights) = sampling else {
        let why = match settings.light_sampling {
            LightSampling::Off => "light sampling is off",
            _ if matches!(scene.spacetime, SpacetimeKind::Indexed(_)) => {
                "nothing aims at lights in this spacetime yet"
            }
            _ if !scene.materials.iter().any(Material::spreads_light) => "nothing diffuse to be lit",
            _ => "nothing that rays do not find as well by themselves",
        };
        return stage("light", false, format!("{why}: paths that meet light count it"));
    };
    let way = match (settings.light_sampling, scene.spacetime.is_flat()) {
        (_, true) => "along straight lines".to_owned(),
        (LightSampling::Straight, _) => "along straight lines, wrong here".to_owned(),
        _ if matches!(scene.spacetime, SpacetimeKind::Spinning { .. }) => {
            let most = settings.max_winding.min(1);
            format!("in regions of directions about winding number 0 to {most}; what these miss, paths meet")
        }
        _ => {
            let through =
                if scene.spacetime.wormhole().is_some() { ", through the throat as well" } else { "" };
            format!("along geodesics of winding number 0 to {}{through}", settings.max_winding)
        }
    };
    let also = if lights.is_guided { ", and through mirrors and glass as photons came" } else { "" };
    let surfaces = plural(lights.surfaces, "surface", "surfaces");
    let points = plural(lights.punctual, "punctual light", "punctual lights");
    let sky = if lights.sky { " and the sky" } else { "" };
    stage("light", true, format!("rays to {surfaces}, {points}{sky}, {way}{also}"))
}

fn aovs(planes: &[Aov]) -> Stage {
    let names: Vec<&str> = planes.iter().map(|plane| plane.name()).collect();
    match names.is_empty() {
        true => stage("AOVs", false, "none asked for"),
        false => stage("AOVs", true, names.join(", ")),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::time::Duration;

    use glam::{DVec3, Vec3};

    use super::*;
    use crate::geometry::{Geometry, Primitives, Sphere, Surface};
    use crate::scene::{Camera, FarLights, Settings};
    use crate::shade::{Environment, Material};
    use crate::trace::{Run, probe};

    /// Nothing in front of a camera in a white room.
    pub(in crate::cli) fn empty_scene(spacetime: SpacetimeKind) -> Baked {
        let camera = Camera::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z, DVec3::Y, 0.7, 0.0).unwrap();
        Baked {
            spacetime,
            camera,
            geometry: Geometry::build(Primitives::default()),
            materials: vec![Material::default()],
            textures: Vec::new(),
            entities: Vec::new(),
            punctual: Vec::new(),
            environment: Environment::Constant(Vec3::ONE),
            settings: Settings::default(),
            far: FarLights::default(),
            warnings: Vec::new(),
            notes: Vec::new(),
        }
    }

    fn find(scene: &Baked, name: &str) -> Stage {
        let sampling = probe(scene, &Run::default(), Duration::ZERO).lights;
        of(scene, sampling, &[]).into_iter().find(|stage| stage.name == name).unwrap()
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
        let hole = SpacetimeKind::black_hole(DVec3::ZERO, 1.0);
        let scene = empty_scene(hole);
        assert_eq!(find(&scene, "advance").why, "curved: rkn6 steps of tolerance 1e-5");
        assert!(find(&scene, "capture").runs);
    }

    #[test]
    fn light_sampling_runs_where_there_is_light_to_sample_and_says_why_not_elsewhere() {
        let mut scene = empty_scene(SpacetimeKind::Flat);
        let sampling = |scene: &Baked| {
            let stage = find(scene, "light");
            (stage.runs, stage.why)
        };
        assert!(sampling(&scene).1.contains("as well by themselves"), "an even sky");
        scene.environment = Environment::Black;
        assert!(sampling(&scene).1.contains("no lights"));
        scene.materials[0].emission = Vec3::ONE;
        let lamp = Sphere { center: DVec3::ZERO, radius: 1.0 };
        let surface = Surface { material: 0, entity: 0 };
        let primitives = Primitives { spheres: vec![(lamp, surface)], ..Primitives::default() };
        scene.geometry = Geometry::build(primitives);
        let (runs, why) = sampling(&scene);
        assert!(runs && why.contains("1 surface") && why.contains("along straight lines"), "{why}");
        scene.settings.light_sampling = LightSampling::Off;
        assert!(sampling(&scene).1.contains("off"));
    }
}
