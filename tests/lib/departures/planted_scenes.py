# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes in which departures are planted, and comparisons of them."""

import functools
from dataclasses import replace

import numpy as np
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.comparison.departures import Alternatives, alternatives
from etalon.lib.scene.converters import Curve, Curves
from etalon.lib.scene.expressions import (
    ONE,
    WHITE,
    ColorRamp,
    Constant,
    Coordinates,
    ImageTexture,
    LayerWeight,
    Math,
    SurfaceNormal,
    ValueToColor,
)
from etalon.lib.scene.images import Image
from etalon.lib.scene.layers import BeneathLayer
from etalon.lib.scene.lights import AreaLight, SunLight
from etalon.lib.scene.materials import Diffuse, Emission, Glass, Material, Metallic, Subsurface, WeightedClosure
from etalon.lib.scene.motion import Motion
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests import scenes
from scipy.spatial.transform import Rotation

ANGLES = np.radians([64.0, 78.0, 87.1])


# Most are done after 27; where the difference is not much more than the tolerance its share takes longer.
REPLICATES = 62


def furnace():
    """A white world over facets that do not see each other.

    The middle ones mirror a sun to the camera.
    """
    inside = (0.2, 0.2, 0.2, 1.0), (0.9, 0.9, 0.9, 1.0)
    ramp = ColorRamp(LayerWeight(Constant(0.5), output="FACING"), (0.5610, 0.5620), inside)
    checker = np.ones((2, 2, 4), np.float32)
    checker[[0, 1], [0, 1], :3] = 0.6
    materials = [
        scenes.glossy(0.36, distribution="BECKMANN"),
        scenes.glossy(0.21**2, 0.9, distribution="MULTI_GGX"),
        scenes.diffuse(0.8, 0.6, 0.4, roughness=1.0),
        scenes.material(Diffuse(ramp)),
        scenes.material(Diffuse(ImageTexture(Coordinates("POSITION"), 0))),
        Material("coated", (WeightedClosure(Diffuse(), BeneathLayer(Constant(1.5), WHITE, Constant(0.6), ONE)),)),
    ]
    twice = 2.0 * ANGLES[1]
    sun = SunLight("sun", (np.sin(twice), 0.0, np.cos(twice)), 0.0, (0.5, 0.5, 0.5))
    count = len(materials)
    geometry, camera = scenes.fan(ANGLES, count), scenes.fan_camera(ANGLES, count)
    scene = scenes.scene(geometry, materials, camera, (sun,), 1.0, images=(Image("checker", checker, "SRGB"),))
    return replace(scene, blender=(5, 2))


def coats():
    """A rough coat over a white base, and a layer that is no coat, in a white world.

    They are as Blender 5.3 has them.
    """
    coat = BeneathLayer(Constant(1.5), WHITE, Constant(0.8), ONE, "MULTI_GGX", coat=True)
    layer = BeneathLayer(Constant(1.5), WHITE, Constant(0.6), ONE)
    materials = [
        Material(name, (WeightedClosure(Diffuse(), node),)) for name, node in (("coat", coat), ("layer", layer))
    ]
    scene = scenes.scene(scenes.fan(ANGLES, 2), materials, scenes.fan_camera(ANGLES, 2), world=1.0)
    return replace(scene, blender=(5, 3))


def early():
    """A rough diffuse floor under a sun, as Blender 4.2 has it."""
    sun = SunLight("sun", (0.0, 0.6, 0.8), 0.0, (1.0, 1.0, 1.0))
    camera = scenes.orthographic(2, 2, 1.0, (0.0, 0.0, 5.0))
    scene = scenes.scene(scenes.floor(), scenes.diffuse(0.8, 0.6, 0.4, roughness=1.0), camera, (sun,))
    return replace(scene, blender=(4, 2))


def halves():
    """Two flat floors side by side, in materials 0 and 1."""
    return [scenes.quad((x, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), k) for k, x in enumerate((-2.0, 0.0))]


