# SPDX-License-Identifier: GPL-3.0-or-later
"""The product's own verdict on photon mapping and Metropolis.

They stand in the candidate's place against path tracing.

    python tests/benchmarks/estimators.py [--time 60]

Small reference scenes, one thread for each side.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace

import bpy
from etalon.addon.host.quiet import quiet
from etalon.addon.job import export
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.film.parts import Part
from etalon.lib.film.rendering import Rendering
from etalon.lib.film.windows import Windows
from etalon.lib.metropolis.render import MetropolisRenderer
from etalon.lib.photon_mapping.render import PhotonMappingRenderer
from etalon.lib.progress import NO_PROGRESS, Progress
from etalon.lib.scene.camera import smaller_camera
from etalon.lib.scene.scene import Scene
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.coverage import coverage
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process
from etalon.reference_scenes import SCENES

ESTIMATORS = {
    "photon mapping": PhotonMappingRenderer,
    "metropolis": MetropolisRenderer,
}
REFERENCE_SCENES = ("lambert_analytic", "cornell_glossy", "glossy_spheres")
WIDE = 64


class Candidate:
    """An estimator in the candidate's place.

    It renders the whole image where windows are asked for.
    """

    def __init__(self, name: str, scene: Scene, options: Options) -> None:
        self.name, self.settings = name, {}
        self._scene, self._options = scene, options
        self.renderer = ESTIMATORS[name](scene, options)

    def render(
        self, replicate: int, samples: int, progress: Progress = NO_PROGRESS, windows: Windows | None = None
    ) -> Rendering:
        return replace(self.renderer.render(replicate, samples, progress), windows=windows)

    def at_size(self, width: int, height: int) -> Candidate:
        return Candidate(self.name, _at_size(self._scene, width, height), self._options)

    def with_passes(self, passes: Sequence[Part]) -> Candidate:
        return self


def _at_size(scene: Scene, width: int, height: int) -> Scene:
    return replace(scene, camera=smaller_camera(scene.camera, width, height))


def verdicts(seconds: float) -> None:
    """One line for each reference scene and estimator."""
    for scene_name in REFERENCE_SCENES:
        with quiet():
            SCENES[scene_name].build()
            scene = export(bpy.context.scene)
        divisor = max(scene.camera.width // WIDE, 1)
        scene = _at_size(scene, scene.camera.width // divisor, scene.camera.height // divisor)
        for name in ESTIMATORS:
            reference = ReferenceRenderer(scene, Options(seed=1, threads=1))
            candidate = Candidate(name, scene, Options(seed=2, threads=1))
            options = CompareOptions(time=seconds, tolerance=0.01)
            verdict = compare(scene, reference, candidate, coverage(reference.kernel), options).verdict
            bias = getattr(candidate.renderer, "bias", "")
            print(
                f"{scene_name:18} {scene.camera.width} x {scene.camera.height} {name:15} {verdict.outcome.value:11} "
                f"image within {verdict.bounds[0]:.2%}, "
                f"all regions within {verdict.bound:.2%}  {bias}",
                flush=True,
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--time", type=float, default=60.0)
    verdicts(parser.parse_args().time)


if __name__ == "__main__":
    tune_process()
    main()
