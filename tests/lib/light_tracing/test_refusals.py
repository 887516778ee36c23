# SPDX-License-Identifier: GPL-3.0-or-later
"""What light tracing does not simulate is refused by name, with a remedy."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import EtalonError, Refused
from etalon.lib.light_tracing.render import LightTracingRenderer
from etalon.lib.light_tracing.scouting import scout_caustics
from etalon.lib.rendering.replicates import render_film
from etalon.lib.scene.expressions import Constant, Coordinates, VectorToValue
from etalon.lib.scene.lights import Falloff, PointLight, SphereLight
from etalon.lib.scene.materials import Glass, Glossy, Material, Sheen, Subsurface, Toon
from etalon.lib.settings.comparison import Settings
from etalon.lib.settings.reference import Options, RenderOptions
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.lib.light_tracing.traced import CAMERA, MATERIALS, ball_on_floor
from etalon.tests.scenes import color, diffuse, material

PANORAMA = replace(CAMERA, kind="EQUIRECTANGULAR")


def tilted():
    return material(Glossy("GGX", color(0.8), normal=Constant((0.0, 0.6, 0.8))), name="Bumpy")


REFUSED = {
    "camera: light tracing to a panoramic camera": ball_on_floor(MATERIALS["diffuse"], camera=PANORAMA),
    "material 'Worn': .* textured roughness": ball_on_floor(
        material(Glossy("GGX", color(0.8), VectorToValue(Coordinates("POSITION"))), name="Worn")
    ),
    "material 'Bumpy': .* smooth lobe under a normal map": ball_on_floor(tilted()),
    "material 'Paint': .* Toon BSDF": ball_on_floor(material(Toon(), name="Paint")),
    "material 'Wax': subsurface scattering": ball_on_floor(material(Subsurface(), name="Wax")),
    "material 'Dust': .* sheen whose roughness may be below 0.15": ball_on_floor(
        material(Sheen(roughness=Constant(0.1)), name="Dust")
    ),
    "material 'Hair': a node is not simulated": ball_on_floor(Material("Hair", (), "a node")),
    "scene: dispersion": ball_on_floor(material(Glass(color(1.0), Constant(1.5), dispersion=Constant(0.02)))),
    "scene: light tracing of lights that do not fall off as usual": ball_on_floor(
        diffuse(0.5), [PointLight("lamp", (0.0, 0.0, 3.0), (1.0, 1.0, 1.0), falloff=Falloff(1))]
    ),
    "light 'lamp': .* faces inside it": ball_on_floor(
        diffuse(0.5), [SphereLight("lamp", (0.0, 0.0, 0.15), 0.2, (1.0, 1.0, 1.0))]
    ),
}


@pytest.mark.parametrize("text", REFUSED)
def test_it_is_refused_by_name(text):
    with pytest.raises(Refused, match=text) as caught:
        LightTracingRenderer(REFUSED[text], Options())
    assert "render with a strategy of path tracing" in str(caught.value)


def test_departures_are_refused():
    with pytest.raises(EtalonError, match="leave out --depart"):
        LightTracingRenderer(
            ball_on_floor(MATERIALS["rough_glass"]), Options(departures=frozenset({"refraction from behind"}))
        )


def test_a_face_that_only_touches_the_bounds_of_a_sphere_light_is_not_inside():
    lamp = SphereLight("lamp", (3.8, 3.8, 0.25), 0.2, (1.0, 1.0, 1.0))
    assert LightTracingRenderer(ball_on_floor(diffuse(0.5), [lamp]), Options()).scene.lights == (lamp,)


def test_comparisons_do_not_take_light_tracing():
    with pytest.raises(EtalonError, match="unknown strategy 'light-tracing'"):
        Settings(strategy="light-tracing")


def test_panoramas_are_not_scouted():
    kernel = ReferenceRenderer(REFUSED["camera: light tracing to a panoramic camera"]).kernel
    with pytest.raises(EtalonError, match="panoramic camera cannot be scouted"):
        scout_caustics(kernel)


def test_the_strategy_renders_by_light_tracing():
    the_scene = ball_on_floor(MATERIALS["glossy"])
    options = RenderOptions(strategy="light-tracing", samples=16, replicates=2, threads=1)
    film = render_film(the_scene, options)
    renderer = LightTracingRenderer(the_scene, Options(threads=1))
    expected = np.mean([renderer.render(k, 16).radiance for k in range(2)], axis=0)
    np.testing.assert_allclose(film.moments.mean, expected, rtol=1e-12)