def under_two_suns(parts, materials):
    """A scene under a sun below the faces and one above them, as Blender 5.2 has it."""
    suns = [((np.cos(0.2), 0.0, -np.sin(0.2)), 0.05), ((0.0, 0.6, 0.8), 0.0)]
    suns = [SunLight(f"sun {k}", place, angle, (1.0, 1.0, 1.0)) for k, (place, angle) in enumerate(suns)]
    camera = scenes.orthographic(4, 2, 4.0, (0.0, 0.0, 5.0))
    return replace(scenes.scene(parts, materials, camera, suns), blender=(5, 2))


LEANING = (np.sin(0.5), 0.0, np.cos(0.5))


def slope():
    """Two floors under two suns.

    One is smooth, under a sun below its face but above its normals, the other rough.
    """
    smooth, rough = halves()
    normals = np.repeat(np.array(LEANING)[:, None], 4, axis=1)
    smooth = scenes.Part(smooth.vertices, smooth.triangles, 0, normals)
    return under_two_suns([smooth, rough], [scenes.diffuse(0.8), scenes.diffuse(0.8, 0.6, 0.4, roughness=1.0)])


def raised():
    """Two flat floors whose normals lean towards a sun below their faces.

    A displacement leans those of the first, and a normal map those of the other.
    """
    normals = SurfaceNormal(Constant(LEANING)), Constant(LEANING)
    return under_two_suns(halves(), [scenes.material(Diffuse(scenes.color(0.8), normal=n)) for n in normals])


def soft_box():
    """A floor under an area light whose slats let hardly anything pass aside."""
    edges = (3.0, 0.0, 0.0), (0.0, 3.0, 0.0)
    light = AreaLight("narrow", (0.0, 0.0, 4.0), *edges, (0.0, 0.0, -1.0), "RECTANGLE", (1.0, 1.0, 1.0), 0.1)
    camera = scenes.orthographic(2, 2, 1.0, (0.0, 0.0, 3.0))
    scene = scenes.scene(scenes.floor(), scenes.diffuse(0.8, 0.6, 0.4, roughness=1.0), camera, (light,))
    return replace(scene, blender=(5, 2))


def documents():
    """Rough facets in a white world.

    The reference masks them as the documents do, each direction by itself.
    """
    return scenes.scene(scenes.fan(ANGLES[1:]), scenes.glossy(0.6, 0.9), scenes.fan_camera(ANGLES[1:]), world=1.0)


def phong():
    """Facets by Ashikhmin and Shirley under grazing angles in a white world.

    Rough facets stand beside them.
    """
    materials = [scenes.glossy(0.7**2, 0.9, distribution="ASHIKHMIN_SHIRLEY"), scenes.glossy(0.6, 0.9)]
    return scenes.scene(scenes.fan(ANGLES, 2), materials, scenes.fan_camera(ANGLES, 2), world=1.0)


def window():
    """Rough glass, and a steep rough face without it.

    The sun is below the glass: only facets whose backs it sees refract it to the camera.
    """
    low, steep = 0.2, np.radians(85.0)
    parts = [
        scenes.quad((-2.0, -1.0, 0.0), (2.0, 0.0, 2.0 * np.tan(low)), (0.0, 2.0, 0.0), 0),
        scenes.quad((0.0, -1.0, 0.0), (2.0, 0.0, -2.0 * np.tan(steep)), (0.0, 2.0, 0.0), 1),
    ]
    glass = Material("glass", (WeightedClosure(Glass(distribution="GGX", roughness=Constant(0.8), ior=Constant(1.5))),))
    sun = SunLight("sun", (-0.9, 0.0, -0.436), 0.0, (10.0, 10.0, 10.0))
    camera = scenes.orthographic(4, 2, 4.0, (0.0, 0.0, 5.0))
    return scenes.scene(parts, [glass, scenes.glossy(0.6, 0.9)], camera, (sun,), 1.0)


def prism():
    """Dispersive glass that mirrors a lamp above the camera and swallows what it refracts."""
    parts = [scenes.floor(5.0), scenes.floor(50.0, 9.0, 1)]
    glass = scenes.material(Glass(ior=Constant(1.5), dispersion=Constant(1.0 / 3.0), transmission=scenes.color(0.0)))
    camera = scenes.orthographic(2, 1, 1.0, (0.1, 0.0, 5.0))
    return scenes.scene(parts, [glass, scenes.emission(10.0)], camera)


