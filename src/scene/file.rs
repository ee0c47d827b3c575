//! The TOML scene format: one struct per table, spans kept so that later checks can show the line.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::LazyLock;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, Deserializer, MapAccess, SeqAccess, Visitor};
use toml::Spanned;

use super::error::{Fault, suggestion};
use super::{Background, Filter, LightSampling, Precision, SamplerKind, Schedule, StepperKind};
use crate::light::Heuristic;
use crate::spacetime::{Entry, LISTED, SPACETIMES, Side};

/// A number with its place.
pub type Number = Spanned<f64>;
/// Three numbers with their place: a position, a direction.
pub type Vector = Spanned<[f64; 3]>;
/// A string with its place.
pub type Text = Spanned<String>;

/// A scene file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// `[spacetime]`; flat if absent.
    pub spacetime: Option<Spanned<SpacetimeTable>>,
    /// `[camera]`; if absent, the first camera of a glTF file, else one that frames everything. Without `position` it
    /// changes that of the glTF file.
    pub camera: Option<Spanned<CameraTable>>,
    /// `[film]`.
    #[serde(default)]
    pub film: FilmTable,
    /// `[render]`.
    #[serde(default)]
    pub render: RenderTable,
    /// `[environment]`; black if absent.
    pub environment: Option<Spanned<EnvironmentTable>>,
    /// `[[material]]`.
    #[serde(default)]
    pub material: Vec<MaterialTable>,
    /// `[[entity]]`.
    #[serde(default)]
    pub entity: Vec<Spanned<EntityTable>>,
}

/// `[spacetime]`: its keys besides those named here are the parameters of [`SPACETIMES`].
#[derive(Debug)]
pub struct SpacetimeTable {
    /// Kind; parameters that it does not have are without effect.
    pub kind: &'static Entry,
    /// Position of the centre; the origin if absent.
    pub center: Option<Vector>,
    /// Direction of the axis, of any length; +Y if absent.
    pub axis: Option<Vector>,
    /// Position of a wormhole's centre in the far world; `center` if absent.
    pub far_center: Option<Vector>,
    /// Rotation of the far world of a wormhole; none if absent.
    pub far_rotate: Option<Spanned<Rotation>>,
    /// Values by their keys.
    pub parameters: BTreeMap<&'static str, Number>,
    /// `[[spacetime.hole]]`, of several holes.
    pub hole: Vec<Spanned<HoleTable>>,
    /// `[[spacetime.lens]]`, of lenses.
    pub lens: Vec<Spanned<LensTable>>,
}

/// `[[spacetime.hole]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HoleTable {
    /// Position.
    pub center: Vector,
    /// Mass, scene units.
    pub mass: Number,
}

/// `[[spacetime.lens]]`; which keys there are depends on the kind.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LensTable {
    /// Kind.
    pub kind: LensName,
    /// Position of the middle.
    pub center: Vector,
    /// Standard deviation of a Gaussian lens, scene units.
    pub width: Option<Number>,
    /// Index in the middle of a Gaussian lens, less 1.
    pub amplitude: Option<Number>,
    /// Radius of a Luneburg lens, scene units.
    pub radius: Option<Number>,
}

/// `spacetime.lens.kind`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LensName {
    /// n = 1 + a exp(−r²/2s²).
    Gaussian,
    /// n² = 2 − r²/R² within R.
    Luneburg,
}

impl LensName {
    /// The name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gaussian => "gaussian",
            Self::Luneburg => "luneburg",
        }
    }
}

impl<'de> Deserialize<'de> for SpacetimeTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(SpacetimeKeys)
    }
}

/// Reads `[spacetime]`.
struct SpacetimeKeys;

/// A key of `[spacetime]`.
struct SpacetimeKey(&'static str);

impl<'de> Deserialize<'de> for SpacetimeKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let known = SPACETIME_KEYS.iter().find(|known| **known == key);
        known.map(|known| Self(known)).ok_or_else(|| de::Error::unknown_field(&key, &SPACETIME_KEYS))
    }
}

