//! Whole files that are then damaged: those of this repository, and small ones of every format that is read.

use std::io::Cursor;
use std::path::Path;

use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image, Layer};
use exr::meta::attribute::LineOrder;
use exr::prelude::{Compression, ImageAttributes, IntegerBounds, LayerAttributes, Vec2, WritableImage, f16};
use image::{DynamicImage, ImageFormat};
use serde_json::{Value, json};

use super::mutate;

/// A file with a name by which others know it.
#[derive(Clone)]
pub struct Seed {
    pub name: String,
    pub bytes: Vec<u8>,
}

/// The files of one kind.
pub struct Corpus {
    pub exr: Vec<Seed>,
    pub png: Vec<Seed>,
    pub jpeg: Vec<Seed>,
    pub hdr: Vec<Seed>,
    pub gltf: Vec<Seed>,
    pub glb: Vec<Seed>,
    pub obj: Vec<Seed>,
    pub mtl: Vec<Seed>,
    pub toml: Vec<Seed>,
    pub rays: Vec<Seed>,
    pub pairs: Vec<Seed>,
}

/// Largest file of this repository that is taken: larger ones are copies of the same structure.
const LARGEST: u64 = 1_500_000;

impl Corpus {
    pub fn new() -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut files = Vec::new();
        for folder in ["assets", "scenes", "tests/data", "tests/data/flat"] {
            for entry in std::fs::read_dir(root.join(folder)).unwrap() {
                let path = entry.unwrap().path();
                if path.is_file() && path.metadata().unwrap().len() <= LARGEST {
                    files.push(path);
                }
            }
        }
        files.sort();
        let of = |extension: &str| -> Vec<Seed> {
            let wanted = files.iter().filter(|path| path.extension().is_some_and(|e| e == extension));
            let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
            wanted.map(|path| Seed { name: name(path), bytes: std::fs::read(path).unwrap() }).collect()
        };
        let tables = of("csv");
        let table = |name: &str| -> Vec<Seed> {
            let wanted = tables.iter().filter(|seed| seed.name.contains(name));
            wanted.map(|seed| Seed { bytes: few_rows(&seed.bytes), ..seed.clone() }).collect()
        };
        Self {
            exr: [of("exr"), exr_files()].concat(),
            png: pictures(ImageFormat::Png),
            jpeg: pictures(ImageFormat::Jpeg),
            hdr: pictures(ImageFormat::Hdr),
            gltf: vec![seed("a.gltf", document(Some("mesh.bin")).to_string()), seed("b.gltf", INLINE)],
            glb: [of("glb"), vec![small_glb()]].concat(),
            obj: [of("obj"), vec![seed("a.obj", OBJ)]].concat(),
            mtl: [of("mtl"), vec![seed("a.mtl", MTL)]].concat(),
            toml: [of("toml"), vec![seed("a.toml", TOML)]].concat(),
            rays: table("rays"),
            pairs: table("connections"),
        }
    }
}

fn seed(name: &str, bytes: impl Into<Vec<u8>>) -> Seed {
    Seed { name: name.to_owned(), bytes: bytes.into() }
}

/// The names of the columns and the first rows.
fn few_rows(table: &[u8]) -> Vec<u8> {
    let text = String::from_utf8_lossy(table);
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .take(12)
        .map(|line| format!("{line}\n"))
        .collect::<String>()
        .into()
}

/// Width and height of generated pictures.
const SIZE: (usize, usize) = (9, 5);

fn channel(name: &str, kind: usize) -> AnyChannel<FlatSamples> {
    let values = || (0..SIZE.0 * SIZE.1).map(|i| 0.25 * i as f32);
    let samples = match kind % 3 {
        0 => FlatSamples::F16(values().map(f16::from_f32).collect()),
        1 => FlatSamples::F32(values().collect()),
        _ => FlatSamples::U32(values().map(|value| value as u32).collect()),
    };
    AnyChannel::new(name, samples)
}

fn layer(name: &str, channels: &[&str], kind: usize, encoding: Encoding) -> Layer<AnyChannels<FlatSamples>> {
    let list = channels.iter().enumerate().map(|(i, name)| channel(name, kind + i / 4)).collect();
    let attributes = LayerAttributes { layer_name: Some(name.into()), ..LayerAttributes::default() };
    Layer::new(SIZE, attributes, encoding, AnyChannels::sort(list))
}

