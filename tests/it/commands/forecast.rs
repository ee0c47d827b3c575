//! The forecast of `info` beside the render itself.

use crate::support::command::{Folder, assert_good};
use warpfront::study::estimate::geometric_median;

/// Scenes and flags that stress one part each: learning, many samples, edges of lamps, one thread, a crop.
const RENDERS: [(&str, &str); 6] = [
    ("cornell_black_hole", "--size 320x240 --spp 4"),
    ("cornell_flat", "--size 160x120 --spp 128"),
    ("accretion_disk", "--size 160x120 --spp 16"),
    ("room_black_hole", "--size 160x120 --spp 16 --threads 1"),
    ("teapot_black_hole", "--size 640x480 --spp 32 --crop 200,100,300,200"),
    ("cornell_small_light", "--size 160x120 --spp 8 --light-sampling off"),
];

#[test]
#[ignore = "measures times, which other work on the machine disturbs"]
fn the_time_of_a_render_is_estimated_within_30_percent() {
    let folder = Folder::with(&[]);
    let json = |text: &[u8]| serde_json::from_slice::<serde_json::Value>(text).unwrap();
    for (name, flags) in RENDERS {
        let scene = format!("{}/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let flags: Vec<&str> = flags.split(' ').collect();
        let measure = || {
            let info = folder.run(&[&["info", &scene, "--json"][..], &flags].concat());
            assert_good(&info);
            let base = ["render", &scene, "-o", "out.exr", "--no-png", "--stats", "stats.json"];
            assert_good(&folder.run(&[&base[..], &flags].concat()));
            let stats = json(&std::fs::read(folder.path("stats.json")).unwrap());
            let estimated = json(&info.stdout)["cost"]["seconds"]["value"].as_f64().unwrap();
            estimated / stats["stats"]["seconds"].as_f64().unwrap()
        };
        let ratio = geometric_median((0..5).map(|_| measure()).collect()).unwrap();
        println!("{name} {flags:?}: {ratio:.3}");
        assert!((0.7..1.3).contains(&ratio), "{name} {flags:?}: {ratio}");
    }
}
