# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin film on glass, seen along the normal from either side.

The reflectance should be the same. One sun behind the camera and one sample, without noise. Expected is what Cycles
itself shows from outside: a lossless film reflects the same share from both sides (Stokes).
"""

import probe


def seen(side, thickness, film, ior):
    """Colour that the plane shows from above (side 1) or below (side -1)."""
    scene = probe.start()
    names = {"Thin_Film_Thickness": thickness, "Thin_Film_IOR": film}
    probe.add_plane(scene, probe.add_material("BsdfGlass", distribution="GGX", Roughness=0.5, IOR=ior, **names))
    towards = probe.tilted(0.0) * side
    probe.look_from(scene, towards)
    probe.add_sun(scene, towards, 10.0)
    return probe.render(scene)[0, 0]


rows = []
for thickness, film, ior in ((100.0, 1.8, 1.5), (300.0, 1.8, 1.5), (300.0, 1.38, 1.5), (500.0, 2.2, 1.8)):
    outside, inside = (seen(side, thickness, film, ior) for side in (1.0, -1.0))
    rows += [
        (thickness, film, ior, color, outside[k], inside[k], 0.0) for k, color in enumerate(("red", "green", "blue"))
    ]
probe.show("thin film on glass, from inside", ("nm", "film IOR", "glass IOR", "colour"), rows)
