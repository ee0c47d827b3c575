//! glTF 2.0 files, text and binary.

mod accessor;
mod animation;
mod buffers;
mod container;
mod deform;
mod empty;
mod factors;
mod instancing;
mod light;
mod maps;
mod material;
mod pose;
mod primitive;
mod texture;
mod transform;
mod validate;

use std::collections::{HashMap, HashSet, VecDeque};
use std::f64::consts::PI;
use std::ops::{Range, RangeInclusive};
use std::path::Path;
use std::rc::Rc;

use glam::DAffine3;

use super::error::AssetError;
use super::files::Files;
use super::flaw::Flaw;
use super::model::{Model, ModelCamera, ModelNode, ModelView, Part};
use super::notes::Notes;
use animation::Moment;
use buffers::Buffers;
use deform::{MOST_TARGETS, MeshPose, PoseKey};
use gltf::json::validation::Checked;
use pose::ScenePose;
use primitive::{AskedFor, MOST_PER_BYTE, SMALL};
use texture::Textures;

use crate::shade::{Opacity, TextureId, VertexColors};

/// Width over height of pictures that somebody may want.
const USUAL_ASPECTS: RangeInclusive<f32> = 0.01..=100.0;
/// Half of the height of what an orthographic camera sees, exclusive.
const USUAL_HEIGHTS: Range<f64> = 0.0..1e18;

/// Reads a `.gltf` or `.glb` file: the default scene's nodes, meshes, materials, cameras and lights, `time` seconds
/// after its animations started.
///
/// What has no surface is left out, as [`Model::warnings`] says. A node without anything that is named `BlackHole`
/// places a black hole.
///
/// # Errors
/// The file or one of its buffers cannot be read, an index or a range is out of bounds, a node is its own ancestor,
/// an extension without which the geometry is unknown is required, a vertex is not finite, or a light has a colour,
/// an intensity or cone angles that make no sense.
pub fn load(path: &Path, files: &Files, time: f64) -> Result<Model, AssetError> {
    let bytes = AssetError::read(path, files)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut import = GltfImport::default();
    import.file(bytes, folder, files, time).map_err(|flaw| AssetError::content(path, flaw))?;
    import.model.warnings = import.notes.into_lines(&path.display().to_string());
    Ok(import.model)
}

/// An import in progress.
#[derive(Default)]
struct GltfImport {
    model: Model,
    notes: Notes,
    /// Parts of each glTF mesh read so far, by its pose, so that nodes share it.
    parts: HashMap<(usize, PoseKey), Vec<Part>>,
    /// Matrices of the joints of each skin read so far.
    joints: HashMap<usize, Rc<[DAffine3]>>,
    /// What animations make of the nodes.
    moment: Moment,
    /// Where nodes are, once a skin asks for it.
    pose: Option<ScenePose>,
    /// Index in the model of each surface read so far, so that primitives share it; `None` if it has no area.
    surfaces: HashMap<primitive::SurfaceKey, Option<usize>>,
    /// Bytes of the surfaces read so far.
    size: usize,
    /// Index in the model of the material for primitives without one.
    default_material: Option<usize>,
    /// Instances that the file may still have; `None` before it has any.
    instances_left: Option<usize>,
    /// Degenerate triangles dropped.
    dropped: usize,
}

impl GltfImport {
    fn file(&mut self, bytes: Vec<u8>, folder: &Path, files: &Files, time: f64) -> Result<(), Flaw> {
        let gltf = container::open(bytes)?;
        validate::check(gltf.document.as_json())?;
        buffers::mention_images(&gltf, folder, files);
        let buffers = Buffers::read(&gltf, folder, files)?;
        let (notes, mut textures) = (&mut self.notes, Textures::new(&gltf, &buffers));
        let materials =
            gltf.materials().map(|material| material::convert(&gltf, &material, &mut textures, notes));
        self.model.materials = materials.collect();
        self.model.textures = textures.into_textures();
        self.moment = Moment::new(&gltf, time, &buffers, &mut self.notes);
        self.nodes(&gltf, &buffers)?;
        for material in &mut self.model.materials {
            material.opacity = material.opacity.filter(Opacity::lets_through);
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
            let copies = match node.skin() {
                Some(_) if !converted.parts.is_empty() => Some(vec![skinned(&converted)]),
                Some(_) => None,
                None => self.instances(gltf, &node, &converted, index, buffers).map_err(node_at)?,
            };
            match copies {
                None => self.model.nodes.push(converted),
                Some(copies) => {
                    self.model.nodes.push(ModelNode { parts: Vec::new(), ..converted });
                    self.model.nodes.extend(copies);
                }
            }
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
            Some(mesh) => {
                let pose = self.mesh_pose(gltf, node, &mesh, buffers)?;
                self.mesh(&mesh, &pose, buffers)?
            }
            None => Vec::new(),
        };
        let camera = node.camera().and_then(|camera| self.camera(gltf, &camera, &name));
        let light = node.light().map(|light| light::convert(&light, &mut self.notes)).transpose()?;
        let hole = empty::hole(node, &name, &mut self.notes)?;
        Ok(ModelNode {
            to_parent: transform::of_node(node, &self.moment)?,
            name,
            parent,
            parts,
            camera,
            light,
            hole,
        })
    }

