//! Materials of OBJ files: what Blender writes, and what bumps do to light.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use image::{Rgb, RgbImage};
use warpfront::scene::{Baked, load};
use warpfront::shade::{Lobe, TextureId};
use warpfront::trace::Run;

use crate::support::{film, render};

/// A square that faces +Z, from −1 to 1, with its picture upright.
const SQUARE: &str = "mtllib a.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                      usemtl m\nf 1/1 2/2 3/3 4/4\n";

/// The square with a library beside these pictures, seen from above in a distant light.
fn square(mtl: &str, pictures: &[(&str, RgbImage)], travel: DVec3) -> Baked {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.obj", SQUARE);
    write("a.mtl", mtl);
    for (name, picture) in pictures {
        picture.save(folder.path().join(name)).unwrap();
    }
    let text = "[camera]\nposition = [0, 0, 1]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\n\
                projection = \"orthographic\"\nheight = 0.5\n[[entity]]\nmesh = \"a.obj\"\n"
        .to_owned()
        + &film(2, 2)
        + &format!(
            "[[entity]]\nlight = {{ kind = \"distant\", direction = {:?}, irradiance = 3 }}\n",
            travel.to_array()
        );
    write("scene.toml", &text);
    load(&folder.path().join("scene.toml"), &[]).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn normal_maps_and_heights_bend_the_normals_of_a_mesh() {
    let travel = DVec3::new(-1.0, -0.5, -1.0).normalize();
    let lit = |normal: DVec3| 3.0 * normal.normalize().dot(-travel) / PI;
    // To the right by 0.3, and upwards by 0.2.
    let normals = RgbImage::from_pixel(4, 4, Rgb([166, 148, 242]));
    let texel = DVec3::new(166.0, 148.0, 242.0) / 127.5 - 1.0;
    // Uphill by 0.1 a texel to the right and by 0.2 a texel downwards.
    let heights = RgbImage::from_fn(4, 4, |x, y| Rgb([(25.5 * f64::from(x + 2 * y)).round() as u8; 3]));
    let slopes = |strength: f64| DVec3::new(-0.1 * strength, 0.2 * strength, 1.0);
    let pictures = [("n.png", normals), ("h.png", heights)];
    for (bump, expected) in [
        ("", DVec3::Z),
        ("norm n.png", texel),
        ("map_Bump n.png", texel),
        ("bump -bm 0.5 n.png", DVec3::new(0.5 * texel.x, 0.5 * texel.y, texel.z)),
        ("map_bump -clamp on h.png", slopes(1.0)),
        ("map_Bump -bm 3 h.png", slopes(3.0)),
    ] {
        let scene = square(&format!("newmtl m\nKd 1 1 1\n{bump}\n"), &pictures, travel);
        assert_eq!(scene.warnings, Vec::<String>::new());
        // In the middle no neighbour is across an edge.
        let image = render(&scene, &Run::default()).image;
        let red = f64::from(image.channel("R").unwrap()[0]);
        assert!((red - lit(expected)).abs() < 0.01, "{bump}: {red} is not {}", lit(expected));
    }
}

#[test]
fn a_library_of_blenders_means_what_blender_means() {
    let grey = |value: u8| RgbImage::from_pixel(2, 2, Rgb([value; 3]));
    let pictures = [
        ("col.png", grey(255)),
        ("rough.png", grey(51)),
        ("metal.png", grey(102)),
        ("nmap.png", RgbImage::from_pixel(2, 2, Rgb([128, 128, 255]))),
    ];
    let header = "# Blender 5.0.1 MTL File: 'None'\n# www.blender.org\n\n";
    let of = |statements: &str| {
        let scene = square(&format!("{header}newmtl m\n{statements}"), &pictures, DVec3::NEG_Z);
        assert_eq!(scene.warnings, Vec::<String>::new(), "{statements}");
        scene
    };
    let principled = |scene: &Baked| match scene.materials[0].lobe {
        Lobe::Principled(lobe) => lobe,
        other => panic!("{other:?}"),
    };
    let gold = of("Ns 640\nKa 1 1 1\nKd 1 0.8 0.3\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.5\nd 1\nillum 3\n");
    let lobe = principled(&gold);
    assert_eq!((lobe.metallic, lobe.base), (1.0, Vec3::new(1.0, 0.8, 0.3)));
    assert!((lobe.roughness - 0.2).abs() < 1e-6, "{lobe:?}");
    let leaf = of("Ns 250\nKa 1 1 1\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNi 1.5\nd 0.4\nillum 9\n");
    let opacity = leaf.materials[0].opacity.map(|opacity| opacity.factor);
    assert_eq!((principled(&leaf).metallic, principled(&leaf).transmission, opacity), (0.0, 0.0, Some(0.4)));
    let extended = "Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNi 1.5\nd 1\nillum 2\nPr 0.5\nPm 0\nPs 0.3\nPc 4\nPcr 0.1\n\
                    aniso 0.000000\nanisor 0.000000\nTf 1.000000 1.000000 1.000000\n";
    let lobe = principled(&of(extended));
    assert_eq!((lobe.clearcoat, lobe.clearcoat_roughness, lobe.transmission), (1.0, 0.1, 1.0));
    assert_eq!((lobe.sheen_color, lobe.is_thin), (Vec3::splat(0.3), false));
    for maps in ["map_Ns rough.png\nmap_refl metal.png\n", "Pr 0.9\nmap_Pm metal.png\nmap_Pr rough.png\n"] {
        let textured =
            "Ka 1 1 1\nKs 0.5 0.5 0.5\nNi 1.5\nd 1\nillum 2\nmap_Kd col.png\nmap_Bump -bm 0.7 nmap.png\n";
        let scene = of(&format!("{textured}{maps}"));
        let (lobe, read) = (principled(&scene), scene.materials[0].maps);
        let TextureId(id) = read.metallic_roughness.expect("a picture");
        let texel = scene.textures[id as usize].image.texel(0, [0, 0]);
        assert!((lobe.roughness * texel.y - 0.2).abs() < 1e-4, "{texel} {lobe:?}");
        assert!((lobe.metallic * texel.z - 0.4).abs() < 1e-4, "{texel} {lobe:?}");
        assert_eq!((lobe.base, read.normal.map(|map| map.scale)), (Vec3::ONE, Some(0.7)));
        assert!(read.base_color.is_some());
    }
}
