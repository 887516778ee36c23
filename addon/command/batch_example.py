# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan that `etalon batch --example` prints."""

EXAMPLE = """\
out = "sweep"                              # folder for the results, beside the plan
scenes = ["glossy_spheres"]                # reference scenes, files beside the plan, and patterns such as "shots/**/*.blend"
# frames = [1, "10-100:10"]                # each of these is an axis: all combinations are compared
# cameras = ["Front", "Side"]
# view_layers = ["ViewLayer"]
# blenders = ["4.5", "5.2", "/opt/blender/blender"]
# per_process = 20                         # comparisons that one process runs, one after the other; 1 if left out

[options]                                  # any long option of `etalon compare`; a list of values is an axis
tolerance = "1%"
time = "1m"
masking = ["correlated", "separable"]

[limits]                                   # of one comparison
time = "10m"
memory = "8 GB"

[[vary]]                                   # any number of these
path = 'scene.render.resolution_percentage'  # from bpy.data, or from the open scene if it begins with scene.
values = [25, 50]
name = "size"                              # optional: its name in tables
"""
