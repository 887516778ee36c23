# SPDX-License-Identifier: GPL-3.0-or-later
"""Four smaller departures.

They are narrow spread, disk for sphere, corrected glossy normal, and shadow terminator offset.
"""

import bpy
import numpy as np

import probe

WHITE = (1.0, 1.0, 1.0, 1.0)


def white_plane(size, samples):
    scene = probe.start(size, samples)
    body = probe.add_plane(scene, probe.add_material("BsdfDiffuse", Color=WHITE))
    return scene, body


rows = []
for spread in (0.02, 0.05, 0.099, 0.101, 0.2):
    scene, _ = white_plane(32, 64)
    light = probe.add_area_light(scene, 1.0, 1.0)
    light.spread, light.energy = spread, np.pi
    probe.look_from(scene, (0.0, 0.0, 1.0))
    h = 0.5 * spread
    series = (np.tan(h) - h) * 3 / h**3
    # The whole cone of light falls inside the lamp, so the irradiance is power / area.
    rows.append((spread, f"{series:.6f}", 1.0, *probe.mean(probe.render(scene))))
probe.show("area light of 1 m2 and pi W, its cone inside the lamp", ("spread", "predicted"), rows)

rows = []
for soft in (True, False):
    for radius, distance in ((0.2, 2.0), (0.5, 1.0)):
        scene, _ = white_plane(32, 128)
        light = bpy.data.lights.new("Point", "POINT")
        light.energy, light.shadow_soft_size, light.use_soft_falloff = 4 * np.pi**2, radius, soft
        body = bpy.data.objects.new("Point", light)
        body.location = (probe.AIM[0], probe.AIM[1], distance)
        scene.collection.objects.link(body)
        probe.look_from(scene, (0.0, 0.0, 1.0))
        disk = 1 / (distance**2 + radius**2)
        seen, noise = probe.mean(probe.render(scene))
        rows.append((str(soft), radius, distance, f"{disk:.6f}", 1 / distance**2, seen, noise))
probe.show("point light above a white plane", ("soft falloff", "radius", "distance", "disk"), rows)


def ggx(normal, view, light, alpha):
    """GGX lobe times cosine about `normal`, height-correlated masking."""
    h = (view + light) / np.linalg.norm(view + light)
    i, o, m = normal @ view, normal @ light, normal @ h
    a, b = (0.5 * (np.sqrt(1 + alpha**2 * (1 / c**2 - 1)) - 1) for c in (i, o))
    return alpha**2 / (np.pi * (1 + (alpha**2 - 1) * m * m) ** 2) / (4 * i * (1 + a + b))


rows = []
for correct in (True, False):
    for tilt in (10.0, 30.0):
        scene = probe.start()
        material = probe.add_material("BsdfAnisotropic", distribution="GGX", Color=WHITE, Roughness=0.5)
        material.cycles.use_bump_map_correction = correct
        body = probe.add_plane(scene, material)
        body.data.polygons[0].use_smooth = True
        body.data.normals_split_custom_set([tuple(probe.tilted(tilt))] * 4)
        body.shadow_terminator_geometry_offset = 0.0
        view, light = probe.tilted(50.0, 180.0), probe.tilted(75.0)
        probe.look_from(scene, view)
        probe.add_sun(scene, light)
        book = ggx(probe.tilted(tilt), view, light, 0.25)
        rows.append((str(correct), tilt, book, probe.render(scene).mean(), 0.0))
probe.show("glossy plane whose normals lean, one sun", ("correction", "tilt"), rows)


def sphere(offset, rings):
    scene = probe.start(64, 64)
    corners, faces = [(0.0, 0.0, 1.0)], []
    for k in range(1, rings):
        for j in range(2 * rings):
            t, p = np.pi * k / rings, np.pi * j / rings
            corners.append((np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)))
    corners.append((0.0, 0.0, -1.0))
    row = 2 * rings
    for j in range(row):
        n = (j + 1) % row
        faces.append((0, 1 + j, 1 + n))
        faces.append((len(corners) - 1, 1 + (rings - 2) * row + n, 1 + (rings - 2) * row + j))
        for k in range(rings - 2):
            faces.append((1 + k * row + j, 1 + (k + 1) * row + j, 1 + (k + 1) * row + n, 1 + k * row + n))
    body = probe.add_mesh(scene, corners, faces, probe.add_material("BsdfDiffuse", Color=WHITE))
    for face in body.data.polygons:
        face.use_smooth = True
    body.shadow_terminator_geometry_offset = offset
    probe.look_from(scene, (0.0, -1.0, 0.3), 2.2)
    probe.add_sun(scene, probe.tilted(80.0, 20.0))
    return probe.render(scene).mean()


rows = [(rings, sphere(0.0, rings), sphere(0.1, rings), 0.0) for rings in (8, 16, 32)]
probe.show("smooth sphere, one sun; expected is Cycles at offset 0, Cycles is at the default 0.1", ("rings",), rows)