/// Value of `spacetime.kind`.
struct SpacetimeName(&'static Entry);

impl<'de> Deserialize<'de> for SpacetimeName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let entry = Entry::named(&name).map(Self);
        entry.ok_or_else(|| de::Error::unknown_variant(&name, &SPACETIME_NAMES))
    }
}

/// Names of all spacetimes, and keys of `[spacetime]`.
static SPACETIME_NAMES: LazyLock<Vec<&str>> =
    LazyLock::new(|| SPACETIMES.iter().chain(LISTED).map(|entry| entry.name).collect());
static SPACETIME_KEYS: LazyLock<Vec<&str>> = LazyLock::new(|| {
    let parameters = SPACETIMES.iter().flat_map(|entry| entry.parameters).map(|parameter| parameter.key);
    let mut keys: Vec<&str> = ["kind", "center", "axis", "far_center", "far_rotate", "hole", "lens"]
        .into_iter()
        .chain(parameters)
        .collect();
    let mut known = BTreeSet::new();
    keys.retain(|key| known.insert(*key));
    keys
});

impl<'de> Visitor<'de> for SpacetimeKeys {
    type Value = SpacetimeTable;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a table that describes a spacetime")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<SpacetimeTable, A::Error> {
        let (mut kind, mut center, mut axis, mut parameters) = (None, None, None, BTreeMap::new());
        let (mut far_center, mut far_rotate) = (None, None);
        let (mut hole, mut lens) = (Vec::new(), Vec::new());
        while let Some(SpacetimeKey(key)) = map.next_key()? {
            match key {
                "kind" => kind = Some(map.next_value::<SpacetimeName>()?.0),
                "center" => center = Some(map.next_value()?),
                "axis" => axis = Some(map.next_value()?),
                "far_center" => far_center = Some(map.next_value()?),
                "far_rotate" => far_rotate = Some(map.next_value()?),
                "hole" => hole = map.next_value()?,
                "lens" => lens = map.next_value()?,
                parameter => drop(parameters.insert(parameter, map.next_value()?)),
            }
        }
        let kind = kind.ok_or_else(|| de::Error::missing_field("kind"))?;
        Ok(SpacetimeTable { kind, center, axis, far_center, far_rotate, parameters, hole, lens })
    }
}

/// `[camera]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraTable {
    /// Pinhole, or middle of the lens or the picture plane; that of a glTF file's camera if absent.
    pub position: Option<Vector>,
    /// Point in the middle of the image (in flat space).
    pub look_at: Option<Vector>,
    /// View direction, instead of `look_at`.
    pub direction: Option<Vector>,
    /// Up in the image; +Y if absent.
    pub up: Option<Vector>,
    /// Projection; perspective if absent. Which of the keys below there are depends on it.
    pub projection: Option<ProjectionName>,
    /// Degrees, of perspective.
    pub vertical_fov: Option<Number>,
    /// Radius of a lens, scene units; 0, a pinhole, if absent.
    pub aperture: Option<Number>,
    /// Distance along the view direction of what is in focus; that of `look_at` if absent.
    pub focus_distance: Option<Number>,
    /// Blades around the lens; 0, round, if absent.
    pub blades: Option<Spanned<u32>>,
    /// Degrees by which they are turned.
    pub blade_rotation: Option<Number>,
    /// Height of what an orthographic camera sees, scene units.
    pub height: Option<Number>,
    /// Degrees across a fisheye's disk; 180 if absent.
    pub fov: Option<Number>,
    /// Distance at which rays start; 0 if absent.
    pub near: Option<Number>,
    /// Side of a wormhole that it is on; near if absent.
    pub side: Option<Spanned<SideName>>,
}

/// `camera.projection`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ProjectionName {
    /// Straight lines stay straight.
    #[default]
    Perspective,
    /// Parallel rays.
    Orthographic,
    /// All directions, by longitude and latitude.
    Equirectangular,
    /// A disk in which distance from the middle is angle.
    Fisheye,
}

