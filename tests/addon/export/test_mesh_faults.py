# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes with faults, and the memory that reading a large one takes."""

import logging
import tracemalloc

import bpy
import numpy as np
import pytest
from etalon.addon.export.mesh import read_mesh, require_indices
from etalon.lib.errors import EtalonError
from etalon.lib.scene.mesh import Object
from etalon.lib.scene.placements import Placements
from etalon.lib.scene_check.check import check_scene


def test_faces_without_area_are_left_out_and_counted(studio, caplog):
    vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (2, 0, 0), (0, 0, 0)]
    studio.add("thin", studio.mesh("thin", vertices, [(0, 1, 2), (0, 1, 3), (0, 4, 1)]))
    with caplog.at_level(logging.WARNING):
        mesh = studio.export().mesh
    assert mesh.triangle_count == 1
    assert "thin: 2 faces without area left out" in caplog.text


def test_faces_on_top_of_each_other_are_found_by_name_with_their_area(studio):
    """Copies of an object in one place, turned or turned over.

    A face that shares only an edge does not count, nor does its mirror image.
    """
    square, order = [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 2, 1)], [(0, 1, 2), (0, 2, 3)]
    studio.add("sheet", studio.mesh("sheet", square, order))
    studio.add("copy", studio.mesh("copy", square[::-1], [(1, 2, 3)]))
    studio.add("apart", studio.mesh("apart", [(x, y, -z) for x, y, z in square], order))
    scene = studio.export()
    assert scene.mesh.overlaps.pairs.tolist() == [[0], [2]]
    assert scene.mesh.overlaps.area.tolist() == pytest.approx([0.5])
    found = next(finding for finding in check_scene(scene) if finding.check == "overlapping faces")
    assert "'sheet' and 'copy' (0.5 m²)" in found.what
    assert "apart" not in found.what


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1.1e18])
def test_a_vertex_that_is_nowhere_is_named(studio, bad):
    thing = studio.quad("broken")
    thing.data.vertices[2].co.y = bad
    with pytest.raises(EtalonError, match="broken: 1 coordinate of vertices not finite or beyond"):
        studio.export()


@pytest.mark.parametrize("bad", [-1, 5, -838819771])
def test_a_face_whose_corners_are_not_there_is_named(bad):
    require_indices(np.array([[0, 1, 2], [2, 3, 4]], np.int32), 5, "whole")
    require_indices(np.empty((0, 3), np.int32), 0, "empty")
    with pytest.raises(EtalonError, match="broken: faces of its mesh use corners that are not there"):
        require_indices(np.array([[0, 1, 2], [2, 3, bad]], np.int32), 5, "broken")


@pytest.mark.slow
def test_reading_and_joining_a_mesh_takes_little_beyond_its_arrays(studio):
    """At most 160 bytes a triangle, with normals and texture coordinates: 160 MB a million."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=500, y_subdivisions=500)
    mesh = bpy.context.object.data
    mesh.shade_smooth()
    mesh.calc_loop_triangles()
    tracemalloc.start()
    try:
        placements = Placements()
        placements.add(Object("grid", np.eye(3, 4)), read_mesh(mesh, "grid", [""], False), np.zeros(1, np.int32))
        joined = placements.join(frozenset([""]), False)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    arrays = [joined.vertices, joined.triangles, joined.corner_normals, joined.uvs[""]]
    beyond = (peak - sum(array.nbytes for array in arrays)) / joined.triangle_count
    assert 0 < beyond < 160
