//! Textures on surfaces: what a pixel sees of them, and what they light.

use crate::support::lit::{Agreement, picture as noisy_picture};
use crate::support::quads::{Quad, gltf, picture};
use crate::support::{camera, film, hole, render, scene_with, spacetimes};
use glam::DVec3;
use image::RgbaImage;
use serde_json::{Value, json};
use warpfront::film::Image;
use warpfront::scene::LightSampling::{Geodesic, Off};
use warpfront::scene::{Baked, Schedule};
use warpfront::trace::Run;

/// A diffuse material without gloss.
fn material(values: Value) -> Value {
    let mut material = json!({
        "extensions": { "KHR_materials_specular": { "specularFactor": 0 } },
        "pbrMetallicRoughness": { "metallicFactor": 0 },
    });
    for (key, value) in values.as_object().expect("an object") {
        match (&mut material[key], value) {
            (Value::Object(known), Value::Object(more)) => known.extend(more.clone()),
            (known, value) => *known = value.clone(),
        }
    }
    material
}

fn scene(text: &str, quads: &[Quad], materials: &Value, images: &[RgbaImage]) -> Baked {
    let text = format!("{text}[[entity]]\ngltf = \"a.gltf\"\n");
    let scene = scene_with(&text, &[("a.gltf", &gltf(quads, materials, images))]);
    assert_eq!(scene.warnings, Vec::<String>::new());
    scene
}

/// Four pixels that see the quarters of a quad, under a white sky.
fn quarters(quad: Quad, material: Value, images: &[RgbaImage]) -> [[f32; 3]; 4] {
    quarters_in("[environment]\ncolor = [1, 1, 1]\n", quad, material, images)
}

/// Four pixels that see the quarters of a quad, in some light.
fn quarters_in(light: &str, quad: Quad, material: Value, images: &[RgbaImage]) -> [[f32; 3]; 4] {
    let view =
        "[camera]\nposition = [0, 0, 1]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\nvertical_fov = 90.0\n";
    let text = view.to_owned() + &film(2, 2) + light;
    let scene = scene(&text, &[quad], &json!([material]), images);
    let image = render(&scene, &Run::default()).image;
    [0, 1, 2, 3].map(|pixel| ["R", "G", "B"].map(|name| image.channel(name).expect(name)[pixel]))
}

/// The square that a camera at (0, 0, 1) with 90° sees.
fn square() -> Quad {
    Quad::new(DVec3::new(-1.0, -1.0, 0.0), 2.0 * DVec3::X, 2.0 * DVec3::Y, 0)
}

fn assert_near(found: [[f32; 3]; 4], expected: [[f32; 3]; 4]) {
    for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
        assert!((found - expected).abs() < 2e-6, "{found} for {expected}");
    }
}

#[test]
fn a_pixel_is_texel_times_factor_times_vertex_colour() {
    let texels = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [188, 188, 188, 255]];
    let image = picture(2, &texels);
    let textured = material(json!({ "pbrMetallicRoughness": {
        "baseColorTexture": { "index": 0 }, "baseColorFactor": [1.0, 0.5, 0.25, 1.0],
    } }));
    let grey = 0.502_886_5;
    let plain = [[1.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.25], [grey, 0.5 * grey, 0.25 * grey]];
    assert_near(quarters(square(), textured.clone(), std::slice::from_ref(&image)), plain);
    let coloured = Quad { colors: Some([[0.5, 0.25, 1.0, 1.0]; 4]), ..square() };
    let tinted = plain.map(|[r, g, b]| [0.5 * r, 0.25 * g, b]);
    assert_near(quarters(coloured, textured.clone(), std::slice::from_ref(&image)), tinted);
    // Moved by half a picture, clamped; and turned by a quarter.
    let moved = |transform: Value| {
        let mut moved = textured.clone();
        moved["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
            json!({ "KHR_texture_transform": transform });
        moved
    };
    let right = quarters(square(), moved(json!({ "offset": [0.5, 0] })), std::slice::from_ref(&image));
    assert_near(right, [plain[1], plain[1], plain[3], plain[3]]);
    let turn = json!({ "offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2 });
    assert_near(
        quarters(square(), moved(turn), std::slice::from_ref(&image)),
        [plain[2], plain[0], plain[3], plain[1]],
    );
}

#[test]
fn an_unlit_pixel_is_texel_times_factor_times_vertex_colour_in_the_dark() {
    let image = picture(2, &[[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]]);
    let unlit = json!({
        "extensions": { "KHR_materials_unlit": {} },
        "pbrMetallicRoughness": {
            "baseColorTexture": { "index": 0 }, "baseColorFactor": [1.0, 0.5, 0.25, 1.0],
        },
    });
    let coloured = Quad { colors: Some([[0.5, 0.25, 1.0, 1.0]; 4]), ..square() };
    let expected = [[0.5, 0.0, 0.0], [0.0, 0.125, 0.0], [0.0, 0.0, 0.25], [0.5, 0.125, 0.25]];
    assert_near(quarters_in("", coloured, unlit, &[image]), expected);
}

#[test]
fn a_camera_ray_sees_the_mean_of_what_its_pixel_covers() {
    let checker = (0..64 * 64).map(|i| if (i + i / 64) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] });
    let image = picture(64, &checker.collect::<Vec<_>>());
    let textured = material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    let light = "[environment]\ncolor = [1, 1, 1]\n[render]\nspp = 1\n";
    for pixel in quarters_in(light, square(), textured, &[image]).as_flattened() {
        assert!((pixel - 0.5).abs() < 1e-4, "{pixel}");
    }
}

