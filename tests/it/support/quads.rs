//! glTF files of textured quads.

use glam::DVec3;
use image::RgbaImage;
use serde_json::{Value, json};

/// A quad with one material.
pub struct Quad {
    /// Lower left, lower right, upper left and upper right corner, seen from the front.
    pub corners: [DVec3; 4],
    /// Texture coordinates of the corners.
    pub uvs: [[f32; 2]; 4],
    /// Linear colours and opacities of the corners.
    pub colors: Option<[[f32; 4]; 4]>,
    /// Index of the material.
    pub material: usize,
}

impl Quad {
    /// One that shows a picture upright.
    pub fn new(origin: DVec3, right: DVec3, up: DVec3, material: usize) -> Self {
        let corners = [origin, origin + right, origin + up, origin + right + up];
        Self { corners, uvs: [[0.0, 1.0], [1.0, 1.0], [0.0, 0.0], [1.0, 0.0]], colors: None, material }
    }
}

fn escaped(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("%{byte:02x}")).collect()
}

/// A picture of texels in rows from the top.
pub fn picture(width: u32, texels: &[[u8; 4]]) -> RgbaImage {
    RgbaImage::from_vec(width, texels.len() as u32 / width, texels.concat()).expect("whole rows")
}

/// The text of a file with a node for each quad; textures are numbered as images, and show their nearest texels.
pub fn gltf(quads: &[Quad], materials: &Value, images: &[RgbaImage]) -> String {
    let mut bytes: Vec<u8> = Vec::new();
    let (mut views, mut accessors) = (Vec::new(), Vec::new());
    let mut add = |values: &[f32], kind: &str, width: usize| {
        let data = values.iter().flat_map(|value| value.to_le_bytes());
        views.push(json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": 4 * values.len() }));
        bytes.extend(data);
        let (view, count) = (views.len() - 1, values.len() / width);
        accessors.push(json!({ "bufferView": view, "componentType": 5126, "count": count, "type": kind }));
        accessors.len() - 1
    };
    let meshes: Vec<Value> = quads
        .iter()
        .map(|quad| {
            let corners = quad.corners.map(|corner| corner.as_vec3().to_array());
            let mut attributes = json!({
                "POSITION": add(corners.as_flattened(), "VEC3", 3),
                "TEXCOORD_0": add(quad.uvs.as_flattened(), "VEC2", 2),
            });
            if let Some(colors) = quad.colors {
                attributes["COLOR_0"] = json!(add(colors.as_flattened(), "VEC4", 4));
            }
            json!({ "primitives": [{ "attributes": attributes, "mode": 5, "material": quad.material }] })
        })
        .collect();
    let png = |image: &RgbaImage| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, image::ImageFormat::Png).expect("a PNG file");
        json!({ "uri": format!("data:image/png,{}", escaped(bytes.get_ref())) })
    };
    let nodes: Vec<Value> = (0..quads.len()).map(|mesh| json!({ "mesh": mesh })).collect();
    let mut model = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": (0..quads.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": bytes.len(), "uri": format!("data:,{}", escaped(&bytes)) }],
    });
    if !images.is_empty() {
        model["images"] = images.iter().map(png).collect();
        model["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33071, "wrapT": 33071 }]);
        model["textures"] = (0..images.len()).map(|image| json!({ "source": image, "sampler": 0 })).collect();
    }
    model.to_string()
}