/// `side` of a camera or an entity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SideName {
    /// The world of `spacetime.center`.
    Near,
    /// The world of `spacetime.far_center`.
    Far,
}

impl From<SideName> for Side {
    fn from(name: SideName) -> Self {
        match name {
            SideName::Near => Self::Near,
            SideName::Far => Self::Far,
        }
    }
}

/// `[film]`; what is absent keeps its default.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilmTable {
    /// Pixels.
    pub width: Option<Spanned<usize>>,
    /// Pixels.
    pub height: Option<Spanned<usize>>,
    /// Reconstruction filter.
    pub filter: Option<Filter>,
    /// Background, behind everything.
    pub background: Option<Background>,
    /// Stops, for the preview.
    pub exposure: Option<Number>,
}

/// `[render]`; what is absent keeps its default.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderTable {
    /// Samples per pixel.
    pub spp: Option<Spanned<u64>>,
    /// Most segments of a path.
    pub max_depth: Option<Spanned<u32>>,
    /// Segments before Russian roulette.
    pub roulette_depth: Option<u32>,
    /// Seed.
    pub seed: Option<u64>,
    /// Stepper.
    pub stepper: Option<StepperKind>,
    /// Numbers that orbits are followed in.
    pub precision: Option<Precision>,
    /// Schedule.
    pub schedule: Option<Schedule>,
    /// Sampler.
    pub sampler: Option<SamplerKind>,
    /// Sampling of lights.
    pub light_sampling: Option<LightSampling>,
    /// Largest winding number of rays to lights.
    pub max_winding: Option<Spanned<u32>>,
    /// Heuristic that shares light found both ways.
    pub mis: Option<Heuristic>,
    /// Compensation of light that microfacets scatter more than once.
    pub multiscatter: Option<bool>,
    /// Radians of direction per step.
    pub tolerance: Option<Number>,
    /// Scene units.
    pub arc_tolerance: Option<Number>,
}

/// `[environment]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentTable {
    /// A built-in sky, instead of a colour or an image.
    pub kind: Option<SkyName>,
    /// Radiance from everywhere; white if only `strength` is given.
    pub color: Option<Spanned<Triple>>,
    /// Factor on the radiance.
    pub strength: Option<Number>,
    /// Latitude-longitude picture.
    pub image: Option<Text>,
    /// Degrees about +Y, of the picture.
    pub rotation: Option<Number>,
    /// Degrees above the horizon, of the sun of a clear sky.
    pub sun_elevation: Option<Number>,
    /// Degrees from −Z towards +X, of that sun.
    pub sun_azimuth: Option<Number>,
    /// Degrees across that sun.
    pub sun_size: Option<Number>,
    /// Factor on the radiance of its disk.
    pub sun_strength: Option<Number>,
    /// Presence of its disk.
    pub sun_disk: Option<Spanned<bool>>,
    /// Amount of air in a clear sky.
    pub air: Option<Number>,
    /// Amount of aerosols in it.
    pub dust: Option<Number>,
    /// Amount of ozone in it.
    pub ozone: Option<Number>,
    /// Reflectance of the ground below it.
    pub ground_albedo: Option<Spanned<Triple>>,
    /// `[environment.far]`, of a wormhole's far side; black if absent.
    pub far: Option<Box<Spanned<EnvironmentTable>>>,
}

/// `environment.kind`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SkyName {
    /// A gradient from the ground over the horizon to the zenith.
    Sky,
    /// A clear sky with the sun in it.
    SunSky,
}

