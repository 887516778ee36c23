# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of the export tests.

It has an empty scene, Cycles as a one-sample probe, and rays met by brute force.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.export import export_scene
from etalon.addon.export.render_depsgraph import with_render_depsgraph
from etalon.addon.host.quiet import quiet
from etalon.lib.film.exr import read_exr
from etalon.lib.surfaces.surface import SurfacePoints
from etalon.lib.vectors import normalize
from etalon.tests.conftest import unknown_cycles

# What Cycles' table of its pixel filter adds to the centre, in pixels, right and up.
ASIDE = 0.5 / 1023
# Rays times triangles that are tried at a time.
PAIRS_AT_ONCE = 1 << 17


class Studio:
    """An empty Blender scene with a camera, and the few things that tests do to it."""

    def __init__(self, folder):
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        self.scene = bpy.context.scene
        self.layer = bpy.context.view_layer
        self.plain = self.probe_material("ShaderNodeNewGeometry", "Position")
        self.plain.name = "plain"
        self.plain.node_tree.nodes.clear()
        self.camera = self.add("camera", bpy.data.cameras.new("camera"))
        self.scene.camera = self.camera
        self.scene.render.resolution_x, self.scene.render.resolution_y = 48, 32
        self._folder = folder

    def add(self, name, data, matrix=None):
        """A linked object; what has no material yet is a plain one's."""
        if hasattr(data, "materials") and not data.materials:
            data.materials.append(self.plain)
        thing = bpy.data.objects.new(name, data)
        self.scene.collection.objects.link(thing)
        if matrix is not None:
            thing.matrix_world = matrix
        return thing

    def mesh(self, name, vertices, faces):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([tuple(map(float, v)) for v in vertices], [], [tuple(map(int, f)) for f in faces])
        return mesh

    def quad(self, name="quad", half=1.0, z=0.0):
        """A square that faces +z."""
        corners = [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)]
        return self.add(name, self.mesh(name, corners, [(0, 1, 2, 3)]))

    def look_down(self, scale, height=10.0):
        """An orthographic camera above the origin."""
        self.camera.data.type = "ORTHO"
        self.camera.data.ortho_scale = scale
        self.camera.location = (0.0, 0.0, height)
        self.scene.render.resolution_x = self.scene.render.resolution_y = 32

    def export(self, **options):
        with quiet():
            return with_render_depsgraph(self.scene, lambda depsgraph: export_scene(depsgraph, **options))

    def cycles(self, samples=1):
        """(h, w, 3) linear pixels; with one sample each ray goes through its pixel's centre.

        Skips where this release of Cycles is unknown.
        """
        if unknown_cycles():
            pytest.skip(unknown_cycles())
        render, cycles = self.scene.render, self.scene.cycles
        kept = render.engine
        render.engine = "CYCLES"
        render.threads_mode, render.threads = "FIXED", 2
        cycles.samples = samples
        cycles.use_adaptive_sampling = cycles.use_denoising = False
        cycles.pixel_filter_type = "BOX"
        cycles.sample_clamp_indirect = 0.0
        if hasattr(render.image_settings, "media_type"):
            render.image_settings.media_type = "IMAGE"
        render.image_settings.file_format = "OPEN_EXR"
        render.image_settings.color_depth = "32"
        render.filepath = str(self._folder / "probe.exr")
        with quiet():
            bpy.ops.render.render(write_still=True)
        render.engine = kept
        channels = read_exr(self._folder / "probe.exr")
        return np.stack([channels[c] for c in "RGB"], axis=2).astype(np.float64)

    def probe_material(self, node, output, offset=0.0, scale=1.0):
        """A material that glows with a node's output times `scale` plus `offset`."""
        material = bpy.data.materials.new("probe")
        if bpy.app.version < (5, 0, 0):
            material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        source, emission = tree.nodes.new(node), tree.nodes.new("ShaderNodeEmission")
        shift, out = tree.nodes.new("ShaderNodeVectorMath"), tree.nodes.new("ShaderNodeOutputMaterial")
        shift.operation = "MULTIPLY_ADD"
        shift.inputs[1].default_value = (scale,) * 3
        shift.inputs[2].default_value = (offset,) * 3
        tree.links.new(source.outputs[output], shift.inputs[0])
        tree.links.new(shift.outputs[0], emission.inputs["Color"])
        tree.links.new(emission.outputs[0], out.inputs["Surface"])
        return material

    def probe(self, node, output, offset=0.0, scale=1.0):
        """What every surface has there, at each pixel's centre, by Cycles: (h, w, 3).

        NaN where there is no surface.
        """
        background = 1e6
        world = bpy.data.worlds.new("far")
        if bpy.app.version < (5, 0, 0):
            world.use_nodes = True
        world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
        world.node_tree.nodes["Background"].inputs["Strength"].default_value = background
        kept = self.layer.material_override, self.scene.world
        self.layer.material_override = self.probe_material(node, output, offset, scale)
        self.scene.world = world
        try:
            image = (self.cycles() - offset) / scale
        finally:
            self.layer.material_override, self.scene.world = kept
        return np.where(image > background / 2 / scale, np.nan, image)


