# SPDX-License-Identifier: GPL-3.0-or-later
"""Light tracing, photon mapping and Metropolis beside path tracing.

They get the product's own verdict, and error against time.

    python tests/benchmarks/estimators.py [--time 60] [--size 32]   # verdicts on reference scenes
    python tests/benchmarks/estimators.py --cost FOLDER [--time 60] # scenes on which each wins or loses

Small images, one thread for each side. `--cost` writes a cost page with its plot for each scene into FOLDER.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import bpy
import mathutils
from etalon.addon.host.quiet import quiet
from etalon.addon.job import export
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.cost.document import Extras
from etalon.lib.cost.estimators import Estimator, estimator_ways
from etalon.lib.cost.measure import measure
from etalon.lib.cost.ways import BEST, reference_ways
from etalon.lib.cost.write import write_cost
from etalon.lib.errors import EtalonError
from etalon.lib.scene.camera import smaller_camera
from etalon.lib.scene.scene import Scene
from etalon.lib.settings.reference import (
    LIGHT_TRACING,
    METROPOLIS,
    OTHER_ESTIMATORS,
    PHOTON_MAPPING,
    Options,
    RenderOptions,
)
from etalon.lib.wavefront.coverage import coverage
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process
from etalon.reference_scenes import SCENES, building
from etalon.tests.benchmarks.caustics import glass

REFERENCE_SCENES = ("lambert_analytic", "cornell_glossy", "glossy_spheres")
WIDE, SIDE = 64, 32
WITHOUT = "without-pane"


def _caustic(pane: bool) -> None:
    """A small spot lamp that shines on a mirror, which lights the floor.

    The camera sees the floor alone.
    """
    building.start("caustic", SIDE, SIDE, 3)
    floor = building.diffuse("Floor", (0.5, 0.5, 0.5))
    building.rectangle("Floor", floor, (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))
    mirror = building.glossy("Mirror", "GGX", 0.0, (0.95,) * 3)
    building.rectangle("Mirror", mirror, (0.0, 1.0, 0.8), (1.2, 0.0, 0.0), (0.0, 0.0, 1.2))
    data = bpy.data.lights.new("Lamp", "SPOT")
    data.energy, data.spot_size, data.shadow_soft_size = 100.0, 0.5, 0.01
    lamp = bpy.data.objects.new("Lamp", data)
    lamp.location = (0.0, 0.0, 2.0)
    lamp.rotation_euler = mathutils.Vector((0.0, 1.0, -1.2)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(lamp)
    building.camera((0.9, -0.2, 2.2), (0.0, 0.25, 0.0), lens=80.0)


def _pane(width: float) -> None:
    """A pane of index 1 at a height of 0.6 m, through which light goes straight on."""
    clear = glass("Glass")
    clear.node_tree.nodes["Glass BSDF"].inputs["IOR"].default_value = 1.0
    building.box("Pane", clear, (0.0, 0.0, 0.6), (width, width, 0.1))


def _under_glass(pane: bool) -> None:
    """A floor under a pane, which both camera and lamp look through.

    Its index is 1, so that the scene without the `pane` has the same image, and no estimator knows that.
    """
    building.start("under glass", SIDE, SIDE, 6)
    floor = building.diffuse("Floor", (0.6, 0.6, 0.6))
    building.rectangle("Floor", floor, (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))
    if pane:
        _pane(4.0)
    building.sphere_light("Lamp", (0.3, 0.3, 1.2), 0.01, (10_000.0,) * 3)
    building.camera((0.0, 0.0, 2.0), (0.0, 0.0, 0.0), lens=50.0)


def _high_lamp(pane: bool) -> None:
    """A cube on a wide floor under a wide pane of index 1, and a lamp so high that few of its photons come into view."""
    building.start("high lamp", SIDE, SIDE, 6)
    white = building.diffuse("White", (0.6, 0.6, 0.6))
    building.rectangle("Floor", white, (0.0, 0.0, 0.0), (200.0, 0.0, 0.0), (0.0, 200.0, 0.0))
    building.box("Cube", white, (0.05, 0.0, 0.1), (0.2, 0.2, 0.2))
    if pane:
        _pane(200.0)
    building.sphere_light("Lamp", (20.0, 10.0, 60.0), 2.0, (1_000.0,) * 3)
    building.camera((0.0, 0.0, 2.0), (0.0, 0.0, 0.0), lens=70.0)


def _window(pane: bool) -> None:
    """A room that the sun lights through a small window; the camera does not see where.

    Around it lies a wide ground.
    """
    building.start("window", SIDE // 2, SIDE // 2, 4)
    white, ground = building.diffuse("White", (0.7, 0.7, 0.7)), building.diffuse("Ground", (0.1, 0.1, 0.1))
    walls = {
        "Floor": ((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0)),
        "Ceiling": ((0.0, 0.0, 2.0), (0.0, 2.0, 0.0), (2.0, 0.0, 0.0)),
        "Left": ((-1.0, 0.0, 1.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.0)),
        "Back": ((0.0, 1.0, 1.0), (2.0, 0.0, 0.0), (0.0, 0.0, 2.0)),
        "Front": ((0.0, -1.0, 1.0), (0.0, 0.0, 2.0), (2.0, 0.0, 0.0)),
        # About a window of 0.2 m in the right wall, 1 m above the floor.
        "Below": ((1.0, 0.0, 0.45), (0.0, 0.0, 0.9), (0.0, 2.0, 0.0)),
        "Above": ((1.0, 0.0, 1.55), (0.0, 0.0, 0.9), (0.0, 2.0, 0.0)),
        "Before": ((1.0, -0.55, 1.0), (0.0, 0.0, 0.2), (0.0, 0.9, 0.0)),
        "Behind": ((1.0, 0.55, 1.0), (0.0, 0.0, 0.2), (0.0, 0.9, 0.0)),
    }
    for name, (center, u, v) in walls.items():
        building.rectangle(name, white, center, u, v)
    building.rectangle("Ground", ground, (0.0, 0.0, -0.5), (200.0, 0.0, 0.0), (0.0, 200.0, 0.0))
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 100.0, 0.01
    lamp = bpy.data.objects.new("Sun", sun)
    lamp.rotation_euler = mathutils.Vector((-0.6, 0.2, -1.0)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(lamp)
    building.camera((0.9, -0.9, 1.6), (-1.0, -0.2, 1.5), lens=35.0)


def _glossy_floor() -> None:
    """A floor of roughness 0.77 under an area lamp; the camera sees the floor alone."""
    building.start("glossy floor", SIDE, SIDE, 0)
    gloss = building.glossy("Gloss", "GGX", 0.6, (0.8, 0.7, 0.6))
    building.rectangle("Floor", gloss, (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))
    building.area_light("Lamp", (0.0, 0.3, 1.2), (0.0, 0.3, 0.0), (0.8, 0.8), (10.0, 9.0, 8.0))
    building.camera((0.0, -1.5, 2.0), (0.0, 0.0, 0.0), lens=50.0)


def _room() -> None:
    """A closed white room with a lamp at the ceiling; the camera sees a part of one wall."""
    building.start("room", SIDE, SIDE, 3)
    white = building.diffuse("White", (0.6, 0.6, 0.6))
    building.rectangle("Floor", white, (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    building.rectangle("Ceiling", white, (0.0, 0.0, 2.0), (0.0, 2.0, 0.0), (2.0, 0.0, 0.0))
    building.rectangle("Back", white, (0.0, 1.0, 1.0), (2.0, 0.0, 0.0), (0.0, 0.0, 2.0))
    building.rectangle("Front", white, (0.0, -1.0, 1.0), (0.0, 0.0, 2.0), (2.0, 0.0, 0.0))
    building.rectangle("Left", white, (-1.0, 0.0, 1.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.0))
    building.rectangle("Right", white, (1.0, 0.0, 1.0), (0.0, 0.0, 2.0), (0.0, 2.0, 0.0))
    building.area_light("Lamp", (0.0, 0.0, 1.98), (0.0, 0.0, 0.0), (0.7, 0.7), (10.0, 9.0, 8.0))
    building.camera((0.0, -0.8, 1.0), (0.05, 1.0, 0.95), lens=50.0)


SMALL = {"glossy floor": _glossy_floor, "room": _room}
"""Scenes for verdicts that are small and even enough to be decided in a minute or two."""


def _plain(pane: bool) -> None:
    SCENES["lambert_analytic"].build()


WINNERS = {
    "caustic": (_caustic, LIGHT_TRACING, LIGHT_TRACING),
    "under glass": (_under_glass, PHOTON_MAPPING, WITHOUT),
    "high lamp": (_high_lamp, METROPOLIS, WITHOUT),
    "window": (_window, BEST, BEST),
    "lambert_analytic": (_plain, BEST, BEST),
}
"""Scenes, the way that is expected to win, and the way that the truth comes from: WITHOUT is path tracing without the pane."""


def _at_size(scene: Scene, side: int) -> Scene:
    camera = scene.camera
    divisor = max(camera.width // side, 1)
    return replace(scene, camera=smaller_camera(camera, camera.width // divisor, camera.height // divisor))


def verdicts(seconds: float, scenes: Sequence[str], estimators: Sequence[str], side: int) -> None:
    """One line for each reference scene and estimator; images are about `side` pixels wide."""
    for scene_name in scenes:
        with quiet():
            (SMALL[scene_name] if scene_name in SMALL else SCENES[scene_name].build)()
            scene = _at_size(export(bpy.context.scene), side)
        for name in estimators:
            reference = ReferenceRenderer(scene, Options(seed=1, threads=1))
            title = f"{scene_name:18} {scene.camera.width} x {scene.camera.height} {name:15}"
            try:
                candidate = Estimator(scene, RenderOptions(seed=2, threads=1, strategy=name))
            except EtalonError as error:
                print(f"{title} {error}", flush=True)
                continue
            options = CompareOptions(time=seconds, tolerance=0.01)
            comparison = compare(scene, reference, candidate, coverage(reference.kernel), options)
            verdict, bias = comparison.verdict, getattr(candidate.renderer, "bias", "")
            print(
                f"{title} {verdict.outcome.value:11} image within {verdict.bounds[0]:.2%}, all {verdict.bounds.size} "
                f"regions within {verdict.bound:.2%}, {comparison.seconds:.0f} s  {bias}",
                flush=True,
            )


def _exported(build: Callable[[bool], None], pane: bool) -> Scene:
    with quiet():
        build(pane)
        return _at_size(export(bpy.context.scene), SIDE)


def costs(seconds: float, folder: Path, only: str | None) -> None:
    """Write a page and a few lines for each scene.

    They have the error of each way at its last level, and what it took.
    """
    for name, (build, expected, truth) in WINNERS.items():
        if only not in (None, name):
            continue
        scene, other = (_exported(build, pane) for pane in (True, False))
        ways = [way for way in reference_ways(scene, 1, 1, 0.0) if way.key == BEST]
        ways += estimator_ways(scene, 2, 1, 0.0)
        if truth == WITHOUT:
            ways += [
                replace(way, key=WITHOUT, label="path tracing without the pane")
                for way in reference_ways(other, 3, 1, 0.0)
                if way.key == BEST
            ]
        share = 0.1 if truth == WITHOUT else 0.4  # light sampling finds the lamp where there is no pane
        measurement = measure(name, ways, truth, seconds, truth_share=share)
        place = folder / name.replace(" ", "_")
        place.mkdir(parents=True, exist_ok=True)
        figures = write_cost(
            measurement, Extras(command=f"python tests/benchmarks/estimators.py --cost {folder}"), place
        )
        print(
            f"{name}: truth by {truth}, {measurement.truth.samples} x {measurement.truth.replicates} samples; expected {expected}"
        )
        for way in figures["ways"]:
            if not way["points"]:
                print(f"  {way['label']}: {way['missing']}")
                continue
            points = [(p["samples"], p["seconds"]["value"], p["error"]["value"]) for p in way["points"]]
            shown = ", ".join(f"{n}: {s:.2g} s {e:.2%}" for n, s, e in points)
            print(
                f"  {way['label']:28} error x sqrt(s) {points[-1][2] * points[-1][1] ** 0.5:.4f}   {shown}", flush=True
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--time", type=float, default=60.0)
    parser.add_argument("--cost", type=Path, metavar="FOLDER")
    parser.add_argument("--size", type=int, default=WIDE, help="width of the images of verdicts, about")
    parser.add_argument("--scenes", nargs="+", choices=[*SCENES, *SMALL], default=REFERENCE_SCENES)
    parser.add_argument("--estimators", nargs="+", choices=OTHER_ESTIMATORS, default=OTHER_ESTIMATORS)
    parser.add_argument("--only", choices=sorted(WINNERS), help="one scene of --cost")
    arguments = parser.parse_args()
    try:
        if arguments.cost is None:
            verdicts(arguments.time, arguments.scenes, arguments.estimators, arguments.size)
        else:
            costs(arguments.time, arguments.cost, arguments.only)
    except EtalonError as error:
        raise SystemExit(str(error)) from None


if __name__ == "__main__":
    tune_process()
    main()
