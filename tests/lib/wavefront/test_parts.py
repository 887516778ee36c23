# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits of bounces and the light of each emitter, from one render.

Tested are closed forms, and sums that are the whole image.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.effects.plan import make_plan
from etalon.lib.errors import EtalonError
from etalon.lib.film.parts import WORLD, BounceLimit, EmitterLight, decode_part, encode_part
from etalon.lib.scene.lights import SunLight
from etalon.lib.scene.materials import Diffuse, Emission
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.emitter_names import MOST
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.effect_cases import CASES
from etalon.tests.indoors import indoors
from etalon.tests.scenes import color, cube, diffuse, emission, floor, material, orthographic, perspective, quad, scene

ABOVE = orthographic(4, 4, 1.0, (0.05, 0.1, 5.0))
EVERY = pytest.mark.parametrize(
    "effect", [one if k % 4 == 0 else pytest.param(one, marks=pytest.mark.slow) for k, one in enumerate(CASES)]
)


def some(effect):
    """Scenes that show one effect: the first of each part, and the same in a room."""
    return [s for part in CASES[effect] for s in (part[0], indoors(part[0]))]


@pytest.mark.grid(3)
@EVERY
def test_limits_end_in_the_image_and_leave_it_as_it_is(effect, seed):
    for the_scene in some(effect):
        options, plan = Options(seed=seed, threads=1), make_plan(the_scene)
        most = the_scene.transport.max_bounces
        limits = (*map(BounceLimit, range(min(most, 3) + 1)), BounceLimit(most))
        plain = ReferenceRenderer(the_scene, options, plan).render(0, 8)
        found = ReferenceRenderer(the_scene, options, plan, passes=limits).render(0, 8)
        np.testing.assert_array_equal(found.radiance, plain.radiance)
        np.testing.assert_allclose(found.passes[limits[-1]], plain.radiance, rtol=1e-12, atol=1e-300)


@pytest.mark.grid(3)
@EVERY
def test_the_light_of_all_emitters_is_the_image(effect, seed):
    for the_scene in some(effect):
        options, plan = Options(seed=seed, threads=1), make_plan(the_scene)
        reference = ReferenceRenderer(the_scene, options, plan).with_passes((WORLD,))
        names = reference.kernel.emitters.names
        found = reference.with_passes(names).render(0, 8)
        total = sum(found.passes.values(), np.zeros(found.radiance.shape))
        np.testing.assert_allclose(total, found.radiance, rtol=1e-12, atol=1e-300)


@pytest.mark.parametrize("albedo", [0.8, 0.5])
def test_a_closed_room_that_glows_has_a_geometric_series(albedo, seed):
    """Every path meets a wall of radiance 1 at each step.

    1 + a + a^2 + ... has one term more than bounces plus one.
    """
    room = scene(
        cube(4.0),
        material(Diffuse(color(albedo)), Emission(color(1.0))),
        perspective(4, 4, 1.0, (0.1, 0.2, 0.3)),
        bounces=6,
    )
    limits = tuple(map(BounceLimit, range(7)))
    options = Options(seed=seed, threads=1, direct="bsdf", russian_roulette=False)
    found = ReferenceRenderer(room, options, passes=limits).render(0, 4).passes
    for k in range(7):
        expected = sum(albedo**s for s in range(k + 2))
        np.testing.assert_allclose(found[BounceLimit(k)], expected, rtol=1e-12)


def test_each_sun_lights_a_floor_by_its_own_irradiance(seed):
    """Two suns and a world: albedo / pi times each irradiance."""
    suns = (
        SunLight("Key", (0.0, 0.0, 1.0), 0.0, (2.0, 1.0, 3.0)),
        SunLight("Fill", (0.0, 0.6, 0.8), 0.0, (0.5, 0.5, 0.5)),
    )
    the_scene = scene(floor(), diffuse(0.5), ABOVE, suns, 0.3, bounces=0)
    reference = ReferenceRenderer(the_scene, Options(seed=seed, threads=1)).with_passes((WORLD,))
    assert reference.kernel.emitters.names == (EmitterLight("Key"), EmitterLight("Fill"), WORLD)
    found = reference.with_passes(reference.kernel.emitters.names).render(0, 4096).passes
    means = {name: image.mean(axis=(0, 1)) for name, image in found.items()}
    np.testing.assert_allclose(means[EmitterLight("Key")], 0.5 / np.pi * np.array([2.0, 1.0, 3.0]), rtol=5e-3)
    np.testing.assert_allclose(means[EmitterLight("Fill")], 0.5 / np.pi * 0.8 * 0.5, rtol=5e-3)
    np.testing.assert_allclose(means[WORLD], 0.15, rtol=5e-3)


def cards():
    """A floor under two cards of radiance 1 and 3, each an object of its own."""
    parts = [
        floor(50.0),
        *(quad((x, -1.0, 2.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), k + 1) for k, x in enumerate((-4.0, 2.0))),
    ]
    return scene(parts, [diffuse(0.5), emission(1.0), emission(3.0)], ABOVE, bounces=0)


def test_emitting_objects_are_told_apart(seed):
    """Cards in mirror symmetry about the camera.

    The light of the one is three times that of the other.
    """
    the_scene = cards()
    names = [one.name for one in the_scene.mesh.objects]
    reference = ReferenceRenderer(the_scene, Options(seed=seed, threads=1)).with_passes((EmitterLight(names[1]),))
    assert reference.kernel.emitters.names == tuple(map(EmitterLight, names[1:]))
    found = reference.with_passes(reference.kernel.emitters.names).render(0, 2048).passes
    low, high = (found[EmitterLight(name)].mean() for name in names[1:])
    # The camera stands 0.05 to the right, and within 0.5 of the middle the floor gets 4 % more from the right for each 0.05.
    assert high / low == pytest.approx(3.0, rel=0.1)
    whole = ReferenceRenderer(the_scene, Options(seed=seed, threads=1)).render(1, 2048).radiance.mean()
    assert low + high == pytest.approx(whole, rel=0.01)


def test_objects_of_one_name_are_one_emitter():
    the_scene = cards()
    objects = tuple(replace(one, name="Card") for one in the_scene.mesh.objects)
    the_scene = replace(the_scene, mesh=replace(the_scene.mesh, objects=objects))
    reference = ReferenceRenderer(the_scene, Options(threads=1)).with_passes((WORLD,))
    assert reference.kernel.emitters.names == (EmitterLight("Card"),)


def test_too_many_emitters_are_refused():
    suns = tuple(SunLight(f"{k}", (0.0, 0.0, 1.0), 0.0, (1.0, 1.0, 1.0)) for k in range(MOST + 1))
    the_scene = scene(floor(), diffuse(0.5), ABOVE, suns)
    reference = ReferenceRenderer(the_scene, Options(threads=1)).with_passes((WORLD,))
    with pytest.raises(EtalonError, match="65 lamps and emitting objects cannot be told apart, 64 can"):
        reference.render(0, 1)


def test_parts_travel_as_text():
    for part in (BounceLimit(3), WORLD, EmitterLight("bounces:1"), EmitterLight("Ü \n")):
        assert decode_part(encode_part(part)) == part