#[test]
fn a_normal_map_bends_normals_along_the_texture_coordinates() {
    // x 0.6, y 1/255, z about 0.8.
    let texel = [204, 128, 230, 255];
    let normal = texel.map(|value: u8| f64::from(value) / 127.5 - 1.0);
    let normal = DVec3::new(normal[0], normal[1], normal[2]).normalize();
    let bumpy = |more: Value| {
        let mut bumpy = material(json!({ "normalTexture": { "index": 0 } }));
        bumpy["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, 1]);
        bumpy["normalTexture"].as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        bumpy
    };
    let travel = DVec3::new(-1.0, -0.5, -1.0).normalize();
    let light = format!(
        "[[entity]]\nlight = {{ kind = \"distant\", direction = {:?}, irradiance = 3 }}\n",
        travel.to_array()
    );
    let seen =
        |quad: Quad, material: Value| quarters_in(&light, quad, material, &[picture(1, &[texel])])[0][0];
    let lit = |normal: DVec3| (3.0 * normal.dot(-travel) / std::f64::consts::PI) as f32;
    let mirrored = || Quad { uvs: [[1.0, 1.0], [0.0, 1.0], [1.0, 0.0], [0.0, 0.0]], ..square() };
    let turned = || Quad { uvs: [[1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]], ..square() };
    let flatter = DVec3::new(0.5 * normal.x, 0.5 * normal.y, normal.z).normalize();
    let cases = [
        (square(), json!({}), normal),
        (square(), json!({ "scale": 0.5 }), flatter),
        (mirrored(), json!({}), DVec3::new(-normal.x, normal.y, normal.z)),
        // U goes down, and V, which is mirrored, to the left: what is up in the picture is to the right.
        (turned(), json!({}), DVec3::new(normal.y, -normal.x, normal.z)),
    ];
    for (quad, more, expected) in cases {
        let found = seen(quad, bumpy(more));
        assert!((found - lit(expected)).abs() < 1e-5, "{found} for {}", lit(expected));
    }
}

#[test]
fn a_white_surface_with_a_normal_map_reflects_all_light() {
    let image =
        picture(2, &[[230, 128, 150, 255], [128, 10, 140, 255], [20, 40, 160, 255], [128, 128, 255, 255]]);
    let mut bumpy = material(json!({ "normalTexture": { "index": 0 } }));
    bumpy["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, 1]);
    for light_sampling in ["off", "geodesic"] {
        let light =
            format!("[environment]\ncolor = [1, 1, 1]\n[render]\nlight_sampling = \"{light_sampling}\"\n");
        assert_near(
            quarters_in(&light, square(), bumpy.clone(), std::slice::from_ref(&image)),
            [[1.0; 3]; 4],
        );
    }
}

#[test]
fn a_coat_has_the_normals_of_its_own_texture_and_none_of_the_base() {
    let leaning = [242, 128, 183, 255];
    let image = || picture(1, &[leaning]);
    // What a smooth coat over black reflects of a white sky, looked at straight from above, goes by its normal.
    let seen = |coat_normal: Option<Value>, base_normal: bool| {
        let mut coated =
            material(json!({ "extensions": { "KHR_materials_clearcoat": { "clearcoatFactor": 1 } } }));
        coated["pbrMetallicRoughness"]["baseColorFactor"] = json!([0, 0, 0, 1]);
        if let Some(map) = coat_normal {
            coated["extensions"]["KHR_materials_clearcoat"]["clearcoatNormalTexture"] = map;
        }
        if base_normal {
            coated["normalTexture"] = json!({ "index": 0 });
        }
        let text = "[camera]\nposition = [0, 0, 1]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\n\
                    projection = \"orthographic\"\nheight = 1\n[environment]\ncolor = [1, 1, 1]\n"
            .to_owned()
            + &film(2, 2)
            + "[render]\nspp = 1024\n";
        let scene = scene(&text, &[square()], &json!([coated]), &[image()]);
        render(&scene, &Run::default()).image.channel("G").expect("G")[0]
    };
    let reflectance = |scale: f64| {
        let [x, y, z] = [0, 1, 2].map(|axis| f64::from(leaning[axis]) / 127.5 - 1.0);
        let cos = DVec3::new(scale * x, scale * y, z).normalize().z;
        (0.04 + 0.96 * (1.0 - cos).powi(5)) as f32
    };
    for (coat_normal, base_normal, expected) in [
        (None, false, 0.04),
        (None, true, 0.04),
        (Some(json!({ "index": 0 })), false, reflectance(1.0)),
        (Some(json!({ "index": 0 })), true, reflectance(1.0)),
        (Some(json!({ "index": 0, "scale": 2.0 })), false, reflectance(2.0)),
    ] {
        let found = seen(coat_normal.clone(), base_normal);
        // Coat and base are chosen by chance, one of four samples is the coat's.
        let error = (found / expected - 1.0).abs();
        assert!(error < 0.01, "{coat_normal:?} {base_normal}: {found} is not {expected}");
    }
    assert!(reflectance(1.0) > 0.08, "{}", reflectance(1.0));
}

#[test]
fn only_meshes_whose_materials_look_at_them_have_texture_coordinates() {
    let quads = |material: Value, images: &[RgbaImage]| {
        scene("[environment]\ncolor = [1, 1, 1]\n", &[square()], &json!([material]), images)
    };
    let image = picture(1, &[[255; 4]]);
    let textured = material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    let [with, without] = [quads(textured, &[image]), quads(material(json!({})), &[])];
    // Four coordinates of 8 bytes, a set of them, and two triangles that find them.
    let more = with.geometry.memory_bytes() - without.geometry.memory_bytes();
    assert_eq!(more, 4 * 8 + 2 * 12, "{more}");
}

/// A lamp over a floor, with walls: the right half of the lamp is dark, its left one coloured.
fn lamp(text: &str) -> Baked {
    let quads = [
        Quad::new(DVec3::new(-3.0, 0.0, 3.0), 6.0 * DVec3::X, -6.0 * DVec3::Z, 0),
        Quad::new(DVec3::new(-3.0, 0.0, -3.0), 6.0 * DVec3::X, 4.0 * DVec3::Y, 0),
        Quad::new(DVec3::new(-1.5, 3.0, -1.0), 3.0 * DVec3::X, 2.0 * DVec3::Z, 1),
    ];
    let row = [[255, 128, 64, 255], [90, 255, 255, 255], [0, 0, 0, 255], [0, 0, 0, 255]];
    let image = picture(4, [row, row].concat().as_slice());
    let emits = material(json!({
        "emissiveFactor": [1, 1, 1], "emissiveTexture": { "index": 0 },
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 } },
        "pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, 1] },
    }));
    let text = camera(DVec3::new(0.0, 2.0, 8.0), DVec3::new(0.0, 1.5, 0.0), 50.0) + &film(24, 24) + text;
    scene(&text, &quads, &json!([material(json!({})), emits]), &[image])
}