    /// Nodes below the one of index `parent`, one for each of its instances; `None` if it places its mesh itself.
    fn instances(
        &mut self,
        gltf: &gltf::Gltf,
        node: &gltf::Node,
        converted: &ModelNode,
        parent: usize,
        buffers: &Buffers,
    ) -> Result<Option<Vec<ModelNode>>, Flaw> {
        if converted.parts.is_empty() || node.extension_value(instancing::EXTENSION).is_none() {
            return Ok(None);
        }
        let left = *self.instances_left.get_or_insert_with(|| instancing::most(buffers));
        let Some(placements) = instancing::placements(gltf, node, buffers, left)? else {
            self.notes.add("instances without places are ignored, the mesh is placed once", &converted.name);
            return Ok(None);
        };
        self.instances_left = Some(left - placements.len());
        let instance = |(number, to_parent)| ModelNode {
            name: format!("{}[{number}]", converted.name),
            parent: Some(parent),
            to_parent,
            parts: converted.parts.clone(),
            ..ModelNode::default()
        };
        Ok(Some(placements.into_iter().enumerate().map(instance).collect()))
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
                "KHR_node_visibility" | instancing::EXTENSION => continue,
                other => format!("extension {other} is ignored, on node"),
            };
            self.notes.add(kind, name);
        }
    }

    /// The pose that a node gives to its mesh.
    fn mesh_pose(
        &mut self,
        gltf: &gltf::Gltf,
        node: &gltf::Node,
        mesh: &gltf::Mesh,
        buffers: &Buffers,
    ) -> Result<MeshPose, Flaw> {
        let weights = self.moment.weights(node.index()).or_else(|| node.weights()).or_else(|| mesh.weights());
        let weights = weights.unwrap_or_default().to_vec();
        if weights.len() > MOST_TARGETS {
            return Err(Flaw::new(
                format!("it has {} weights of morph targets, more than {MOST_TARGETS}", weights.len()),
                "use fewer shape keys, or apply them before the export",
            ));
        }
        let Some(skin) = node.skin().map(|skin| skin.index()) else {
            return Ok(MeshPose { weights, skin: None });
        };
        let joints = match self.joints.get(&skin) {
            Some(joints) => joints.clone(),
            None => {
                let pose = self.pose.get_or_insert_with(|| ScenePose::new(gltf, &self.moment));
                let joints =
                    pose.joints(gltf, skin, buffers).map_err(|flaw| flaw.at(format!("skin {skin}")))?;
                self.joints.entry(skin).or_insert(joints.into()).clone()
            }
        };
        Ok(MeshPose { weights, skin: Some((skin, joints)) })
    }

    /// Parts of a mesh in a pose, read once however many nodes use it.
    fn mesh(&mut self, mesh: &gltf::Mesh, pose: &MeshPose, buffers: &Buffers) -> Result<Vec<Part>, Flaw> {
        let key = (mesh.index(), pose.key());
        if let Some(parts) = self.parts.get(&key) {
            return Ok(parts.clone());
        }
        let name = mesh.name().map_or_else(|| format!("mesh {}", mesh.index()), str::to_owned);
        let mut parts = Vec::new();
        for primitive in mesh.primitives() {
            let surface = self
                .surface(&primitive, pose, buffers, &name)
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
        self.parts.insert(key, parts.clone());
        Ok(parts)
    }

    /// Index in the model of a primitive's surface, read once however many primitives have it; `None` without area.
    fn surface(
        &mut self,
        primitive: &gltf::Primitive,
        pose: &MeshPose,
        buffers: &Buffers,
        name: &str,
    ) -> Result<Option<usize>, Flaw> {
        let asked_for = self.asked_for(&primitive.material());
        let Some(source) = primitive::source(primitive, asked_for, pose, &mut self.notes, name)? else {
            return Ok(None);
        };
        if let Some(known) = self.surfaces.get(&source) {
            return Ok(*known);
        }
        let (mesh, dropped) = primitive::read(primitive, &source, pose, buffers, &mut self.notes, name)?;
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
                "the file is damaged: its accessors overlap, or give fewer nodes poses of their own of one mesh",
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

/// What stands for the mesh of a node with a skin: its joints place it, whatever the node's own transform.
fn skinned(converted: &ModelNode) -> ModelNode {
    ModelNode { name: converted.name.clone(), parts: converted.parts.clone(), ..ModelNode::default() }
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

#[cfg(test)]
mod tests;
