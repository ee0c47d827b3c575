//! glTF 2.0 files, text and binary.

mod accessor;
mod buffers;
mod container;
mod empty;
mod factors;
mod light;
mod maps;
mod material;
mod primitive;
mod texture;
mod validate;

use std::collections::{HashMap, HashSet, VecDeque};
use std::f64::consts::PI;
use std::ops::{Range, RangeInclusive};
use std::path::Path;

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};

use super::error::AssetError;
use super::files::Files;
use super::flaw::Flaw;
use super::model::{Model, ModelCamera, ModelNode, ModelView, Part};
use super::notes::Notes;
use buffers::Buffers;
use gltf::json::validation::Checked;
use primitive::AskedFor;
use texture::Textures;

use crate::shade::{Opacity, TextureId, VertexColors};

/// Width over height of pictures that somebody may want.
const USUAL_ASPECTS: RangeInclusive<f32> = 0.01..=100.0;
/// Half of the height of what an orthographic camera sees, exclusive.
const USUAL_HEIGHTS: Range<f64> = 0.0..1e18;
/// Bytes of surfaces that need no reason.
const SMALL: usize = 1 << 20;
/// Most bytes of surfaces per byte of the buffers: a triangle of three indices of a byte each, with its own three
/// vertices, is 28 times as large here.
const MOST_PER_BYTE: usize = 64;

/// Reads a `.gltf` or `.glb` file: the default scene's nodes, meshes, materials, cameras and lights.
///
/// Textures of base colours and of emission are read. Other textures, animation, skins and
/// instancing are not read, and what has no surface is left out; [`Model::warnings`] says where they were met. A node
/// without anything that is named `BlackHole` places a black hole.
///
/// # Errors
/// The file or one of its buffers cannot be read, an index or a range is out of bounds, a node is its own ancestor,
/// an extension without which the geometry is unknown is required, a vertex is not finite, or a light has a colour,
/// an intensity or cone angles that make no sense.
pub fn load(path: &Path, files: &Files) -> Result<Model, AssetError> {
    let bytes = AssetError::read(path, files)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut import = GltfImport::default();
    import.file(bytes, folder, files).map_err(|flaw| AssetError::content(path, flaw))?;
    import.model.warnings = import.notes.into_lines(&path.display().to_string());
    Ok(import.model)
}

/// An import in progress.
#[derive(Default)]
struct GltfImport {
    model: Model,
    notes: Notes,
    /// Parts of each glTF mesh read so far, so that nodes share it.
    parts: HashMap<usize, Vec<Part>>,
    /// Index in the model of each surface read so far, so that primitives share it; `None` if it has no area.
    surfaces: HashMap<primitive::SurfaceKey, Option<usize>>,
    /// Bytes of the surfaces read so far.
    size: usize,
    /// Index in the model of the material for primitives without one.
    default_material: Option<usize>,
    /// Degenerate triangles dropped.
    dropped: usize,
}

impl GltfImport {
    fn file(&mut self, bytes: Vec<u8>, folder: &Path, files: &Files) -> Result<(), Flaw> {
        let gltf = container::open(bytes)?;
        validate::check(gltf.document.as_json())?;
        buffers::mention_images(&gltf, folder, files);
        let buffers = Buffers::read(&gltf, folder, files)?;
        let (notes, mut textures) = (&mut self.notes, Textures::new(&gltf, &buffers));
        let materials =
            gltf.materials().map(|material| material::convert(&gltf, &material, &mut textures, notes));
        self.model.materials = materials.collect();
        self.model.textures = textures.into_textures();
        self.nodes(&gltf, &buffers)?;
        for material in &mut self.model.materials {
            material.opacity = material.opacity.filter(Opacity::lets_through);
        }
        for animation in gltf.animations() {
            let name = animation.name().unwrap_or("unnamed");
            self.notes.add("animation ignored, the rest pose is used", name);
        }
        if self.dropped > 0 {
            self.notes.add("degenerate (zero-area) triangles dropped", self.dropped.to_string());
        }
        Ok(())
    }

    /// Walks the default scene breadth first, so that parents come before their children.
    fn nodes(&mut self, gltf: &gltf::Gltf, buffers: &Buffers) -> Result<(), Flaw> {
        let mut queue: VecDeque<_> =
            roots(gltf, &mut self.notes).into_iter().map(|node| (node, None)).collect();
        let mut seen = HashSet::new();
        while let Some((node, parent)) = queue.pop_front() {
            let name = name_of(&node);
            if !seen.insert(node.index()) {
                return Err(Flaw::new(
                    format!("node `{name}` is reached twice: it has two parents or is its own ancestor"),
                    "nodes must form a tree; export the file again",
                ));
            }
            let index = self.model.nodes.len();
            if is_hidden(&node) {
                self.notes.add("nodes that are not visible are left out, with all below them", name);
                continue;
            }
            let node_at = |flaw: Flaw| flaw.at(format!("node `{name}`"));
            let converted = self.node(gltf, &node, parent, buffers).map_err(node_at)?;
            self.model.nodes.push(converted);
            queue.extend(node.children().map(|child| (child, Some(index))));
        }
        Ok(())
    }

