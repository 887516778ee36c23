# SPDX-License-Identifier: GPL-3.0-or-later
"""How the reference's time and memory grow with threads, samples and pixels.

Also how long a command takes to its first tile.

    python tests/benchmarks/scaling.py [SCENE] [--runs 5] [--threads 2]

Settings take turns within a run, so that a machine that speeds up or slows down does so for all; ratios are medians
over the runs.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import bpy
from etalon.addon.command.opening import open_target
from etalon.addon.job import export
from etalon.lib.scene import archive
from etalon.lib.scene.scene import Scene
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process

SAMPLES = (16, 64, 256)
SIZES = (0.5, 1.0, 2.0)
MEMORY = (1, 16, 256)


def in_turns(ways: dict[str, Callable[[int], float]], runs: int) -> dict[str, list[float]]:
    """Seconds of each way in each run; each is run once before, to be set up."""
    for way in ways.values():
        way(runs)
    seconds: dict[str, list[float]] = {key: [] for key in ways}
    for run in range(runs):
        for key, way in ways.items():
            seconds[key].append(way(run))
    return seconds


def ratios(seconds: dict[str, list[float]], one: str, other: str) -> str:
    """The median of the runs' ratios, and their range."""
    found = [a / b for a, b in zip(seconds[one], seconds[other], strict=True)]
    return f"{statistics.median(found):.2f} ({min(found):.2f} to {max(found):.2f})"


def resized(scene: Scene, factor: float) -> Scene:
    """The same view in `factor` times as many pixels on either side."""
    camera = scene.camera
    plane = camera.plane_from_raster.copy()
    plane[:, :2] /= factor
    size = {"width": round(camera.width * factor), "height": round(camera.height * factor)}
    return replace(scene, camera=replace(camera, plane_from_raster=plane, **size))


# A process starts with the peak of the one that made it, so a small one makes it.
MEASURED = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, capture_output=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


def peak_of(path: Path, samples: int) -> float:
    """Peak resident megabytes of a process that renders the saved scene."""
    words = [sys.executable, "-m", "etalon", "render", str(path), "--samples", str(samples), "--replicates", "1"]
    words = [sys.executable, "-c", MEASURED, *words, "--out", str(path.with_name("peak.exr"))]
    return int(subprocess.run(words, check=True, capture_output=True, text=True).stdout) / 1024


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", nargs="?", default="glossy_spheres")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    arguments = parser.parse_args()
    open_target(arguments.scene)
    scene = export(bpy.context.scene)
    options = Options(threads=arguments.threads)
    renderer = ReferenceRenderer(scene, options)
    single = renderer.under(replace(options, threads=1))

    def timed(which: ReferenceRenderer, samples: int) -> Callable[[int], float]:
        return lambda run: which.render(run, samples).seconds

    found = in_turns({"one": timed(single, 64), "all": timed(renderer, 64)}, arguments.runs)
    print(f"{arguments.threads} threads over one: {ratios(found, 'one', 'all')} times as fast")
    found = in_turns({str(n): timed(renderer, n) for n in SAMPLES}, arguments.runs)
    for few, many in pairwise(SAMPLES):
        print(
            f"{few} to {many} samples: {ratios(found, str(many), str(few))} times the seconds for {many // few} times the work"
        )
    sized = {str(f): timed(ReferenceRenderer(resized(scene, f), options), 32) for f in SIZES}
    found = in_turns(sized, arguments.runs)
    for small, large in pairwise(SIZES):
        told = ratios(found, str(large), str(small))
        print(
            f"{small:g} to {large:g} times the width: {told} times the seconds for {(large / small) ** 2:g} times the work"
        )
    with tempfile.TemporaryDirectory() as folder:
        archive.save(scene, Path(folder) / "scene.npz")
        peaks = ", ".join(f"{n}: {peak_of(Path(folder) / 'scene.npz', n):.0f} MB" for n in MEMORY)
        print(f"peak memory by samples: {peaks}")
        words = [sys.executable, "-m", "etalon", "render", arguments.scene, "--samples", "1", "--replicates", "1"]
        seconds = []
        for _ in range(arguments.runs):
            begin = time.perf_counter()
            subprocess.run([*words, "--out", f"{folder}/x.exr"], check=True, capture_output=True)
            seconds.append(time.perf_counter() - begin)
        print(f"command to one whole image of one sample: {statistics.median(seconds):.2f} s")


if __name__ == "__main__":
    tune_process()
    main()
