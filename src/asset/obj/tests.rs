use super::*;
use crate::shade::{Diffuse, Lobe};
use glam::Vec3;

/// Loads a file of these bytes, beside the library `a.mtl` and a picture `p.png`.
fn load_bytes(obj: &[u8], mtl: &str) -> Result<Model, AssetError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.mtl"), mtl).unwrap();
    image::RgbImage::new(1, 1).save(folder.path().join("p.png")).unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, obj).unwrap();
    let prefix = format!("{}/", folder.path().display());
    let mut model = load(&path, &Files::default())?;
    model.warnings.iter_mut().for_each(|line| *line = line.replace(&prefix, ""));
    Ok(model)
}

fn load_text(obj: &str, mtl: &str) -> Result<Model, AssetError> {
    load_bytes(obj.as_bytes(), mtl)
}

/// Sum of the triangles' areas.
fn area(model: &Model) -> f32 {
    let place = |mesh: &Mesh, vertex: u32| Vec3::from(mesh.positions[vertex as usize]);
    let areas = model.meshes.iter().flat_map(|mesh| {
        mesh.triangles.iter().map(move |triangle| {
            let [a, b, c] = triangle.map(|vertex| place(mesh, vertex));
            (b - a).cross(c - a).length() / 2.0
        })
    });
    areas.sum()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn polygons_are_triangulated_and_objects_with_two_materials_stay_one_node() {
    let obj = format!("mtllib a.mtl\n{SQUARE}o box\nusemtl red\nf 1 2 3 4\nusemtl lamp\nf -4 -3 -2\n");
    let mtl = "newmtl red\nKd 1 0 0\nnewmtl lamp\nKd 0\nKe 5 5 5\n";
    let model = load_text(&obj, mtl).unwrap();
    assert_eq!(model.nodes.len(), 1);
    assert_eq!(model.nodes[0].name, "box");
    assert_eq!(model.nodes[0].parts, [Part { mesh: 0, material: 0 }, Part { mesh: 1, material: 1 }]);
    assert_eq!(model.meshes[0].triangles.len(), 2);
    assert_eq!(model.materials[0].lobe, Lobe::Diffuse(Diffuse { albedo: Vec3::X }));
    assert_eq!(model.materials[1].lobe, Lobe::Diffuse(Diffuse { albedo: Vec3::ZERO }));
    assert_eq!(model.materials[1].emission, Vec3::splat(5.0));
    assert_eq!(model.warnings, Vec::<String>::new());
}

#[test]
fn polygons_with_dents_keep_their_area_and_normals_whatever_their_first_corner() {
    let corners = [[0, 0], [3, 0], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]];
    let vertices: String = corners.iter().map(|[x, y]| format!("v {x} {y} 0\n")).collect();
    for turn in 0..corners.len() {
        let corner = |i: usize| (i + turn) % corners.len() + 1;
        let plain: String = (0..corners.len()).map(|i| format!(" {}", corner(i))).collect();
        let smooth: String = (0..corners.len()).map(|i| format!(" {0}/{0}/{0}", corner(i))).collect();
        let model = load_text(&format!("{vertices}f{plain}\n"), "").unwrap();
        assert!((area(&model) - 7.0).abs() < 1e-5, "{turn}: {}", area(&model));
        let normals: String = corners.iter().map(|[x, y]| format!("vn {x} {y} 9\nvt 0 0\n")).collect();
        let model = load_text(&format!("{vertices}{normals}f{smooth}\n"), "").unwrap();
        assert!((area(&model) - 7.0).abs() < 1e-5, "{turn}: {}", area(&model));
        let mesh = &model.meshes[0];
        for (place, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert_eq!(place[..2], normal[..2], "{turn}");
        }
    }
}

