"""Grids of materials by Blender's Cycles and by Warpfront, and how far the pictures are apart.

    pip install bpy numpy OpenEXR      (bpy 5.0 needs Python 3.11)
    cargo build --release
    python tests/cycles/grids.py [NAME ...] [--spp N] [--folder FOLDER]

A grid is 6 × 6 balls before a striped wall under a sky: one quantity grows to the right, another downwards. Blender
makes it, renders it and exports it as glTF; Warpfront renders that. Printed are Khronos' figure of the glTF render
fidelity tests (10 log10 of the root mean square of the YIQ distance, relative to the largest one), and the relative
difference of every ball, per cent.
"""

import argparse
import math
import pathlib
import subprocess

import bpy
import numpy as np
import OpenEXR

BALLS = 6
SIZE = 240
ROOT = pathlib.Path(__file__).resolve().parents[2]

# Inputs of Blender's Principled BSDF, by two quantities from 0 to 1.
GRIDS = {
    "metal": lambda x, y: {"Base Color": (0.9, 0.55, 0.25), "Metallic": y, "Roughness": x},
    "ior": lambda x, y: {"Base Color": (0.2, 0.4, 0.7), "Roughness": x, "IOR": 1.1 + 1.3 * y},
    "coat": lambda x, y: {
        "Base Color": (0.7, 0.1, 0.1), "Roughness": 0.6, "Coat Weight": y, "Coat Roughness": x},
    "sheen": lambda x, y: {
        "Base Color": (0.3, 0.1, 0.4), "Roughness": 0.8, "Sheen Weight": y, "Sheen Roughness": max(x, 0.1)},
    "alpha": lambda x, y: {"Base Color": (0.8, 0.3 * x, 0.2), "Roughness": 0.7, "Alpha": y},
}


def material(name, inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    sockets = made.node_tree.nodes["Principled BSDF"].inputs
    for key, value in inputs.items():
        sockets[key].default_value = (*value, 1) if key == "Base Color" else value
    return made


def sky():
    """A sky that is brighter on one side, as an environment picture: rows from straight up, columns to the right."""
    polar, azimuth = np.mgrid[0.5:64, 0.5:128] * np.array([math.pi / 64, 2 * math.pi / 128])[:, None, None]
    y, x, z = np.cos(polar), -np.sin(polar) * np.sin(azimuth), np.sin(polar) * np.cos(azimuth)
    lamp = np.exp(12 * (0.5 * x + 0.7 * y + 0.5 * z - 1))
    return np.stack([0.4 + 0.3 * y + 4 * lamp, 0.45 + 0.3 * y + 3.5 * lamp, 0.6 + 0.3 * y + 3 * lamp], -1).astype(np.float32)


def build(name, folder):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    for row in range(BALLS):
        for column in range(BALLS):
            place = (column - (BALLS - 1) / 2, 0, (BALLS - 1) / 2 - row)
            bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.45, location=place)
            bpy.ops.object.shade_smooth()
            inputs = GRIDS[name](column / (BALLS - 1), row / (BALLS - 1))
            bpy.context.object.data.materials.append(material(f"{row} {column}", inputs))
    bpy.ops.mesh.primitive_plane_add(size=20, location=(0, 3, 0), rotation=(math.pi / 2, 0, 0))
    bpy.context.object.data.materials.append(material("wall", {"Base Color": (0.5, 0.5, 0.5), "Roughness": 1.0}))
    stripes = material("stripes", {"Base Color": (0.1, 0.5, 0.2), "Roughness": 1.0})
    for stripe in range(-4, 5):
        bpy.ops.mesh.primitive_cube_add(size=1, location=(1.3 * stripe, 2.9, 0), scale=(0.35, 0.1, 9))
        bpy.context.object.data.materials.append(stripes)
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0, -12, 0), (math.pi / 2, 0, 0)
    camera.data.sensor_fit, camera.data.angle = "VERTICAL", 2 * math.atan(3.4 / 12)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    background = next(node for node in nodes if node.type == "BACKGROUND")
    image = nodes.new("ShaderNodeTexEnvironment")
    image.image = bpy.data.images.load(str(folder / "sky.exr"))
    # Blender's pictures of the sky have their middle at +X, ours at Blender's +Y.
    turn, place = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
    turn.inputs["Rotation"].default_value = (0, 0, -math.pi / 2)
    links.new(place.outputs["Generated"], turn.inputs["Vector"])
    links.new(turn.outputs["Vector"], image.inputs["Vector"])
    links.new(image.outputs["Color"], background.inputs["Color"])
    return scene


def render_in_cycles(scene, spp, path):
    scene.render.engine = "CYCLES"
    cycles, render = scene.cycles, scene.render
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = spp, False, False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 8
    cycles.transparent_max_bounces, cycles.blur_glossy = 32, 0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.pixel_filter_type = "BOX"
    scene.view_settings.view_transform = "Raw"
    render.resolution_x = render.resolution_y = SIZE
    render.resolution_percentage = 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def pixels(path):
    channels = OpenEXR.File(str(path)).channels()
    return np.asarray(next(iter(channels.values())).pixels, float)[..., :3]


def decibels(a, b):
    def shown(colour):
        colour = np.clip(colour, 0, 1)
        return np.round(255 * np.where(colour <= 0.0031308, 12.92 * colour, 1.055 * colour ** (1 / 2.4) - 0.055))

    to_yiq = np.array([[0.29889531, 0.58662247, 0.11448223],
                       [0.59597799, -0.27417610, -0.32180189],
                       [0.21147017, -0.52261711, 0.31114694]])
    distance = ((shown(a) - shown(b)) @ to_yiq.T) ** 2 @ np.array([0.5053, 0.299, 0.1957])
    return 10 * math.log10(math.sqrt(np.mean(distance**2)) / 35215)


def compare(name, spp, folder):
    scene = build(name, folder)
    bpy.ops.export_scene.gltf(filepath=str(folder / f"{name}.glb"), export_format="GLB", export_cameras=True)
    render_in_cycles(scene, spp, folder / f"{name}_cycles.exr")
    (folder / f"{name}.toml").write_text(
        f'[film]\nwidth = {SIZE}\nheight = {SIZE}\nfilter = "box"\n[render]\nmax_depth = 10\n'
        f'[environment]\nimage = "sky.exr"\n[[entity]]\ngltf = "{name}.glb"\n')
    ours = folder / f"{name}.exr"
    command = [ROOT / "target/release/warpfront", "render", folder / f"{name}.toml", "-o", ours,
               "--spp", str(spp), "--no-png"]
    subprocess.run(command, check=True)
    theirs, ours = pixels(folder / f"{name}_cycles.exr"), pixels(ours)
    print(f"{name}: {decibels(theirs, ours):.1f} dB")
    cells = lambda picture: picture.reshape(BALLS, SIZE // BALLS, BALLS, SIZE // BALLS, 3).mean((1, 3, 4))
    for row in 100 * (cells(ours) / cells(theirs) - 1):
        print("   ", *(f"{difference:+5.1f}" for difference in row))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=list(GRIDS), metavar="NAME", help=", ".join(GRIDS))
    parser.add_argument("--spp", type=int, default=192)
    parser.add_argument("--folder", type=pathlib.Path, default=ROOT / "target/cycles")
    options = parser.parse_args()
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    OpenEXR.File({}, {"RGB": sky()}).write(str(folder / "sky.exr"))
    for name in options.names:
        compare(name, options.spp, folder)


if __name__ == "__main__":
    main()
