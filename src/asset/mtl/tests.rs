//! Tests of libraries.

use std::sync::Arc;

use glam::{DVec2, Vec3, Vec4};

use super::*;
use crate::shade::{Dielectric, Diffuse, Lobe, Maps, Mirror, NormalMap, Principled, TextureId, Wrap};

/// The materials and warnings of a library beside a picture `e.png`, of which one of 64 pixels is white.
fn convert_bytes(bytes: &[u8]) -> (Vec<Material>, Vec<String>) {
    let (mut libraries, warnings) = read_beside_pictures(bytes);
    (libraries.take().0, warnings)
}

/// The library and its warnings, also beside `n.png`, whose normals lean, and `g.png`, of grey 51 on 4 pixels.
fn read_beside_pictures(bytes: &[u8]) -> (Libraries, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.mtl"), bytes).unwrap();
    std::fs::create_dir(folder.path().join("tex")).unwrap();
    let picture = image::RgbImage::from_fn(8, 8, |x, y| image::Rgb([255 * u8::from(x + y == 0); 3]));
    picture.save(folder.path().join("tex/e 1.png")).unwrap();
    let flat = |name: &str, size: u32, colour: [u8; 3]| {
        let picture = image::RgbImage::from_pixel(size, size, image::Rgb(colour));
        picture.save(folder.path().join(name)).unwrap();
    };
    flat("n.png", 4, [153, 128, 250]);
    flat("g.png", 2, [51; 3]);
    let mut libraries = Libraries::default();
    let mut notes = Notes::default();
    libraries.read("a.mtl", folder.path(), &Files::default(), &mut notes);
    assert_eq!(notes.into_lines("a.obj"), Vec::<String>::new());
    let prefix = format!("{}/", folder.path().display());
    let warnings = libraries.warnings.iter().map(|line| line.replace(&prefix, "")).collect();
    (libraries, warnings)
}

fn convert_text(text: &str) -> (Vec<Material>, Vec<String>) {
    convert_bytes(text.as_bytes())
}

fn lobes(text: &str) -> Vec<Lobe> {
    let (materials, warnings) = convert_text(text);
    assert!(warnings.is_empty(), "{warnings:?}");
    materials.iter().map(|material| material.lobe).collect()
}

#[test]
fn illumination_models_choose_the_lobe() {
    let text = "newmtl m\nillum 3\nKs .9 .8 .7\nnewmtl g\nillum 7\nNi 1.3\nnewmtl t\nd 0.1\nnewmtl d\nKd .1 .2 .3\nillum 2\n";
    let expected = [
        Lobe::Mirror(Mirror { reflectance: Vec3::new(0.9, 0.8, 0.7) }),
        Lobe::Dielectric(Dielectric { ior: 1.3, tint: Vec3::ONE }),
        Lobe::Dielectric(Dielectric { ior: 1.5, tint: Vec3::ONE }),
        Lobe::Diffuse(Diffuse { albedo: Vec3::new(0.1, 0.2, 0.3) }),
    ];
    assert_eq!(lobes(text), expected);
    assert_eq!(lobes(&text.replace('\n', "\r")), expected);
    assert_eq!(lobes(&format!("\u{feff}{}", text.replace('\n', "\r\n"))), expected);
}

#[test]
fn roughness_metal_coat_and_sheen_make_a_principled_material() {
    let base = Vec3::new(0.1, 0.2, 0.3);
    let plain = Principled { base, roughness: 0.5, sheen_roughness: 0.5, ..Principled::PLAIN };
    let coated = Principled { clearcoat: 1.0, clearcoat_roughness: 0.03, ..plain };
    let cloth = Principled { sheen_color: Vec3::splat(0.4), sheen_roughness: 0.5, ..plain };
    let frosted =
        Principled { roughness: 0.3, ior: 1.4, transmission: 1.0, is_thin: false, ..Principled::PLAIN };
    let text = "newmtl a\nKd .1 .2 .3\nPr 0.25\nPm 2\nnewmtl b\nKd .1 .2 .3\nPc 1\nPcr 0.03\n\
                newmtl c\nKd .1 .2 .3\nPs 0.4\nillum 3\nKs 1 1 1\nnewmtl d\nillum 7\nPr 0.3\nNi 1.4\n";
    let metal = Principled { metallic: 1.0, roughness: 0.25, ..plain };
    assert_eq!(lobes(text), [metal, coated, cloth, frosted].map(Lobe::Principled));
}

