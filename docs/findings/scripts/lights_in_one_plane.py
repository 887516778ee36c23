# SPDX-License-Identifier: GPL-3.0-or-later
"""Two area lights that overlap in one plane, above a diffuse plane.

Lights do not shadow each other, so the irradiance is the sum of both. That of a rectangle is known in closed form
(Lambert 1760; Howell, "A catalog of radiation heat transfer configuration factors", B-3).
"""

import numpy as np

import probe

ALBEDO, SIZE, HEIGHT = 0.8, 4.0, 2.0


def corner(x, y, height):
    """Irradiance by a rectangle of radiance 1 with one corner straight above the point."""
    a, b = np.hypot(x, height), np.hypot(y, height)
    return 0.5 * (x / a * np.arctan2(y, a) + y / b * np.arctan2(x, b))


def irradiance(x, height):
    """Irradiance by a square light of radiance 1 that is centred at (x, 0)."""
    left, right = x - 0.5 * SIZE - probe.AIM[0], x + 0.5 * SIZE - probe.AIM[0]
    low, high = -0.5 * SIZE - probe.AIM[1], 0.5 * SIZE - probe.AIM[1]
    parts = (corner(right, high, height), corner(left, high, height))
    return parts[0] - parts[1] - corner(right, low, height) + corner(left, low, height)


def place(scene, x, height):
    probe.add_area_light(scene, SIZE, height)
    scene.objects[-1].location.x = x


CASES = {
    "one light": (),
    "same place": ((0.0, 0.0),),
    "half of each": ((0.5 * SIZE, 0.0),),
    "side by side": ((SIZE, 0.0),),
    "1e-6 m above": ((0.0, 1e-6),),
    "1e-3 m above": ((0.0, 1e-3),),
    "three of them": ((0.0, 0.0), (0.0, 0.0)),
}

rows = []
for name, others in CASES.items():
    scene = probe.start(size=32, samples=1024)
    probe.add_plane(scene, probe.add_material("BsdfDiffuse", Color=(ALBEDO, ALBEDO, ALBEDO, 1.0)), half=8.0)
    probe.look_from(scene, (0.0, 0.0, 1.0))
    places = ((0.0, 0.0), *others)
    for x, above in places:
        place(scene, x, HEIGHT + above)
    expected = ALBEDO / np.pi * sum(irradiance(x, HEIGHT + above) for x, above in places)
    rows.append((name, expected, *probe.mean(probe.render(scene))))
probe.show("area lights over a diffuse plane", ("second light",), rows)
