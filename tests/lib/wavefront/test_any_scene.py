# SPDX-License-Identifier: GPL-3.0-or-later
"""Any scene that keeps its rules gives a finite, non-negative film.

Any that does not gives an error that names the defect.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.effects.facts import Facts
from etalon.lib.errors import Refused, SceneError
from etalon.lib.scattering.subsurface import MAPPINGS
from etalon.lib.scene.camera import PANORAMAS, Aperture, Camera
from etalon.lib.scene.checks import validate
from etalon.lib.scene.expressions import Constant, Coordinates, EnvironmentTexture, ImageTexture
from etalon.lib.scene.images import Image
from etalon.lib.scene.lights import AreaLight, Cone, PointLight, SphereLight, SpotLight, SunLight
from etalon.lib.scene.links import EVERY_SET, Links
from etalon.lib.scene.materials import (
    Diffuse,
    Emission,
    Glass,
    Glossy,
    Material,
    Metallic,
    Refraction,
    Specular,
    Subsurface,
    Translucent,
    Transparent,
    WeightedClosure,
)
from etalon.lib.scene.mesh import Mesh, Object
from etalon.lib.scene.rays import EVERY, SCATTERED, SHADOW
from etalon.lib.scene.scene import Scene, Transport
from etalon.lib.scene.world import World
from etalon.lib.settings.reference import STRATEGIES, Options
from etalon.lib.wavefront.refuse import refuse_linked_faces
from etalon.lib.wavefront.render import ReferenceRenderer
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

KEPT = {
    "deadline": None,
    "derandomize": True,
    "database": None,
    "suppress_health_check": [HealthCheck.too_slow, HealthCheck.data_too_large],
}
shares = st.one_of(st.sampled_from([0.0, 1e-8, 1e-3, 0.5, 1.0]), st.floats(0.0, 1.0))
values = shares.map(Constant)
colors = st.tuples(shares, shares, shares).map(Constant)
radii = st.tuples(*[st.sampled_from([0.0, 1.0, 1e3])] * 3).map(Constant)
bright = st.tuples(*[st.one_of(st.sampled_from([0.0, 1.0, 1e6]), st.floats(0.0, 1e4))] * 3)
coordinates = st.one_of(st.sampled_from([0.0, 1.0, -1.0, 1e-6, 1e3]), st.floats(-4.0, 4.0))
points = st.tuples(coordinates, coordinates, coordinates)
distributions = st.sampled_from(["GGX", "BECKMANN", "MULTI_GGX", "ASHIKHMIN_SHIRLEY"])
smooth_or_rough = st.sampled_from(["GGX", "BECKMANN"])
indices = st.sampled_from([1.0, 1.0 + 1e-6, 1.0 - 1e-8, 1.45, 0.7, 20.0]).map(Constant)
textured = st.one_of(colors, st.just(ImageTexture(Coordinates("POSITION"), 0)))


@st.composite
def directions(draw):
    v = np.array(draw(points)) + np.array([0.0, 0.0, 1e-3])
    length = np.linalg.norm(v)
    return tuple(v / length) if length > 1e-9 else (0.0, 0.0, 1.0)


closures = st.one_of(
    st.builds(Diffuse, textured, values),
    st.builds(Glossy, distributions, textured, values, st.sampled_from([0.0, 0.99, -1.0, 2.0]).map(Constant), values),
    st.builds(Metallic, smooth_or_rough, st.just("F82"), colors, colors, values),
    st.builds(Specular, smooth_or_rough, indices, colors, values),
    st.builds(Glass, colors, indices, values, smooth_or_rough),
    st.builds(Refraction, colors, indices, values, smooth_or_rough),
    st.builds(Transparent, colors),
    st.builds(Translucent, colors),
    st.builds(Subsurface, colors, radii, values, indices, values, st.sampled_from(MAPPINGS), st.booleans()),
    st.builds(Emission, colors, st.sampled_from([0.0, 1.0, 1e5]).map(Constant)),
)
materials = st.lists(st.builds(WeightedClosure, closures, values), max_size=3).map(
    lambda lobes: Material("m", tuple(lobes))
)
masks = st.one_of(st.sampled_from([EVERY, SCATTERED, EVERY & ~SHADOW]), st.integers(0, EVERY))

links = st.builds(Links, *[st.sampled_from([EVERY_SET, 0, 1, 2])] * 2)


@st.composite
def meshes(draw, count):
    """Vertices on few places, so that triangles share, repeat and degenerate.

    At any scale, anywhere.
    """
    v = draw(st.sampled_from([0, 3, 5, 12]))
    t = draw(st.integers(0, 14)) if v else 0
    places = np.array(draw(st.lists(points, min_size=v, max_size=v))).reshape(v, 3).T
    scale = 10.0 ** draw(st.integers(-6, 6))
    offset = np.array(draw(points)) * draw(st.sampled_from([0.0, 1.0, 1e5]))
    corners = draw(st.lists(st.tuples(*[st.integers(0, max(v - 1, 0))] * 3), min_size=t, max_size=t))
    smooth = np.array(draw(st.lists(st.booleans(), min_size=t, max_size=t)), bool)
    normals = np.zeros((3, 3, 0), np.float32)
    if smooth.any():
        normals = np.array(draw(st.lists(directions(), min_size=3 * t, max_size=3 * t)), np.float32)
        normals = np.ascontiguousarray(normals.reshape(t, 3, 3).transpose(1, 2, 0))
    index = np.array(draw(st.lists(st.integers(0, count - 1), min_size=t, max_size=t)), np.int32)
    mesh = Mesh(
        vertices=places * scale + offset[:, None],
        triangles=np.array(corners, np.int32).reshape(t, 3).T.copy(),
        material_index=index,
        object_index=np.zeros(t, np.int32),
        smooth=smooth,
        corner_normals=normals,
        objects=(
            Object(
                "thing",
                np.eye(4)[:3],
                rays=draw(masks),
                receiver=draw(st.integers(0, 1)),
                blocker=draw(st.integers(0, 1)),
                links=draw(links),
            ),
        ),
        generated=places,
    )
    return mesh, scale, offset


@st.composite
def lights(draw, scale, offset):
    at = tuple(np.array(draw(points)) * scale + offset)
    kind = draw(st.sampled_from(["point", "sphere", "spot", "sun", "area"]))
    strength = draw(bright)
    radius = scale * draw(st.sampled_from([1e-9, 0.1, 3.0]))
    switches = {
        "rays": draw(masks),
        "casts_shadow": draw(st.booleans()),
        "max_bounces": draw(st.integers(0, 4)),
        "links": draw(links),
    }
    if kind == "point":
        return PointLight("light", at, strength, **switches)
    if kind == "sphere":
        return SphereLight("light", at, radius, strength, **switches)
    if kind == "spot":
        half = draw(st.sampled_from([1e-3, 0.5, 0.5 * math.pi]))
        cone = Cone((0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), math.cos(half), draw(shares))
        return SpotLight("light", at, draw(st.sampled_from([0.0, radius])), strength, cone, **switches)
    if kind == "sun":
        angle = draw(st.sampled_from([0.0, 1e-6, 0.3, 0.5 * math.pi]))
        return SunLight("light", draw(directions()), angle, strength, **switches)
    size = scale * draw(st.sampled_from([1e-6, 1.0, 50.0]))
    skew = scale * draw(st.sampled_from([0.0, 0.3]))
    shape, spread = draw(st.sampled_from(["RECTANGLE", "ELLIPSE"])), draw(st.sampled_from([1e-3, 1.0, math.pi]))
    return AreaLight(
        "light", at, (size, 0.0, 0.0), (skew, size, 0.0), (0.0, 0.0, 1.0), shape, strength, spread, **switches
    )


@st.composite
def cameras(draw, scale, offset):
    from etalon.tests.scenes import axes

    away = np.array(draw(points)) * scale
    eye = away + offset
    looks_home = draw(st.booleans()) and np.linalg.norm(away) > 1e-3 * scale
    forward = tuple(-away / np.linalg.norm(away)) if looks_home else draw(directions())
    kind = draw(st.sampled_from(["PERSPECTIVE", "ORTHOGRAPHIC", *PANORAMAS]))
    step = draw(st.sampled_from([1e-6, 0.3])) * (scale if kind == "ORTHOGRAPHIC" else 1.0)
    plane = np.array([[step, 0.0, -1.5 * step], [0.0, step, -1.5 * step]])
    aperture = None
    if draw(st.booleans()):
        blades = draw(st.sampled_from([0, 3, 7]))
        aperture = Aperture(
            0.1 * scale, blades, 0.2, draw(st.sampled_from([0.5, 1.0, 2.0])), scale * draw(st.sampled_from([1e-3, 3.0]))
        )
    to_world = np.concatenate([axes(forward), eye[:, None]], axis=1)
    near, field = draw(st.sampled_from([0.0, 0.1 * scale])), draw(st.sampled_from([0.5, 2.0 * np.pi]))
    polynomial = (0.0, 1.0, 0.1, 0.0, 0.0) if kind == "FISHEYE_LENS_POLYNOMIAL" else ()
    return Camera(kind, 3, 3, plane, to_world, near, 1e9 * scale, aperture, field, polynomial)


@st.composite
def image(draw, name, values):
    texels = np.array(draw(st.lists(st.sampled_from(values), min_size=16, max_size=16)), np.float32)
    return Image(name, texels.reshape(2, 2, 4), draw(st.sampled_from(["LINEAR", "DATA"])))


@st.composite
def scenes(draw):
    coats = tuple(draw(st.lists(materials, min_size=1, max_size=3)))
    mesh, scale, offset = draw(meshes(len(coats)))
    several = tuple(draw(st.lists(lights(scale, offset), max_size=3)))
    # Light that a rough surface gives back more than once has no sum for colours far above 1, and is NaN: those are for the sky.
    images = tuple(
        draw(image(name, values)) for name, values in (("color", [0.0, 0.5, 1.0]), ("sky", [0.0, 0.5, 1.0, 1e6]))
    )
    sky = draw(st.one_of(colors, st.just(EnvironmentTexture(Coordinates("GENERATED"), 1))))
    transport = Transport(draw(st.integers(0, 4)), draw(st.integers(0, 3)))
    world, camera = World(sky, (8, 4), draw(masks)), draw(cameras(scale, offset))
    found = Scene("any", mesh, coats, several, world, camera, transport, images)
    return found if is_simulated(found) else replace(found, mesh=without_blockers(mesh))


def is_simulated(scene):
    try:
        refuse_linked_faces(Facts(scene))
    except Refused:
        return False
    return True


def without_blockers(mesh):
    """The mesh, whose faces' light every object hides."""
    return replace(mesh, objects=tuple(replace(one, links=Links(one.links.receivers)) for one in mesh.objects))