#[test]
fn a_mirror_that_reflects_nothing_is_diffuse() {
    let red = Lobe::Diffuse(Diffuse { albedo: Vec3::X });
    assert_eq!(lobes("newmtl a\nillum 3\nKd 1 0 0\nnewmtl b\nKd 1 0 0\nKs 0 0 0\nillum 5"), [red, red]);
}

#[test]
fn ignored_maps_and_odd_colours_are_said_once_each() {
    let (materials, warnings) = convert_text(
        "newmtl a\nmap_Ks a.png\nKd 2 0 0\nKe spectral x.rfl\naniso 0.5\nnewmtl b\nmap_Ks b.png\n",
    );
    assert_eq!(materials[0].lobe, Lobe::Diffuse(Diffuse { albedo: Vec3::X }));
    assert_eq!(
        warnings,
        [
            "a.mtl: `map_Ks` is ignored, in material: a, b",
            "a.mtl: statements that cannot be read are left out, in line: 4: `Ke spectral x.rfl`",
            "a.mtl: `aniso` is ignored, in material: a",
            "a.mtl: colours outside 0..1 are clamped: a",
        ]
    );
}

#[test]
fn one_odd_statement_costs_itself_and_not_the_library() {
    for odd in [
        "illum",
        "illum 2.0",
        "illum -1",
        "illum 999",
        "Ni 1,45",
        "Ni",
        "Ns none",
        "d -halo 0.5",
        "map_Kd",
        "Kd 1 1",
        "Kd 0,5 0,5 0,5",
        "Kd 1 1 x",
        "Kd",
        "Ks xyz 1 1 1",
        "Ke -1.#IND 0 0",
        "map_Ke ",
    ] {
        let (materials, warnings) =
            convert_text(&format!("newmtl wall\nKd 1 1 1\n{odd}\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n"));
        let shown = odd.trim_end();
        let said = format!("a.mtl: statements that cannot be read are left out, in line: 3: `{shown}`");
        assert_eq!(warnings, [said], "{odd}");
        assert_eq!(materials[0].lobe, Lobe::Diffuse(Diffuse { albedo: Vec3::ONE }), "{odd}");
        assert_eq!(materials[1].emission, Vec3::ONE, "{odd}");
    }
}

#[test]
fn statements_without_a_material_and_materials_without_a_name_are_said() {
    let (materials, warnings) = convert_text("Kd 1 0 0\nnewmtl\nKd 0 1 0\nnewmtl a\nKd 0 0 1\n");
    assert_eq!(materials[1].lobe, Lobe::Diffuse(Diffuse { albedo: Vec3::Z }));
    assert_eq!(
        warnings,
        [
            "a.mtl: statements before the first `newmtl` are left out, in line: 1",
            "a.mtl: materials without a name cannot be used, in line: 2",
        ]
    );
}