def films():
    """A film on a steep metal, and one on glass seen from behind, in a white world.

    What glass refracts is swallowed.
    """
    eta, k = (Constant((value,) * 3) for value in (1.5, 1.8))
    film = {"film_thickness": Constant(60.0), "film_ior": Constant(1.33)}
    metal = scenes.material(Metallic("GGX", "CONDUCTOR", eta, k, Constant(0.1), **film))
    film = {"film_thickness": Constant(20.0), "film_ior": Constant(2.0)}
    glass = scenes.material(Glass(ior=Constant(1.5), roughness=Constant(0.1), transmission=scenes.color(0.0), **film))
    parts = [
        scenes.quad((-2.0, -1.0, 0.0), (2.0, 0.0, -2.0 * np.tan(ANGLES[1])), (0.0, 2.0, 0.0), 0),
        scenes.quad((0.0, -1.0, 0.0), (0.0, 2.0, 0.0), (2.0, 0.0, 0.0), 1),
    ]
    made = scenes.scene(parts, [metal, glass], scenes.orthographic(4, 2, 4.0, (0.0, 0.0, 20.0)), world=1.0)
    return replace(made, blender=(5, 3))


def curved():
    """Facets whose colour a curve makes of values above its end.

    Its handle falls there and its table is flat.
    """
    curve = Curve(0.0, 1.0, (0.2, *(0.9,) * 256), (0.2, 0.0), (0.9, -0.8))
    facing = Math("ADD", LayerWeight(Constant(0.5), output="FACING"), ONE, Constant(0.0))
    materials = scenes.material(Diffuse(Curves(ONE, ValueToColor(facing), (curve,) * 3)))
    return scenes.scene(scenes.fan(ANGLES), materials, scenes.fan_camera(ANGLES), world=1.0)


def decal():
    """A texture of uniform texels that cover half of what they lie on.

    It shines, and it is a diffuse floor under a sun.
    """
    parts = [scenes.quad((x, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), k) for k, x in enumerate((-2.0, 0.0))]
    texture = ImageTexture(Coordinates("POSITION"), 0, interpolation="CLOSEST", association="MULTIPLIED")
    materials = [scenes.material(Emission(texture)), scenes.material(Diffuse(texture))]
    sun = SunLight("sun", (0.0, 0.6, 0.8), 0.0, (1.0, 1.0, 1.0))
    images = (Image("decal", np.tile(np.array([0.6, 0.7, 0.8, 0.5], np.float32), (2, 2, 1)), "SRGB"),)
    return scenes.scene(parts, materials, scenes.orthographic(4, 2, 4.0, (0.0, 0.0, 5.0)), (sun,), images=images)


def rug():
    """On the left a floor and its copy under a sun.

    On the right two panels in one plane that shine differently.
    """
    left, right = (scenes.quad((x, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0)) for x in (-2.0, 0.0))
    parts = [left, left, replace(right, material=1), replace(right, material=2)]
    sun = SunLight("sun", (0.0, 0.6, 0.8), 0.0, (1.0, 1.0, 1.0))
    materials = [scenes.diffuse(0.8, 0.6, 0.4), scenes.emission(0.2), scenes.emission(0.3)]
    return scenes.scene(parts, materials, scenes.orthographic(4, 2, 4.0, (0.0, 0.0, 5.0)), (sun,))


def turned_rug():
    """A floor and its copy, in no plane along two axes, under a sun."""
    turn = Rotation.from_rotvec((0.5, 0.2, 0.1))
    floor = scenes.floor(3.0)
    floor = replace(floor, vertices=turn.apply(floor.vertices.T).T)
    sun = SunLight("sun", tuple(turn.apply((0.0, 0.6, 0.8))), 0.0, (1.0, 1.0, 1.0))
    camera = scenes.orthographic(2, 2, 2.0, (0.0, 0.0, 5.0))
    return scenes.scene([floor, floor], scenes.diffuse(0.8, 0.6, 0.4), camera, (sun,))


