//! Alpha: what a picture leaves to be seen of what a compositor puts behind it.

use crate::support::{render, scene};
use glam::Vec3;
use warpfront::scene::{Background, Baked, Schedule};
use warpfront::shade::Environment;
use warpfront::trace::{Rendered, Run};

/// A hole between balls, before an even sky of radiance 1.
const SCENE: &str = "
[spacetime]
kind = \"schwarzschild\"
schwarzschild_radius = 1
[camera]
position = [0, 0, 12]
look_at = [0, 0, 0]
vertical_fov = 50
[film]
width = 25
height = 17
[render]
spp = 8
[environment]
color = 1
[[material]]
name = \"mirror\"
kind = \"mirror\"
[[material]]
name = \"glass\"
kind = \"dielectric\"
[[material]]
name = \"lamp\"
emission = 3
[[entity]]
sphere = { center = [-3.5, 0, 0], radius = 1.4 }
material = \"mirror\"
[[entity]]
sphere = { center = [3.5, 0, 0], radius = 1.4 }
material = \"glass\"
[[entity]]
sphere = { center = [0, 3.5, 0], radius = 1 }
[[entity]]
sphere = { center = [0, -3.5, 0], radius = 0.5 }
material = \"lamp\"
";

fn rendered(background: Background, change: impl FnOnce(&mut Baked)) -> Rendered {
    let mut scene = scene(SCENE);
    scene.settings.background = background;
    change(&mut scene);
    render(&scene, &Run::default())
}

fn plane<'a>(rendered: &'a Rendered, name: &str) -> &'a [f32] {
    rendered.image.channel(name).unwrap()
}

/// Channels of a pixel.
fn pixel(rendered: &Rendered, x: usize, y: usize) -> [f32; 4] {
    ["R", "G", "B", "A"].map(|name| plane(rendered, name)[y * 25 + x])
}

#[test]
fn a_transparent_picture_over_its_environment_is_the_opaque_one() {
    let flat = |scene: &mut Baked| scene.spacetime = warpfront::spacetime::SpacetimeKind::Flat;
    let per_pixel = |scene: &mut Baked| scene.settings.schedule = Schedule::PerPixel;
    for change in [&(|_: &mut Baked| ()) as &dyn Fn(&mut Baked), &flat, &per_pixel] {
        let opaque = rendered(Background::Opaque, change);
        let transparent = rendered(Background::Transparent, change);
        assert!(plane(&opaque, "A").iter().all(|&alpha| alpha == 1.0));
        let alpha = plane(&transparent, "A");
        assert!(alpha.contains(&0.0) && alpha.contains(&1.0));
        for name in ["R", "G", "B"] {
            for ((&over, &color), &alpha) in
                plane(&opaque, name).iter().zip(plane(&transparent, name)).zip(alpha)
            {
                assert!((over - (color + 1.0 - alpha)).abs() < 1e-5 * (1.0 + over), "{over} {color} {alpha}");
            }
        }
    }
}

/// Rays are followed to infinity only if their directions there matter.
#[test]
fn an_even_sky_looks_the_same_whether_directions_at_infinity_are_known_or_not() {
    let hole = "kind = \"schwarzschild\"\nschwarzschild_radius = 1";
    let two = "kind = \"several-holes\"\n[[spacetime.hole]]\ncenter = [1, 0, 0]\nmass = 0.3\n\
               [[spacetime.hole]]\ncenter = [-1, 0, 0]\nmass = 0.3";
    let kerr = "kind = \"kerr\"\nschwarzschild_radius = 1\nspin = 0.9";
    for spacetime in [hole, kerr, "kind = \"ellis-wormhole\"\nthroat_radius = 1", two] {
        let text = SCENE.replace(hole, spacetime);
        for schedule in [Schedule::Wavefront, Schedule::PerPixel] {
            let reds = |environment: Environment| {
                let mut scene = scene(&text);
                (scene.environment, scene.settings.schedule) = (environment, schedule);
                plane(&render(&scene, &Run::default()), "R").to_vec()
            };
            let white = Vec3::ONE;
            let even = reds(Environment::Constant(white));
            let known = reds(Environment::Gradient { ground: white, horizon: white, zenith: white });
            let far = even.iter().zip(&known).filter(|(a, b)| (*a - *b).abs() > 1e-5 * *b);
            assert_eq!(far.count(), 0, "{spacetime}");
            assert!(even.contains(&1.0), "{spacetime}");
        }
    }
}

#[test]
fn without_an_environment_both_backgrounds_leave_out_what_is_behind() {
    let dark = |scene: &mut Baked| scene.environment = Environment::Black;
    let [opaque, transparent] =
        [Background::Opaque, Background::Transparent].map(|background| rendered(background, dark));
    assert_eq!(opaque.image.channels, transparent.image.channels);
    let lit = rendered(Background::Transparent, |_| ());
    assert_eq!(plane(&opaque, "A"), plane(&lit, "A"));
}

#[test]
fn the_hole_hides_what_is_behind_and_mirrors_and_glass_show_the_sky() {
    let picture = rendered(Background::Transparent, |_| ());
    assert_eq!(pixel(&picture, 12, 8), [0.0, 0.0, 0.0, 1.0], "the shadow");
    assert_eq!(pixel(&picture, 0, 0), [0.0; 4], "the sky");
    for (x, what) in [(4, "the mirror"), (20, "the glass")] {
        let [red, _, _, alpha] = pixel(&picture, x, 8);
        assert!(red > 0.5 && alpha > 0.9, "{what}: {red} {alpha}");
    }
}
