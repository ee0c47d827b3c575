//! glTF 2.0 files, text and binary.

mod accessor;
mod buffers;
mod light;
mod material;
mod primitive;
mod validate;

use std::collections::{HashMap, HashSet, VecDeque};
use std::path::Path;

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};

use super::error::{AssetError, Flaw};
use super::files::Files;
use super::model::{Lens, Model, Node, Part};
use super::notes::Notes;
use buffers::Buffers;

/// Reads a `.gltf` or `.glb` file: the default scene's nodes, meshes, materials, cameras and lights.
///
/// A base colour texture counts as its mean colour. Other textures, animation, skins and instancing are not read;
/// [`Model::warnings`] says where they were met.
///
/// # Errors
/// The file or one of its buffers cannot be read, an index or a range is out of bounds, a node is its own ancestor,
/// an extension without which the geometry is unknown is required, a vertex is not finite, or a light has a colour,
/// an intensity or cone angles that make no sense.
pub fn load(path: &Path, files: &Files) -> Result<Model, AssetError> {
    // The bytes are gone before the meshes are there.
    let gltf =
        validate::parse(&AssetError::read(path, files)?).map_err(|flaw| AssetError::content(path, flaw))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut import = Import::default();
    import.document(&gltf, folder, files).map_err(|flaw| AssetError::content(path, flaw))?;
    import.model.warnings = import.notes.into_lines(&path.display().to_string());
    Ok(import.model)
}

/// An import in progress.
#[derive(Default)]
struct Import {
    model: Model,
    notes: Notes,
    /// Parts of each glTF mesh read so far, so that nodes share it.
    parts: HashMap<usize, Vec<Part>>,
    /// Index in the model of the material for primitives without one.
    default_material: Option<usize>,
    /// Degenerate triangles dropped.
    dropped: usize,
}

impl Import {
    fn document(&mut self, gltf: &gltf::Gltf, folder: &Path, files: &Files) -> Result<(), Flaw> {
        let buffers = Buffers::read(gltf, folder, files)?;
        let notes = &mut self.notes;
        let materials = gltf.materials().map(|material| material::convert(&material, &buffers, notes));
        self.model.materials = materials.collect();
        self.nodes(gltf, &buffers)?;
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
            let node_at = |flaw: Flaw| flaw.at(format!("node `{name}`"));
            let converted = self.node(&node, parent, buffers).map_err(node_at)?;
            self.model.nodes.push(converted);
            queue.extend(node.children().map(|child| (child, Some(index))));
        }
        Ok(())
    }

    fn node(&mut self, node: &gltf::Node, parent: Option<usize>, buffers: &Buffers) -> Result<Node, Flaw> {
        let name = name_of(node);
        self.note_ignored(node, &name);
        let parts = match node.mesh() {
            Some(mesh) => self.mesh(&mesh, buffers)?,
            None => Vec::new(),
        };
        let lens = node.camera().and_then(|camera| match camera.projection() {
            gltf::camera::Projection::Perspective(lens) => Some(Lens { vertical_fov: lens.yfov().into() }),
            gltf::camera::Projection::Orthographic(_) => {
                self.notes.add("orthographic cameras are ignored", &name);
                None
            }
        });
        let light = node.light().map(|light| light::convert(&light, &mut self.notes)).transpose()?;
        Ok(Node { to_parent: transform(node)?, name, parent, parts, lens, light })
    }

    fn note_ignored(&mut self, node: &gltf::Node, name: &str) {
        let extensions = node.extensions().into_iter().flat_map(|map| map.keys());
        for extension in extensions {
            let kind = match extension.as_str() {
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
            let read = primitive::read(&primitive, buffers, &mut self.notes, &name)
                .map_err(|flaw| flaw.at(format!("mesh `{name}`, primitive {}", primitive.index())))?;
            if let Some((triangles, dropped)) = read {
                self.dropped += dropped;
                let material = self.material_index(&primitive);
                parts.push(Part { mesh: self.model.meshes.len(), material });
                self.model.meshes.push(triangles);
            }
        }
        self.parts.insert(mesh.index(), parts.clone());
        Ok(parts)
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