/// OpenEXR files in every compression, in lines and in tiles, of one layer and of two.
fn exr_files() -> Vec<Seed> {
    use Compression::{B44, B44A, PIZ, PXR24, RLE, Uncompressed, ZIP1, ZIP16};
    let compressions = [Uncompressed, RLE, ZIP1, ZIP16, PIZ, PXR24, B44, B44A];
    let names: [&[&str]; 4] = [&["R", "G", "B"], &["Y"], &["A", "B", "G", "R", "Z"], &["V.R", "V.G", "V.B"]];
    let mut seeds = Vec::new();
    for (i, compression) in compressions.into_iter().enumerate() {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(4, 3))] {
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            let name = format!("{i}.exr");
            let one = layer("one", names[i % names.len()], i, encoding);
            seeds.push(Seed { name: name.clone(), bytes: written(vec![one.clone()]) });
            if i % 3 == 0 {
                let layers = vec![one, layer("two", names[0], i + 1, encoding)];
                seeds.push(Seed { name, bytes: written(layers) });
            }
        }
    }
    seeds
}

fn written(layers: Vec<Layer<AnyChannels<FlatSamples>>>) -> Vec<u8> {
    let window = IntegerBounds::from_dimensions(SIZE);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layers(ImageAttributes::new(window), layers).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// Pictures of every colour type that the format has.
fn pictures(format: ImageFormat) -> Vec<Seed> {
    let (width, height) = (SIZE.0 as u32, SIZE.1 as u32);
    let picture =
        image::RgbaImage::from_fn(width, height, |x, y| image::Rgba([20 * x as u8, 40 * y as u8, 99, 200]));
    let picture = DynamicImage::from(picture);
    let colours = [
        picture.to_rgb8().into(),
        picture.to_luma8().into(),
        picture.to_luma_alpha8().into(),
        picture.to_rgb16().into(),
        picture.to_luma16().into(),
        picture.to_rgba16().into(),
        picture.to_rgb32f().into(),
        picture,
    ];
    let write = |picture: DynamicImage| {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).ok()?;
        Some(seed(&format!("a.{}", format.extensions_str()[0]), bytes.into_inner()))
    };
    colours.into_iter().filter_map(write).collect()
}

/// Four positions, four normals, four texture coordinates, four indices, a sparse index and value, joints and weights of
/// four vertices.
pub fn buffer() -> Vec<u8> {
    let positions = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    let normals = [0f32, 0.0, 1.0].repeat(4);
    let coordinates = [0f32, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let floats = positions.iter().chain(&normals).chain(&coordinates);
    let mut bytes: Vec<u8> = floats.flat_map(|value| value.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 3].iter().flat_map(|index| index.to_le_bytes()));
    bytes.extend([2, 0, 0, 0]);
    bytes.extend([0f32, 5.0, 0.0].iter().flat_map(|value| value.to_le_bytes()));
    bytes.extend([0, 1, 0, 0].repeat(4));
    bytes.extend([200, 40, 10, 5].repeat(4));
    bytes
}

