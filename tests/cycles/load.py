"""Large files by Blender's Cycles and by Warpfront: CPU seconds and memory of one sample per pixel, 512 × 384, one thread.

    pip install bpy numpy      (bpy 5.0 needs Python 3.11)
    cargo build --release
    python tests/cycles/load.py [FILE.glb ...] [--folder FOLDER]

Without files two are made: textures.glb, four pictures of 4096² (JPEG) on 80 000 triangles that emit them, and
triangles.glb, a surface of 10⁷ triangles under a point light. Printed are user CPU seconds, the least of three, and
peak memory of each process; the seconds of bpy without what it takes to start.
"""

import argparse
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLENDER = [sys.executable, ROOT / "tests/cycles/large_files.py"]


def run(command):
    """CPU seconds, MiB and standard output of a command."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    text = process.stdout.read()
    _, status, used = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"{command} failed")
    return used.ru_utime, used.ru_maxrss // 1024, text


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    parser.add_argument("--folder", type=pathlib.Path, default=ROOT / "target" / "load")
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    if not args.files:
        run([*BLENDER, "make", args.folder])
    for file in args.files or [args.folder / "textures.glb", args.folder / "triangles.glb"]:
        by_cycles = [*BLENDER, "render", file.resolve(), args.folder / "cycles"]
        ours = [ROOT / "target/release/warpfront", "render", file, "-o", args.folder / "ours.exr", "--threads", "1",
                "--size", "512x384", "--spp", "1"]
        seconds, memory, text = min(run(by_cycles) for _ in range(3))
        started = next(float(line.split()[1]) for line in text.splitlines() if line.startswith("started"))
        our_seconds, our_memory, _ = min(run(ours) for _ in range(3))
        print(f"{file.name}: Cycles {seconds - started:.2f} s, {memory} MiB; "
              f"Warpfront {our_seconds:.2f} s, {our_memory} MiB")


if __name__ == "__main__":
    main()
