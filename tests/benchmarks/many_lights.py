# SPDX-License-Identifier: GPL-3.0-or-later
"""What the choice of lights and of emissive faces by place gains over a choice by power: measures and prints.

    python tests/benchmarks/many_lights.py [NAME ...] [--runs 8] [--samples 16]

Halls of 40 x 40 m with lamps below their ceiling, a floor under a near lamp and a far one, `veach_plates`, and emissive meshes: balls
in a ring, a tube along a corridor of 30 m, and a panel in place of the lamp of `cornell_glossy`. Only those whose name contains a
NAME. Efficiency is one over variance times seconds of the processor, by place over by power; the two take turns.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import bpy
import numpy as np
from etalon.addon.command.opening import open_target
from etalon.addon.job import export
from etalon.lib.lights.selection import LightSelection
from etalon.lib.scene.lights import USUAL_FALLOFF, Falloff, PointLight, SphereLight
from etalon.lib.scene.materials import Diffuse
from etalon.lib.scene.scene import Scene
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process
from etalon.tests.scenes import Part, color, emission, floor, icosphere, material, mesh, perspective, quad, scene

EMITTER = 2.0
"""Pixels that are brighter anywhere, W m^-2 sr^-1, are left out of the variance."""
PAPER = material(Diffuse(color(0.8, 0.7, 0.6)))
WALLS = (
    quad((-20.0, -20.0, 0.0), (0.0, 40.0, 0.0), (0.0, 0.0, 3.0), 0),
    quad((20.0, -20.0, 0.0), (0.0, 40.0, 0.0), (0.0, 0.0, 3.0), 0),
    quad((-20.0, 20.0, 0.0), (40.0, 0.0, 0.0), (0.0, 0.0, 3.0), 0),
)


def hall(count: int, radius: float, falloff: Falloff = USUAL_FALLOFF) -> Scene:
    """A floor and three walls below `count` lamps of `radius` in metres, points where it is 0; points fall off by `falloff`."""
    places = np.random.default_rng(1).uniform(-20.0, 20.0, (count, 2))
    lights = [
        SphereLight(f"lamp {k}", (float(x), float(y), 2.0), radius, (40.0, 40.0, 40.0))
        if radius
        else PointLight(f"lamp {k}", (float(x), float(y), 2.0), (1.0, 1.0, 1.0), falloff=falloff)
        for k, (x, y) in enumerate(places)
    ]
    camera = perspective(64, 48, 1.2, (0.0, -18.0, 2.5), (0.0, 1.0, -0.2))
    return scene([floor(20.0), *WALLS], [PAPER], camera, lights, bounces=3)


def near_and_far(falloff: Falloff) -> Scene:
    """A floor under two points that fall off by `falloff`, 3 and 40 m away; the far one has 1.4 times the power."""
    lights = [
        PointLight(f"lamp {k}", (x, 0.0, 1.5), (power,) * 3, falloff=falloff)
        for k, (x, power) in enumerate(((0.0, 1.0), (40.0, 1.4)))
    ]
    camera = perspective(64, 48, 1.2, (0.0, -5.0, 4.0), (0.0, 1.0, -0.7))
    return scene([floor(60.0)], [PAPER], camera, lights)


def ring(count: int) -> Scene:
    """The hall below a ring of `count` emissive balls of 320 faces each."""
    ball = icosphere(0.1, 2, 1)
    turns = 2.0 * np.pi * np.arange(count) / count
    places = np.stack([15.0 * np.cos(turns), 15.0 * np.sin(turns), np.full(count, 2.0)], axis=1)
    balls = [replace(ball, vertices=ball.vertices + place[:, None]) for place in places]
    camera = perspective(64, 48, 1.2, (0.0, -18.0, 2.5), (0.0, 1.0, -0.2))
    return scene([floor(20.0), *WALLS, *balls], [PAPER, emission(40.0)], camera, bounces=3)


def tube(length: float, segments: int, sides: int = 12) -> Part:
    """A tube along y, of `segments` between rings of `sides` corners, in material 1."""
    turns = 2.0 * np.pi * np.arange(sides) / sides
    along = np.linspace(-0.5 * length, 0.5 * length, segments + 1)
    x, y = np.tile(0.03 * np.cos(turns), segments + 1), np.repeat(along, sides)
    vertices = np.stack([x, y, 2.8 + np.tile(0.03 * np.sin(turns), segments + 1)])
    k, j = (one.ravel() for one in np.meshgrid(np.arange(segments), np.arange(sides), indexing="ij"))
    a, b = k * sides + j, k * sides + (j + 1) % sides
    return Part(vertices, np.concatenate([[a, b, b + sides], [a, b + sides, a + sides]], axis=1), 1)


def corridor(segments: int) -> Scene:
    """A corridor of 30 m below a tube of `segments`."""
    walls = [
        quad((-1.5, -15.0, 0.0), (3.0, 0.0, 0.0), (0.0, 30.0, 0.0), 0),
        quad((-1.5, -15.0, 0.0), (0.0, 30.0, 0.0), (0.0, 0.0, 3.0), 0),
        quad((1.5, -15.0, 0.0), (0.0, 0.0, 3.0), (0.0, 30.0, 0.0), 0),
        quad((-1.5, 15.0, 0.0), (3.0, 0.0, 0.0), (0.0, 0.0, 3.0), 0),
    ]
    camera = perspective(64, 48, 0.8, (0.0, -14.0, 1.6), (0.0, 1.0, -0.1))
    return scene([*walls, tube(29.0, segments)], [PAPER, emission(40.0)], camera, bounces=3)


def lamp_in_hall() -> Scene:
    """The hall below one emissive ball of 1,280 faces."""
    ball = icosphere(0.3, 3, 1)
    camera = perspective(64, 48, 1.2, (0.0, -18.0, 2.5), (0.0, 1.0, -0.2))
    placed = replace(ball, vertices=ball.vertices + np.array([[0.0], [-5.0], [2.0]]))
    return scene([floor(20.0), *WALLS, placed], [PAPER, emission(40.0)], camera, bounces=3)


def panel_in_box() -> Scene:
    """`cornell_glossy` at a quarter of its size, with an emissive panel of 128 faces in place of its lamp."""
    open_target("cornell_glossy")
    bpy.context.scene.render.resolution_percentage = 25
    built = export(bpy.context.scene)
    lamp = np.array([(-0.35 + 0.7 * k / 8, 1.05 + 0.7 * j / 8, 1.985) for j in range(9) for k in range(9)]).T
    corner = np.array([9 * j + k for j in range(8) for k in range(8)])
    faces = np.concatenate([[corner, corner + 9, corner + 10], [corner, corner + 10, corner + 1]], axis=1)
    panel = mesh(Part(lamp, faces, len(built.materials)))
    old = built.mesh
    joined = replace(
        old,
        vertices=np.concatenate([old.vertices, panel.vertices], axis=1),
        triangles=np.concatenate([old.triangles, panel.triangles + old.vertices.shape[1]], axis=1).astype(np.int32),
        material_index=np.concatenate([old.material_index, panel.material_index]),
        object_index=np.concatenate([old.object_index, panel.object_index + len(old.objects)]),
        smooth=np.concatenate([old.smooth, panel.smooth]),
        objects=(*old.objects, *panel.objects),
    )
    return replace(built, mesh=joined, materials=(*built.materials, emission(11.0, 10.0, 8.2)), lights=())


def plates() -> Scene:
    """`veach_plates` at a quarter of its size."""
    open_target("veach_plates")
    bpy.context.scene.render.resolution_percentage = 25
    return export(bpy.context.scene)


HALLS = ((4, 0.1), (16, 0.1), (64, 0.1), (64, 0.0), (256, 0.0), (1000, 0.0))
SCENES: dict[str, Callable[[], Scene]] = {
    **{f"hall, {count} {'spheres' if radius else 'points'}": partial(hall, count, radius) for count, radius in HALLS},
    **{f"hall, {count} points, Linear": partial(hall, count, 0.0, Falloff(1)) for count in (16, 64)},
    "hall, 16 points, Smooth 1 m2": partial(hall, 16, 0.0, Falloff(0, 1.0)),
    "near and far": partial(near_and_far, USUAL_FALLOFF),
    "near and far, Linear": partial(near_and_far, Falloff(1)),
    "near and far, Constant": partial(near_and_far, Falloff(2)),
    "veach_plates, a quarter": plates,
    "ring of 24 emissive balls": partial(ring, 24),
    "corridor, tube of 100 segments": partial(corridor, 100),
    "corridor, tube of 1 segment": partial(corridor, 1),
    "one emissive ball": lamp_in_hall,
    "panel in cornell_glossy": panel_in_box,
}


def reference(built: Scene, by_place: bool) -> ReferenceRenderer:
    """A renderer that chooses lights by place, or by power."""
    renderer = ReferenceRenderer(built, Options(threads=1))
    if not by_place:
        kernel = renderer.kernel
        kernel._selection = LightSelection(kernel.lights)
    return renderer


def measure(name: str, built: Scene, runs: int, samples: int) -> None:
    """Print the ratios of variance, seconds and efficiency for one scene."""
    ways = {by_place: reference(built, by_place) for by_place in (False, True)}
    images: dict[bool, list[np.ndarray]] = {way: [] for way in ways}
    seconds = dict.fromkeys(ways, 0.0)
    for run in range(runs + 1):  # the first sets up
        for way, renderer in ways.items():
            begin = time.process_time()
            image = renderer.render(run, samples).radiance
            if run:
                seconds[way] += time.process_time() - begin
                images[way].append(image)
    # An emitter in view is the same noise for both, and brighter than all else.
    plain = np.max([np.max(one, axis=(0, 3)) for one in images.values()], axis=0) < EMITTER
    variance = {way: np.var(images[way], axis=0, ddof=1)[plain].mean() for way in ways}
    fewer, longer = variance[False] / variance[True], seconds[True] / seconds[False]
    print(f"{name:28} variance / {fewer:5.1f}   seconds x {longer:.2f}   efficiency x {fewer / longer:.1f}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=("",))
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--samples", type=int, default=16)
    given = parser.parse_args()
    for name, make in SCENES.items():
        if any(part in name for part in given.names):
            measure(name, make(), given.runs, given.samples)


if __name__ == "__main__":
    tune_process()
    main()
