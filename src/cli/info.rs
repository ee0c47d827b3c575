//! `warpfront info`.

use std::fmt::Write;
use std::time::Duration;

use glam::Vec3;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::args::InfoArgs;
use super::completion::Completion;
use super::cost::{self, Limits};
use super::failure::Failure;
use super::memory;
use super::say::{note_stepper, print, print_json, shown};
use super::stages::{self, Stage};
use super::units::{plural, rounded};
use crate::geometry::Counts;
use crate::light::Punctual;
use crate::scene::{
    self, Baked, Camera, Fisheye, LoadOptions, Orthographic, Perspective, Projection, Schedule, Settings,
    flag_name,
};
use crate::shade::{ClearSky, Environment, Lobe, SunSky};
use crate::spacetime::{
    ConformallyFlat, GradedLens, Hole, IndexField, IndexMedium, Lenses, SeveralHoles, Side, Sink,
    SpacetimeKind,
};
use crate::study::forecast::Forecast;
use crate::text::bytes;
use crate::trace::{Run, probe};

/// Significant digits of places and lengths: about what glTF's numbers hold.
const PLACE: usize = 6;
/// Time limit of the probe.
const PROBE: Duration = Duration::from_secs(1);

/// Prints what a scene holds.
pub(super) fn run(args: &InfoArgs) -> Result<Completion, Failure> {
    let options = LoadOptions { size: args.settings.size(), ..args.scene.options()? };
    let mut scene = scene::load_with(&args.scene.path, &options)?;
    args.settings.apply(&mut scene.settings);
    note_stepper(&mut scene);
    let run = args.run.resolve(scene.settings.width, scene.settings.height)?;
    let report = SceneReport::of(args.scene.path.display().to_string(), &scene, &run);
    if args.json {
        print_json(&report)?;
    } else {
        print(&report.text())?;
    }
    Ok(Completion::Good)
}

/// Report on a scene.
#[derive(Serialize)]
struct SceneReport<'a> {
    scene: String,
    spacetime: Spacetime<'a>,
    geometry: Shapes,
    materials: Materials,
    lights: LightCounts,
    environment: String,
    camera: CameraReport,
    settings: &'a Settings,
    memory: MemoryReport,
    stages: Vec<Stage>,
    /// Of all samples, whatever limits there are.
    cost: Forecast,
    #[serde(skip)]
    limits: Limits,
    /// The faster one; absent where neither surely is.
    #[serde(skip_serializing_if = "Option::is_none")]
    schedule: Option<Schedule>,
    notes: &'a [String],
    warnings: &'a [String],
}

struct Spacetime<'a>(&'a SpacetimeKind);

#[derive(Serialize)]
struct Shapes {
    entities: usize,
    spheres: usize,
    disks: usize,
    triangles: usize,
    instanced_triangles: usize,
    meshes: usize,
    instances: usize,
}

/// Counts of materials by the name of their lobe, and of those that emit.
struct Materials {
    lobes: Vec<(&'static str, usize)>,
    emitting: usize,
}

impl Serialize for Materials {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        self.lobes.iter().try_for_each(|(name, count)| map.serialize_entry(name, count))?;
        map.serialize_entry("emitting", &self.emitting)?;
        map.end()
    }
}

/// Punctual lights.
#[derive(Default, Serialize)]
struct LightCounts {
    point: usize,
    spot: usize,
    distant: usize,
}

#[derive(Serialize)]
struct CameraReport {
    position: [f64; 3],
    forward: [f64; 3],
    projection: &'static str,
    /// Of perspective, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    vertical_fov: Option<f64>,
    /// Radius of a lens, scene units.
    #[serde(skip_serializing_if = "Option::is_none")]
    aperture: Option<f64>,
    /// Scene units.
    #[serde(skip_serializing_if = "Option::is_none")]
    focus_distance: Option<f64>,
    /// Of what an orthographic camera sees, scene units.
    #[serde(skip_serializing_if = "Option::is_none")]
    height: Option<f64>,
    /// Of a fisheye, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    fov: Option<f64>,
}

/// Bytes.
#[derive(Serialize)]
struct MemoryReport {
    geometry: u64,
    textures: u64,
    environment: u64,
    film: u64,
}