/// `[[material]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialTable {
    /// Name that entities use.
    pub name: Text,
    /// Lobe; diffuse if absent.
    pub kind: Option<LobeName>,
    /// Reflectance, the tint of a dielectric, or base colour.
    pub albedo: Option<Spanned<Triple>>,
    /// Index of refraction.
    pub ior: Option<Number>,
    /// Share of metal.
    pub metallic: Option<Number>,
    /// Roughness of the base.
    pub roughness: Option<Number>,
    /// Factor on the reflectance of a dielectric.
    pub specular: Option<Number>,
    /// Colour of that reflectance at normal incidence.
    pub specular_color: Option<Spanned<Triple>>,
    /// Share of the dielectric that light goes through.
    pub transmission: Option<Number>,
    /// True for a wall without thickness.
    pub thin: Option<Spanned<bool>>,
    /// Colour that is left of white light after `attenuation_distance` inside.
    pub attenuation_color: Option<Spanned<Triple>>,
    /// Scene units.
    pub attenuation_distance: Option<Number>,
    /// Share that is coated.
    pub clearcoat: Option<Number>,
    /// Roughness of the coat.
    pub clearcoat_roughness: Option<Number>,
    /// Colour of the sheen.
    pub sheen_color: Option<Spanned<Triple>>,
    /// Roughness of the sheen.
    pub sheen_roughness: Option<Number>,
    /// Share that a thin film covers.
    pub iridescence: Option<Number>,
    /// Index of refraction of the film.
    pub iridescence_ior: Option<Number>,
    /// Thickness of the film, nanometres.
    pub iridescence_thickness: Option<Number>,
    /// Radiance.
    pub emission: Option<Spanned<Triple>>,
    /// Sides that emit; both if absent.
    pub emits: Option<EmittingSides>,
}

/// `material.kind`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LobeName {
    /// Lambertian.
    Diffuse,
    /// Perfect mirror.
    Mirror,
    /// Clear glass.
    Dielectric,
    /// Metallic–roughness model.
    Principled,
}

/// `material.emits`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EmittingSides {
    /// The side that the normal points to.
    Front,
    /// Both.
    Both,
}

/// `[[entity]]`: one shape and what goes with it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EntityTable {
    /// Name.
    pub name: Option<String>,
    /// A sphere.
    pub sphere: Option<SphereTable>,
    /// Path of an OBJ file.
    pub mesh: Option<Text>,
    /// Path of a glTF file.
    pub gltf: Option<Text>,
    /// A flat annulus.
    pub disk: Option<DiskTable>,
    /// A punctual light.
    pub light: Option<Spanned<LightTable>>,
    /// Factor on the lights of a glTF file; 1/683 if absent.
    pub light_scale: Option<Number>,
    /// Placement; none if absent.
    pub transform: Option<Spanned<TransformTable>>,
    /// Name of a material; overrides those of a mesh or glTF file.
    pub material: Option<Text>,
    /// Radiance; overrides the material's.
    pub emission: Option<Spanned<Triple>>,
    /// Side of a wormhole that it is on; near if absent.
    pub side: Option<SideName>,
}

/// `entity.sphere`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereTable {
    /// Centre.
    pub center: Vector,
    /// Radius.
    pub radius: Number,
}

/// `entity.disk`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DiskTable {
    /// Centre.
    pub center: Vector,
    /// Normal, of any length.
    pub normal: Vector,
    /// Inner radius; 0 if absent.
    pub inner: Option<Number>,
    /// Outer radius.
    pub outer: Number,
}

/// `entity.light`; which keys there are depends on the kind.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightTable {
    /// Kind.
    pub kind: LightName,
    /// Position of a point or spot.
    pub position: Option<Vector>,
    /// Direction in which the light of a spot or distant light travels, of any length.
    pub direction: Option<Vector>,
    /// Intensity of a point, or of a spot on its axis: radiance × scene units².
    pub intensity: Option<Spanned<Triple>>,
    /// Irradiance by a distant light of a surface that faces it: radiance × steradian.
    pub irradiance: Option<Spanned<Triple>>,
    /// Half-angle of a spot's cone of full light, degrees; 0 if absent.
    pub inner_angle: Option<Number>,
    /// Half-angle of a spot's cone, degrees; 45 if absent.
    pub outer_angle: Option<Number>,
}

/// `entity.light.kind`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightName {
    /// Alike in all directions.
    Point,
    /// A cone.
    Spot,
    /// At infinity.
    Distant,
}

impl LightName {
    /// The name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Spot => "spot",
            Self::Distant => "distant",
        }
    }
}