    fn node(
        &mut self,
        gltf: &gltf::Gltf,
        node: &gltf::Node,
        parent: Option<usize>,
        buffers: &Buffers,
    ) -> Result<ModelNode, Flaw> {
        let name = name_of(node);
        self.note_ignored(node, &name);
        let parts = match node.mesh() {
            Some(mesh) => self.mesh(&mesh, buffers)?,
            None => Vec::new(),
        };
        let camera = node.camera().and_then(|camera| self.camera(gltf, &camera, &name));
        let light = node.light().map(|light| light::convert(&light, &mut self.notes)).transpose()?;
        let hole = empty::hole(node, &name, &mut self.notes)?;
        Ok(ModelNode { to_parent: transform(node)?, name, parent, parts, camera, light, hole })
    }

    /// Goes by the JSON, since the crate's `Camera::projection` panics on a camera without lens.
    fn camera(&mut self, gltf: &gltf::Gltf, camera: &gltf::Camera, node: &str) -> Option<ModelCamera> {
        let json = gltf.document.as_json().cameras.get(camera.index())?;
        let is_orthographic = json.type_ == Checked::Valid(gltf::json::camera::Type::Orthographic);
        let given = match (&json.orthographic, &json.perspective) {
            (Some(lens), _) if is_orthographic => {
                let [half_width, half_height] = [lens.xmag, lens.ymag].map(|half| f64::from(half).abs());
                let view = ModelView::Orthographic { half_height };
                Some((view, half_height, USUAL_HEIGHTS, Some((half_width / half_height) as f32)))
            }
            (_, Some(lens)) if !is_orthographic => {
                let vertical_fov = f64::from(lens.yfov);
                Some((ModelView::Perspective { vertical_fov }, vertical_fov, 0.0..PI, lens.aspect_ratio))
            }
            _ => None,
        };
        let Some((view, size, usual, ratio)) = given else {
            self.notes.add("cameras without a lens (`perspective` or `orthographic`) are ignored", node);
            return None;
        };
        if !(usual.contains(&size) && size > usual.start) {
            self.notes.add("cameras whose field of view makes no sense are ignored", node);
            return None;
        }
        let aspect = ratio.filter(|aspect| USUAL_ASPECTS.contains(aspect)).map(f64::from);
        if aspect.is_none() && ratio.is_some() {
            self.notes.add("aspect ratio that makes no sense is ignored, of camera", node);
        }
        Some(ModelCamera { view, aspect })
    }

    fn note_ignored(&mut self, node: &gltf::Node, name: &str) {
        let extensions = node.extensions().into_iter().flat_map(|map| map.keys());
        for extension in extensions {
            let kind = match extension.as_str() {
                "KHR_node_visibility" => continue,
                "EXT_mesh_gpu_instancing" => {
                    "instances (EXT_mesh_gpu_instancing) are ignored, the mesh is placed once".to_owned()
                }
                other => format!("extension {other} is ignored, on node"),
            };
            self.notes.add(kind, name);
        }
        if node.skin().is_some() {
            self.notes.add("skin ignored, the rest pose is used", name);
        }
    }

    /// Parts of a mesh, read once however many nodes use it.
    fn mesh(&mut self, mesh: &gltf::Mesh, buffers: &Buffers) -> Result<Vec<Part>, Flaw> {
        if let Some(parts) = self.parts.get(&mesh.index()) {
            return Ok(parts.clone());
        }
        let name = mesh.name().map_or_else(|| format!("mesh {}", mesh.index()), str::to_owned);
        let mut parts = Vec::new();
        for primitive in mesh.primitives() {
            let surface = self
                .surface(&primitive, buffers, &name)
                .map_err(|flaw| flaw.at(format!("mesh `{name}`, primitive {}", primitive.index())))?;
            if let Some(surface) = surface {
                let material = self.material_index(&primitive);
                if !self.model.meshes[surface].attributes.colors.is_empty() {
                    let converted = &mut self.model.materials[material];
                    let is_unlit = material::is_unlit(&primitive.material());
                    converted.maps.vertex_colors =
                        if is_unlit { VertexColors::Emission } else { VertexColors::BaseColor };
                    converted.opacity.iter_mut().for_each(|opacity| opacity.by_vertices = true);
                }
                parts.push(Part { mesh: surface, material });
            }
        }
        self.parts.insert(mesh.index(), parts.clone());
        Ok(parts)
    }