impl<'a> SceneReport<'a> {
    fn of(name: String, scene: &'a Baked, run: &Run) -> Self {
        let probe = probe(scene, run, PROBE);
        let cost = Forecast::new(&probe, &scene.settings);
        Self {
            scene: name,
            spacetime: Spacetime(&scene.spacetime),
            geometry: Shapes::of(scene),
            materials: Materials::of(scene),
            lights: LightCounts::of(scene.punctual().map(|(_, light)| light)),
            environment: environments(scene),
            camera: CameraReport::of(&scene.camera),
            settings: &scene.settings,
            memory: MemoryReport::of(scene, run),
            stages: stages::of(scene, probe.lights, &run.aovs),
            schedule: cost.faster().map(|(schedule, _)| schedule),
            cost,
            limits: Limits { time: run.time_limit, noise: run.noise },
            notes: &scene.notes,
            warnings: &scene.warnings,
        }
    }

    /// A label and what there is to say, line by line.
    fn text(&self) -> String {
        let mut rows = vec![
            ("scene", self.scene.clone()),
            ("spacetime", self.spacetime.text()),
            ("geometry", self.geometry.text()),
            ("materials", self.materials.text()),
            ("lights", self.lights.text()),
            ("environment", self.environment.clone()),
            ("camera", self.camera.text()),
            ("film", film(self.settings)),
            ("paths", paths(self.settings)),
            ("memory", self.memory.text()),
            ("cost", cost::time(&self.cost, &self.limits)),
            ("schedule", cost::schedule(&self.cost, self.settings.schedule)),
        ];
        rows.extend(self.stages.iter().map(|stage| {
            let state = if stage.runs { "runs" } else { "not run" };
            ("stage", format!("{:<10} {state:<8} {}", stage.name, stage.why))
        }));
        rows.extend(shown(self.notes).map(|note| ("note", note)));
        rows.extend(shown(self.warnings).map(|warning| ("warning", warning)));
        rows.iter().fold(String::new(), |mut text, (label, value)| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{label:<12} {value}");
            text
        })
    }
}

impl Serialize for Spacetime<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("kind", self.0.entry().name)?;
        if let Some(center) = self.0.center() {
            map.serialize_entry("center", &center.to_array())?;
        }
        for (parameter, value) in self.0.parameters() {
            map.serialize_entry(parameter.key, &value)?;
        }
        match self.0 {
            SpacetimeKind::Flat => {}
            SpacetimeKind::Spherical { metric, .. } => {
                map.serialize_entry("horizon", &metric.horizon())?;
                map.serialize_entry("photon_sphere", &metric.photon_sphere())?;
            }
            SpacetimeKind::Wormhole { mouths, metric } => {
                map.serialize_entry("far_center", &mouths.far.to_array())?;
                map.serialize_entry("far_rotation", &mouths.rotation.to_cols_array_2d())?;
                map.serialize_entry("throat", &metric.throat())?;
                if metric.mouth() > 0.0 {
                    map.serialize_entry("mouth", &metric.mouth())?;
                }
            }
            SpacetimeKind::Spinning { placement, hole } => {
                map.serialize_entry("axis", &placement.axis.to_array())?;
                map.serialize_entry("horizon", &hole.horizon())?;
                map.serialize_entry("ergosphere", &hole.ergosphere())?;
            }
            SpacetimeKind::Indexed(IndexMedium::SeveralHoles(holes)) => {
                map.serialize_entry("hole", &HoleRow::of(holes))?;
            }
            SpacetimeKind::Indexed(IndexMedium::Lenses(lenses)) => {
                map.serialize_entry("lens", &LensRow::of(lenses))?;
            }
        }
        map.end()
    }
}

