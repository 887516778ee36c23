# SPDX-License-Identifier: GPL-3.0-or-later
"""How soon a light pass that is off is named.

5 % of the glossy indirect light of cornell_glossy is taken out of Cycles' side.

    python tests/benchmarks/light_passes.py --time 60

prints the seconds and the processor time after which the pass is first found to differ, and how the comparison ends.
"""

import argparse
import time
from dataclasses import replace

import bpy
from etalon.addon.command.opening import open_target
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.host.quiet import quiet
from etalon.addon.job import export, judge
from etalon.lib.comparison import compare as comparing
from etalon.lib.film.light_passes import LightPass
from etalon.lib.progress import NO_PROGRESS
from etalon.lib.report.words import sentences
from etalon.lib.settings.comparison import Settings
from etalon.lib.verdict.passes import PassTest
from etalon.lib.wavefront.tuning import tune_process

PLANTED, FACTOR = LightPass.GLOSSY_INDIRECT, 0.95


class Dimmed:
    """Cycles with less light in one pass, and as much less in its image."""

    def __init__(self, renderer):
        self._renderer = renderer
        self.name, self.settings = renderer.name, renderer.settings

    def with_passes(self, passes):
        return Dimmed(self._renderer.with_passes(passes))

    def at_size(self, width, height):
        return Dimmed(self._renderer.at_size(width, height))

    def render(self, *how):
        found = self._renderer.render(*how)
        light = found.passes.get(PLANTED)
        if light is None:
            return found
        less = found.passes | {PLANTED: FACTOR * light}
        return replace(found, radiance=found.radiance - (1.0 - FACTOR) * light, passes=less)


class Watched(PassTest):
    """The test of passes, which notes when it first finds the planted one."""

    named: tuple | None = None

    def look(self, *how):
        super().look(*how)
        if PLANTED in self.differing and Watched.named is None:
            Watched.named = time.monotonic(), time.process_time()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--time", type=float, default=60.0)
    parser.add_argument("--edge", type=int, default=64)
    parser.add_argument("--threads", type=int, default=2)
    asked = parser.parse_args()
    tune_process()
    size = (f"scene.render.resolution_{axis}={asked.edge}" for axis in "xy")
    open_target("cornell_glossy", None, None, (*size, "scene.render.resolution_percentage=100"))
    scene = bpy.context.scene
    comparing.PassTest = Watched
    settings = Settings(time=asked.time, passes="all", threads=asked.threads)
    with quiet(), neutral(scene, threads=asked.threads):
        exported = export(scene)
        candidate = Dimmed(CyclesRenderer(scene, threads=asked.threads))
        begin = time.monotonic(), time.process_time()
        comparison = judge(exported, candidate, settings, None, "", NO_PROGRESS)
    spent = [after - before for before, after in zip(begin, (time.monotonic(), time.process_time()), strict=True)]
    if Watched.named is None:
        print("the pass was not named")
    else:
        clock, processor = (at - before for before, at in zip(begin, Watched.named, strict=True))
        print(f"the pass was named after {clock:.1f} s, {processor:.1f} s of processor time")
    print(
        f"the comparison ended after {spent[0]:.1f} s, {spent[1]:.1f} s of processor time: {comparison.stopped.value}"
    )
    print("\n".join(sentences(comparison)))


if __name__ == "__main__":
    main()
