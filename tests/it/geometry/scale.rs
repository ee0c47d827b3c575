//! Big meshes and big pictures: memory grows as is accounted for.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;
use std::time::Instant;

use crate::support::command::{Folder, assert_good, stderr};
use crate::support::heap::{HEAP, is_alone};
use warpfront::geometry::Mesh;
use warpfront::scene::load;
use warpfront::study::bench::bumpy_sphere;

const GIB: f64 = (1u64 << 30) as f64;

/// Writes a mesh as an OBJ file, with the positions as normals if wanted.
fn write_obj(mesh: &Mesh, normals: bool, path: &Path) {
    let mut out = BufWriter::new(File::create(path).unwrap());
    let columns: &[&str] = if normals { &["v", "vn"] } else { &["v"] };
    for keyword in columns {
        for [x, y, z] in &mesh.positions {
            writeln!(out, "{keyword} {x:.6} {y:.6} {z:.6}").unwrap();
        }
    }
    for corners in &mesh.triangles {
        let mut line = "f".to_owned();
        for corner in corners.map(|index| index + 1) {
            match normals {
                true => write!(line, " {corner}//{corner}").unwrap(),
                false => write!(line, " {corner}").unwrap(),
            }
        }
        writeln!(out, "{line}").unwrap();
    }
    out.flush().unwrap();
}

/// Writes a mesh as a binary glTF file, with the positions as normals.
fn write_glb(mesh: &Mesh, path: &Path) {
    let (vertices, corners) = (mesh.positions.len(), 3 * mesh.triangles.len());
    let (column, length) = (12 * vertices, 12 * vertices + 4 * corners);
    let mut json = serde_json::json!({
        "asset": { "version": "2.0" },
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 0 }, "indices": 1 }] }],
        "buffers": [{ "byteLength": length }],
        "bufferViews": [
            { "buffer": 0, "byteLength": column },
            { "buffer": 0, "byteOffset": column, "byteLength": 4 * corners },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5125, "count": corners, "type": "SCALAR" },
        ],
    })
    .to_string();
    json.push_str(&" ".repeat(json.len().next_multiple_of(4) - json.len()));
    let mut out = BufWriter::new(File::create(path).unwrap());
    let mut number = |n: usize| out.write_all(&(n as u32).to_le_bytes()).unwrap();
    number(0x4654_6c67);
    number(2);
    number(28 + json.len() + length);
    number(json.len());
    out.write_all(b"JSON").unwrap();
    out.write_all(json.as_bytes()).unwrap();
    out.write_all(&(length as u32).to_le_bytes()).unwrap();
    out.write_all(b"BIN\0").unwrap();
    mesh.positions.as_flattened().iter().for_each(|x| out.write_all(&x.to_le_bytes()).unwrap());
    mesh.triangles.as_flattened().iter().for_each(|i| out.write_all(&i.to_le_bytes()).unwrap());
    out.flush().unwrap();
}

#[test]
fn a_mesh_holds_the_memory_that_info_tells_and_not_much_more_while_it_is_loaded() {
    const TEST: &str =
        "geometry::scale::a_mesh_holds_the_memory_that_info_tells_and_not_much_more_while_it_is_loaded";
    if !is_alone(TEST) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mesh = bumpy_sphere(200_000);
    let count = mesh.triangles.len();
    write_obj(&mesh, false, &folder.path().join("flat.obj"));
    write_obj(&mesh, true, &folder.path().join("smooth.obj"));
    write_glb(&mesh, &folder.path().join("smooth.glb"));
    drop(mesh);
    // Bytes per triangle: corners, item, source, the hierarchy's share; vertex normals and indices.
    for (name, most) in [("flat.obj", 80.0), ("smooth.obj", 100.0), ("smooth.glb", 100.0)] {
        let before = HEAP.allocated();
        let scene = load(&folder.path().join(name), &[]).unwrap();
        let (held, told) = ((HEAP.allocated() - before) as f64, scene.geometry.memory_bytes() as f64);
        assert_eq!(scene.geometry.counts().triangles, count);
        assert!((held / told - 1.0).abs() < 0.02, "{name}: {held} bytes held, {told} told");
        assert!(told / (count as f64) < most, "{name}: {} bytes per triangle", told / count as f64);
        let peak = (HEAP.max_allocated() - before) as f64 / count as f64;
        assert!(peak < 400.0, "{name}: {peak} bytes per triangle at most");
    }
}

/// Largest resident memory of a render, bytes, and what the command says; 0 where the system does not tell.
fn render(folder: &Folder, flags: &[&str]) -> (f64, String) {
    let base = ["render", "-o", "out.exr", "--no-png", "--stats", "stats.json", "--spp", "1"];
    let output = folder.run(&[&base[..], flags].concat());
    assert_good(&output);
    let stats = std::fs::read(folder.path("stats.json")).unwrap();
    let stats: serde_json::Value = serde_json::from_slice(&stats).unwrap();
    (stats["stats"]["peak_memory_bytes"].as_f64().unwrap_or_default(), stderr(&output))
}

#[test]
fn a_larger_picture_takes_the_memory_of_its_film_and_no_more() {
    let folder = Folder::with(&[(
        "empty.toml",
        "[environment]\ncolor = 1\n[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nvertical_fov = 40\n",
    )]);
    let peak = |size: &str| render(&folder, &["empty.toml", "--size", size, "--threads", "2"]).0;
    let (small, large) = (peak("320x240"), peak("1920x1440"));
    let pixels = (1920 * 1440 - 320 * 240) as f64;
    // Sums of four channels in f64; tiles and pages are not filled to the last byte.
    assert!((large - small) / pixels < 36.0, "{} bytes per pixel", (large - small) / pixels);
}

/// Renders, and tells how long it took; asserts the memory, GiB.
fn render_within(most: f64, folder: &Folder, flags: &[&str]) {
    let started = Instant::now();
    let (peak, said) = render(folder, flags);
    println!("{flags:?}: {:.1?}, {:.2} GiB; {said}", started.elapsed(), peak / GIB);
    assert!(peak < most * GIB, "{flags:?}: {} GiB", peak / GIB);
}

#[test]
#[ignore = "long: loads 10 million triangles five times"]
fn ten_million_triangles_load_and_render() {
    let scene = "[[entity]]\ngltf = \"smooth.glb\"\nemission = 1\n\
                 [[entity]]\ndisk = { center = [0, -2, 0], normal = [0, 1, 0], outer = 5 }\n";
    let folder = Folder::with(&[("lamp.toml", scene)]);
    let mesh = bumpy_sphere(10_000_000);
    println!("{} triangles", mesh.triangles.len());
    write_obj(&mesh, false, &folder.path("flat.obj"));
    write_obj(&mesh, true, &folder.path("smooth.obj"));
    write_glb(&mesh, &folder.path("smooth.glb"));
    drop(mesh);
    render_within(3.0, &folder, &["flat.obj"]);
    render_within(3.0, &folder, &["smooth.obj"]);
    render_within(3.0, &folder, &["smooth.glb"]);
    render_within(3.0, &folder, &["smooth.glb", "--black-hole", "0,0,1.5,0.1"]);
    render_within(3.5, &folder, &["lamp.toml"]);
}
