# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference beside Cycles and Mitsuba 3: throughput, and seconds to an error.

All have the same arrays, threads and bounces.

    python tests/benchmarks/peers.py [SCENE ...] [--threads 2] [--runs 6] [--samples 64] [--json FILE]

All take turns, so that a machine that changes its pace does so for all; figures are medians over runs, ratios medians
of the runs' ratios. Errors are noise alone, from pairs of runs (the models of the peers differ, see
mitsuba_renderer.py): the mean over pixels of the relative squared error, the mean less the 1 % worst pixels, and the
median pixel. Seconds to an error take the noise to fall as 1/N from where it was measured. The clock runs around
rendering alone. Mitsuba is left out where it is not installed (`pip install etalon[peers]`); its LLVM variant needs
an LLVM library that knows the processor (DRJIT_LIBLLVM_PATH names one; 19 does for AVX-512).
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import platform
import statistics
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from etalon.addon.command.opening import open_target
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.host.quiet import quiet
from etalon.addon.job import export
from etalon.lib.comparison.compare import Renderer
from etalon.lib.errors import Refused
from etalon.lib.scene.scene import Scene
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process

SCENES = ("glossy_spheres", "veach_plates", "cornell_glossy")
MITSUBA = (("scalar_rgb", "independent"), ("llvm_ad_rgb", "independent"), ("llvm_ad_rgb", "multijitter"))
ERRORS = ("mean", "trimmed", "median")
TARGETS = (0.01, 0.003)
FLOOR, TRIMMED = 0.01, 0.01


@dataclass
class Row:
    """One renderer on one scene.

    Seconds and million camera samples per second of each run, and relative squared errors of each pair.
    """

    scene: str
    name: str
    samples: int
    seconds: list[float] = field(default_factory=list)
    throughput: list[float] = field(default_factory=list)
    errors: dict[str, list[float]] = field(default_factory=lambda: {name: [] for name in ERRORS})

    def to(self, target: float, error: str) -> float:
        """Seconds until that error is down to `target` squared, the noise falling as 1/N."""
        return statistics.median(self.seconds) * statistics.mean(self.errors[error]) / target**2


def renderers(scene: Scene, bpy_scene: object, threads: int) -> list[Renderer]:
    """The reference first, Cycles second."""
    found = [ReferenceRenderer(scene, Options(threads=threads)), CyclesRenderer(bpy_scene, threads=threads)]
    if importlib.util.find_spec("mitsuba"):
        from mitsuba_renderer import MitsubaRenderer

        try:
            found += [MitsubaRenderer(scene, variant, sampler, threads) for variant, sampler in MITSUBA]
        except Refused as refused:
            print(f"without Mitsuba: {refused}")
    else:
        print("Mitsuba is not installed and left out; `pip install etalon[peers]`")
    return found


def measure(name: str, threads: int, runs: int, samples: int, scale: int) -> list[Row]:
    """`runs` runs of every renderer in turns."""
    import bpy

    open_target(name)
    bpy.context.scene.render.resolution_percentage = scale
    with neutral(bpy.context.scene, threads=threads):
        with quiet():
            scene = export(bpy.context.scene)
        peers = renderers(scene, bpy.context.scene, threads)
        rows = [Row(name, peer.name, samples) for peer in peers]
        for peer in peers:
            peer.render(1 << 20, samples)
        before: list[np.ndarray] = []
        weight = None
        for run in range(runs):
            images = []
            for peer, row in zip(peers, rows, strict=True):
                done = peer.render(run, samples)
                row.seconds.append(done.seconds)
                row.throughput.append(done.camera_samples / done.seconds / 1e6)
                images.append(done.radiance)
            if run % 2:
                if weight is None:
                    truth = 0.5 * (before[0] + images[0])
                    weight = 1.0 / (truth**2 + (FLOOR * truth.mean()) ** 2)
                for row, one, two in zip(rows, before, images, strict=True):
                    _add_errors(row, (0.5 * weight * (one - two) ** 2).mean(axis=2).ravel())
            before = images
    return rows


def _add_errors(row: Row, squares: np.ndarray) -> None:
    kept = squares.size - int(TRIMMED * squares.size)
    row.errors["mean"].append(float(squares.mean()))
    row.errors["trimmed"].append(float(np.partition(squares, kept - 1)[:kept].mean()))
    row.errors["median"].append(float(np.median(squares)))


def table(rows: list[Row]) -> str:
    """One scene as Markdown.

    Ratios are reference to peer in throughput, peer to reference in seconds: above 1 the reference is ahead.
    """
    reference = rows[0]
    head = ["", "M samples/s", "ratio", *(f"s to {100 * t:g} % ({e})" for e in ERRORS[1:] for t in TARGETS)]
    head += [f"ratio ({e})" for e in ERRORS]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for row in rows:
        ratios = [a / b for a, b in zip(reference.throughput, row.throughput, strict=True)]
        cells = [row.name, f"{statistics.median(row.throughput):.2f}"]
        cells.append(f"{statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})")
        cells += [f"{row.to(target, error):.3g}" for error in ERRORS[1:] for target in TARGETS]
        cells += [_ratio(row.to(0.01, error), reference.to(0.01, error)) for error in ERRORS]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _ratio(peer: float, reference: float) -> str:
    """Of seconds; the reference needs none where it has no noise."""
    return f"{peer / reference:.2f}" if reference else "-" if not peer else "inf"


def machine(threads: int) -> str:
    """The processor by its own name, and the threads."""
    model = platform.processor() or platform.machine()
    information = Path("/proc/cpuinfo")
    if information.exists():
        names = [
            line.split(":", 1)[1] for line in information.read_text().splitlines() if line.startswith("model name")
        ]
        model = names[0].strip() if names else model
    return f"{model}, {os.cpu_count()} logical processors, {threads} threads"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--runs", type=int, default=6)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--scale", type=int, default=100, metavar="PERCENT", help="resolution, for a quick look")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all figures of all runs there")
    arguments = parser.parse_args()
    print(f"{machine(arguments.threads)}; {arguments.samples} samples a pixel, {arguments.runs} runs in turns")
    rows = []
    for name in arguments.scenes:
        measured = measure(name, arguments.threads, arguments.runs, arguments.samples, arguments.scale)
        print(f"\n{name}\n\n{table(measured)}", flush=True)
        rows += measured
    if arguments.json is not None:
        figures = {"machine": machine(arguments.threads), "rows": [asdict(row) for row in rows]}
        arguments.json.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    tune_process()
    main()
