# SPDX-License-Identifier: GPL-3.0-or-later
"""Irradiance from each kind of light, as Cycles has it on a white diffuse plane.

The scene is built from Blender's own numbers and the light from the conversion that its manual and our conventions state, so that
neither passes through the exporter. Ours is the mean over a 128 x 128 grid of uniforms; Cycles' the mean over 64 pixels of a patch of 1 mm.
"""

import math
import warnings

import numpy as np
import pytest
from etalon.lib.lights.build import light_sampler
from etalon.lib.scene.lights import AreaLight, Cone, PointLight, SphereLight, SpotLight, SunLight
from scipy import stats

pytestmark = pytest.mark.compares_with_cycles

bpy = pytest.importorskip("bpy")
oiio = pytest.importorskip("OpenImageIO")

PLACE = (0.3, -0.2, 1.0)
AXIS = np.array([0.0, -math.sin(0.3), -math.cos(0.3)])  # local -Z of a lamp turned by -0.3 about X
X = (1.0, 0.0, 0.0)
Y = (0.0, math.cos(0.3), -math.sin(0.3))
FLUX = np.array([1.0, 2.0, 0.5])


def gray(value):
    return tuple(FLUX * value)


def area(shape, spread, place=PLACE):
    size = math.pi / 4.0 if shape == "ELLIPSE" else 1.0
    edges = tuple(0.8 * c for c in X), tuple(0.5 * c for c in Y)
    return AreaLight("area", place, *edges, tuple(AXIS), shape, gray(1.0 / (math.pi * size * 0.4)), spread)


CONE = Cone(tuple(AXIS), X, Y, math.cos(0.6), 0.5)
SPHERE = 1.0 / (4.0 * math.pi**2)
CASES = {
    "point": (PointLight("", PLACE, gray(1.0 / (4.0 * math.pi))), "POINT", {"shadow_soft_size": 0.0}),
    "sphere": (
        SphereLight("", PLACE, 0.3, gray(SPHERE / 0.09)),
        "POINT",
        {"shadow_soft_size": 0.3, "use_soft_falloff": False},
    ),
    "sphere around": (
        SphereLight("", PLACE, 2.0, gray(SPHERE / 4.0)),
        "POINT",
        {"shadow_soft_size": 2.0, "use_soft_falloff": False},
    ),
    "spot": (
        SpotLight("", PLACE, 0.0, gray(1.0 / (4.0 * math.pi)), CONE),
        "SPOT",
        {"shadow_soft_size": 0.0, "spot_size": 1.2, "spot_blend": 0.5},
    ),
    "sphere spot": (
        SpotLight("", PLACE, 0.3, gray(SPHERE / 0.09), CONE),
        "SPOT",
        {"shadow_soft_size": 0.3, "use_soft_falloff": False, "spot_size": 1.2, "spot_blend": 0.5},
    ),
    "sun": (SunLight("", tuple(-AXIS), 0.2, gray(1.0)), "SUN", {"angle": 0.4}),
    "rectangle": (area("RECTANGLE", math.pi), "AREA", {"shape": "RECTANGLE", "size": 0.8, "size_y": 0.5}),
    "ellipse": (area("ELLIPSE", math.pi), "AREA", {"shape": "ELLIPSE", "size": 0.8, "size_y": 0.5}),
    "rectangle with spread": (
        area("RECTANGLE", 1.0),
        "AREA",
        {"shape": "RECTANGLE", "size": 0.8, "size_y": 0.5, "spread": 1.0},
    ),
    "ellipse with spread": (
        area("ELLIPSE", 1.0),
        "AREA",
        {"shape": "ELLIPSE", "size": 0.8, "size_y": 0.5, "spread": 1.0},
    ),
    "beam": (
        area("RECTANGLE", 0.0, (0.2, 0.3, 1.0)),
        "AREA",
        {"shape": "RECTANGLE", "size": 0.8, "size_y": 0.5, "spread": 0.0},
    ),
}


@pytest.fixture
def cycles(tmp_path):
    """Irradiance in the pixels of a 1 mm patch about the origin, (64, 3).

    It comes from one lamp over a white plane.
    """

    def render(kind, place, properties):
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        scene = bpy.context.scene
        scene.render.engine = "CYCLES"
        for owner, values in (
            (scene.cycles, {"samples": 1024, "use_adaptive_sampling": False, "use_denoising": False, "max_bounces": 0}),
            (scene.cycles, {"sample_clamp_indirect": 0.0, "pixel_filter_type": "BOX", "blur_glossy": 0.0}),
            (scene.render, {"resolution_x": 8, "resolution_y": 8, "threads_mode": "FIXED", "threads": 2}),
            (scene.render, {"filepath": str(tmp_path / "patch.exr")}),
            (scene.render.image_settings, {"file_format": "OPEN_EXR", "color_depth": "32"}),
        ):
            for name, value in values.items():
                setattr(owner, name, value)
        material = bpy.data.materials.new("white")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of use_nodes, to be removed in Blender 6.0
            material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        diffuse, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
        diffuse.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        material.node_tree.links.new(diffuse.outputs[0], output.inputs[0])
        mesh = bpy.data.meshes.new("plane")
        mesh.from_pydata([(-1.0, -1.0, 0.0), (1.0, -1.1, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)], [], [(0, 1, 2, 3)])
        mesh.materials.append(material)
        camera = bpy.data.cameras.new("camera")
        camera.type, camera.ortho_scale, camera.clip_start = "ORTHO", 1e-3, 1e-4
        lamp = bpy.data.lights.new("lamp", kind)
        lamp.energy, lamp.color = 2.0, FLUX / 2.0
        for name, value in properties.items():
            setattr(lamp, name, value)
        for data, location, turn in (
            (mesh, (0.0, 0.0, 0.0), 0.0),
            (camera, (0.0, 0.0, 0.01), 0.0),
            (lamp, place, -0.3),
        ):
            thing = bpy.data.objects.new(data.name, data)
            thing.location, thing.rotation_euler = location, (turn, 0.0, 0.0)
            scene.collection.objects.link(thing)
            if data == camera:
                scene.camera = thing
        bpy.ops.render.render(write_still=True)
        image = oiio.ImageInput.open(str(tmp_path / "patch.exr"))
        pixels = np.asarray(image.read_image("float"), float)[..., :3].reshape(-1, 3)
        image.close()
        return math.pi * pixels

    return render


@pytest.mark.parametrize("name", CASES)
def test_irradiance_is_that_of_cycles(cycles, name):
    light, kind, properties = CASES[name]
    side = (np.arange(128) + 0.5) / 128
    u1, u2 = (grid.ravel() for grid in np.meshgrid(side, side))
    sample = light_sampler(light, 1.0).sample(np.zeros((3, u1.size)), u1, u2)
    ours = (sample.radiance * np.maximum(sample.wi[2], 0.0) / sample.pdf).mean(axis=1)
    assert ours.all()
    theirs = cycles(kind, getattr(light, "center", PLACE), properties)
    error = theirs.std(axis=0, ddof=1) / math.sqrt(len(theirs))
    # Level 1e-4 for each kind; 3e-4 for the size of the patch, the grid, and float32.
    slack = stats.t.ppf(1.0 - 0.5e-4 / 3.0, len(theirs) - 1) * error + 3e-4 * ours
    assert np.all(error < 2e-3 * ours), "too noisy to tell"
    assert np.all(np.abs(theirs.mean(axis=0) - ours) <= slack), (theirs.mean(axis=0) / ours, error / ours)
