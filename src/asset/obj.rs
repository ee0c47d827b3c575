//! Wavefront OBJ files, parsed by `tobj` after a check that tells the line of whatever is wrong.

use std::cell::RefCell;
use std::io::Cursor;
use std::path::Path;

use glam::DAffine3;

use super::error::{AssetError, Flaw};
use super::model::{Model, Node, Part};
use super::mtl;
use super::notes::Notes;
use super::tidy::tidy;
use crate::geometry::Mesh;
use crate::shade::Material;

/// Reads an OBJ file and the material libraries that it names.
///
/// Each object (or group) becomes a node, with one mesh per material; polygons are cut into triangles.
///
/// # Errors
/// The file cannot be read, a number is malformed or not finite, an index is out of range, or there is no triangle.
pub fn load(path: &Path) -> Result<Model, AssetError> {
    let text = String::from_utf8_lossy(&AssetError::read(path)?).into_owned();
    let notes = RefCell::new(Notes::default());
    let content = |flaw| AssetError::content(path, flaw);
    check_lines(&text, &mut notes.borrow_mut()).map_err(content)?;
    let options =
        tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let library = |file: &Path| {
        let file = path.parent().unwrap_or(Path::new("")).join(file);
        mtl::load(&file, &mut notes.borrow_mut())
    };
    let (models, materials) = tobj::load_obj_buf(&mut Cursor::new(text), &options, library)
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
    let mut mesh = Mesh {
        positions: part.mesh.positions.as_chunks().0.to_vec(),
        normals: part.mesh.normals.as_chunks().0.to_vec(),
        triangles: part.mesh.indices.as_chunks().0.to_vec(),
    };
    if !mesh.normals.is_empty() && mesh.normals.len() != mesh.positions.len() {
        notes.add("normals on some faces only, so shaded flat", &name);
        mesh.normals.clear();
    }
    let dropped = tidy(&mut mesh).map_err(|flaw| flaw.at(format!("object `{name}`")))?;
    let material = part.mesh.material_id.unwrap_or_else(|| default_material(model));
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

/// How many positions, texture coordinates and normals there are.
type Counts = [i64; 3];

const INDEX_NAMES: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// Checks vertices and faces line by line.
///
/// `tobj` says what is wrong but not where, and computes with any index that it is given, so indices are checked
/// here.
fn check_lines(text: &str, notes: &mut Notes) -> Result<(), Flaw> {
    let keyword = |line: &str| line.split_whitespace().next().and_then(column_of);
    let mut total: Counts = [0; 3];
    for column in text.lines().filter_map(keyword) {
        total[column] += 1;
    }
    let mut so_far: Counts = [0; 3];
    let mut edges = 0;
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let word = words.next().unwrap_or_default();
        let checked = match (column_of(word), word) {
            (Some(column), _) => {
                so_far[column] += 1;
                check_numbers(words, INDEX_NAMES[column])
            }
            (None, "f") => words.try_for_each(|corner| check_corner(corner, so_far, total)),
            (None, "l") => {
                edges += 1;
                words.try_for_each(|corner| check_corner(corner, so_far, total))
            }
            _ => Ok(()),
        };
        checked.map_err(|flaw| flaw.at(format!("line {}", index + 1)))?;
    }
    if edges > 0 {
        notes.add("line elements have no surface and are ignored", edges.to_string());
    }
    Ok(())
}

fn column_of(word: &str) -> Option<usize> {
    ["v", "vt", "vn"].iter().position(|known| *known == word)
}

fn check_numbers<'a>(words: impl Iterator<Item = &'a str>, what: &str) -> Result<(), Flaw> {
    for word in words {
        // A normal that is not finite is repaired later; exporters write them for degenerate faces.
        let finite = word.parse::<f32>().map_err(|_| {
            Flaw::new(format!("`{word}` is not a number"), "write the coordinates as decimal numbers")
        })?;
        if !finite.is_finite() && what == INDEX_NAMES[0] {
            return Err(Flaw::new(
                format!("the {what} is not finite: `{word}`"),
                "fix the vertex in the modelling program and export again",
            ));
        }
    }
    Ok(())
}

/// Checks a face corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
fn check_corner(corner: &str, so_far: Counts, total: Counts) -> Result<(), Flaw> {
    let malformed = || {
        Flaw::new(format!("`{corner}` is not a face corner"), "write corners as v, v/vt, v//vn or v/vt/vn")
    };
    for (column, word) in corner.split('/').enumerate() {
        if word.is_empty() && column > 0 {
            continue;
        }
        let index: i64 = word.parse().map_err(|_| malformed())?;
        let (Some(name), Some(&before), Some(&all)) =
            (INDEX_NAMES.get(column), so_far.get(column), total.get(column))
        else {
            return Err(malformed());
        };
        let in_range = (1..=all).contains(&index) || (-before..=-1).contains(&index);
        if !in_range {
            return Err(Flaw::new(
                format!("{name} index {index} is out of range: the file has {all}"),
                "indices count from 1, or backwards from -1; the file is damaged or cut off",
            ));
        }
    }
    Ok(())
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
        load(&path)
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
    fn malformed_lines_are_named() {
        for (tail, expected) in [
            ("f 1 2 9", "line 5: vertex index 9 is out of range: the file has 4"),
            ("f 1 2 0", "line 5: vertex index 0 is out of range"),
            ("f 1 2 -9223372036854775808", "line 5: vertex index"),
            ("f 1//9223372036854775807 2 3", "line 5: normal index"),
            ("f 1/2/3/4 2 3", "line 5: texture coordinate index"),
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
