//! Wavefront OBJ files, parsed by `tobj` after a check that tells the line of whatever is wrong.

mod check;
mod lossy;
mod merge;

use std::cell::RefCell;
use std::path::Path;

use glam::DAffine3;

use super::error::{AssetError, Flaw};
use super::files::Files;
use super::model::{Model, Node, Part};
use super::mtl;
use super::notes::Notes;
use super::tidy::tidy;
use crate::geometry::Mesh;
use crate::shade::Material;
use lossy::Lossy;
use merge::merge;

/// Reads an OBJ file and the material libraries that it names.
///
/// Each object (or group) becomes a node, with one mesh per material; polygons are cut into triangles.
///
/// # Errors
/// The file cannot be read, a number is malformed or not finite, an index is out of range, or there is no triangle.
pub fn load(path: &Path, files: &Files) -> Result<Model, AssetError> {
    let content = |flaw| AssetError::content(path, flaw);
    let unread = |source| AssetError::Read { path: path.to_owned(), source };
    let checked = check::check(Lossy::open(path, files)?).map_err(unread)?.map_err(content)?;
    let notes = RefCell::new(Notes::default());
    if checked.edges > 0 {
        let kind = "line elements have no surface and are ignored";
        notes.borrow_mut().add(kind, checked.edges.to_string());
    }
    let options = tobj::LoadOptions {
        // One index for all takes `tobj` a hash table as large as the rest of the mesh, several indices a guess where
        // a normal is missing.
        single_index: checked.has_partial_normals(),
        triangulate: true,
        ignore_points: true,
        // Of faces with two corners; it reads a line element as a face.
        ignore_lines: true,
    };
    let library = |file: &Path| {
        let file = path.parent().unwrap_or(Path::new("")).join(file);
        mtl::load(&file, files, &mut notes.borrow_mut())
    };
    let (models, materials) =
        tobj::load_obj_buf(&mut Lossy::open(path, files)?.without("l"), &options, library)
            .map_err(|error| content(Flaw::new(error.to_string(), "fix the file or export it again")))?;
    let mut notes = notes.into_inner();
    let materials = materials.unwrap_or_default();
    let mut model = Model {
        materials: materials.iter().map(|material| mtl::convert(material, &mut notes)).collect(),
        ..Model::default()
    };
    let mut dropped = 0;
    for part in models.into_iter().filter(|model| !model.mesh.indices.is_empty()) {
        dropped += add_part(&mut model, part, &mut notes).map_err(content)?;
    }
    if model.meshes.is_empty() {
        return Err(content(Flaw::new(
            "holds no triangles",
            "export it with faces; points and lines have no surface",
        )));
    }
    if dropped > 0 {
        notes.add("degenerate (zero-area) triangles dropped", dropped.to_string());
    }
    model.warnings = notes.into_lines(&path.display().to_string());
    Ok(model)
}

/// Adds one mesh to the node of its object; returns the number of degenerate triangles dropped.
fn add_part(model: &mut Model, part: tobj::Model, notes: &mut Notes) -> Result<usize, Flaw> {
    let name = part.name;
    let tobj::Mesh { positions, normals, indices, normal_indices, material_id, .. } = part.mesh;
    let mut mesh = if normal_indices.is_empty() {
        let is_complete = normals.len() == positions.len();
        if !is_complete && !normals.is_empty() {
            notes.add("normals on some faces only, so shaded flat", &name);
        }
        Mesh {
            positions: positions.as_chunks().0.to_vec(),
            normals: if is_complete { normals.as_chunks().0.to_vec() } else { Vec::new() },
            triangles: indices.as_chunks().0.to_vec(),
        }
    } else {
        merge(&positions, &normals, &indices, &normal_indices)
    };
    drop((positions, normals, indices, normal_indices));
    let in_object = |flaw: Flaw| flaw.at(format!("object `{name}`"));
    let dropped = tidy(&mut mesh).map_err(in_object)?;
    if mesh.triangles.is_empty() {
        let problem = format!("no triangle with an area is left of {dropped}");
        let help = "remove the object, or check the scale at which it was exported";
        return Err(in_object(Flaw::new(problem, help)));
    }
    let material = material_id.unwrap_or_else(|| default_material(model));
    let part = Part { mesh: model.meshes.len(), material };
    model.meshes.push(mesh);
    match model.nodes.last_mut().filter(|node| node.name == name) {
        Some(node) => node.parts.push(part),
        None => model.nodes.push(Node {
            name,
            parent: None,
            to_parent: DAffine3::IDENTITY,
            parts: vec![part],
            lens: None,
            light: None,
            hole: None,
        }),
    }
    Ok(dropped)
}