#[test]
fn a_picture_is_a_factor_on_kd_or_ke_moved_as_its_options_say() {
    let (materials, warnings) = convert_text(
        "newmtl a\nKd 1 1 .5\nmap_Kd -s 2 3 1 -o 0.5 0.25 -clamp on tex\\e 1.png\n\
         newmtl b\nKd 0 0 0\nKe 64 64 64\nmap_Ke tex/e 1.png\nmap_Kd C:\\gone\\x.png\nnewmtl c\nmap_Kd tex/e 1.png\n\
         newmtl d\nmap_Ke tex/e 1.png\nmap_Kd -mm 0 2 tex/e 1.png\n",
    );
    let map =
        |index: usize| (materials[index].lobe.albedo(), materials[index].emission, materials[index].maps);
    let maps = |base_color: Option<u32>, emission: Option<u32>| Maps {
        base_color: base_color.map(TextureId),
        emission: emission.map(TextureId),
        ..Maps::default()
    };
    assert_eq!(map(0), (Vec3::new(1.0, 1.0, 0.5), Vec3::ZERO, maps(Some(0), None)));
    assert_eq!(map(1), (Vec3::ZERO, Vec3::splat(64.0), maps(None, Some(1))));
    assert_eq!(map(2), (Vec3::ONE, Vec3::ZERO, maps(Some(2), None)));
    assert_eq!(map(3), (Vec3::ONE, Vec3::ONE, maps(Some(4), Some(3))));
    assert!(warnings[0].starts_with(
        "a.mtl: pictures of `map_Kd` that cannot be used are ignored: C:\\gone\\x.png (cannot be read"
    ));
    assert_eq!(warnings[1..], ["a.mtl: `-mm` of `map_Kd` is ignored, in material: d"]);
    let MapStatement { name, scale, offset, wrap, bumps, ignored } =
        MapStatement::of(" -s 2 3 1 -o 0.5 0.25 -clamp on tex/e 1.png");
    assert_eq!((name, scale, offset), ("tex/e 1.png", DVec2::new(2.0, 3.0), DVec2::new(0.5, 0.25)));
    assert_eq!((wrap, bumps, ignored), (Wrap::Clamp, 1.0, None));
}

#[test]
fn emission_is_bounded() {
    let (materials, warnings) = convert_text(
        "newmtl a\nKe 1e39 1 0\nnewmtl b\nKe -1 0 0\nnewmtl c\nKe nan 0 0\nnewmtl d\nKe 1e18 0 0",
    );
    let emission: Vec<Vec3> = materials.iter().map(|material| material.emission).collect();
    assert_eq!(emission, [Vec3::new(1e18, 1.0, 0.0), Vec3::ZERO, Vec3::ZERO, Vec3::X * 1e18]);
    assert_eq!(
        warnings,
        [
            "a.mtl: emission above 1e18 is clamped: a",
            "a.mtl: emission that is negative or not a number is ignored: b, c",
        ]
    );
}

#[test]
fn very_many_unknown_statements_are_a_few_lines() {
    let keys: String = (0..100_000).map(|i| format!("k{i} 1\n")).collect();
    let (_, warnings) = convert_text(&format!("newmtl a\n{keys}"));
    assert!(warnings.len() < 30, "{}", warnings.len());
}

