# SPDX-License-Identifier: GPL-3.0-or-later
"""An Attribute node named "P" on a plain mesh.

The render runs in a process of its own, because it may crash.
"""

import subprocess
import sys

import bpy

CHILD = """
import sys, probe
scene = probe.start()
material = probe.add_material("Emission", Strength=1.0)
tree = probe.node_tree(material)
glow = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeEmission")
node = tree.nodes.new("ShaderNodeAttribute")
node.attribute_name = sys.argv[1]
tree.links.new(node.outputs["Color"], glow.inputs["Color"])
probe.add_plane(scene, material)
probe.look_from(scene, (0.0, 0.0, 1.0))
probe.render(scene)
"""

print(f"\nBlender {bpy.app.version_string}: exit status of a render with an Attribute node")
print(f"{'name':>12}  {'expected':>12}  {'Cycles':>12}")
for name in ("nothing", "P"):
    done = subprocess.run([sys.executable, "-c", CHILD, name], capture_output=True, timeout=60)
    print(f"{name:>12}  {0:>12}  {done.returncode:>12}")
