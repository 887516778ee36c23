# SPDX-License-Identifier: GPL-3.0-or-later
"""What the plan saves: measures and prints.

Seconds with the plan stand against seconds with effects forced on at their neutral values.

    python tests/benchmarks/pruning.py [EFFECT ...] [--threads 1] [--runs 7] [--samples 16]

The first table is of scenes that need one lobe and one light, everything else forced on: once what the scene itself
gives the stages to do, once every effect of the catalogue at its neutral value (lobes of weight 0, dark lights, a
lens of radius 0, ...). The second is of each effect alone, on the first of these scenes that does not need it. The
two sides take turns; the figures are the median of the pairs' ratios and the 95 % interval of that median by order
statistics. Setting up is not in it.
"""

from __future__ import annotations

import argparse
import statistics
import time
from dataclasses import replace

import numpy as np
from etalon.lib.effects.names import Effect
from etalon.lib.effects.plan import make_plan
from etalon.lib.scene.lights import AreaLight, PointLight
from etalon.lib.scene.scene import Scene
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process
from etalon.tests.neutral import NEUTRAL, TOGETHER
from etalon.tests.scenes import diffuse, floor, glossy, icosphere, perspective, scene
from scipy.stats import binom

CAMERA = perspective(192, 192, 0.5, (0.0, -4.5, 4.5), (0.0, 1.0, -1.0))
POINT = PointLight("point", (2.0, -2.0, 5.0), (50.0, 50.0, 50.0))
AREA = AreaLight(
    "area", (0.0, 0.0, 4.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0), "RECTANGLE", (9.0, 9.0, 9.0), np.pi
)
BODY, FLOOR = icosphere(subdivisions=5), floor(4.0, -1.0)
SCENES = {
    "sphere on a floor, Lambert, point light": scene([BODY, FLOOR], diffuse(0.5), CAMERA, (POINT,), bounces=4),
    "sphere on a floor, GGX, area light": scene([BODY, FLOOR], glossy(0.3), CAMERA, (AREA,), bounces=4),
    "sphere alone, Lambert, point light": scene(BODY, diffuse(0.5), CAMERA, (POINT,), bounces=4),
    "sphere alone, GGX, area light": scene(BODY, glossy(0.3), CAMERA, (AREA,), bounces=4),
    "sphere on a floor, mirror, area light": scene([BODY, FLOOR], glossy(0.0), CAMERA, (AREA,), bounces=4),
}


class Pair:
    """Two renderers that take turns.

    It has the ratios first / second of wall and of processor time.
    """

    def __init__(self, first: ReferenceRenderer, second: ReferenceRenderer, runs: int, samples: int) -> None:
        self.wall: list[float] = []
        self.processor: list[float] = []
        self.seconds: list[float] = []
        for renderer in (first, second):
            renderer.render(1 << 20, 1)
        for replicate in range(runs):
            (wall, processor), (other_wall, other_processor) = (
                _timed(renderer, replicate, samples) for renderer in (first, second)
            )
            self.wall.append(wall / other_wall)
            self.processor.append(processor / other_processor)
            self.seconds.append(processor)

    def saved(self, ratios: list[float]) -> str:
        """Per cent saved, the median and its interval."""
        ordered = sorted(ratios)
        k = max(int(binom.ppf(0.025, len(ordered), 0.5)) - 1, 0)
        low, middle, high = (100.0 * (1.0 - x) for x in (ordered[-1 - k], statistics.median(ordered), ordered[k]))
        return f"{middle:4.0f} % ({low:4.0f} to {high:3.0f})"


def _timed(renderer: ReferenceRenderer, replicate: int, samples: int) -> tuple[float, float]:
    wall, processor = time.perf_counter(), time.process_time()
    renderer.render(replicate, samples)
    return time.perf_counter() - wall, time.process_time() - processor


def _pair(planned: Scene, forced: Scene, effects: tuple[str, ...], arguments: argparse.Namespace) -> Pair:
    options = Options(threads=arguments.threads)
    plain = ReferenceRenderer(planned, options)
    more = ReferenceRenderer(forced, options, make_plan(forced).forcing(*effects))
    return Pair(plain, more, arguments.runs, arguments.samples)


def _everything(one: Scene) -> Scene:
    for effect in Effect:
        one = NEUTRAL[effect](one)
    return replace(one, name="everything")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("effects", nargs="*", default=list(Effect))
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--samples", type=int, default=16)
    arguments = parser.parse_args()
    print(f"{'saved of everything forced on':44} {'processor':>22} {'wall':>22}")
    for name, one in SCENES.items():
        for what, forced in (("its stages", one), ("all effects", _everything(one))):
            pair = _pair(one, forced, (), arguments)
            label = f"{name}: {what}"
            print(f"{label:56} {pair.saved(pair.processor):>22} {pair.saved(pair.wall):>22}", flush=True)
    print(f"\n{'saved of one effect forced on':30} {'processor':>22} {'wall':>22}  scene")
    for effect in arguments.effects:
        free = [(name, one) for name, one in SCENES.items() if not make_plan(one).needs(effect)]
        if not free:
            print(f"{effect:30} every one of the scenes needs it")
            continue
        name, one = free[0]
        forced = NEUTRAL[effect](one)
        pair = _pair(one, forced, (effect, *TOGETHER.get(effect, ())), arguments)
        print(f"{effect:30} {pair.saved(pair.processor):>22} {pair.saved(pair.wall):>22}  {name}", flush=True)


if __name__ == "__main__":
    tune_process()
    main()
