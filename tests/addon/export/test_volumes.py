# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes of Blender's materials and worlds.

Tested are what is read, what is refused, and Cycles beside it.
"""

from dataclasses import replace

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.addon.export.materials import read_material, read_world
from etalon.addon.export.nodes.images import ImageTable
from etalon.lib.errors import Refused
from etalon.lib.scene.volumes import Phase, Volume
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.addon.export.nodes.node_cells import node
from mathutils import Matrix

SAMPLES = 32
TINT = (0.25, 0.5, 0.75, 1.0)


def fill(owner, volume, surface=None):
    """Have the tree of a material or world make a volume and a surface, and nothing else."""
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = True
    tree = owner.node_tree
    tree.nodes.clear()
    is_world = isinstance(owner, bpy.types.World)
    out = tree.nodes.new("ShaderNodeOutputWorld" if is_world else "ShaderNodeOutputMaterial")
    tree.links.new(volume(tree), out.inputs["Volume"])
    if surface is not None:
        tree.links.new(surface(tree), out.inputs["Surface"])
    return owner


def shader(kind, **inputs):
    """What makes a shader node with these inputs."""
    return lambda tree: node(tree, kind, {name.replace("_", " "): value for name, value in inputs.items()})


def mixed(factor, first, second):
    return lambda t: node(t, "MixShader", {"Fac": factor, "Shader": first(t), "Shader_001": second(t)})


def absorption(density=1.0, color=TINT):
    return shader("VolumeAbsorption", Color=color, Density=density)


def read(volume, surface=None):
    refusals = []
    material = read_material(fill(bpy.data.materials.new("air"), volume, surface), ImageTable(), refusals)
    return material, [str(refusal) for refusal in refusals]


READ = {
    "absorption": (absorption(2.0), (1.5, 1.0, 0.5)),
    "a negative density": (absorption(-2.0), (0.0, 0.0, 0.0)),
    "two parts of it": (mixed(0.25, absorption(4.0), absorption(8.0)), (3.75, 2.5, 1.25)),
    "a sum": (lambda t: node(t, "AddShader", {"Shader": absorption()(t), "Shader_001": absorption()(t)}), (1.5, 1.0, 0.5)),
    "principled": (
        shader("VolumePrincipled", Color=(0.0, 0.0, 0.0, 1.0), Absorption_Color=(0.25, 0.0, 1.0, 1.0), Density=3.0),
        (1.5, 3.0, 0.0),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", READ)
def test_what_is_read(name):
    build, exact = READ[name]
    material, refusals = read(build)
    assert refusals == []
    assert material.only_bounds
    np.testing.assert_allclose(material.volume.absorption, exact, rtol=1e-6)


HALF = (0.5, 0.5, 0.5, 1.0)
GLOWING = {"Scatter_Coefficients": (1.0, 2.0, 3.0), "Emission_Coefficients": (0.5, 0.0, 0.0)}
SCATTERING = {
    "scatter": (
        shader("VolumeScatter", Color=TINT, Density=2.0, Anisotropy=0.25),
        Volume(phases=(Phase((0.5, 1.0, 1.5), 0.25),)),
    ),
    "the largest anisotropy": (
        shader("VolumeScatter", Color=HALF, Density=2.0, Anisotropy=1.0),
        Volume(phases=(Phase((1.0, 1.0, 1.0), 0.999),)),
    ),
    "coefficients": (
        shader("VolumeCoefficients", Absorption_Coefficients=(0.25, 0.5, 0.0), **GLOWING),
        Volume((0.25, 0.5, 0.0), (Phase((1.0, 2.0, 3.0)),), (0.5, 0.0, 0.0)),
    ),
    "principled": (
        shader("VolumePrincipled", Color=HALF, Absorption_Color=(0.25, 0.0, 1.0, 1.0), Density=4.0, Emission_Strength=2.0),
        Volume((1.0, 2.0, 0.0), (Phase((2.0, 2.0, 2.0)),), (2.0, 2.0, 2.0), ("density",)),
    ),
    "emission": (shader("Emission", Color=TINT, Strength=2.0), Volume(emission=(0.5, 1.0, 1.5))),
    "half of it": (
        mixed(0.5, shader("VolumeScatter", Color=TINT, Density=4.0), absorption(2.0)),
        Volume((0.75, 0.5, 0.25), (Phase((0.5, 1.0, 1.5)),)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SCATTERING)
def test_what_is_read_of_scattering_and_emission(name):
    build, exact = SCATTERING[name]
    material, refusals = read(build)
    assert refusals == []
    assert material.volume == exact


def test_a_surface_beside_the_volume():
    """Emission without light is no surface, as in Cycles.

    Transparent Shadows is left alone.
    """
    assert not read(absorption(), shader("BsdfGlass"))[0].only_bounds
    assert read(absorption(), shader("Emission", Strength=0.0))[0].only_bounds
    owner = fill(bpy.data.materials.new("air"), absorption(), shader("BsdfTransparent"))
    owner.use_transparent_shadow = False
    assert read_material(owner, ImageTable(), []).transparent_shadows


def test_a_world_of_fog():
    world = read_world(fill(bpy.data.worlds.new("fog"), absorption(0.5)), ImageTable(), [])
    assert world.volume == Volume((0.375, 0.25, 0.125))


REFUSED = {
    "Density' (a heterogeneous volume)": lambda t: node(t, "VolumeAbsorption", {"Density": node(t, "TexNoise")}),
    "Color' (a heterogeneous volume)": lambda t: node(t, "VolumeAbsorption", {"Color": node(t, "LightPath")}),
    "through which a heterogeneous volume is mixed": lambda t: mixed(node(t, "TexNoise"), absorption(), absorption())(t),
    "a colour outside 0 to 1": absorption(1.0, (0.5, 1.5, 0.5, 1.0)),
    "Diffuse BSDF) in a volume": shader("BsdfDiffuse"),
    "phase function Rayleigh": lambda t: node(t, "VolumeScatter", phase="RAYLEIGH"),
    "below 0 in a volume": shader("Emission", Strength=-1.0),
    "Blackbody Intensity": shader("VolumePrincipled", Blackbody_Intensity=1.0),
}  # fmt: skip


@pytest.mark.parametrize("named", REFUSED)
def test_what_is_not_simulated_is_refused_by_name(named):
    refusals = read(REFUSED[named])[1]
    assert len(refusals) == 1
    assert named in refusals[0]


def sphere(studio, name, radius, place, material):
    """A ball of flat faces, closed."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=radius, location=place)
    thing = bpy.context.object
    thing.name = name
    thing.data.materials.append(material)
    return thing