@pytest.fixture
def studio(tmp_path):
    return Studio(tmp_path)


def camera_rays(camera):
    """Origin and unit direction (3, h, w) of the rays through the pixels' centres.

    Row 0 is on top.
    """
    x, y = np.meshgrid(np.arange(camera.width) + 0.5, camera.height - 0.5 - np.arange(camera.height))
    x, y = x + ASIDE, y + ASIDE
    plane = np.einsum("ij,jhw->ihw", camera.plane_from_raster, np.stack([x, y, np.ones_like(x)]))
    zero = np.zeros_like(x)
    if camera.kind == "PERSPECTIVE":
        origin, direction = np.zeros((3, *x.shape)), np.stack([*plane, zero - 1.0])
    else:
        origin, direction = np.stack([*plane, zero]), np.stack([zero, zero, zero - 1.0])
    rotation, translation = camera.world_from_camera[:, :3], camera.world_from_camera[:, 3]
    direction = np.einsum("ij,jhw->ihw", rotation, direction)
    origin = np.einsum("ij,jhw->ihw", rotation, origin) + translation[:, None, None]
    return origin, direction / np.linalg.norm(direction, axis=0)


def first_hits(mesh, origin, direction):
    """Triangle (-1 where none), barycentrics (3, ...) and distance of each nearest hit.

    It tries every triangle.
    """
    corners = [mesh.vertices[:, mesh.triangles[k]] for k in range(3)]
    shape = origin.shape[1:]
    origin, direction = origin.reshape(3, -1), direction.reshape(3, -1)
    count = origin.shape[1]
    index, weights, best = np.full(count, -1), np.zeros((3, count)), np.full(count, np.inf)
    rays = max(1, PAIRS_AT_ONCE // max(mesh.triangle_count, 1))
    for start in range(0, count if mesh.triangle_count else 0, rays):
        part = slice(start, start + rays)
        t, u, v = _distances(*corners, origin[:, part], direction[:, part])
        k, ray = np.argmin(t, axis=1), np.arange(len(t))
        t, u, v = t[ray, k], u[ray, k], v[ray, k]
        met = t < np.inf
        best[part], index[part] = t, np.where(met, k, -1)
        weights[:, part] = np.where(met, [1 - u - v, u, v], 0.0)
    return index.reshape(shape), weights.reshape(3, *shape), best.reshape(shape)


def _distances(a, b, c, origin, direction):
    """Distance (rays, triangles), and the barycentrics u and v of corners `b` and `c`.

    The distance is infinite where there is no hit.
    """
    e1, e2 = (corner - a for corner in (b, c))
    d, s = direction.T[:, None, :], origin.T[:, None, :] - a.T
    p, q = np.cross(d, e2.T), np.cross(s, e1.T)
    det = (p * e1.T).sum(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v, t = (p * s).sum(axis=2) / det, (q * d).sum(axis=2) / det, (q * e2.T).sum(axis=2) / det
        met = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (t > 0)
    return np.where(met, t, np.inf), u, v


@pytest.fixture
def rays():
    return camera_rays


@pytest.fixture
def hits():
    return first_hits


@pytest.fixture
def _normal_of_unit_length(monkeypatch):
    """From Blender 5.2 on Cycles normalises the interpolated normal.

    It does so before it adds the tangents; MikkTSpace leaves both as they are.
    """
    if bpy.app.version >= (5, 2, 0):
        plain = SurfacePoints.tangent_frame

        def unit(self, uv_map):
            tangent, sign, normal = plain(self, uv_map)
            return tangent, sign, normalize(normal)

        monkeypatch.setattr(SurfacePoints, "tangent_frame", unit)
