# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera rays against Cycles' own.

One sample through each pixel's centre gives the point that the ray met.
"""

import math

import bpy
import numpy as np
import pytest
from etalon.lib.errors import EtalonError, Refused
from mathutils import Euler, Matrix, Vector


def room(studio):
    """A box from 0 to 20, so that positions are radiances; its corners are cut off nothing."""
    corners = [(x, y, z) for x in (0, 20) for y in (0, 20) for z in (0, 20)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    studio.add("room", studio.mesh("room", corners, faces))


def randomize(studio, rng, kind):
    render, data = studio.scene.render, studio.camera.data
    render.resolution_x, render.resolution_y = (int(n) for n in rng.integers(40, 90, 2))
    render.resolution_percentage = int(rng.integers(40, 100))
    render.pixel_aspect_x, render.pixel_aspect_y = (float(a) for a in rng.uniform(1.0, 2.0, 2))
    data.type = kind
    data.sensor_fit = str(rng.choice(["AUTO", "HORIZONTAL", "VERTICAL"]))
    data.sensor_width, data.sensor_height = (float(s) for s in rng.uniform(15.0, 45.0, 2))
    data.lens = float(rng.uniform(12.0, 60.0))
    data.ortho_scale = float(rng.uniform(2.0, 6.0))
    data.shift_x, data.shift_y = (float(s) for s in rng.uniform(-0.4, 0.4, 2))
    rotation = Euler([float(a) for a in rng.uniform(-math.pi, math.pi, 3)]).to_matrix().to_4x4()
    scale = Matrix.Diagonal([*(float(s) for s in rng.uniform(0.3, 3.0, 3) * rng.choice([-1, 1], 3)), 1.0])
    studio.camera.matrix_world = Matrix.Translation([float(c) for c in rng.uniform(8.0, 12.0, 3)]) @ rotation @ scale


def miss(studio, rays):
    """The largest distance in metres of Cycles' hit points from the exported rays."""
    camera = studio.export().camera
    points = studio.probe("ShaderNodeNewGeometry", "Position").transpose(2, 0, 1)
    assert points.shape[1:] == (camera.height, camera.width)
    origin, direction = rays(camera)
    to = points - origin
    along = np.einsum("ihw,ihw->hw", to, direction)
    assert (along > 0.0).all()
    return np.linalg.norm(to - along * direction, axis=0).max()


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("turn", range(3))
def test_rays_of_random_cameras_meet_what_cycles_sees(studio, rng, rays, kind, turn):
    room(studio)
    randomize(studio, rng, kind)
    assert miss(studio, rays) < 1e-4


def test_the_border_is_the_raster(studio, rng, rays):
    room(studio)
    randomize(studio, rng, "PERSP")
    render = studio.scene.render
    render.use_border = render.use_crop_to_border = True
    render.border_min_x, render.border_max_x = 0.23, 0.81
    render.border_min_y, render.border_max_y = 0.37, 0.9
    assert miss(studio, rays) < 1e-4
    cropped = studio.export().camera
    render.use_crop_to_border = False
    whole = studio.export().camera
    assert (whole.width, whole.height) == (cropped.width, cropped.height)
    assert np.array_equal(whole.plane_from_raster, cropped.plane_from_raster)


@pytest.mark.parametrize(("kind", "unit"), [("PERSP", 0.05), ("ORTHO", 1.0)])
def test_the_lens(studio, kind, unit):
    studio.quad()
    data = studio.camera.data
    data.type = kind
    assert studio.export().camera.aperture is None
    data.dof.use_dof = True
    data.dof.aperture_fstop, data.dof.aperture_blades = 2.0, 5
    data.dof.aperture_rotation, data.dof.aperture_ratio, data.dof.focus_distance = 0.3, 1.5, 7.0
    lens = studio.export().camera.aperture
    assert lens.radius == pytest.approx(unit / 4.0)
    assert (lens.blades, lens.focus_distance) == (5, 7.0)
    assert (lens.rotation, lens.ratio) == pytest.approx((0.3, 1.5))
    data.dof.aperture_blades = 0
    assert studio.export().camera.aperture.blades == 0


def test_the_focus_object_counts_by_its_depth(studio):
    studio.quad()
    studio.camera.matrix_world = (
        Matrix.Translation((1, 2, 3)) @ Euler((0.4, 0.5, 0.6)).to_matrix().to_4x4() @ Matrix.Scale(3, 4)
    )
    target = studio.add("target", None)
    target.location = (4.0, -1.0, -2.0)
    studio.camera.data.dof.use_dof = True
    studio.camera.data.dof.focus_object = target
    axis = Euler((0.4, 0.5, 0.6)).to_matrix() @ Vector((0, 0, -1))
    depth = abs(axis @ (Vector((4, -1, -2)) - Vector((1, 2, 3))))
    assert studio.export().camera.aperture.focus_distance == pytest.approx(depth, rel=1e-6)


def test_another_camera_and_its_clip_planes(studio):
    studio.quad()
    other = studio.add("other", bpy.data.cameras.new("other"), Matrix.Translation((5, 6, 7)))
    other.data.clip_start, other.data.clip_end = 0.25, 12.0
    camera = studio.export(camera=other).camera
    assert np.allclose(camera.world_from_camera[:, 3], (5, 6, 7))
    assert (camera.clip_start, camera.clip_end) == (0.25, 12.0)


def test_a_moving_camera_is_where_its_frame_has_it(studio):
    studio.quad()
    for frame, x in ((1, 0.0), (11, 10.0)):
        studio.camera.location = (x, 0.0, 5.0)
        studio.camera.keyframe_insert("location", frame=frame)
    studio.scene.frame_set(6)
    assert studio.export().camera.world_from_camera[0, 3] == pytest.approx(5.0, abs=1e-6)


def test_what_no_raster_can_show_is_refused(studio):
    studio.quad()
    studio.camera.data.type = "CUSTOM"
    with pytest.raises(Refused, match="camera 'camera': the lens type CUSTOM"):
        studio.export()
    studio.camera.data.type = "PERSP"
    parent = studio.add("parent", None)
    parent.scale = (1.0, 3.0, 1.0)
    studio.camera.parent = parent
    studio.camera.rotation_euler = (0.0, 0.0, 0.5)
    with pytest.raises(Refused, match="a sheared matrix"):
        studio.export()
    parent.scale = (0.0, 0.0, 0.0)
    with pytest.raises(
        Refused, match="camera 'camera': a scale of 0 along an axis is not simulated; give it a scale above 0"
    ):
        studio.export()


def test_a_lamp_as_camera_is_bad_input(studio):
    studio.quad()
    studio.scene.camera = studio.add("lamp", bpy.data.lights.new("lamp", "SPOT"))
    with pytest.raises(EtalonError, match="lamp: the scene looks through an object that is no camera"):
        studio.export()