#[test]
fn bumps_are_normals_if_they_are_blue_and_heights_if_they_are_grey() {
    let text = "newmtl a\nmap_Bump -bm 0.5 n.png\nnewmtl b\nbump -bm 2 -clamp on tex/e 1.png\nnewmtl c\nnorm g.png\n\
                newmtl d\nillum 7\nmap_bump n.png\nnewmtl e\nmap_Bump gone.png\nnewmtl f\nmap_bump g.png\nnorm n.png\n\
                newmtl g\nnorm gone.png\nmap_bump n.png\nnewmtl h\nbump -clamp on tex/e 1.png\n";
    let (mut libraries, warnings) = read_beside_pictures(text.as_bytes());
    let (materials, textures) = libraries.take();
    let map = |index: usize| {
        let NormalMap { texture: TextureId(id), scale } = materials[index].maps.normal?;
        Some((textures[id as usize].image.texel(0, [0, 0]), scale))
    };
    let leaning = Vec4::new(0.6, 128.0 / 255.0, 250.0 / 255.0, 1.0);
    assert_eq!(map(0), Some((leaning, 0.5)));
    // White beside black to the right and below: downhill to both.
    let (normal, scale) = map(1).unwrap();
    let normal = 2.0 * normal.truncate() - 1.0;
    assert!(scale == 2.0 && (normal / normal.z - Vec3::new(0.5, -0.5, 1.0)).length() < 1e-3, "{normal}");
    assert_eq!(map(2), Some((Vec4::new(0.2, 0.2, 0.2, 1.0), 1.0)));
    assert_eq!((materials[3].is_dielectric(), map(3)), (true, Some((leaning, 1.0))));
    assert_eq!((map(4), map(5), map(6)), (None, Some((leaning, 1.0)), Some((leaning, 1.0))));
    let image = |index: usize| {
        let TextureId(id) = materials[index].maps.normal.expect("a map").texture;
        &textures[id as usize].image
    };
    assert!(Arc::ptr_eq(image(1), image(7)), "normals of the same heights are made once");
    for said in [
        "pictures of `map_Bump` that cannot be used are ignored: gone.png",
        "pictures of `norm` that cannot be used are ignored: gone.png",
        "`map_Bump` beside `norm` is ignored, in material: f",
    ] {
        assert!(warnings.iter().any(|line| line.contains(said)), "{said}: {warnings:?}");
    }
    assert_eq!(warnings.len(), 3, "{warnings:?}");
}

#[test]
fn pictures_of_roughness_and_metal_take_the_places_of_their_numbers() {
    let text = "newmtl a\nPr 0.5\nmap_Pr g.png\nnewmtl b\nPr 0.5\nPm 0\nmap_Pm g.png\nnewmtl c\nmap_Pr g.png\n\
                map_Pm -s 2 2 tex/e 1.png\nnewmtl d\nmap_Pr gone.png\nPr 0.25\nnewmtl e\nillum 7\nmap_Pr g.png\n";
    let (mut libraries, warnings) = read_beside_pictures(text.as_bytes());
    let (materials, textures) = libraries.take();
    let read = |index: usize, at: [usize; 2]| {
        let Lobe::Principled(lobe) = materials[index].lobe else { panic!("{:?}", materials[index].lobe) };
        let map = materials[index].maps.metallic_roughness;
        let texel = map.map_or(Vec4::ONE, |TextureId(id)| textures[id as usize].image.texel(0, at));
        [lobe.roughness * texel.y, lobe.metallic * texel.z]
    };
    for (index, at, expected) in [
        (0, [0, 0], [0.2, 0.0]),
        (1, [0, 0], [0.5, 0.2]),
        (2, [0, 0], [0.2, 1.0]),
        (2, [7, 7], [0.2, 0.0]),
        (3, [0, 0], [0.25, 0.0]),
    ] {
        let got = read(index, at);
        assert!(
            (got[0] - expected[0]).abs() < 1e-4 && (got[1] - expected[1]).abs() < 1e-4,
            "{index}: {got:?}"
        );
    }
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert_eq!(warnings[0], "a.mtl: `map_Pm` is placed as `map_Pr` is, in material: c");
    assert!(warnings[1].contains("gone.png"), "{warnings:?}");
    assert_eq!(warnings[2], "a.mtl: `map_Pr` of glass is ignored, in material: e");
}