#[test]
fn files_as_programs_write_them_are_the_same_square() {
    let face = "f 1 2 3 4\n";
    for text in [
        format!("\u{feff}{SQUARE}{face}"),
        format!("{SQUARE}{face}").replace('\n', "\r"),
        format!("{SQUARE}{face}").replace('\n', "\r\n"),
        format!("{SQUARE}f 1 2 \\\n3 4\n"),
        format!("{SQUARE}f 1 2 \\\r\n3 \\\r\n4\r\n"),
        format!("{SQUARE}{face}").replace("v 1 1", "v 1 \\\n1"),
        format!("{SQUARE}{face}").replace("0\n", "0 # corner\n").replace("4\n", "4# all\n"),
        format!("\t{SQUARE}  {face}").replace(' ', "\t "),
        format!("{SQUARE}{face}").replace("0\n", "0 0.5 0.5 0.5\n"),
        format!("{SQUARE}{face}").replace("0\n", "0 1 1 0 0\n"),
        format!("{SQUARE}{face}").replace("0\n", "0 nan nan nan\n"),
        format!("{SQUARE}{face}").replacen("0\n", "0 0.5 0.5 0.5\n", 2),
        format!("{SQUARE}{face}").replace("0\n", "0 1.0\n"),
        format!("{SQUARE}vt -1.#IND 0.5\nvt 1.#QNAN\nvt nan(ind) inf\nvt\nf 1/1 2/2 3/3 4/4\n"),
        format!("{SQUARE}s 1\ng\n{face}"),
    ] {
        let model = load_text(&text, "").unwrap_or_else(|error| panic!("{text:?}: {error}"));
        assert_eq!(area(&model), 1.0, "{text:?}");
        assert_eq!(model.meshes[0].positions.len(), 4, "{text:?}");
        assert_eq!(model.nodes[0].name, "unnamed_object");
        assert_eq!(model.warnings, Vec::<String>::new(), "{text:?}");
    }
}

#[test]
fn what_is_left_out_is_said() {
    for (tail, said) in [
        ("f\nf 1 2\n", "faces with fewer than three corners are left out, in line: 6, 7"),
        (
            "cstype bezier\ncurv 0 1 1 2 3\nend\n",
            "free-form curves and surfaces are left out, in line: 6, 7, 8",
        ),
        ("p 1 2\n", "point elements have no surface and are ignored: 1"),
        ("csh -e x\n", "statements that are not understood are left out: csh"),
        ("o bad\nf 1 1 2\n", "objects without area are left out: bad"),
        ("usemtl Lamp\nf 1 2 3\n", "materials that no library before them defines are grey: Lamp"),
        ("usemtl\nf 1 2 3\n", "`usemtl` without a name means grey, in line: 6"),
        ("mtllib\n", "material libraries that cannot be read are left out: `mtllib` without a name"),
        (
            "v 1 2 3 0\nf 1 2 5",
            "weights of vertices by which they cannot be divided are left out, in line: 6",
        ),
        ("vn -1.#IND 0 1\n", "normals that are not three finite numbers are replaced, in line: 6"),
        (
            "f 1/1 2/-1 3/0\n",
            "without texture coordinates, since some are named that the file does not have, in line: 6",
        ),
    ] {
        let model = load_text(&format!("{SQUARE}f 1 2 3 4\n{tail}"), "").unwrap();
        assert_eq!(model.warnings[0], format!("a.obj: {said}"), "{tail}");
    }
}

#[test]
fn a_missing_material_file_is_a_warning_and_gives_the_default_material() {
    let model = load_text(&format!("mtllib gone.mtl\n{SQUARE}usemtl x\nf 1 2 3\n"), "").unwrap();
    assert_eq!(model.materials, [Material::default()]);
    let [library, material] = model.warnings.as_slice() else { panic!("{:?}", model.warnings) };
    assert!(
        library.starts_with("a.obj: material libraries that cannot be read are left out: gone.mtl (No such")
    );
    assert_eq!(material, "a.obj: materials that no library before them defines are grey: x");
}

