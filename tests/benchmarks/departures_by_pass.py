# SPDX-License-Identifier: GPL-3.0-or-later
"""What every departure of the catalogue does to each light pass.

The page is docs/departures_by_pass.md.

    python tests/benchmarks/departures_by_pass.py > docs/departures_by_pass.md

The scenes are those of tests/lib/departures/planted_scenes.py. Each is rendered by the reference with the departure and
without, under the same random numbers, so that what it does not act on is the same bit by bit.
"""

from dataclasses import replace

import bpy
import numpy as np
from etalon.addon.command.opening import open_target
from etalon.addon.job import export
from etalon.lib.departures.catalogue import DEPARTURES, relevant
from etalon.lib.film.light_passes import LightPass
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.lib.departures.planted_scenes import SCENES, masking

SAMPLES = 256
REFERENCE_SCENES, EDGE = ("cornell_glossy", "glossy_spheres", "veach_plates"), 48
# The reference's form in these, so that Cycles' masking is a departure too.
MASKING = "separable"

HEAD = """\
# Departures by light pass

What each departure of Cycles does to the light passes of the scene in which tests plant it (`tests/lib/departures/planted_scenes.py`): the
change of a pass in the pixel where it is largest, relative to the brightest pixel of that pass. A pass that is not named is the same bit
by bit. Made by `python tests/benchmarks/departures_by_pass.py`; random numbers are the same with the departure and without.

| departure | scene | passes and their largest change |
|---|---|---|"""

BETWEEN = f"""
The same in three reference scenes, {EDGE} pixels wide, with every departure of any release that applies to them. The reference has
separable masking here, so that Cycles' correlated masking is one of them:

| departure | reference scene | passes and their largest change |
|---|---|---|"""

FOOT = """
The scenes are small, so a departure may act on more passes elsewhere: in light that scatters again, nearly all of them act on indirect light.
The catalogue (`lib/departures/catalogue.py`) lists for each the passes that it can act on; where passes are compared, those that can act
on a pass that differs are tried first."""


def change(plain, departed):
    """The largest change of a pixel and channel, with its sign.

    It is relative to the largest value of the pass.
    """
    difference = departed - plain
    at = np.unravel_index(np.abs(difference).argmax(), difference.shape)
    return difference[at] / np.abs(plain).max() if plain.any() else np.inf


def row(scene, title, mask, name):
    """One line of a table: what the departure called `name` does to a scene.

    The line shows the scene's `title`.
    """
    options, departing = (Options(threads=1, masking=mask, departures=frozenset(some)) for some in ((), (name,)))
    images = [
        ReferenceRenderer(scene, one, passes=tuple(LightPass)).render(0, SAMPLES).passes for one in (options, departing)
    ]
    plain, departed = images
    changes = {one: change(plain[one], departed[one]) for one in LightPass if (plain[one] != departed[one]).any()}
    told = [f"{one} {'from black' if np.isinf(by) else f'{100 * by:+.3g} %'}" for one, by in changes.items()]
    return f"| {name} | {title} | {', '.join(told) or 'none'} |"


def reference_scene(name):
    """A reference scene, EDGE pixels wide, to which the departures of all releases apply."""
    open_target(name, None, None, ())
    render = bpy.context.scene.render
    render.resolution_percentage = max(100 * EDGE // render.resolution_x, 1)
    return replace(export(bpy.context.scene), blender=None)


def main():
    print(HEAD)
    places = {departure.name: make for make in reversed(SCENES) for departure in relevant(make(), masking(make))}
    for departure in DEPARTURES:
        if departure.name in places:
            make = places[departure.name]
            print(row(make(), make.__name__, masking(make), departure.name))
    print(BETWEEN)
    for name in REFERENCE_SCENES:
        scene = reference_scene(name)
        for departure in relevant(scene, MASKING):
            print(row(scene, name, MASKING, departure.name))
    print(FOOT)


if __name__ == "__main__":
    main()
