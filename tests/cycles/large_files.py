"""Large files that Blender makes, and renders by Cycles: what load.py measures.

    python tests/cycles/large_files.py make FOLDER
    python tests/cycles/large_files.py render FILE.glb PICTURE
"""

import json
import math
import pathlib
import resource
import struct
import sys

import bpy
import numpy as np

WIDTH, HEIGHT = 512, 384
PIXELS = 4096
CAMERA = {"type": "perspective", "perspective": {"yfov": 0.7, "aspectRatio": WIDTH / HEIGHT, "znear": 0.01}}


def turned(axis, degrees):
    """The rotation of a glTF node."""
    half = math.radians(degrees) / 2
    return [*(math.sin(half) * np.array(axis)), math.cos(half)]


def write(path, document, blobs):
    binary, views = b"", []
    for blob in blobs:
        binary += b"\0" * (-len(binary) % 4)
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(blob)})
        binary += blob
    binary += b"\0" * (-len(binary) % 4)
    nodes = document["nodes"]
    document |= {"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(binary)}], "bufferViews": views,
                 "cameras": [CAMERA], "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text)
        out.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def grid(squares):
    """A bumpy square of `squares` × `squares` × 2 triangles: accessors, and their views."""
    v, u = np.mgrid[0:1:(squares + 1) * 1j, 0:1:(squares + 1) * 1j]
    bumps = 0.02 * np.sin(40 * u) * np.sin(40 * v)
    positions = np.stack([2 * u - 1, 1 - 2 * v, bumps], -1).reshape(-1, 3).astype("<f4")
    corners = np.stack([u, v], -1).reshape(-1, 2).astype("<f4")
    first = (np.arange(squares)[:, None] * (squares + 1) + np.arange(squares)).ravel()
    below, beside = first + squares + 1, first + 1
    triangles = np.stack([first, below, beside, beside, below, below + 1], -1).reshape(-1).astype("<u4")
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3",
         "min": positions.min(0).tolist(), "max": positions.max(0).tolist()},
        {"bufferView": 1, "componentType": 5126, "count": len(corners), "type": "VEC2"},
        {"bufferView": 2, "componentType": 5125, "count": len(triangles), "type": "SCALAR"}]
    return accessors, [positions.tobytes(), corners.tobytes(), triangles.tobytes()]


def picture(seed, folder):
    """A JPEG picture with waves of all sizes and some noise."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0:1:PIXELS * 1j, 0:1:PIXELS * 1j].astype(np.float32)
    pixels = np.ones((PIXELS, PIXELS, 4), np.float32)
    for channel in range(3):
        pixels[..., channel] = 0.3
        for octave in range(8):
            across, down = rng.uniform(6, 9 * 2**octave, 2)
            pixels[..., channel] += 0.6 / (octave + 2) * np.sin(across * x + down * y + rng.uniform(0, 6))
    pixels[..., :3] += rng.normal(0, 0.03, (PIXELS, PIXELS, 1))
    image = bpy.data.images.new(f"picture {seed}", PIXELS, PIXELS)
    image.pixels.foreach_set(np.clip(pixels, 0, 1).ravel())
    path = folder / f"picture_{seed}.jpg"
    bpy.context.scene.render.image_settings.quality = 90
    image.filepath_raw, image.file_format = str(path), "JPEG"
    image.save()
    return path.read_bytes()


def make_textures(folder):
    accessors, views = grid(100)
    attributes = {"POSITION": 0, "TEXCOORD_0": 1}
    materials = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}, "metallicFactor": 0, "roughnessFactor": 0.8},
                  "emissiveTexture": {"index": i}, "emissiveFactor": [1, 1, 1]} for i in range(4)]
    floor = {"pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.7, 0.7, 1], "metallicFactor": 0, "roughnessFactor": 0.9}}
    meshes = [{"primitives": [{"attributes": attributes, "indices": 2, "material": i}]} for i in range(5)]
    panel = lambda i: {"mesh": i, "translation": [2.1 * (i - 1.5), 1.1, -2 - 0.4 * (i % 2)],
                       "rotation": turned((0, 1, 0), 10 * (1.5 - i))}
    nodes = [panel(i) for i in range(4)] + [
        {"mesh": 4, "scale": [9, 9, 9], "rotation": turned((1, 0, 0), -90)},
        {"camera": 0, "translation": [0, 2, 9], "rotation": turned((1, 0, 0), -7)}]
    images = [{"bufferView": 3 + i, "mimeType": "image/jpeg"} for i in range(4)]
    write(folder / "textures.glb", {
        "accessors": accessors, "meshes": meshes, "materials": materials + [floor], "nodes": nodes, "images": images,
        "textures": [{"source": i} for i in range(4)]}, views + [picture(i, folder) for i in range(4)])


def make_triangles(folder):
    accessors, views = grid(2237)
    light = {"type": "point", "color": [1, 1, 1], "intensity": 5000}
    material = {"pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.6, 0.5, 1], "metallicFactor": 0, "roughnessFactor": 0.9}}
    write(folder / "triangles.glb", {
        "accessors": accessors, "materials": [material],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 2, "material": 0}]}],
        "extensionsUsed": ["KHR_lights_punctual"], "extensions": {"KHR_lights_punctual": {"lights": [light]}},
        "nodes": [{"mesh": 0, "scale": [4, 4, 4], "rotation": turned((1, 0, 0), -90)},
                  {"camera": 0, "translation": [0, 2, 7], "rotation": turned((1, 0, 0), -16)},
                  {"translation": [1, 3, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}}]}, views)


def render(path, out):
    """Renders a file with one sample per pixel on one thread, and prints what it took to start, CPU seconds."""
    started = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for addon in ("io_scene_gltf2", "cycles"):
        bpy.ops.preferences.addon_enable(module=addon)
    bpy.ops.import_scene.gltf(filepath=path)
    scene = bpy.context.scene
    scene.camera = next(thing for thing in bpy.data.objects if thing.type == "CAMERA")
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", 1
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format, scene.render.filepath = "OPEN_EXR", out
    bpy.ops.render.render(write_still=True)
    print(f"\nstarted {started}")


if sys.argv[1] == "make":
    make_textures(pathlib.Path(sys.argv[2]))
    make_triangles(pathlib.Path(sys.argv[2]))
else:
    render(*sys.argv[2:])
