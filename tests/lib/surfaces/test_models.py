# SPDX-License-Identifier: GPL-3.0-or-later
"""Another model in place of Glossy nodes.

Tested are which lobes it reaches, and that the picture is the one of that model.
"""

import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.microfacets import fresnel
from etalon.lib.microfacets.student_t import StudentT
from etalon.lib.scene.expressions import Constant
from etalon.lib.scene.materials import Glossy, Metallic
from etalon.lib.settings.models import MODELS
from etalon.lib.settings.reference import Options
from etalon.lib.surfaces.models import _SHAPED, distribution_of, with_other_model
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import color, floor, material, orthographic, scene

ROUGH = Constant(0.6)
NEEDED = {"g": 2.5, "p": 0.8, "shift": 0.01, "b": 0.5}
TEXTS = [
    f"{name}:{','.join(f'{key}={NEEDED[key]}' for key in parameters if key in NEEDED)}".rstrip(":")
    for name, parameters in MODELS.items()
]


def plane(closure):
    """A plane in a white world, seen at 30 degrees from its face: its albedo."""
    return scene(floor(), material(closure), orthographic(2, 2, 0.1, (0.0, -5.0, 2.9), (0.0, 1.0, -0.577)), world=1.0)


def render(view, seed, samples=256, **options):
    return ReferenceRenderer(view, Options(threads=1, seed=seed, **options)).render(0, samples).radiance


def test_without_a_model_the_scene_is_the_one_it_was():
    view = plane(Glossy("GGX", roughness=ROUGH))
    assert with_other_model(view, Options()) is view


@pytest.mark.parametrize("closure", [Glossy("GGX", roughness=ROUGH), Glossy("BECKMANN", roughness=ROUGH)])
def test_every_model_makes_another_picture(closure, seed):
    images = {text: render(plane(closure), seed, model=text) for text in TEXTS}
    assert all(np.isfinite(image).all() and (image > 0.0).all() for image in images.values())
    same = {"lafortune", "modified-phong"}  # its usual coefficients
    np.testing.assert_array_equal(*(images.pop(text) for text in sorted(same)))
    assert len({image.tobytes() for image in images.values()}) == len(images)


def test_metals_keep_their_lobes(seed):
    view = plane(Metallic("GGX", roughness=ROUGH))
    np.testing.assert_array_equal(render(view, seed), render(view, seed, model="ward", fresnel="schlick"))


def test_the_models_of_blenders_own_are_those_of_the_nodes(seed):
    for text, name in (("ggx", "GGX"), ("beckmann", "BECKMANN"), ("ashikhmin-shirley", "ASHIKHMIN_SHIRLEY")):
        replaced = render(plane(Glossy("MULTI_GGX", roughness=ROUGH)), seed, model=text)
        np.testing.assert_array_equal(replaced, render(plane(Glossy(name, roughness=ROUGH)), seed))


def test_student_t_of_shape_2_makes_the_picture_of_ggx(seed):
    view = plane(Glossy("GGX", roughness=ROUGH))
    images = [render(view, seed, 4096, model=text) for text in ("ggx", "student-t:g=2")]
    np.testing.assert_allclose(images[0], images[1], rtol=5e-3)
    assert distribution_of("student-t:g=2.5") == StudentT(2.5)


@pytest.mark.parametrize(
    ("term", "expected"),
    [
        ("schlick", lambda c: fresnel.schlick(c, np.array([0.2, 0.5, 0.9]))),
        ("cook-torrance", lambda c: fresnel.cook_torrance(c, np.array([0.2, 0.5, 0.9]))),
        ("exact:ior=1.5", lambda c: fresnel.dielectric(c, 1.5) * np.array([0.2, 0.5, 0.9])),
        ("exact:ior=0.2,k=3", lambda c: fresnel.conductor(c, 0.2, 3.0) * np.array([0.2, 0.5, 0.9])),
    ],
)
def test_a_mirror_reflects_by_the_term(term, expected, seed):
    image = render(plane(Glossy("GGX", color=color(0.2, 0.5, 0.9))), seed, 4, fresnel=term)
    direction = np.array([0.0, 1.0, -0.577])
    cosine = 0.577 / np.sqrt((direction * direction).sum())
    np.testing.assert_allclose(image[0, 0], expected(np.array([cosine])), rtol=1e-6)


@pytest.mark.parametrize("term", ["schlick", "cook-torrance"])
def test_white_stays_white_under_multiple_scattering(term, seed):
    """A white surface of Multiscatter GGX reflects all light.

    It does with an approximation of Fresnel as without it.
    """
    image = render(plane(Glossy("MULTI_GGX", roughness=ROUGH)), seed, 4096, fresnel=term)
    np.testing.assert_allclose(image, 1.0, atol=0.02)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"model": "wrad"}, "unknown model 'wrad'; did you mean 'ward'"),
        ({"model": "student-t"}, "model: 'student-t' needs 'g'; write student-t:g=NUMBER"),
        (
            {"model": "student-t:g=1.5"},
            r"model: g = 1\.5 is out of range for 'student-t'; give more than 1\.5 and at most 10000",
        ),
        ({"model": "student-t:g=two"}, "model: 'g=two' is not a number for 'g'; write g=NUMBER"),
        ({"model": "ward:g=2"}, "model: 'ward' has no parameter 'g'; its parameters: none"),
        (
            {"model": "ward", "masking": "separable"},
            "--masking separable is for distributions of microfacets, and 'ward' has none",
        ),
        ({"model": "ward", "strategy": "d_cos"}, "--strategy d_cos is for distributions of microfacets"),
        ({"fresnel": "exact"}, "fresnel: 'exact' needs 'ior'; write exact:ior=NUMBER"),
        ({"fresnel": "exact:ior=nan"}, "fresnel: ior = nan is out of range"),
    ],
)
def test_what_is_no_model_is_refused_in_one_line(options, message):
    with pytest.raises(EtalonError, match=message):
        Options(**options)


@pytest.mark.parametrize(
    ("text", "key"),
    [("student-t", "g"), ("shifted-gamma", "p"), ("shifted-gamma", "shift"), ("exponential-power", "b")],
)
def test_the_option_and_the_distribution_agree_on_the_range_of_a_shape(text, key):
    usual = {name: NEEDED[name] for name in MODELS[text]}
    limits = MODELS[text][key]
    for value in (
        limits.low,
        np.nextafter(limits.low, -1.0),
        limits.high,
        np.nextafter(limits.high, 1e9),
        float("nan"),
    ):
        words = ",".join(f"{name}={one!r}" for name, one in {**usual, key: float(value)}.items())
        if limits.contains(float(value)):
            distribution_of(f"{text}:{words}")
        else:
            with pytest.raises(EtalonError, match="out of range"):
                _SHAPED[text](**{**usual, key: float(value)})