/// A glTF document with something of everything that is read.
fn document(uri: Option<&str>) -> Value {
    let mut buffers = json!([{ "byteLength": buffer().len() }]);
    if let Some(uri) = uri {
        buffers[0]["uri"] = uri.into();
    }
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_emissive_strength"],
        "scene": 0,
        "scenes": [{ "nodes": [0, 2, 4, 5] }],
        "nodes": [
            { "mesh": 0, "name": "square", "children": [1, 3], "rotation": [0, 0, 0, 1], "scale": [1, 2, 1] },
            { "camera": 0, "name": "eye", "translation": [0.5, 0.5, 3] },
            { "extensions": { "KHR_lights_punctual": { "light": 0 } }, "translation": [0, 0, 2] },
            { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 1], "name": "BlackHole" },
            { "mesh": 1, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 0, "SCALE": 8, "ROTATION": 6 } } } },
            { "mesh": 1, "skin": 0, "weights": [0.5] },
        ],
        "animations": [{
            "channels": [
                { "sampler": 0, "target": { "node": 4, "path": "translation" } },
                { "sampler": 1, "target": { "node": 4, "path": "rotation" } },
                { "sampler": 2, "target": { "node": 2, "path": "translation" } },
                { "sampler": 3, "target": { "node": 5, "path": "weights" } },
            ],
            "samplers": [
                { "input": 9, "output": 0 }, { "input": 9, "output": 6, "interpolation": "STEP" },
                { "input": 10, "output": 0, "interpolation": "CUBICSPLINE" }, { "input": 9, "output": 9 },
            ],
        }],
        "skins": [{ "joints": [4, 1], "inverseBindMatrices": 7 }],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1, "aspectRatio": 1.5 } }],
        "extensions": { "KHR_lights_punctual": { "lights": [
            { "type": "spot", "intensity": 50, "color": [1, 0.5, 0.2], "spot": { "outerConeAngle": 0.6 } },
            { "type": "point" }, { "type": "directional", "intensity": 2 },
        ] } },
        "meshes": [{ "primitives": [
            { "attributes": { "POSITION": 0, "NORMAL": 2, "TEXCOORD_0": 3, "COLOR_0": 2 }, "indices": 1, "mode": 5, "material": 0 },
            { "attributes": { "POSITION": 4 }, "material": 1 },
        ] }, { "weights": [0.25], "primitives": [
            { "attributes": { "POSITION": 0, "NORMAL": 2, "JOINTS_0": 5, "WEIGHTS_0": 6 }, "indices": 1, "mode": 5,
              "targets": [{ "POSITION": 2, "NORMAL": 2, "TANGENT": 2 }] },
        ] }],
        "materials": [
            { "normalTexture": { "index": 1, "scale": 0.5 }, "emissiveTexture": { "index": 0,
                "extensions": { "KHR_texture_transform": { "offset": [0.1, 0.2], "rotation": 0.3, "scale": [2, 3] } } },
              "alphaMode": "MASK", "alphaCutoff": 0.2,
              "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "texCoord": 0 }, "metallicFactor": 0, "roughnessFactor": 0.9 },
              "emissiveFactor": [1, 1, 1], "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 5 } } },
            { "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 }, "KHR_materials_ior": { "ior": 1.4 },
                              "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0.2] },
                              "KHR_materials_specular": { "specularFactor": 0.5, "specularColorFactor": [1, 0.5, 0.2] },
                              "KHR_materials_clearcoat": { "clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.2,
                                  "clearcoatNormalTexture": { "index": 1, "scale": 0.5, "texCoord": 0 } },
                              "KHR_materials_sheen": { "sheenColorFactor": [0.5, 0.2, 0.1], "sheenRoughnessFactor": 0.4 },
                              "KHR_materials_iridescence": { "iridescenceFactor": 1, "iridescenceIor": 1.4, "iridescenceThicknessMaximum": 300 },
                              "KHR_materials_anisotropy": { "anisotropyStrength": 0.5, "anisotropyRotation": 1 } },
              "pbrMetallicRoughness": { "roughnessFactor": 0, "baseColorFactor": [1, 0.5, 1, 1] } },
        ],
        "textures": [{ "source": 0, "sampler": 0 }, { "source": 0 }],
        "samplers": [{ "magFilter": 9728, "wrapS": 33648, "wrapT": 33071 }],
        "images": [{ "uri": "a.png" }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 3, "componentType": 5123, "count": 4, "type": "SCALAR" },
            { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "componentType": 5126, "count": 3, "type": "VEC3", "sparse": { "count": 1,
              "indices": { "bufferView": 4, "componentType": 5121 }, "values": { "bufferView": 5 } } },
            { "bufferView": 6, "componentType": 5121, "count": 4, "type": "VEC4" },
            { "bufferView": 7, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4" },
            { "bufferView": 8, "componentType": 5126, "count": 2, "type": "MAT4" },
            { "bufferView": 7, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC3" },
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "SCALAR" },
            { "bufferView": 0, "componentType": 5126, "count": 1, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 96, "byteLength": 32 },
            { "buffer": 0, "byteOffset": 128, "byteLength": 8 },
            { "buffer": 0, "byteOffset": 136, "byteLength": 4 },
            { "buffer": 0, "byteOffset": 140, "byteLength": 12 },
            { "buffer": 0, "byteOffset": 152, "byteLength": 16 },
            { "buffer": 0, "byteOffset": 168, "byteLength": 16 },
            { "buffer": 0, "byteLength": 128 },
        ],
        "buffers": buffers,
    })
}

