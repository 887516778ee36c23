# SPDX-License-Identifier: GPL-3.0-or-later
"""How `etalon` handles damaged files and odd settings.

It gives a verdict, or one line and exit code 2.

    python tests/benchmarks/fuzzed.py [--files 200] [--first 0]

A third of the files has bytes changed, a third is cut or has parts zeroed, moved or swapped, and a third has
rendering properties at random values that Blender allows. Each is read by `etalon plan`, and compared for two seconds
where that passes. A file fails if a command ends with another code than its own, prints a traceback, says nothing, or
takes longer than PATIENCE.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
from etalon.addon.host.quiet import quiet
from etalon.reference_scenes import build

SCENES = ("glossy_spheres", "cornell_glossy", "veach_plates", "lambert_analytic")
PATIENCE = 90.0
COMPARE = ("--time", "2", "--set", "scene.render.resolution_percentage=20", "--quiet")


def change_bytes(data: bytes, rng: np.random.Generator) -> bytes:
    """Some to many bytes, replaced; the header is spared in half of the files."""
    found = np.frombuffer(data, np.uint8).copy()
    start = 0 if rng.random() < 0.5 else 64
    places = rng.integers(start, found.size, int(10 ** rng.uniform(0, 4)))
    found[places] = rng.integers(0, 256, places.size)
    return found.tobytes()


def break_up(data: bytes, rng: np.random.Generator) -> bytes:
    """A file with a fault.

    It was cut, or a stretch of it is zero, comes twice, or has changed places with another.
    """
    a, b = sorted(rng.integers(0, len(data), 2).tolist())
    size = min(b - a, int(10 ** rng.uniform(1, 5)))
    kind = rng.integers(4)
    if kind == 0:
        return data[:b]
    if kind == 1:
        return data[:a] + bytes(size) + data[a + size :]
    if kind == 2:
        return data[:b] + data[a : a + size] + data[b:]
    return data[:a] + data[b : b + size] + data[a + size : b] + data[a : a + size] + data[b + size :]


def _structs() -> list[bpy.types.bpy_struct]:
    """What the export reads, and all nodes with their sockets."""
    scene = bpy.context.scene
    found: list[bpy.types.bpy_struct] = [
        scene,
        scene.render,
        scene.cycles,
        scene.view_layers[0],
        scene.camera.data,
        scene.world,
    ]
    for thing in scene.objects:
        found += [thing, thing.cycles, *filter(None, [thing.data])]
    for owner in (*bpy.data.materials, *bpy.data.worlds, *bpy.data.lights):
        found.append(owner)
        if owner.node_tree is not None:
            for node in owner.node_tree.nodes:
                found += [node, *node.inputs]
    return found


def _set_at_random(struct: bpy.types.bpy_struct, rng: np.random.Generator) -> str:
    """Set one property of a struct to a random value that it allows.

    Returns what was set, "" where nothing can be.
    """
    settable = [
        p for p in struct.bl_rna.properties if not p.is_readonly and p.type in ("BOOLEAN", "INT", "FLOAT", "ENUM")
    ]
    if not settable:
        return ""
    chosen = settable[rng.integers(len(settable))]
    if chosen.type == "ENUM":
        values = [item.identifier for item in chosen.enum_items] or [""]
        value = set(values[:1]) if chosen.is_enum_flag else values[rng.integers(len(values))]
    elif chosen.type == "BOOLEAN":
        value = [bool(v) for v in rng.integers(0, 2, max(chosen.array_length, 1))]
    else:
        soft = rng.random() < 0.5
        low, high = (chosen.soft_min, chosen.soft_max) if soft else (chosen.hard_min, chosen.hard_max)
        low, high = max(low, -1e12), min(high, 1e12)
        value = [rng.choice([low, high, 0.0, rng.uniform(-2, 2)]) for _ in range(max(chosen.array_length, 1))]
        value = [int(v) if chosen.type == "INT" else float(v) for v in value]
    if isinstance(value, list) and not chosen.is_array:
        value = value[0]
    try:
        setattr(struct, chosen.identifier, value)
    except (TypeError, ValueError, AttributeError, OverflowError, RuntimeError):
        return ""  # Blender does not allow it here
    return f"{struct.bl_rna.identifier}.{chosen.identifier}={value}"


def odd_file(path: Path, rng: np.random.Generator) -> str:
    """Save a reference scene with one to thirty properties at random values; returns which."""
    with quiet():
        build(str(rng.choice(SCENES)))
        structs = _structs()
        done = [_set_at_random(structs[rng.integers(len(structs))], rng) for _ in range(int(10 ** rng.uniform(0, 1.5)))]
        bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    return ", ".join(filter(None, done))


def damaged_file(path: Path, rng: np.random.Generator, damage: Callable[[bytes, np.random.Generator], bytes]) -> str:
    """Save a reference scene and damage the file."""
    with quiet():
        build(str(rng.choice(SCENES)))
        bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    path.write_bytes(damage(path.read_bytes(), rng))
    return damage.__name__


def judge(words: list[str], allowed: set[int]) -> tuple[int | None, str]:
    """The exit code of a command (None where it hangs), and what is wrong with its end.

    The latter is "" for nothing.
    """
    try:
        done = subprocess.run(
            [sys.executable, "-m", "etalon", *words], capture_output=True, text=True, timeout=PATIENCE, errors="replace"
        )
    except subprocess.TimeoutExpired:
        return None, f"hangs: {words[0]}"
    said = [line for line in done.stderr.splitlines() if line.startswith("etalon")]
    if "Traceback" in done.stderr + done.stdout:
        return done.returncode, f"traceback: {done.stderr.strip().splitlines()[-1]}"
    if done.returncode not in allowed:
        return done.returncode, f"exit code {done.returncode}: {done.stderr.strip()[-200:]}"
    if done.returncode == 2 and not said:
        return done.returncode, "refused without a word"
    if any("error in etalon" in line for line in said):
        return done.returncode, said[-1]
    return done.returncode, ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--files", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    arguments = parser.parse_args()
    codes: Counter[str] = Counter()
    bad = 0
    for number in range(arguments.first, arguments.first + arguments.files):
        rng = np.random.default_rng([15, number])
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "fuzzed.blend"
            kind = number % 3
            what = odd_file(path, rng) if kind == 2 else damaged_file(path, rng, (change_bytes, break_up)[kind])
            code, wrong = judge(["plan", str(path)], {0, 2})
            codes[f"plan {code}"] += 1
            if code == 0 and not wrong:
                code, wrong = judge(
                    ["compare", str(path), *COMPARE, "--out", str(Path(folder) / "out")], {0, 1, 2, 3, 4}
                )
                codes[f"compare {code}"] += 1
        if wrong:
            bad += 1
            print(f"{number}: {what}: {wrong}", flush=True)
    print(f"{arguments.files} files, {bad} bad; exit codes: {dict(sorted(codes.items()))}")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
