# SPDX-License-Identifier: GPL-3.0-or-later
"""What compiled shading would give: measures and prints.

The integrator as it is runs beside one whose hottest functions Numba compiles.

    pip install numba
    python tests/benchmarks/compiled.py [SCENE ...] [--runs 8] [--samples 8]

Compiled are the microfacet lobes (GGX and Beckmann, visible normals, correlated masking), solid angles of and places on
rectangle lights, and turns into and out of local frames. The two integrators take turns in one process on one thread;
figures are processor time, the least of the runs. The images agree to rounding, which is printed too.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter, process_time, thread_time_ns
from unittest import mock

import numpy as np
from etalon.addon.command.opening import open_target
from etalon.addon.job import export
from etalon.lib import vectors
from etalon.lib.bsdfs.lobe import to_rgb
from etalon.lib.bsdfs.microfacet import MicrofacetReflection
from etalon.lib.lights.spherical_rectangle import SphericalRectangle
from etalon.lib.microfacets import inverse_tables, visible_slope
from etalon.lib.microfacets.beckmann import Beckmann
from etalon.lib.microfacets.ggx import GGX
from etalon.lib.settings.reference import Options
from etalon.lib.surfaces import lobes
from etalon.lib.wavefront import shade
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process
from etalon.tests.benchmarks import compiled_kernels as kernels

SCENES = ("cornell_glossy", "veach_plates", "glossy_spheres")
POINTS = 16384


def compiled() -> dict[tuple[object, str], object]:
    """(Class or module, name) -> what stands there in the compiled integrator."""
    table = visible_slope._table()
    shape = table._table, table._scale, inverse_tables.LEAST_UNIFORM, inverse_tables.LARGEST_UNIFORM
    shape += inverse_tables._VIEWS, inverse_tables._LEVELS
    init, evaluate, sample = (getattr(MicrofacetReflection, name) for name in ("__init__", "evaluate", "sample"))
    turns = {name: getattr(vectors, name) for name in ("to_local", "to_world")}

    def alphas(lobe, n):
        return (np.broadcast_to(np.asarray(alpha, float), (n,)) for alpha in lobe._alpha)

    def set_up(self, wo, alpha_x, alpha_y, distribution, masking_form, strategy):
        if strategy != "visible" or masking_form != "correlated" or type(distribution) not in (GGX, Beckmann):
            init(self, wo, alpha_x, alpha_y, distribution, masking_form, strategy)
            return
        n = wo.shape[1]
        self._wo, self._alpha, self._bound = wo, (alpha_x, alpha_y), None
        self._ggx = None if type(distribution) is Beckmann else True
        self._lambda_o, self._cos_o, self._pdf_of_d = np.empty((3, n))
        self._above = np.empty(n, bool)
        out = self._lambda_o, self._above, self._cos_o, self._pdf_of_d
        kernels.set_up(self._ggx, wo, *alphas(self, n), *out)

    def value_of(self, wi):
        if not hasattr(self, "_ggx"):
            return evaluate(self, wi)
        value, pdf = np.empty((2, wi.shape[1]))
        known = self._lambda_o, self._cos_o, self._pdf_of_d
        kernels.evaluate(self._ggx, wi, self._wo, *alphas(self, value.size), *known, value, pdf)
        return to_rgb(value), pdf

    def drawn(self, u1, u2):
        if not hasattr(self, "_ggx"):
            return sample(self, u1, u2)
        wi, weight, pdf = np.empty((3, u1.size)), np.empty(u1.size), np.empty(u1.size)
        known = self._lambda_o, self._pdf_of_d, u1, u2
        kernels.sample(self._ggx, self._wo, *alphas(self, u1.size), *known, *shape, wi, weight, pdf)
        return wi, to_rgb(weight), pdf

    def see(self, *bounds):
        self._seen, self._halves = bounds, tuple(np.empty((4, bounds[-1].size)))
        kernels.solid_angle(*bounds, *self._halves)
        self.solid_angle = 2.0 * self._halves[0]

    def place(self, u1, u2):
        x, y = np.empty((2, u1.size))
        kernels.place(*self._seen, *self._halves, u1, u2, x, y)
        return x, y

    def turn(name):
        def turned(v, *axes):
            if any(axis.shape != v.shape for axis in axes):
                return turns[name](v, *axes)
            out = np.empty_like(v)
            getattr(kernels, name)(v, *axes, out)
            return out

        return turned

    lobe = {"__init__": set_up, "evaluate": value_of, "sample": drawn}
    rectangle = {"__init__": see, "place": place}
    return {
        **{(MicrofacetReflection, name): function for name, function in lobe.items()},
        **{(SphericalRectangle, name): function for name, function in rectangle.items()},
        **{(module, name): turn(name) for module in (lobes, shade) for name in turns if hasattr(module, name)},
    }


@contextmanager
def in_place(of: dict[tuple[object, str], object]) -> Iterator[None]:
    """The integrator with the functions `of` in their places."""
    patches = [mock.patch.object(where, name, function) for (where, name), function in of.items()]
    for patch in patches:
        patch.start()
    try:
        yield
    finally:
        for patch in patches:
            patch.stop()


def measure_scene(name: str, functions: dict, runs: int, samples: int) -> None:
    """Print the processor time of a replicate on either side.

    Also how far the images are apart.
    """
    import bpy

    open_target(name)
    renderer = ReferenceRenderer(export(bpy.context.scene), Options(threads=1))
    renderer.render(1 << 20, 1)
    least, images = {}, {}
    for replicate in range(runs):
        for side in ("numpy", "compiled"):
            with in_place(functions if side == "compiled" else {}):
                begin = process_time()
                images[side] = renderer.render(replicate, samples).radiance
                least[side] = min(least.get(side, np.inf), process_time() - begin)
    apart = np.abs(images["compiled"] - images["numpy"]).max() / images["numpy"].mean()
    print(
        f"{name:16} NumPy {least['numpy']:6.3f} s   compiled {least['compiled']:6.3f} s"
        f"   ratio {least['numpy'] / least['compiled']:5.2f}   images apart {apart:.1e} of the mean"
    )


def measure_functions(functions: dict) -> None:
    """Print nanoseconds per point of each function, in arrays that fit the cache."""
    rng = np.random.default_rng(0)
    wo, wi = rng.standard_normal((2, 3, POINTS))
    for w in (wo, wi):
        w[2] = np.abs(w[2])
        w /= np.sqrt((w * w).sum(axis=0))
    u1, u2, alpha = rng.random(POINTS), rng.random(POINTS), np.full(POINTS, 0.3)
    bounds = (*(rng.uniform(*range_, POINTS) for range_ in ((-2, -0.1), (0.1, 2), (-2, -0.1), (0.1, 2), (0.1, 2))),)
    print(f"\n{'ns per point':32} {'NumPy':>8} {'compiled':>8}")
    for label, prepare, run in (
        *(
            (
                f"{type(d).__name__} {what}",
                lambda d=d: MicrofacetReflection(wo, alpha, alpha, d, "correlated", "visible"),
                run,
            )
            for d in (GGX(), Beckmann())
            for what, run in (
                ("lobe, set up", None),
                ("lobe, evaluate", lambda lobe: lobe.evaluate(wi)),
                ("lobe, sample", lambda lobe: lobe.sample(u1, u2)),
            )
        ),
        ("rectangle light, solid angle", lambda: SphericalRectangle(*bounds), None),
        ("rectangle light, place", lambda: SphericalRectangle(*bounds), lambda seen: seen.place(u1, u2)),
    ):
        least = []
        for of in ({}, functions):
            with in_place(of):
                thing, times = prepare(), []
                for _ in range(60):
                    begin = thread_time_ns()
                    run(thing) if run else prepare()
                    times.append(thread_time_ns() - begin)
            least.append(min(times) / POINTS)
        print(f"{label:32} {least[0]:8.1f} {least[1]:8.1f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--samples", type=int, default=8)
    arguments = parser.parse_args()
    tune_process()
    functions = compiled()
    begin = perf_counter()
    with in_place(functions):
        for distribution in (GGX(), Beckmann()):
            lobe = MicrofacetReflection(np.eye(3), 0.3, 0.3, distribution, "correlated", "visible")
            lobe.sample(np.full(3, 0.5), np.full(3, 0.5))
            lobe.evaluate(np.eye(3))
        SphericalRectangle(*np.full((5, 3), 0.5)).place(np.full(3, 0.5), np.full(3, 0.5))
    print(
        f"first calls {perf_counter() - begin:.1f} s (kernels are kept in __pycache__: remove it for the time to compile)"
    )
    for name in arguments.scenes:
        measure_scene(name, functions, arguments.runs, arguments.samples)
    measure_functions(functions)


if __name__ == "__main__":
    main()
