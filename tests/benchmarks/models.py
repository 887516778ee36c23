# SPDX-License-Identifier: GPL-3.0-or-later
"""What other models of Glossy nodes cost beside GGX: measures and prints.

These are a lobe's evaluation and sample, and the picture of a plane.

    python tests/benchmarks/models.py [MODEL ...] [--runs 60]

Seconds of the processor that this thread takes, nothing else's. Lobes: the lower fifth of the runs, each of 4,096
directions. Pictures: the fastest of five, 64 x 64 pixels of 32 samples.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
from etalon.lib.bsdfs.lobe import Lobe
from etalon.lib.bsdfs.microfacet import MicrofacetReflection
from etalon.lib.scene.expressions import Constant
from etalon.lib.scene.materials import Glossy
from etalon.lib.settings.reference import Options
from etalon.lib.surfaces.models import distribution_of, empirical_form
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import floor, material, orthographic, scene

COUNT = 4096
ALPHA = np.float64(0.3)


def directions(rng: np.random.Generator) -> np.ndarray:
    w = rng.normal(size=(3, COUNT))
    w[2] = np.abs(w[2])
    return w / np.sqrt((w * w).sum(axis=0))


def lobe(name: str, wo: np.ndarray) -> Lobe:
    form = empirical_form(name)
    if form is not None:
        return form(wo, ALPHA, ALPHA)
    return MicrofacetReflection(wo, ALPHA, ALPHA, distribution_of(name), "correlated", "visible")


def nanoseconds(action: Callable[[], object]) -> float:
    begin = time.thread_time_ns()
    action()
    return (time.thread_time_ns() - begin) / COUNT


def picture(model: str) -> float:
    """Seconds of the processor for a plane in a white world."""
    view = orthographic(64, 64, 0.1, (0.0, -5.0, 2.9), (0.0, 1.0, -0.577))
    plane = scene(floor(), material(Glossy("GGX", roughness=Constant(0.6))), view, world=1.0)
    renderer = ReferenceRenderer(plane, Options(threads=1, model=model))
    renderer.render(0, 1)
    begin = time.process_time()
    renderer.render(1, 32)
    return time.process_time() - begin


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", default=["beckmann", "student-t:g=2.5"])
    parser.add_argument("--runs", type=int, default=60)
    options = parser.parse_args()
    rng = np.random.default_rng(1)
    wi, wo, u = directions(rng), directions(rng), rng.random((2, COUNT))
    usual = "ggx"
    names = {usual: "GGX", "beckmann": "BECKMANN"}
    taken: dict[str, list[list[float]]] = {model: [[], [], []] for model in (usual, *options.models)}
    for run in range(options.runs):
        for model, (evaluate, sample, whole) in taken.items():
            name = names.get(model, model)
            evaluate.append(nanoseconds(lambda n=name: lobe(n, wo).evaluate(wi)))
            sample.append(nanoseconds(lambda n=name: lobe(n, wo).sample(*u)))
            if run < 5:
                whole.append(picture(model))
    print(f"{'model':24} evaluate, ns   sample, ns    beside GGX: evaluate, sample, both, picture")
    for model, times in taken.items():
        (a, b), c = (np.percentile(one, 20) for one in times[:2]), min(times[2])
        base = [*(np.percentile(one, 20) for one in taken[usual][:2]), min(taken[usual][2])]
        ratios = a / base[0], b / base[1], (a + b) / (base[0] + base[1]), c / base[2]
        print(f"{model:24} {a:12.1f} {b:12.1f}    {', '.join(f'{ratio:.2f}' for ratio in ratios)}")


if __name__ == "__main__":
    main()
