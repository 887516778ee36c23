# SPDX-License-Identifier: GPL-3.0-or-later
"""An edge that moves by a metre while the shutter is open, seen near the start, near the end and as a whole.

A surface that glows lies to the left of the edge. So a point that the edge reaches after the share x of the time shows 1 - x.
"""

import bpy

import probe

SIZE = 256


def cycles_shows(start, stop):
    """The mean of the points between by Cycles' table: u becomes 255 (255 u + 1/2) / 256^2."""
    first, slope = 255 * 0.5 / 256**2, 255**2 / 256**2
    low, high = max(start, first), min(stop, first + slope)
    behind = max(min(first, stop) - start, 0.0)  # what the edge has passed before the first moment
    through = ((first + slope - low) ** 2 - (first + slope - high) ** 2) / (2 * slope)
    return (behind + through) / (stop - start)


rows = []
for name, begin, end in (("first 2 %", 0.0, 0.02), ("whole", 0.0, 1.0), ("last 2 %", 0.98, 1.0)):
    scene = probe.start(size=SIZE, samples=256)
    bpy.context.preferences.edit.keyframe_new_interpolation_type = "LINEAR"
    probe.look_from(scene, (0.0, 0.0, 1.0), width=end - begin)
    scene.camera.location.x = 0.5 * (begin + end)
    plane = probe.add_plane(scene, probe.add_material("Emission"))
    for frame in (0, 2):
        plane.location.x = 0.5 * frame - 2.0
        plane.keyframe_insert("location", frame=frame)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 2.0
    scene.frame_set(1)
    expected = 1.0 - 0.5 * (begin + end)
    rows.append((name, expected, *probe.mean(probe.render(scene))))
    print(f"{name}: the table gives {cycles_shows(begin, end):.6f}, {cycles_shows(begin, end) / expected - 1:+.3%}")
probe.show("an edge that moves over the image", ("part of the way",), rows)
