//! Wavefront OBJ files, parsed by `tobj` after a survey that tells the line of whatever is wrong.

mod cleaned;
mod merge;
mod numbers;
mod polygon;
mod survey;

use std::io;
use std::path::Path;

use glam::DAffine3;

use super::error::AssetError;
use super::files::Files;
use super::flaw::Flaw;
use super::model::{Model, ModelNode, Part};
use super::statements::Statements;
use super::tangents::make_tangents;
use super::tidy::tidy;
use crate::geometry::{Attributes, Mesh};
use crate::shade::Material;
use cleaned::Cleaned;
use merge::merge;
use survey::Survey;

/// Reads an OBJ file and the material libraries that it names.
///
/// Each object (or group) becomes a node, with one mesh per material; polygons are cut into triangles.
///
/// # Errors
/// The file cannot be read, a coordinate is malformed or not finite, an index is out of range, or there is no triangle.
pub fn load(path: &Path, files: &Files) -> Result<Model, AssetError> {
    let content = |flaw| AssetError::content(path, flaw);
    let unread = |source: io::Error| match source.kind() {
        io::ErrorKind::InvalidData => content(Flaw::new(source.to_string(), "save it as UTF-8")),
        _ => AssetError::Read { path: path.to_owned(), source },
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let survey =
        Survey::of(Statements::open(path, files)?, folder, files).map_err(unread)?.map_err(content)?;
    let options = tobj::LoadOptions {
        // One index for all takes `tobj` a hash table as large as the rest of the mesh, several indices a guess where
        // a normal is missing.
        single_index: survey.has_partial_normals(),
        // It cuts every polygon into a fan.
        triangulate: false,
        ignore_points: true,
        // Of faces with two corners.
        ignore_lines: true,
    };
    let mut text = Cleaned::new(Statements::open(path, files)?, &survey);
    // The libraries are read already.
    let (parts, _) = tobj::load_obj_buf(&mut text, &options, |_| Err(tobj::LoadError::OpenFileFailed))
        .map_err(|error| content(Flaw::new(error.to_string(), "fix the file or export it again")))?;
    let mut import = ObjImport::new(survey);
    for part in parts.into_iter().filter(|part| !part.mesh.indices.is_empty()) {
        import.add(part).map_err(content)?;
    }
    import.finish(&path.display().to_string()).map_err(content)
}

/// Attributes of a mesh with at most one set of texture coordinates.
fn of_one_set(uvs: Vec<[f32; 2]>) -> Attributes {
    let uvs = if uvs.is_empty() { Vec::new() } else { vec![uvs] };
    Attributes { uvs, ..Attributes::default() }
}

/// A model in the making.
struct ObjImport {
    model: Model,
    survey: Survey,
    /// Index of the material for faces without one.
    default_material: Option<usize>,
    /// Degenerate triangles dropped.
    dropped: usize,
    /// Polygons that are cut into a fan although they have dents.
    left: usize,
}

impl ObjImport {
    fn new(mut survey: Survey) -> Self {
        let (materials, textures) = survey.libraries.take();
        let model = Model { materials, textures, ..Model::default() };
        Self { model, survey, default_material: None, dropped: 0, left: 0 }
    }

    /// Adds the faces of a section to the node of its object.
    fn add(&mut self, part: tobj::Model) -> Result<(), Flaw> {
        let section = part.name.parse().ok().and_then(|number: usize| self.survey.sections.get(number));
        let Some(&section) = section else { return Ok(()) };
        let name = self.survey.objects.get(section.object).cloned().unwrap_or_default();
        let mut mesh = self.mesh(part.mesh, &name);
        let dropped = tidy(&mut mesh).map_err(|flaw| flaw.at(format!("object `{name}`")))?;
        if mesh.triangles.is_empty() {
            self.survey.notes.add("objects without area are left out", name);
            return Ok(());
        }
        self.dropped += dropped;
        let material = section.material.unwrap_or_else(|| self.default_material());
        let maps = &self.model.materials[material].maps;
        if let Some(uv_set) = maps.tangents_along(|_| Some(0)) {
            make_tangents(&mut mesh, uv_set);
        }
        let part = Part { mesh: self.model.meshes.len(), material };
        self.model.meshes.push(mesh);
        match self.model.nodes.last_mut().filter(|node| node.name == name) {
            Some(node) => node.parts.push(part),
            None => self.model.nodes.push(ModelNode {
                name,
                parent: None,
                to_parent: DAffine3::IDENTITY,
                parts: vec![part],
                camera: None,
                light: None,
                hole: None,
            }),
        }
        Ok(())
    }

    fn mesh(&mut self, mesh: tobj::Mesh, name: &str) -> Mesh {
        let tobj::Mesh {
            positions,
            normals,
            texcoords,
            mut indices,
            mut normal_indices,
            mut texcoord_indices,
            face_arities,
            ..
        } = mesh;
        // There are none if all faces are triangles.
        if !face_arities.is_empty() {
            let triangles = polygon::cut(&positions, &indices, &face_arities);
            self.left += triangles.left;
            let cut = |indices: &[u32]| -> Vec<u32> {
                triangles.corners.iter().filter_map(|corner| indices.get(*corner as usize).copied()).collect()
            };
            (indices, normal_indices) = (cut(&indices), cut(&normal_indices));
            texcoord_indices = cut(&texcoord_indices);
        }
        let (positions, _) = positions.as_chunks::<3>();
        let (normals, _) = normals.as_chunks::<3>();
        let uvs: Vec<[f32; 2]> = texcoords.as_chunks().0.iter().map(|&[u, v]| [u, 1.0 - v]).collect();
        let mut merged = Mesh::default();
        let (mut set, corners) = (Vec::new(), indices.iter().copied());
        match (normal_indices.as_slice(), texcoord_indices.as_slice()) {
            ([], []) => return self.indexed(positions, normals, uvs, &indices, name),
            (of_normals, []) => {
                merged.triangles = merge(corners.zip(of_normals), |(position, &normal)| {
                    merged.positions.push(positions[position as usize]);
                    merged.normals.push(normals[normal as usize]);
                });
            }
            ([], of_uvs) => {
                merged.triangles = merge(corners.zip(of_uvs), |(position, &uv)| {
                    merged.positions.push(positions[position as usize]);
                    set.push(uvs[uv as usize]);
                });
            }
            (of_normals, of_uvs) => {
                let corners = corners.zip(of_normals).zip(of_uvs);
                merged.triangles = merge(corners, |((position, &normal), &uv)| {
                    merged.positions.push(positions[position as usize]);
                    merged.normals.push(normals[normal as usize]);
                    set.push(uvs[uv as usize]);
                });
            }
        }
        merged.normals.shrink_to_fit();
        merged.attributes = of_one_set(set);
        merged
    }

    /// A mesh of columns that have the same indices.
    fn indexed(
        &mut self,
        positions: &[[f32; 3]],
        normals: &[[f32; 3]],
        uvs: Vec<[f32; 2]>,
        indices: &[u32],
        name: &str,
    ) -> Mesh {
        let mut is_complete = |count: usize, lacking: &str| {
            if count != 0 && count != positions.len() {
                self.survey.notes.add(lacking, name);
            }
            count == positions.len()
        };
        Mesh {
            positions: positions.to_vec(),
            normals: if is_complete(normals.len(), "normals on some faces only, so shaded flat") {
                normals.to_vec()
            } else {
                Vec::new()
            },
            triangles: indices.as_chunks().0.to_vec(),
            attributes: of_one_set(
                if is_complete(uvs.len(), "texture coordinates on some faces only, so left out") {
                    uvs
                } else {
                    Vec::new()
                },
            ),
        }
    }

    fn default_material(&mut self) -> usize {
        let materials = &mut self.model.materials;
        *self.default_material.get_or_insert_with(|| {
            materials.push(Material::default());
            materials.len() - 1
        })
    }

    fn finish(mut self, file: &str) -> Result<Model, Flaw> {
        if self.model.meshes.is_empty() {
            return Err(Flaw::new(
                "holds no triangles with an area",
                "export it with faces; points and lines have no surface",
            ));
        }
        let notes = &mut self.survey.notes;
        if self.dropped > 0 {
            notes.add("degenerate (zero-area) triangles dropped", self.dropped.to_string());
        }
        if self.left > 0 {
            let kind = "polygons with dents and more than 4096 corners are cut as if they had no dents";
            notes.add(kind, self.left.to_string());
        }
        self.model.warnings = self.survey.notes.into_lines(file);
        self.model.warnings.append(&mut self.survey.libraries.warnings);
        Ok(self.model)
    }
}

#[cfg(test)]
mod tests;