#[test]
fn a_textured_lamp_lights_the_same_with_and_without_light_sampling() {
    for (what, spacetime) in spacetimes(DVec3::new(1.0, 1.5, 0.5), 0.6) {
        let mut scene = lamp(&spacetime);
        let with = noisy_picture(&mut scene, Geodesic, 128, 1);
        let without = noisy_picture(&mut scene, Off, 1024, 2);
        Agreement::of(&with, &without).check(what);
    }
}

#[test]
fn half_transparent_panels_throw_half_a_shadow() {
    // A floor below a panel below a lamp far away, seen from beside the panel: with and without the panel.
    let floor = || Quad::new(DVec3::new(-1.0, 0.0, 1.0), 2.0 * DVec3::X, -2.0 * DVec3::Z, 0);
    let panel = Quad::new(DVec3::new(-9.0, 2.0, 9.0), 18.0 * DVec3::X, -18.0 * DVec3::Z, 1);
    let black = |alpha: f64, mode: &str| {
        material(json!({
            "alphaMode": mode, "doubleSided": true,
            "pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, alpha] },
        }))
    };
    let text = camera(DVec3::new(0.0, 1.0, 2.0), DVec3::ZERO, 20.0)
        + &film(16, 16)
        + "[render]\nmax_depth = 2\nspp = 64\n[[entity]]\nlight = { kind = \"distant\", direction = [0, -1, 0], irradiance = 3 }\n";
    let mean = |quads: &[Quad], panel: Value| {
        let scene = scene(&text, quads, &json!([material(json!({})), panel]), &[]);
        let image = render(&scene, &Run::default()).image;
        let red = image.channel("R").expect("R");
        red.iter().map(|value| f64::from(*value)).sum::<f64>() / red.len() as f64
    };
    let lit = mean(&[floor()], black(1.0, "OPAQUE"));
    let quads = [floor(), panel];
    let shares = [
        (black(0.25, "BLEND"), 0.75),
        (black(0.5, "BLEND"), 0.5),
        (black(0.4, "MASK"), 1.0),
        (black(0.6, "MASK"), 0.0),
        (black(0.1, "OPAQUE"), 0.0),
    ];
    for (panel, share) in shares {
        let found = mean(&quads, panel.clone()) / lit;
        // 16384 samples: a deviation of 0.4 %.
        assert!(
            (found - share).abs() < 0.02 && (share * (1.0 - share) > 0.0 || found == share),
            "{panel}: {found}"
        );
    }
}