    /// Index in the model of a primitive's surface, read once however many primitives have it; `None` without area.
    fn surface(
        &mut self,
        primitive: &gltf::Primitive,
        buffers: &Buffers,
        name: &str,
    ) -> Result<Option<usize>, Flaw> {
        let asked_for = self.asked_for(&primitive.material());
        let Some(source) = primitive::source(primitive, asked_for, &mut self.notes, name)? else {
            return Ok(None);
        };
        if let Some(known) = self.surfaces.get(&source) {
            return Ok(*known);
        }
        let (mesh, dropped) = primitive::read(primitive, &source, buffers, &mut self.notes, name)?;
        let index = if mesh.triangles.is_empty() {
            self.notes.add("surfaces without area (collapsed or empty) are left out, in mesh", name);
            None
        } else {
            self.dropped += dropped;
            self.size += mesh.memory_bytes();
            self.model.meshes.push(mesh);
            Some(self.model.meshes.len() - 1)
        };
        if self.size > SMALL + MOST_PER_BYTE * buffers.size() {
            return Err(Flaw::new(
                format!(
                    "the surfaces up to here take {} times the bytes that they are read from",
                    MOST_PER_BYTE
                ),
                "the file is damaged: its accessors overlap; export it again",
            ));
        }
        self.surfaces.insert(source, index);
        Ok(index)
    }

    /// Attributes that a material asks for.
    fn asked_for(&self, material: &gltf::Material) -> AskedFor {
        let mut asked_for = AskedFor::default();
        let material = material.index().and_then(|index| self.model.materials.get(index));
        let uv_set = |TextureId(id): TextureId| Some(self.model.textures.get(id as usize)?.uv_set);
        for set in material.iter().flat_map(|material| material.textures()).filter_map(uv_set) {
            asked_for.uv_sets.get_mut(set).iter_mut().for_each(|set| **set = true);
        }
        asked_for.tangents = material.and_then(|material| material.maps.tangents_along(uv_set));
        asked_for
    }

    fn material_index(&mut self, primitive: &gltf::Primitive) -> usize {
        let materials = &mut self.model.materials;
        primitive.material().index().unwrap_or_else(|| {
            *self.default_material.get_or_insert_with(|| {
                materials.push(crate::shade::Material::default());
                materials.len() - 1
            })
        })
    }
}

/// True if `KHR_node_visibility` hides the node, and all below it.
fn is_hidden(node: &gltf::Node) -> bool {
    let visibility = node.extension_value("KHR_node_visibility");
    visibility.and_then(|values| values.get("visible")?.as_bool()) == Some(false)
}

/// Roots of the default scene; of the first if none is the default; of the whole file if it has no scene.
fn roots<'a>(gltf: &'a gltf::Gltf, notes: &mut Notes) -> Vec<gltf::Node<'a>> {
    if let Some(scene) = gltf.default_scene().or_else(|| gltf.scenes().next()) {
        for other in gltf.scenes().filter(|other| other.index() != scene.index()) {
            notes.add("scenes other than the default one are ignored", other.name().unwrap_or("unnamed"));
        }
        return scene.nodes().collect();
    }
    let children: HashSet<usize> =
        gltf.nodes().flat_map(|node| node.children()).map(|child| child.index()).collect();
    gltf.nodes().filter(|node| !children.contains(&node.index())).collect()
}

fn name_of(node: &gltf::Node) -> String {
    node.name().map_or_else(|| format!("node {}", node.index()), str::to_owned)
}

/// Node space → parent space.
fn transform(node: &gltf::Node) -> Result<DAffine3, Flaw> {
    let to_parent = match node.transform() {
        gltf::scene::Transform::Matrix { matrix } => {
            let matrix = DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from)));
            DAffine3 { matrix3: DMat3::from_mat4(matrix), translation: matrix.w_axis.truncate() }
        }
        gltf::scene::Transform::Decomposed { translation, rotation, scale } => {
            let rotation = DQuat::from_array(rotation.map(f64::from));
            let length = rotation.length();
            if !(length.is_finite() && length > 0.0) {
                return Err(Flaw::new("the rotation is not a quaternion", "export the file again"));
            }
            DAffine3::from_scale_rotation_translation(
                DVec3::from(scale.map(f64::from)),
                rotation / length,
                DVec3::from(translation.map(f64::from)),
            )
        }
    };
    if to_parent.is_finite() {
        Ok(to_parent)
    } else {
        Err(Flaw::new("the transform is not finite", "reset the node's transform and export again"))
    }
}

#[cfg(test)]
mod tests;
