# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that overlap in one plane, under one sun.

Every point must show what the plane shows alone, albedo * E / pi. The side of a closed box that is turned away from the sun must be black.
"""

import numpy as np

import probe

ALBEDO, STRENGTH, ANGLE = 0.8, 3.0, 30.0
EXPECTED = ALBEDO * STRENGTH * np.cos(np.radians(ANGLE)) / np.pi


def white(scene):
    return probe.add_material("BsdfDiffuse", Color=(ALBEDO, ALBEDO, ALBEDO, 1.0))


def alone(scene):
    probe.add_plane(scene, white(scene))


def copy_of_object(scene):
    import bpy

    first = probe.add_plane(scene, white(scene))
    scene.collection.objects.link(bpy.data.objects.new("Copy", first.data))


def larger_plane(scene):
    probe.add_plane(scene, white(scene))
    probe.add_plane(scene, white(scene), half=3.5, name="Floor")


def twice_in_one_mesh(scene):
    corners = [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)] * 2
    probe.add_mesh(scene, corners, [(0, 1, 2, 3), (4, 5, 6, 7)], white(scene))


def apart(distance):
    def build(scene):
        probe.add_plane(scene, white(scene))
        probe.add_plane(scene, white(scene), half=3.5, height=-distance, name="Floor")

    return build


def turn(angles):
    """The axes of a turned frame, one a row."""
    from mathutils import Euler

    return np.array(Euler(angles).to_matrix()).T


def tilted(angles):
    """Two quads in one plane that is along no axis."""

    def build(scene):
        corners = np.array([(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)]) @ turn(angles)
        probe.add_mesh(scene, np.tile(corners, (2, 1)), [(0, 1, 2, 3), (4, 5, 6, 7)], white(scene))

    return build


def dark_side(angles, copies):
    """What a turned box shows where the sun does not shine. It is there `copies` times."""
    scene = probe.start(size=32, samples=256)
    corners = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) @ turn(angles)
    sides = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
    faces = [tuple(side + 8 * k) for k in range(copies) for side in sides]
    probe.add_mesh(scene, np.tile(corners, (copies, 1)), faces, white(scene))
    probe.look_from(scene, -turn(angles)[2], width=1.0)
    probe.add_sun(scene, turn(angles)[2], STRENGTH)
    return probe.render(scene)


CASES = {
    "alone": alone,
    "object copy": copy_of_object,
    "larger": larger_plane,
    "one mesh": twice_in_one_mesh,
    "1e-6 m apart": apart(1e-6),
    "1e-4 m apart": apart(1e-4),
}

rows = []
for name, build in CASES.items():
    scene = probe.start(size=32)
    build(scene)
    probe.look_from(scene, (0.0, 0.0, 1.0), width=1.0)
    probe.add_sun(scene, probe.tilted(ANGLE, 70.0), STRENGTH)
    image = probe.render(scene).mean(axis=2)
    dark = np.mean(image < 0.5 * EXPECTED)
    rows.append((name, f"{100 * dark:.1f} %", EXPECTED, image.mean(), 0.0))
probe.show("two diffuse planes in one place, one sun", ("second face", "dark pixels"), rows)

ANGLES = (0.5, 0.2, 0.1), (0.3, 0.03, 0.06), (0.7, -0.4, 0.2)

rows = []
for angles in ANGLES:
    scene = probe.start(size=32, samples=64)
    tilted(angles)(scene)
    probe.look_from(scene, (0.0, 0.0, 1.0), width=1.0)
    probe.add_sun(scene, turn(angles)[2], STRENGTH)
    rows.append((str(angles), ALBEDO * STRENGTH / np.pi, *probe.mean(probe.render(scene))))
probe.show("two quads in one tilted plane, the sun upright on it", ("angles",), rows)

rows = []
for angles in ANGLES:
    for copies in (1, 2):
        rows.append((str(angles), copies, 0.0, *probe.mean(dark_side(angles, copies))))
probe.show("the dark side of a turned box", ("angles", "copies"), rows)