/// A room whose lamp, floor and screen before both are textured, and the screen has holes.
fn screened(text: &str) -> Baked {
    let quads = [
        Quad::new(DVec3::new(-3.0, 0.0, 3.0), 6.0 * DVec3::X, -6.0 * DVec3::Z, 0),
        Quad::new(DVec3::new(-3.0, 3.0, -2.0), 6.0 * DVec3::X, 4.0 * DVec3::Z, 1),
        Quad::new(DVec3::new(-2.0, 0.5, 2.0), 4.0 * DVec3::X, 2.0 * DVec3::Y, 2),
    ];
    let image = picture(2, &[[255, 128, 64, 255], [90, 255, 255, 0], [10, 20, 250, 128], [200, 30, 60, 255]]);
    let map = json!({ "index": 0 });
    let materials = json!([
        material(json!({ "pbrMetallicRoughness": { "baseColorTexture": map }, "normalTexture": map })),
        material(json!({ "emissiveFactor": [1, 1, 1], "emissiveTexture": map })),
        material(json!({ "alphaMode": "BLEND", "pbrMetallicRoughness": { "baseColorTexture": map } })),
    ]);
    let text = camera(DVec3::new(0.0, 2.0, 8.0), DVec3::new(0.0, 1.5, 0.0), 50.0) + &film(24, 24) + text;
    scene(&text, &quads, &materials, &[image])
}

#[test]
fn a_textured_scene_is_the_same_by_either_schedule_bit_for_bit() {
    let around = hole(DVec3::new(1.0, 1.5, 0.5), 0.6);
    for spacetime in ["", &around] {
        let mut scene = screened(spacetime);
        scene.settings.spp = 16;
        let mut image = |schedule: Schedule| -> Image {
            scene.settings.schedule = schedule;
            render(&scene, &Run::default()).image
        };
        let [one, other] = [Schedule::Wavefront, Schedule::PerPixel].map(&mut image);
        for (a, b) in one.channels.iter().zip(&other.channels) {
            let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&a.values), bits(&b.values), "{} {spacetime:?}", a.name);
        }
    }
}

#[test]
fn a_screen_with_holes_looks_the_same_with_and_without_light_sampling() {
    for (what, spacetime) in spacetimes(DVec3::new(1.0, 1.5, 0.5), 0.6) {
        let mut scene = screened(&spacetime);
        let with = noisy_picture(&mut scene, Geodesic, 128, 1);
        let without = noisy_picture(&mut scene, Off, 1024, 2);
        Agreement::of(&with, &without).check(what);
    }
}