def stage(studio):
    """A grey floor under a lamp and a sky, with volumes on it.

    They are a ball of tinted glass, and two clear volumes of which one reaches into the other.
    """
    grey = bpy.data.materials.new("grey")
    if bpy.app.version < (5, 0, 0):
        grey.use_nodes = True
    floor = studio.quad("floor", 4.0)
    floor.data.materials[0] = fill_surface(grey, shader("BsdfDiffuse", Color=(0.7, 0.7, 0.7, 1.0)))
    dark = {"Color": (0.0, 0.0, 0.0, 1.0), "Absorption_Color": (0.1, 0.4, 0.8, 1.0)}
    sphere(
        studio, "glass", 1.0, (-1.5, 0.0, 1.1), fill(new("glass"), absorption(1.0), shader("BsdfGlass", Roughness=0.0))
    )
    sphere(studio, "clear", 0.9, (1.0, 0.0, 1.0), fill(new("clear"), absorption(1.5)))
    sphere(studio, "near", 0.7, (1.6, -0.6, 1.2), fill(new("near"), shader("VolumePrincipled", **dark)))
    lamp = studio.add("lamp", bpy.data.lights.new("lamp", "POINT"), Matrix.Translation((0.5, 0.5, 3.0)))
    lamp.data.energy, lamp.data.shadow_soft_size = 150.0, 0.3
    studio.camera.location, studio.camera.rotation_euler = (0.0, -8.0, 4.0), (1.2, 0.0, 0.0)
    studio.scene.render.resolution_x, studio.scene.render.resolution_y = 24, 16
    studio.scene.render.engine, studio.scene.cycles.max_bounces = "CYCLES", 6
    studio.scene.world = bpy.data.worlds.new("sky")


def new(name):
    return bpy.data.materials.new(name)