def assert_film(scene, strategy):
    renderer = ReferenceRenderer(scene, Options(threads=1, strategy=strategy))
    rendering = renderer.render(0, 4)
    assert np.isfinite(rendering.radiance).all()
    assert (rendering.radiance >= 0.0).all()
    assert not rendering.nonfinite.any()


@settings(max_examples=25, **KEPT)
@given(scenes(), st.sampled_from(STRATEGIES))
def test_any_valid_scene_gives_a_finite_film(scene, strategy):
    validate(scene)
    assert_film(scene, strategy)


@pytest.mark.slow
@settings(max_examples=250, **KEPT)
@given(scenes(), st.sampled_from(STRATEGIES))
def test_any_of_many_valid_scenes_gives_a_finite_film(scene, strategy):
    validate(scene)
    assert_film(scene, strategy)


BAD_NUMBERS = st.sampled_from([np.nan, np.inf, -np.inf])


@st.composite
def broken(draw):
    """A scene with one rule broken, and whose rule it is."""
    scene = draw(scenes().filter(lambda scene: scene.mesh.triangle_count > 0))
    mesh, camera, bad = scene.mesh, scene.camera, draw(BAD_NUMBERS)
    kind = draw(
        st.sampled_from(
            ["vertex", "corner", "material", "object", "shape", "dtype", "camera", "raster", "light", "color"]
        )
    )
    k = draw(st.integers(0, mesh.triangle_count - 1))
    if kind == "vertex":
        vertices = mesh.vertices.copy()
        vertices[draw(st.integers(0, 2)), mesh.triangles[0, k]] = bad
        return replace(scene, mesh=replace(mesh, vertices=vertices)), "thing"
    if kind == "corner":
        triangles = mesh.triangles.copy()
        triangles[draw(st.integers(0, 2)), k] = draw(st.sampled_from([-1, mesh.vertices.shape[1], 2**31 - 1]))
        return replace(scene, mesh=replace(mesh, triangles=triangles)), "mesh"
    if kind in ("material", "object"):
        name = f"{kind}_index"
        index = getattr(mesh, name).copy()
        index[k] = draw(st.sampled_from([-1, 99]))
        return replace(scene, mesh=replace(mesh, **{name: index})), "mesh"
    if kind == "shape":
        return replace(scene, mesh=replace(mesh, smooth=mesh.smooth[:-1])), "mesh"
    if kind == "dtype":
        return replace(scene, mesh=replace(mesh, material_index=mesh.material_index.astype(float))), "mesh"
    if kind == "camera":
        pose = camera.world_from_camera.copy()
        pose[draw(st.integers(0, 2)), draw(st.integers(0, 3))] = bad
        return replace(scene, camera=replace(camera, world_from_camera=pose)), "camera"
    if kind == "raster":
        return replace(scene, camera=replace(camera, plane_from_raster=np.zeros((2, 3)))), "camera"
    if kind == "light":
        light = PointLight("lamp", (0.0, 0.0, 1.0), (1.0, draw(st.sampled_from([-1.0, np.nan, np.inf])), 1.0))
        return replace(scene, lights=(*scene.lights, light)), "lamp"
    coat = Material("coat", (WeightedClosure(Diffuse(Constant((0.5, float(bad), 0.5)))),))
    return replace(scene, materials=(*scene.materials, coat)), "coat"


def assert_refused(scene, owner):
    with pytest.raises(SceneError, match=owner):
        validate(scene)


@settings(max_examples=20, **KEPT)
@given(broken())
def test_any_broken_scene_gives_an_error_that_names_it(case):
    assert_refused(*case)


@pytest.mark.slow
@settings(max_examples=60, **KEPT)
@given(broken())
def test_any_of_many_broken_scenes_gives_an_error_that_names_it(case):
    assert_refused(*case)
