# SPDX-License-Identifier: GPL-3.0-or-later
"""Scattering sampled from the light's side integrates to what its weights do.

They are integrated over the sphere, lobe by lobe and together.
"""

from functools import partial

import numpy as np
import pytest
from etalon.lib.light_tracing import adjoint
from etalon.lib.sampling.warps import uniform_sphere
from etalon.lib.scene.expressions import Constant
from etalon.lib.scene.materials import Diffuse, Glass, Glossy, Sheen, Translucent, Velvet
from etalon.lib.settings.reference import Options
from etalon.lib.surfaces.surface import SurfacePoints
from etalon.lib.vectors import dot
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.lib.light_tracing.traced import MATERIALS, ball_on_floor
from etalon.tests.scenes import color, material

COUNT = 40000
LIGHTS = [(0.3, 0.2, 0.9), (-0.5, 0.6, -0.4), (0.7, -0.7, 0.2)]
TILTED = Constant((0.6, 0.0, 0.8))
ROUGH = {name: coat for name, coat in MATERIALS.items() if name not in ("smooth_glass", "mirror", "diffuse_and_mirror")}
ROUGH |= {
    "very_rough_glass": material(Glass(color(0.9), Constant(1.5), Constant(1.0))),
    "glossy_and_translucent": material(Glossy("GGX", color(0.5), Constant(1.0)), Translucent(color(0.4))),
    "tilted_glass": material(Glass(color(0.9), Constant(1.5), Constant(0.6), normal=TILTED)),
    "tilted_diffuse": material(Diffuse(color(0.9), normal=TILTED)),
    "sheen": material(Sheen(color(0.9), Constant(0.15))),
    "velvet": material(Velvet(color(0.9), Constant(0.3))),
    "tilted_sheen": material(Sheen(color(0.9), Constant(0.5), TILTED)),
    "three_lobes": material(
        Diffuse(color(0.3)), Glossy("GGX", color(0.4), Constant(0.3)), Glass(color(0.3), Constant(1.5), Constant(0.6))
    ),
}


def points_seen_from(kernel, light, triangle=40):
    """A point of a face of the ball, COUNT times, as seen from `light`.

    It lies far from the face's middle, where the normals differ.
    """
    light = np.array(light) / np.linalg.norm(light)
    repeat = [np.repeat(v[:, None], COUNT, axis=1) for v in (kernel.caster.planes[:3, triangle], light)]
    u, v = np.full(COUNT, 0.7), np.full(COUNT, 0.1)
    return SurfacePoints(kernel.tables, np.full(COUNT, triangle), u, v, np.zeros((3, COUNT)), *repeat)


def moments(direction, weight, normal):
    """Integrals (3, n) whose means are compared.

    They are both sides of the face, and a slope across the sphere.
    """
    side = dot(normal, direction) > 0.0
    return weight[0] * np.stack([side, ~side, np.exp(direction[0])])


def assert_integrates(coat, light, rng, scatter, value):
    kernel = ReferenceRenderer(ball_on_floor(coat, subdivisions=1), Options(threads=1)).kernel
    prepared, points = kernel.materials[0], points_seen_from(kernel, light)
    normal = points.ng
    onward = scatter(prepared, points, tuple(rng.random((3, COUNT))))
    direction = uniform_sphere(*rng.random((2, 4 * COUNT)))
    parts = [value(prepared, points_seen_from(kernel, light), d) for d in np.split(direction, 4, axis=1)]
    sampled = moments(onward.direction, onward.weight, normal)
    exact = 4.0 * np.pi * moments(direction, np.concatenate(parts, axis=1), np.tile(normal, 4))
    error = np.hypot(sampled.std(axis=1) / np.sqrt(COUNT), exact.std(axis=1) / np.sqrt(4 * COUNT))
    assert np.all(np.abs(sampled.mean(axis=1) - exact.mean(axis=1)) <= 5.0 * error)


@pytest.mark.grid(3)
@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("name", ROUGH)
def test_all_lobes_together(name, light, rng):
    assert_integrates(ROUGH[name], light, rng, adjoint.scatter, adjoint.light_toward)


@pytest.mark.parametrize("picked", [0, 1, 2])
def test_one_lobe_apart(picked, rng):
    only = np.arange(3)[:, None] == np.full(COUNT, picked)
    scatter, value = partial(adjoint.scatter, allowed=only), partial(adjoint.light_toward, counted=only)
    assert_integrates(ROUGH["three_lobes"], LIGHTS[0], rng, scatter, value)


def test_reflection_into_the_surface_taken_for_transmission_is_seen(monkeypatch, rng):
    draw = adjoint._draw
    monkeypatch.setattr(adjoint, "_draw", lambda *given: (*draw(*given)[:2], np.ones(COUNT, bool)))
    with pytest.raises(AssertionError):
        test_all_lobes_together("glossy_and_translucent", LIGHTS[0], rng)