/// Emission of the faces of an OBJ file, whose face is lit if its material is found.
fn is_lit(head: &str, material: &str, files: &[(&str, &str)]) -> (bool, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let path = folder.path().join("a.obj");
    std::fs::write(&path, format!("{head}\n{SQUARE}usemtl {material}\nf 1 2 3\n")).unwrap();
    let model = load(&path, &Files::default()).unwrap();
    (model.materials[model.nodes[0].parts[0].material].emits(), model.warnings)
}

#[test]
fn libraries_are_found_as_programs_name_them() {
    let (wall, lamp) = ("newmtl wall\nKd 1 1 1\n", "newmtl lamp\nKe 1 1 1\n");
    for (head, file) in [
        ("mtllib a.mtl b.mtl", "b.mtl"),
        ("mtllib a.mtl\nmtllib b.mtl", "b.mtl"),
        ("mtllib a.mtl my lamp.MTL", "my lamp.MTL"),
        ("mtllib my lamp", "my lamp"),
        ("mtllib\tb.mtl # lamps", "b.mtl"),
        ("mtllib \"b.mtl\"", "b.mtl"),
        ("mtllib .\\sub\\b.mtl", "sub/b.mtl"),
        ("mtllib C:\\models\\b.mtl", "b.mtl"),
        ("mtllib b.mtl b.mtl ./b.mtl", "b.mtl"),
        ("mtllib \\\nb.mtl", "b.mtl"),
    ] {
        let found = is_lit(head, "lamp", &[("a.mtl", wall), (file, lamp)]);
        assert_eq!(found, (true, Vec::new()), "{head}");
    }
}

#[test]
fn material_names_are_taken_whole_and_else_without_a_comment() {
    for (defined, used, is_found) in [
        ("Lamp  Bright 01", "Lamp  Bright 01", true),
        ("Material #25", "Material #25", true),
        ("Material #25", "Material #26", false),
        ("lamp", "lamp # bright", true),
        ("lamp # bright", "lamp", true),
        ("lamp#1", "lamp", false),
        ("lamp", "Lamp", false),
    ] {
        let library = format!("newmtl {defined}\nKe 1 1 1\n");
        let (found, warnings) = is_lit("mtllib a.mtl", used, &[("a.mtl", &library)]);
        assert_eq!((found, warnings.is_empty()), (is_found, is_found), "{defined} {used}: {warnings:?}");
    }
}

#[test]
fn a_material_used_before_its_library_is_grey_and_said() {
    let obj = format!("usemtl lamp\n{SQUARE}f 1 2 3\nmtllib a.mtl\nusemtl lamp\nf 1 3 4\n");
    let model = load_text(&obj, "newmtl lamp\nKe 1 1 1\n").unwrap();
    let materials = model.nodes[0].parts.iter().map(|part| model.materials[part.material].emits());
    assert_eq!(materials.collect::<Vec<_>>(), [false, true]);
    assert_eq!(model.warnings, ["a.obj: materials that no library before them defines are grey: lamp"]);
}

#[test]
fn a_library_that_is_named_again_and_again_is_read_once() {
    let library: String = (0..2000).map(|i| format!("newmtl a{i}\nKd 1 1 1\n")).collect();
    let model = load_text(&format!("{}{SQUARE}f 1 2 3\n", "mtllib a.mtl\n".repeat(2000)), &library).unwrap();
    assert_eq!(model.materials.len(), 2001);
}

#[test]
fn long_names_of_objects_are_cut() {
    let text = format!("{SQUARE}o {}\nf 1 2 3\nusemtl \u{1b}[2J\nf 1 3 4\n", "a".repeat(1_000_000));
    let model = load_text(&text, "").unwrap();
    assert_eq!(model.nodes[0].name.chars().count(), 199);
    assert_eq!(model.warnings, ["a.obj: materials that no library before them defines are grey: \\u{1b}[2J"]);
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
    assert_eq!(model.warnings, ["a.obj: normals on some faces only, so shaded flat: mixed"]);
}