impl Spacetime<'_> {
    fn text(&self) -> String {
        let title = self.0.entry().title;
        let values = self.0.parameters();
        let values: String =
            values.map(|(p, value)| format!(", {} {}", p.symbol, rounded(value, PLACE))).collect();
        match self.0 {
            SpacetimeKind::Flat => title.to_owned(),
            SpacetimeKind::Spherical { center, metric } => format!(
                "{title}{values} at {}; isotropic radii: horizon {}, photon sphere {}",
                point(&center.to_array()),
                rounded(metric.horizon(), 4),
                rounded(metric.photon_sphere(), 4)
            ),
            SpacetimeKind::Wormhole { mouths, metric } => format!(
                "{title}{values} at {}, on the far side at {}; isotropic radius of the throat {}{}",
                point(&mouths.near.to_array()),
                point(&mouths.far.to_array()),
                rounded(metric.throat(), 4),
                match metric.mouth() {
                    0.0 => String::new(),
                    mouth => format!(", of its mouths {}", rounded(mouth, 4)),
                }
            ),
            SpacetimeKind::Spinning { placement, hole } => format!(
                "{title}{values} at {}, axis {}; radii at the equator: horizon {}, ergosphere {}",
                point(&placement.center.to_array()),
                point(&placement.axis.to_array()),
                rounded(hole.equatorial_radius(hole.horizon()), 4),
                rounded(hole.equatorial_radius(hole.ergosphere()), 4)
            ),
            SpacetimeKind::Indexed(IndexMedium::SeveralHoles(holes)) => {
                let hole = |HoleRow { center, mass, photon_sphere }: HoleRow| {
                    format!(
                        "; hole of mass {} at {}, photon sphere about {}",
                        rounded(mass, PLACE),
                        point(&center),
                        rounded(photon_sphere, 4)
                    )
                };
                format!("{title}{}", HoleRow::of(holes).into_iter().map(hole).collect::<String>())
            }
            SpacetimeKind::Indexed(IndexMedium::Lenses(lenses)) => {
                let lens = |LensRow { kind, center, size, amplitude }: LensRow| {
                    let size = rounded(size, PLACE);
                    let amplitude = amplitude.map(|a| format!(", index 1 + {}", rounded(a, PLACE)));
                    let amplitude = amplitude.unwrap_or_default();
                    format!("; {kind} lens of size {size} at {}{amplitude}", point(&center))
                };
                format!("{title}{}", LensRow::of(lenses).into_iter().map(lens).collect::<String>())
            }
        }
    }
}

/// A hole of several.
#[derive(Serialize)]
struct HoleRow {
    center: [f64; 3],
    mass: f64,
    photon_sphere: f64,
}

impl HoleRow {
    fn of(holes: &SeveralHoles) -> Vec<Self> {
        let row = |(hole, sink): (&Hole, &Sink)| Self {
            center: hole.center.to_array(),
            mass: hole.mass,
            photon_sphere: sink.photon_sphere,
        };
        holes.holes().iter().zip(holes.sinks()).map(row).collect()
    }
}

/// A lens.
#[derive(Serialize)]
struct LensRow {
    kind: &'static str,
    center: [f64; 3],
    size: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    amplitude: Option<f64>,
}

impl LensRow {
    fn of(lenses: &Lenses) -> Vec<Self> {
        let row = |lens: &GradedLens| {
            let center = lens.center().to_array();
            match *lens {
                GradedLens::Gaussian { width, amplitude, .. } => {
                    Self { kind: "gaussian", center, size: width, amplitude: Some(amplitude) }
                }
                GradedLens::Luneburg { radius, .. } => {
                    Self { kind: "luneburg", center, size: radius, amplitude: None }
                }
            }
        };
        lenses.lenses().iter().map(row).collect()
    }
}

impl Shapes {
    fn of(scene: &Baked) -> Self {
        let Counts { spheres, disks, triangles, instanced_triangles, meshes, instances } =
            scene.geometry.counts();
        let entities = scene.entities.len();
        Self { entities, spheres, disks, triangles, instanced_triangles, meshes, instances }
    }

    fn text(&self) -> String {
        [
            plural(self.entities, "entity", "entities"),
            plural(self.spheres, "sphere", "spheres"),
            plural(self.disks, "disk", "disks"),
            format!(
                "{} in {}, {} ({})",
                plural(self.triangles, "triangle", "triangles"),
                plural(self.meshes, "mesh", "meshes"),
                plural(self.instances, "instance", "instances"),
                plural(self.instanced_triangles, "triangle placed", "triangles placed")
            ),
        ]
        .join("; ")
    }
}