def panels():
    """A floor under two area lights, of which one covers a half of the other in its plane."""
    first = AreaLight(
        "first", (0.0, 0.0, 2.0), (2.0, 0.0, 0.0), (0.0, -2.0, 0.0), (0.0, 0.0, -1.0), "RECTANGLE", (1.0,) * 3, np.pi
    )
    lights = first, replace(first, name="second", center=(1.0, 0.0, 2.0), radiance=(2.0, 1.0, 1.0))
    camera = scenes.orthographic(2, 2, 2.0, (0.0, 0.0, 1.0))
    return scenes.scene(scenes.floor(), scenes.diffuse(0.8, 0.6, 0.4), camera, lights)


def wax():
    """A thick bright body that light scatters inside of, in a white world."""
    coat = scenes.material(Subsurface(scenes.color(0.95), scenes.color(0.05), Constant(0.5)))
    return scenes.scene(scenes.cube(), coat, scenes.orthographic(1, 1, 0.5, (0.0, 0.0, 5.0)), world=1.0)


def trail():
    """The edge of a surface that glows, which moves over the image while the shutter is open."""
    moved = np.array([np.eye(4)[:3], np.eye(4)[:3]])
    moved[1, 0, 3] = 4.0
    scene = scenes.scene(
        scenes.quad((-9, -9, 0), (7, 0, 0), (0, 18, 0)),
        scenes.emission(1.0),
        # Few samples fall within the ends of the shutter, so there are many pixels.
        scenes.orthographic(64, 16, 4.0, (0.0, 0.0, 5.0)),
    )
    return replace(scene, motion=Motion(objects={0: moved}))


class Cached:
    """A renderer that remembers its replicates, so that cases share what they have in common."""

    settings: dict = {}  # noqa: RUF012

    def __init__(self, name, renderer):
        self.name, self._renderer, self._done = name, renderer, {}

    def render(self, replicate, samples, progress, windows=None):
        key = replicate, samples
        if key not in self._done:
            self._done[key] = self._renderer.render(replicate, samples)
        return replace(self._done[key], windows=windows)


@functools.cache
def prepared(make):
    """The scene, its reference, and what may depart, all with remembered replicates."""
    scene = make()
    reference = ReferenceRenderer(scene, Options(threads=1, masking=masking(make)))
    found = alternatives(reference)
    renderer = functools.cache(lambda names: Cached("alternative", found.renderer(names)))
    return scene, Cached("reference", reference), Alternatives(found.departures, renderer)


# Scene: tolerance, samples per pixel, and the cells that are too noisy to tell anything.
SCENES = {
    furnace: (1.5e-3, 1024, {3, 8}),
    slope: (1e-2, 128, set()),
    raised: (1e-2, 128, set()),
    soft_box: (3e-4, 4096, set()),
    documents: (5e-3, 512, set()),
    phong: (1e-2, 512, set()),
    window: (2e-2, 4096, set()),
    coats: (3e-3, 1024, set()),
    early: (5e-3, 64, set()),
    prism: (2e-2, 512, set()),
    films: (5e-3, 1024, set()),
    curved: (5e-3, 64, set()),
    rug: (1e-2, 64, set()),
    turned_rug: (5e-2, 8192, set()),
    panels: (1e-2, 256, set()),
    decal: (1e-2, 64, set()),
    wax: (1e-2, 256, set()),
    trail: (1e-2, 64, set()),
}


def masking(make):
    """The reference's form of it."""
    return "separable" if make is documents else "correlated"


def cells(make):
    """Every pixel as a region of its own."""
    camera = prepared(make)[0].camera
    shape = camera.height, camera.width
    told = [k for k in range(shape[0] * shape[1]) if k not in SCENES[make][2]]
    return {"cell": [(f"{k}", np.eye(shape[0] * shape[1])[k].reshape(shape)) for k in told]}


def judged(make, candidate):
    scene, reference, among = prepared(make)
    tolerance, samples, _ = SCENES[make]
    options = CompareOptions(tolerance, time=None, samples=samples, replicates=REPLICATES)
    return compare(scene, reference, candidate, cells(make), options, among=among)


def planted(make, names, seed):
    scene, _, _ = prepared(make)
    options = Options(threads=1, seed=seed, masking=masking(make), departures=frozenset(names))
    return Cached("candidate", ReferenceRenderer(scene, options))
