# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that overlap in one plane, under one sun.

Every point must show what the plane shows alone, albedo * E / pi.
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