impl Materials {
    fn of(scene: &Baked) -> Self {
        let of = |name: &str| scene.materials.iter().filter(|material| material.lobe.name() == name).count();
        let lobes = Lobe::NAMES.iter().map(|&name| (name, of(name))).collect();
        Self { lobes, emitting: scene.materials.iter().filter(|material| material.emits()).count() }
    }

    fn text(&self) -> String {
        let lobes: Vec<String> = self.lobes.iter().map(|(name, count)| format!("{count} {name}")).collect();
        format!("{}; {} of them emit", lobes.join(", "), self.emitting)
    }
}

impl LightCounts {
    fn of<'a>(lights: impl Iterator<Item = &'a Punctual>) -> Self {
        lights.fold(Self::default(), |mut counts, light| {
            match light {
                Punctual::Point { .. } => counts.point += 1,
                Punctual::Spot { .. } => counts.spot += 1,
                Punctual::Distant { .. } => counts.distant += 1,
            }
            counts
        })
    }

    fn text(&self) -> String {
        let Self { point, spot, distant } = self;
        format!("{point} point, {spot} spot, {distant} distant")
    }
}

impl CameraReport {
    fn of(camera: &Camera) -> Self {
        let mut report = Self {
            position: camera.position.to_array(),
            forward: camera.forward.to_array(),
            projection: camera.projection.name(),
            vertical_fov: None,
            aperture: None,
            focus_distance: None,
            height: None,
            fov: None,
        };
        match camera.projection {
            Projection::Perspective(Perspective { tan_half_fov, lens }) => {
                report.vertical_fov = Some(2.0 * libm::atan(tan_half_fov).to_degrees());
                report.aperture = lens.map(|lens| lens.radius);
                report.focus_distance = lens.map(|lens| lens.focus_distance);
            }
            Projection::Orthographic(Orthographic { half_height }) => report.height = Some(2.0 * half_height),
            Projection::Equirectangular => {}
            Projection::Fisheye(Fisheye { half_fov }) => report.fov = Some(2.0 * half_fov.to_degrees()),
        }
        report
    }

    fn text(&self) -> String {
        let (position, forward) = (point(&self.position), triple(self.forward.map(|x| rounded(x, 3))));
        let view = [
            self.vertical_fov.map(|angle| format!("vertical field of view {}°", rounded(angle, 3))),
            self.height.map(|height| format!("orthographic, height {}", rounded(height, PLACE))),
            self.fov.map(|angle| format!("fisheye of {}°", rounded(angle, 3))),
            (self.projection == Projection::Equirectangular.name()).then(|| "equirectangular".to_owned()),
            self.aperture.map(|radius| format!("lens of radius {}", rounded(radius, PLACE))),
            self.focus_distance.map(|distance| format!("in focus {} away", rounded(distance, PLACE))),
        ];
        let view: Vec<String> = view.into_iter().flatten().collect();
        format!("at {position} along {forward}, {}", view.join(", "))
    }
}

impl MemoryReport {
    fn of(scene: &Baked, run: &Run) -> Self {
        let environment = Side::BOTH.map(|side| scene.environment(side).memory_bytes()).iter().sum::<usize>();
        Self {
            geometry: scene.geometry.memory_bytes() as u64,
            textures: scene.texture_bytes() as u64,
            environment: environment as u64,
            film: memory::film_bytes(&scene.settings, run),
        }
    }

    fn text(&self) -> String {
        let [geometry, textures, environment, film] =
            [self.geometry, self.textures, self.environment, self.film].map(bytes);
        format!("geometry {geometry}, textures {textures}, environment {environment}, film {film}")
    }
}

fn environments(scene: &Baked) -> String {
    let near = environment(scene.environment(Side::Near));
    match scene.spacetime.wormhole() {
        Some(_) => format!("{near}; on the far side {}", environment(scene.environment(Side::Far))),
        None => near,
    }
}

fn environment(environment: &Environment) -> String {
    match environment {
        Environment::Black => "black".to_owned(),
        Environment::Constant(radiance) => format!("constant {}", color(*radiance)),
        Environment::Gradient { ground, horizon, zenith } => format!(
            "gradient: ground {}, horizon {}, zenith {}",
            color(*ground),
            color(*horizon),
            color(*zenith)
        ),
        Environment::Image(image) => format!("image of {}x{} pixels", image.width, image.height),
        Environment::SunSky(sky) => sun_sky(sky),
    }
}