#[test]
fn line_elements_of_any_length_are_ignored_and_counted() {
    let model =
        load_text(&format!("{SQUARE}l 1 2\nl 1 2 3\n l 1 2 3 4\nf 1 2 3\nl 1 2 3 4 1\n"), "").unwrap();
    assert_eq!(model.meshes.len(), 1);
    assert_eq!(model.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(model.warnings, ["a.obj: line elements have no surface and are ignored: 4"]);
}

#[test]
fn malformed_lines_are_named() {
    let long = format!("f 1 2 {}", "A".repeat(5_000_000));
    for (tail, expected) in [
        ("f 1 2 9", "line 5: vertex index 9 is out of range: the file has 4"),
        ("f 1 2 0", "line 5: vertex index 0 is out of range"),
        ("f 1 2 -9223372036854775808", "line 5: vertex index"),
        ("f 1//9223372036854775807 2 3", "line 5: normal index"),
        ("f 1 2 \\\n 9", "line 5: vertex index 9"),
        (
            "f 1 2 5\no b\nv 0 0 0\nf 1 2 5",
            "line 5: vertex index 5 is out of range: up to the end of their object",
        ),
        ("f 1/2/3/4 2 3", "line 5: `1/2/3/4` is not a face corner"),
        ("f a b c", "line 5: `a` is not a face corner"),
        (&long, "line 5: `AAA"),
        ("v 1 nan 2", "line 5: the vertex is not finite: `nan`"),
        ("v 1 1e99 2", "line 5: the vertex is not finite"),
        ("v 1 -1.#IND 2", "line 5: `-1.#IND` is not a number"),
        ("v 1 x 2", "line 5: `x` is not a number"),
        ("v 1 2", "line 5: the vertex has 2 numbers instead of 3"),
        ("v 1 2 # 3", "line 5: the vertex has 2 numbers instead of 3"),
        ("f 1 1 1", "holds no triangles with an area"),
        ("", "holds no triangles"),
    ] {
        let message = load_text(&format!("{SQUARE}{tail}\n"), "").unwrap_err().to_string();
        assert!(message.contains(expected), "{tail}: {message}");
        assert!(message.lines().all(|line| line.chars().count() < 1000));
    }
    let message = load_bytes(b"\xff\xfev\0 \0", "").unwrap_err().to_string();
    assert!(message.contains("its text is UTF-16, not UTF-8\n   = help: save it as UTF-8"), "{message}");
}

#[test]
fn texture_coordinates_are_read_where_a_material_looks_at_them_and_all_are_there() {
    let coordinates = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 nan\nvn 0 0 1\n";
    let load = |faces: &str, mtl: &str| {
        load_text(&format!("mtllib a.mtl\n{SQUARE}{coordinates}usemtl m\n{faces}\n"), mtl).unwrap()
    };
    let textured = "newmtl m\nmap_Kd p.png\n";
    // From the upper left corner, as in glTF; what is no number is 0.
    let expected = vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    for faces in ["f 1/1 2/2 3/3 4/4", "f 1/1/1 2/2/1 3/3/1 4/4/1", "f 1/-4 2/-3 3/-2\nf 1/1 3/3 4/4"] {
        let Mesh { positions, attributes, .. } = &load(faces, textured).meshes[0];
        assert_eq!((attributes.uvs.len(), &attributes.uvs[0]), (1, &expected), "{faces}");
        assert_eq!(positions.len(), 4);
    }
    // A vertex for each pair of place and coordinates.
    let split = load("f 1/1 2/2 3/3\nf 1/2 3/3 4/4", textured);
    assert_eq!((split.meshes[0].positions.len(), split.meshes[0].attributes.uvs[0].len()), (5, 5));
    assert!(load("f 1/1 2/2 3/3 4/4", "newmtl m\nKd 1 1 1\n").meshes[0].attributes.is_empty());
    let lost = load("f 1/1 2/2 3/9 4/4", textured);
    assert!(lost.meshes[0].attributes.is_empty());
    assert!(
        lost.warnings[0].contains("without texture coordinates, since some are named"),
        "{:?}",
        lost.warnings
    );
}