/// Index of a material for faces without one.
fn default_material(model: &mut Model) -> usize {
    let found = model.materials.iter().position(|material| *material == Material::default());
    found.unwrap_or_else(|| {
        model.materials.push(Material::default());
        model.materials.len() - 1
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::Lobe;
    use glam::Vec3;

    fn load_text(obj: &str, mtl: &str) -> Result<Model, AssetError> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.mtl"), mtl).unwrap();
        let path = folder.path().join("a.obj");
        std::fs::write(&path, obj).unwrap();
        load(&path, &Files::default())
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn polygons_are_triangulated_and_objects_with_two_materials_stay_one_node() {
        let obj = format!("mtllib a.mtl\n{SQUARE}o box\nusemtl red\nf 1 2 3 4\nusemtl lamp\nf -4 -3 -2\n");
        let mtl = "newmtl red\nKd 1 0 0\nnewmtl lamp\nKd 0\nKe 5 5 5\n";
        let model = load_text(&obj, mtl).unwrap();
        assert_eq!(model.nodes.len(), 1);
        assert_eq!(model.nodes[0].parts.len(), 2);
        assert_eq!(model.meshes[0].triangles.len(), 2);
        assert_eq!(model.materials[0].lobe, Lobe::Diffuse { albedo: Vec3::X });
        assert_eq!(model.materials[1].lobe, Lobe::Diffuse { albedo: Vec3::ZERO });
        assert_eq!(model.materials[1].emission, Vec3::splat(5.0));
        assert_eq!(model.warnings, Vec::<String>::new());
    }

    #[test]
    fn a_missing_material_file_is_a_warning_and_gives_the_default_material() {
        let model = load_text(&format!("mtllib gone.mtl\n{SQUARE}usemtl x\nf 1 2 3\n"), "").unwrap();
        assert_eq!(model.materials, [Material::default()]);
        assert_eq!(model.warnings.len(), 1);
        assert!(model.warnings[0].contains("gone.mtl"), "{:?}", model.warnings);
    }

    #[test]
    fn flat_faces_with_normals_of_their_own_keep_them() {
        let normals = "vn 0 0 1\nvn 0 0 2\n";
        let model = load_text(&format!("{SQUARE}{normals}f 1//1 2//1 3//1\nf 1//2 3//2 4//2\n"), "").unwrap();
        let mesh = &model.meshes[0];
        assert_eq!(mesh.positions.len(), 6);
        let normals =
            mesh.triangles.iter().map(|triangle| triangle.map(|vertex| mesh.normals[vertex as usize][2]));
        assert_eq!(normals.collect::<Vec<_>>(), [[1.0; 3], [2.0; 3]]);
    }

    #[test]
    fn an_object_without_normals_gets_none_from_its_neighbours() {
        let faces = "o bare\nf 1 2 3\no mixed\nf 1//1 2//1 3//1\nf 1 2 4\no smooth\nf 1//1 3//1 4//1\n";
        let model = load_text(&format!("{SQUARE}vn 0 0 1\n{faces}"), "").unwrap();
        let normals: Vec<usize> = model.meshes.iter().map(|mesh| mesh.normals.len()).collect();
        assert_eq!(normals, [0, 0, 3]);
        assert!(model.warnings[0].ends_with("normals on some faces only, so shaded flat: mixed"));
    }

    #[test]
    fn line_elements_of_any_length_are_ignored_and_counted() {
        let model =
            load_text(&format!("{SQUARE}l 1 2\nl 1 2 3\n l 1 2 3 4\nf 1 2 3\nl 1 2 3 4 1\n"), "").unwrap();
        assert_eq!(model.meshes.len(), 1);
        assert_eq!(model.meshes[0].triangles, [[0, 1, 2]]);
        assert!(model.warnings[0].ends_with("line elements have no surface and are ignored: 4"));
    }

    #[test]
    fn malformed_lines_are_named() {
        for (tail, expected) in [
            ("f 1 2 9", "line 5: vertex index 9 is out of range: the file has 4"),
            ("f 1 2 0", "line 5: vertex index 0 is out of range"),
            ("f 1 2 -9223372036854775808", "line 5: vertex index"),
            ("f 1//9223372036854775807 2 3", "line 5: normal index"),
            ("f 1/1 2 3", "line 5: texture coordinate index"),
            ("f 1/2/3/4 2 3", "line 5: `1/2/3/4` is not a face corner"),
            ("f a b c", "line 5: `a` is not a face corner"),
            ("v 1 nan 2", "line 5: the vertex is not finite: `nan`"),
            ("v 1 1e99 2", "line 5: the vertex is not finite"),
            ("v 1 x 2", "line 5: `x` is not a number"),
            ("v 1 2", "position parse error"),
            ("f", "invalid polygon"),
            ("", "holds no triangles"),
        ] {
            let message = load_text(&format!("{SQUARE}{tail}\n"), "").unwrap_err().to_string();
            assert!(message.contains(expected), "{tail}: {message}");
        }
    }
}