fn sun_sky(sky: &SunSky) -> String {
    let ClearSky { elevation, azimuth, amounts, ground, .. } = sky.clear_sky;
    let [elevation, azimuth] = [elevation, azimuth].map(|angle| rounded(angle.to_degrees(), 3));
    let disk = match sky.disk() {
        Some(disk) => format!("a disk of {}°", rounded(2.0 * disk.radius.to_degrees(), 3)),
        None => "no disk".to_owned(),
    };
    let [air, dust, ozone] = amounts.to_array().map(|amount| rounded(amount, 3));
    format!(
        "clear sky: sun at {elevation}° above the horizon, {azimuth}° from -Z towards +X, {disk}; air {air}, \
         dust {dust}, ozone {ozone}; ground {}",
        color(ground)
    )
}

fn film(settings: &Settings) -> String {
    let Settings { width, height, spp, .. } = settings;
    let (filter, sampler) = (flag_name(settings.filter), flag_name(settings.sampler));
    format!("{width}x{height}, {spp} spp, {filter} filter, {sampler} sampler, seed {}", settings.seed)
}

fn paths(settings: &Settings) -> String {
    let Settings { max_depth, roulette_depth, .. } = settings;
    let schedule = flag_name(settings.schedule);
    format!("up to {max_depth} segments, roulette after {roulette_depth}, {schedule} schedule")
}

fn point(coordinates: &[f64; 3]) -> String {
    triple(coordinates.map(|coordinate| rounded(coordinate, PLACE)))
}

fn color(radiance: Vec3) -> String {
    triple(radiance.to_array().map(|channel| rounded(f64::from(channel), 3)))
}

fn triple([x, y, z]: [String; 3]) -> String {
    format!("({x}, {y}, {z})")
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::stages::tests::empty_scene;
    use super::*;

    #[test]
    fn the_text_tells_spacetime_view_film_stages_and_warnings() {
        let hole = SpacetimeKind::black_hole(DVec3::ZERO, 4.0);
        let mut scene = empty_scene(hole);
        let point = Punctual::Point { position: DVec3::ZERO, intensity: Vec3::ONE };
        let spot = Punctual::Spot {
            position: DVec3::ZERO,
            direction: DVec3::X,
            intensity: Vec3::ONE,
            cos_inner: 0.9,
            cos_outer: 0.8,
        };
        scene.punctual = vec![point, spot, point];
        scene.warnings.push("`fog` is not understood".to_owned());
        let text = SceneReport::of("a.toml".to_owned(), &scene, &Run::default()).text();
        let expected = [
            "scene        a.toml",
            "Schwarzschild, r_s 4 at (0, 0, 0); isotropic radii: horizon 1, photon sphere 3.732",
            "1 diffuse, 0 mirror, 0 dielectric, 0 principled, 0 lacquered; 0 of them emit",
            "lights       2 point, 1 spot, 0 distant",
            "at (0, 0, 5) along (0, 0, -1)",
            "640x480, 64 spp, tent filter, sobol sampler, seed 0",
            "AOVs       not run  none asked for",
            "warning      `fog` is not understood",
        ];
        for part in expected {
            assert!(text.contains(part), "{text}\nlacks {part:?}");
        }
    }

    #[test]
    fn the_json_holds_the_same() {
        let mut scene = empty_scene(SpacetimeKind::Flat);
        scene.punctual = vec![Punctual::Distant { direction: DVec3::X, irradiance: Vec3::ONE }];
        let json =
            serde_json::to_value(SceneReport::of("a.toml".to_owned(), &scene, &Run::default())).unwrap();
        assert_eq!(json["spacetime"]["kind"], "flat");
        assert_eq!(json["settings"]["stepper"], "rkn6");
        assert_eq!(json["stages"][0]["runs"], false);
        assert_eq!(json["materials"]["diffuse"], 1);
        assert_eq!(json["lights"], serde_json::json!({ "point": 0, "spot": 0, "distant": 1 }));
    }
}