fn small_glb() -> Seed {
    seed("a.glb", mutate::glb_of(document(None).to_string().into_bytes(), buffer()))
}

/// A triangle, its buffer in the file.
const INLINE: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":1},"indices":0}]}],"buffers":[{"uri":
"data:application/octet-stream;base64,AAABAAIAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAA=","byteLength":44}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":6},{"buffer":0,"byteOffset":8,"byteLength":36}],"accessors":[
{"bufferView":0,"componentType":5123,"count":3,"type":"SCALAR"},{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"}]}"#;

const OBJ: &str = "# comment
mtllib a.mtl
o first
v 0 0 0
v 1 0 0 1.0
v 1 1 0 0.5 0.5 0.5
v 0 1 0
v 0.5 0.5 0.1
vt 0 0
vt 1 0 0
vt 1 1
vn 0 0 1
g group one
s 1
usemtl lamp
f 1/1/1 2/2/1 3/3/1 4/1/1 5/1/1
usemtl glass
f -1 -2 -3
f 1//1 3//1 \\
  4//1
l 1 2 3
p 1
";

const MTL: &str = "newmtl lamp
Kd 0.5 0.5 0.5
Ka 0 0 0
Ke 3 2 1
illum 2
map_Kd -s 2 3 -o 0.5 -clamp on a.png
map_Bump -bm 0.5 a.png
map_Pr a.png
map_Pm -imfchan r a.png
map_Ke a.png
map_d a.png
newmtl glass
Ks 1 1 1
Ni 1.5
d 0.2
Tr 0.8
illum 7
Ns 1000
";

const TOML: &str = r#"[spacetime]
kind = "schwarzschild"
center = [0, 1, 0]
schwarzschild_radius = 0.4
[camera]
position = [0, 1.2, 8]
look_at = [0, 1, 0]
up = [0, 1, 0]
vertical_fov = 40
near = 0.1
[film]
width = 8
height = 6
filter = "tent"
exposure = 0.5
[render]
spp = 4
max_depth = 5
roulette_depth = 3
seed = 7
stepper = "dopri5"
precision = "f32"
schedule = "per-pixel"
sampler = "independent"
light_sampling = "geodesic"
max_winding = 2
mis = "power"
tolerance = 1e-4
arc_tolerance = 1e-3
[environment]
image = "a.hdr"
rotation = 30
strength = 0.5
[[material]]
name = "floor"
albedo = [0.6, 0.6, 0.55]
[[material]]
name = "glass"
kind = "dielectric"
ior = 1.5
attenuation_color = [0.9, 0.5, 0.1]
attenuation_distance = 2
[[material]]
name = "lacquer"
kind = "principled"
albedo = [0.6, 0.1, 0.1]
metallic = 0.2
roughness = 0.4
specular = 0.5
specular_color = [1, 0.5, 0.2]
transmission = 0.5
thin = true
clearcoat = 1
clearcoat_roughness = 0.1
sheen_color = [0.2, 0.3, 0.4]
sheen_roughness = 0.3
iridescence = 0.5
iridescence_ior = 1.4
iridescence_thickness = 350
[[material]]
name = "lamp"
emission = 10
emits = "front"
[[entity]]
disk = { center = [0, 0, 0], normal = [0, 1, 0], inner = 1, outer = 5 }
material = "floor"
[[entity]]
name = "lamp"
sphere = { center = [2, 3, -1], radius = 0.5 }
material = "lamp"
transform = { scale = 2, rotate = [0, 30, 0], translate = [0, 0.5, 0] }
[[entity]]
mesh = "a.obj"
material = "glass"
transform = { rotate = { axis = [0, 1, 0], angle = 20 } }
[[entity]]
gltf = "a.gltf"
light_scale = 0.01
emission = [1, 2, 3]
[[entity]]
light = { kind = "point", position = [0, 3, 3], intensity = 5 }
[[entity]]
light = { kind = "spot", position = [0, 3, 3], direction = [0, -1, 0], intensity = [5, 4, 3], inner_angle = 10, outer_angle = 30 }
[[entity]]
light = { kind = "distant", direction = [0, -1, 0], irradiance = 1 }
"#;