def fill_surface(material, surface):
    tree = material.node_tree
    tree.nodes.clear()
    tree.links.new(surface(tree), tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def apart(theirs, exported):
    """The root mean square difference of blocks of 4 x 4 pixels from `theirs`.

    It is in standard errors.
    """
    reference = ReferenceRenderer(exported, Options(threads=1))
    sides = [np.array([reference.render(k, SAMPLES).radiance for k in range(4)]), theirs]
    blocks = [a.reshape(4, 4, 4, 6, 4, 3).mean(axis=(2, 4)) for a in sides]
    error = np.sqrt(sum(b.var(axis=0, ddof=1) for b in blocks) / 4)
    means = [b.mean(axis=0) for b in blocks]
    scale = error + 1e-3 * means[1]
    return np.sqrt((np.divide(means[0] - means[1], scale, out=np.zeros_like(scale), where=scale > 0.0) ** 2).mean())


def cycles_images(studio):
    renderer = CyclesRenderer(studio.scene, threads=1)
    return np.array([renderer.render(k, SAMPLES).radiance for k in range(4)])


@pytest.mark.compares_with_cycles
def test_absorption_against_cycles(studio):
    """And without the volumes the two are told apart."""
    stage(studio)
    exported, shown = studio.export(), cycles_images(studio)
    assert apart(shown, exported) < 1.5
    clear = replace(exported, materials=tuple(replace(m, volume=None) for m in exported.materials))
    assert apart(shown, clear) > 5.0


@pytest.mark.compares_with_cycles
def test_fog_and_a_camera_inside_a_volume_against_cycles(studio):
    stage(studio)
    fill(studio.scene.world, absorption(0.1), shader("Background", Color=(0.3, 0.3, 0.3, 1.0)))
    bpy.data.objects["near"].location = (0.0, -8.0, 4.0)
    exported = studio.export()
    assert apart(cycles_images(studio), exported) < 1.5


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_scattering_against_cycles(studio):
    """Smoke, a glowing cloud and thin fog.

    Scattering forwards is distinguished from scattering backwards.
    """
    stage(studio)
    smoke = shader("VolumeScatter", Color=(0.9, 0.6, 0.3, 1.0), Density=2.0, Anisotropy=0.6)
    glow = {"Color": (0.3, 0.6, 0.9, 1.0), "Emission_Strength": 0.05, "Anisotropy": -0.3}
    fill(bpy.data.materials["clear"], smoke)
    fill(bpy.data.materials["near"], shader("VolumePrincipled", Density=1.5, **glow))
    fill(studio.scene.world, shader("VolumeScatter", Density=0.02), shader("Background", Color=(0.3, 0.3, 0.3, 1.0)))
    studio.scene.cycles.volume_bounces = 2
    exported, shown = studio.export(), cycles_images(studio)
    assert exported.transport.volume_bounces == 2
    assert apart(shown, exported) < 1.5
    turned = [
        replace(m, volume=m.volume and replace(m.volume, phases=tuple(map(turn, m.volume.phases))))
        for m in exported.materials
    ]
    assert apart(shown, replace(exported, materials=tuple(turned))) > 3.0


def turn(phase):
    return replace(phase, anisotropy=-phase.anisotropy)


def test_rays_that_volumes_scatter_meet_everything_or_the_scene_is_refused(studio):
    stage(studio)
    bpy.data.objects["floor"].visible_volume_scatter = False
    assert studio.export().mesh.triangle_count
    fill(bpy.data.materials["clear"], shader("VolumeScatter"))
    with pytest.raises(
        Refused, match="object 'floor': ray visibility Volume Scatter off, beside a volume that scatters,"
    ):
        studio.export()


def test_what_bounds_no_volume_is_refused(studio):
    stage(studio)
    bpy.data.objects["floor"].data.materials[0] = bpy.data.materials["clear"]
    with pytest.raises(
        Refused, match="object 'floor': the volume of material 'clear', because its faces leave an opening"
    ):
        studio.export()


def test_attributes_that_the_volume_would_read_are_refused(studio):
    stage(studio)
    mesh = bpy.data.objects["near"].data
    mesh.attributes.new("density", "FLOAT", "POINT")
    with pytest.raises(Refused, match="attribute 'density', by which a heterogeneous volume varies"):
        studio.export()