#[test]
fn a_library_of_blenders_is_principled_all_through() {
    let text = "# Blender 4.2.0 MTL File: 'None'\n# www.blender.org\n\n\
                newmtl plastic\nNs 250\nKa 1 1 1\nKd .1 .2 .3\nKs .5 .5 .5\nKe 0 0 0\nNi 1.45\nd 1\nillum 2\n\
                newmtl gold\nNs 810\nKa 1 1 1\nKd 1 .8 .3\nKs .5 .5 .5\nNi 1.5\nd 1\nillum 3\n\
                newmtl leaf\nNs 0\nKa 1 1 1\nKd 0 1 0\nKs 0 0 0\nNi 1.5\nd 0.25\nillum 9\n\
                newmtl matt\nNs 90\nKd 1 1 1\nKs 1 1 1\nNi 1.5\nillum 1\nPr 0.9\naniso 0.000000\nanisor 0.000000\n\
                newmtl glass\nKd 1 1 1\nKs .5 .5 .5\nNi 1.5\nillum 2\nPr 0\nPm 0\nPc 2\nPcr 0.1\nTf 1 1 1\n";
    let (materials, warnings) = convert_text(text);
    assert!(warnings.is_empty(), "{warnings:?}");
    let plain = Principled { sheen_roughness: 0.5, ..Principled::PLAIN };
    let expected = [
        Principled { base: Vec3::new(0.1, 0.2, 0.3), roughness: 0.5, ior: 1.45, ..plain },
        Principled {
            base: Vec3::new(1.0, 0.8, 0.3),
            roughness: 1.0 - 0.81f32.sqrt(),
            metallic: 1.0,
            ..plain
        },
        Principled { base: Vec3::Y, roughness: 1.0, specular: 0.0, ..plain },
        Principled { roughness: 0.9, specular: 0.0, ..plain },
        Principled {
            roughness: 0.0,
            clearcoat: 0.5,
            clearcoat_roughness: 0.1,
            transmission: 1.0,
            is_thin: false,
            ..plain
        },
    ];
    assert_eq!(materials.len(), expected.len());
    for (material, expected) in materials.iter().zip(expected) {
        assert_eq!(material.lobe, Lobe::Principled(expected));
    }
    assert_eq!(materials[2].opacity.map(|opacity| opacity.factor), Some(0.25));
    // The same from elsewhere: matt, a mirror, glass.
    let (others, _) = convert_text(&text.replace("# Blender", "# Maya"));
    assert!(matches!(others[0].lobe, Lobe::Diffuse(_)) && matches!(others[1].lobe, Lobe::Mirror(_)));
    assert!(others[2].is_dielectric());
}

#[test]
fn blender_writes_pictures_of_roughness_metal_and_level_as_if_of_shininess_reflections_and_specular_colour() {
    let text = "# Blender 5.0.1 MTL File: 'None'\nnewmtl tex\nKa 1 1 1\nKs .5 .5 .5\nNi 1.5\nd 1\nillum 2\n\
                map_Kd tex/e 1.png\nmap_Ns g.png\nmap_refl tex/e 1.png\nmap_Bump -bm 0.7 n.png\nmap_Ks g.png\n";
    let (mut libraries, warnings) = read_beside_pictures(text.as_bytes());
    let (materials, textures) = libraries.take();
    assert_eq!(warnings, Vec::<String>::new());
    let Lobe::Principled(lobe) = materials[0].lobe else { panic!("{:?}", materials[0].lobe) };
    let TextureId(id) = materials[0].maps.metallic_roughness.expect("a picture");
    let texel = textures[id as usize].image.texel(0, [0, 0]);
    assert_eq!((lobe.base, lobe.roughness, lobe.metallic), (Vec3::ONE, 1.0, 1.0));
    assert!((texel.y - 0.2).abs() < 1e-4 && texel.z == 1.0, "{texel}");
    assert_eq!(materials[0].maps.normal.map(|map| map.scale), Some(0.7));
    let TextureId(id) = materials[0].maps.specular_color.expect("a picture");
    assert_eq!(lobe.specular_color, Vec3::splat(2.0));
    assert!((textures[id as usize].image.texel(0, [0, 0]).x - 0.0331).abs() < 1e-4, "decoded as a colour");
    // In others these are what they are called, and ignored.
    let (others, warnings) = convert_text(&text.replace("# Blender", "# Maya"));
    assert!(others[0].maps.metallic_roughness.is_none() && warnings.len() == 3, "{warnings:?}");
}
