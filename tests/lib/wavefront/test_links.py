# SPDX-License-Identifier: GPL-3.0-or-later
"""Light and shadow linking against closed forms.

What is linked is lit or hidden as if the rest were not there, and parts add up.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import EtalonError, Refused
from etalon.lib.light_tracing.render import LightTracingRenderer
from etalon.lib.scene.lights import PointLight
from etalon.lib.scene.links import Links
from etalon.lib.scene.materials import Diffuse, Glossy, Transparent
from etalon.lib.scene.rays import CAMERA, EVERY, SEEN
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.lib.wavefront.test_direct_light import DIRECT, PRECISION, from_polygon, over_pixels
from etalon.tests.lib.wavefront.test_direct_light import lit as under
from etalon.tests.lib.wavefront.test_sight import AREA, CAMERA_AT, COATED, CORNERS, POINT, SCREEN, from_point
from etalon.tests.replicates import assert_mean, assert_same, replicates
from etalon.tests.scenes import color, diffuse, emission, floor, glossy, material, orthographic, quad, scene

FIRST, SECOND = 0b01, 0b10
"""The sets of objects that no emitter names, and of those of number 1."""
EXACT = 3.0 * over_pixels(from_polygon(CORNERS))
PANEL = quad((-0.3, -0.2, 1.5), (1.2, 0.0, 0.0), (0.0, 0.8, 0.0), 1)
UNSEEN = {"rays": EVERY & ~CAMERA}


def linked(the_scene, *facts):
    """The scene with facts of its objects."""
    objects = tuple(replace(one, **each) for one, each in zip(the_scene.mesh.objects, facts, strict=True))
    return replace(the_scene, mesh=replace(the_scene.mesh, objects=objects))


@DIRECT
def test_a_lamp_lights_what_is_linked_to_it_and_nothing_else(direct, seed):
    """The exact irradiance on a floor that it is linked to; none on one that it is not."""
    for receivers, shown in ((SECOND, True), (FIRST, False), (-1, True), (0, False)):
        room = under([replace(AREA, links=Links(receivers=receivers))], [], [])
        image = replicates(linked(room, {"receiver": 1}), 8, 256, direct=direct, seed=seed)
        if shown:
            assert_mean(image, EXACT, PRECISION[direct], rounding=1e-3)
        else:
            assert not image.any()


@DIRECT
def test_faces_light_what_is_linked_to_them(direct, seed):
    """Two panels, one for each of two sets.

    A floor of either set is lit as by one of them alone.
    """
    lower = quad((-0.3, -0.2, 1.4), (1.2, 0.0, 0.0), (0.0, 0.8, 0.0), 2)

    def render(parts, *facts):
        coats = [COATED, emission(3.0), emission(7.0)]
        return replicates(linked(scene(parts, coats, CAMERA_AT), *facts), 12, 512, direct=direct, seed=seed)

    one = render([floor(3.0), lower], {}, UNSEEN)
    for number, bits in enumerate((FIRST, SECOND)):
        upper = {"links": Links(bits ^ 3), **UNSEEN}
        both = render([floor(3.0), lower, PANEL], {"receiver": number}, {"links": Links(bits), **UNSEEN}, upper)
        assert_same(both, one, 0.15 if direct == "bsdf" else 0.03)
        assert not render([floor(3.0), lower], {"receiver": number}, {"links": Links(bits ^ 3), **UNSEEN}).any()


@pytest.mark.parametrize("source", ["lamp", pytest.param("faces", marks=pytest.mark.slow)])
def test_sets_that_part_the_objects_part_the_light(source, seed):
    """Two walls of different sets, a glossy floor and two bounces.

    The light of the three sets adds up to all of it.
    """
    walls = [
        quad((-1.0, 1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 0.0, 2.0)),
        quad((-1.0, -1.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.0)),
    ]

    def render(receivers, shift):
        links = Links(receivers)
        lamps, more = ([replace(AREA, links=links)], []) if source == "lamp" else ([], [PANEL])
        room = scene([floor(3.0), *walls, *more], [COATED, emission(3.0)], CAMERA_AT, lamps, bounces=2)
        facts = [{}, {"receiver": 1}, {"receiver": 2}] + [{"links": links, **UNSEEN}] * len(more)
        return replicates(linked(room, *facts), 12, 512, seed=seed + shift)

    parts = [render(1 << k, k) for k in range(3)]
    assert all(part.any() for part in parts)
    assert_same(sum(parts), render(-1, 10), 0.03)


def test_a_mirror_shows_a_lamp_that_is_linked_to_it(seed):
    """And no other; a clear face between them changes nothing. Camera rays see all lamps."""
    down, up = (orthographic(1, 1, 0.01, (0.3, 0.2, z), (0.0, 0.0, d)) for z, d in ((0.9, -1.0), (0.6, 1.0)))
    clear = quad((-2.0, -2.0, 0.5), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0), 1)
    coats = [material(Glossy("GGX")), material(Transparent(color(1.0)))]
    for receivers, shown in ((FIRST, 0.0), (SECOND, 3.0)):
        lamp = replace(AREA, rays=SEEN, links=Links(receivers))
        for more in ([], [clear]):
            mirror = linked(scene([floor(3.0), *more], coats, down, [lamp]), {"receiver": 1}, *[{}] * len(more))
            np.testing.assert_allclose(replicates(mirror, 2, 16, seed=seed), shown, rtol=1e-9)
            np.testing.assert_allclose(replicates(replace(mirror, camera=up), 2, 16, seed=seed), 3.0, rtol=1e-9)


@DIRECT
def test_a_screen_that_blocks_other_lamps_only(direct, seed):
    """The lamp above it lights the floor exactly as if it were not there.

    A second one does not.
    """
    other = PointLight("other", (0.0, 0.0, 2.0), (5.0, 5.0, 5.0))
    for lamp, exact in ((AREA, EXACT), (POINT, over_pixels(from_point) * POINT.intensity)):
        for more in ([], [other]):
            lamps = [replace(lamp, links=Links(blockers=FIRST)), *more]
            room = linked(under(lamps, [SCREEN], [diffuse(0.5)]), {}, {"blocker": 1, **UNSEEN})
            assert_mean(replicates(room, 8, 512, direct=direct, seed=seed), exact, 0.03, rounding=1e-3)
        hidden = linked(room, {"blocker": 1}, {"blocker": 0})
        assert not replicates(hidden, 2, 64, direct=direct, seed=seed).any()


def test_a_mirror_shows_a_lamp_through_what_does_not_block_it(seed):
    """The lamp is whole behind a screen that does not block it.

    It is not there where the screen alone does; half of it shows through a clear pane that blocks.
    """
    down = orthographic(1, 1, 0.01, (0.3, 0.2, 0.4))
    pane = quad((-2.0, -2.0, 0.5), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0), 2)
    coats = [material(Glossy("GGX")), diffuse(0.0), material(Transparent(color(0.5)))]
    for blockers, screen, clear in ((FIRST, 3.0, 1.5), (SECOND, 0.0, 0.0), (0, 3.0, 3.0)):
        lamp = replace(AREA, links=Links(blockers=blockers))
        for more, shown in (([], screen), ([pane], clear)):
            mirror = linked(
                scene([floor(3.0), SCREEN, *more], coats, down, [lamp]), {}, {"blocker": 1}, *[{}] * len(more)
            )
            np.testing.assert_allclose(replicates(mirror, 2, 16, seed=seed), shown, rtol=1e-9)


def test_faces_shine_through_what_does_not_block_them(seed):
    """As if the screen, which is black, were not there."""
    coats = [diffuse(0.5), emission(3.0), diffuse(0.0)]
    screen = quad((-2.0, -2.0, 1.2), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0), 2)
    free = linked(scene([floor(3.0), PANEL], coats, CAMERA_AT), {}, UNSEEN)
    glow = {"links": Links(blockers=FIRST), **UNSEEN}
    screened = linked(scene([floor(3.0), PANEL, screen], coats, CAMERA_AT), {}, glow, {"blocker": 1, **UNSEEN})
    images = [replicates(one, 12, 512, seed=seed + k) for k, one in enumerate((screened, free))]
    assert_same(*images, 0.03)


def test_light_tracing_refuses_linked_lights():
    for links, what in ((Links(receivers=FIRST), "light linking"), (Links(blockers=FIRST), "shadow linking")):
        lit = scene(floor(), material(Diffuse(color(0.5))), CAMERA_AT, [replace(AREA, links=links)], bounces=2)
        with pytest.raises(EtalonError, match=f"the scene: {what} by light tracing is not simulated"):
            LightTracingRenderer(lit, Options())


def test_linked_faces_beside_a_mirror_are_refused_without_blender_too():
    def room(alpha):
        parts, coats = [floor(3.0), PANEL], [glossy(alpha), emission(3.0)]
        return linked(scene(parts, coats, CAMERA_AT), {}, {"links": Links(blockers=SECOND)})

    ReferenceRenderer(room(0.5))
    with pytest.raises(Refused, match="shadow linking of its faces beside the smooth material"):
        ReferenceRenderer(room(0.0))