/// `entity.transform`: scale first, then rotate, then translate.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransformTable {
    /// Scene units.
    pub translate: Option<Vector>,
    /// Rotation.
    pub rotate: Option<Spanned<Rotation>>,
    /// One factor, or one per axis.
    pub scale: Option<Spanned<Triple>>,
}

/// Three numbers, or one that stands for three equal ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triple(pub [f64; 3]);

/// A rotation, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rotation {
    /// About X, then Y, then Z, all fixed: Blender's "XYZ Euler".
    Euler([f64; 3]),
    /// About an axis, right-handed.
    AxisAngle {
        /// Axis, of any length.
        axis: [f64; 3],
        /// Angle.
        angle: f64,
    },
}

impl<'de> Deserialize<'de> for Triple {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TripleVisitor;
        impl<'de> Visitor<'de> for TripleVisitor {
            type Value = Triple;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number or three numbers")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Triple, E> {
                Ok(Triple([value; 3]))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Triple, E> {
                Ok(Triple([value as f64; 3]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<Triple, A::Error> {
                three_numbers(sequence, &self).map(Triple)
            }
        }
        deserializer.deserialize_any(TripleVisitor)
    }
}

impl<'de> Deserialize<'de> for Rotation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct AxisAngle {
            axis: [f64; 3],
            angle: f64,
        }
        struct RotationVisitor;
        impl<'de> Visitor<'de> for RotationVisitor {
            type Value = Rotation;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("three angles [x, y, z] or { axis = [x, y, z], angle = degrees }")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<Rotation, A::Error> {
                three_numbers(sequence, &self).map(Rotation::Euler)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Rotation, A::Error> {
                let AxisAngle { axis, angle } = Deserialize::deserialize(MapAccessDeserializer::new(map))?;
                Ok(Rotation::AxisAngle { axis, angle })
            }
        }
        deserializer.deserialize_any(RotationVisitor)
    }
}

fn three_numbers<'de, A: SeqAccess<'de>>(
    mut sequence: A,
    expected: &dyn de::Expected,
) -> Result<[f64; 3], A::Error> {
    let mut numbers = [0.0; 3];
    for (index, number) in numbers.iter_mut().enumerate() {
        *number = sequence.next_element()?.ok_or_else(|| de::Error::invalid_length(index, expected))?;
    }
    match sequence.next_element::<f64>()? {
        None => Ok(numbers),
        Some(_) => Err(de::Error::invalid_length(4, expected)),
    }
}

/// Deserialises a scene file's text.
pub(super) fn parse(text: &str) -> Result<SceneFile, Fault> {
    toml::from_str(text).map_err(|error| {
        let message = plain(error.message());
        let help = remedy(&message);
        Fault::maybe_at(error.span(), message, help)
    })
}

/// The message with Rust's names of number types in words.
fn plain(message: &str) -> String {
    let words = [
        ("expected usize", "expected a whole number"),
        ("expected u32", "expected a whole number below 2^32"),
        ("expected u64", "expected a whole number"),
        ("expected f64", "expected a number"),
    ];
    words.iter().fold(message.to_owned(), |message, (name, word)| message.replace(name, word))
}

/// Remedy for a message of serde or of the TOML parser.
///
/// Serde's messages about unknown names read "unknown field `x`, expected one of `a`, `b`".
fn remedy(message: &str) -> String {
    let mut quoted = message.split('`').skip(1).step_by(2);
    if message.starts_with("unknown") {
        let word = quoted.next().unwrap_or_default();
        let known: Vec<&str> = quoted.collect();
        return suggestion(word, known.iter().copied())
            .unwrap_or_else(|| format!("the names known here are {}", known.join(", ")));
    }
    if message.starts_with("missing field") {
        return format!("add `{} = ...`", quoted.next().unwrap_or_default());
    }
    if message.starts_with("invalid") {
        return "change the value to what is expected".to_owned();
    }
    "correct the TOML syntax at the caret".to_owned()
}
