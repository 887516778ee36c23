# SPDX-License-Identifier: GPL-3.0-or-later
"""A node of a type that this Blender does not have.

One line names the node and this Blender.
"""

import subprocess
import sys

import bpy
import pytest
from etalon.addon.command.opening import open_blend
from etalon.addon.export.render_depsgraph import with_render_depsgraph
from etalon.addon.export.scene import export_scene
from etalon.addon.host.quiet import quiet
from etalon.lib.errors import Refused

# Another process makes the file, with a node type that is registered there alone.
SCRIPT = """
import os
import sys
import bpy

class Strange(bpy.types.ShaderNode):
    bl_idname, bl_label = "EtalonStrange", "Strange"
    def init(self, _):
        self.outputs.new("NodeSocketColor", "Color")
        self.outputs.new("NodeSocketShader", "Shader")

bpy.utils.register_class(Strange)
bpy.ops.wm.read_factory_settings()
(principled,) = (n for n in bpy.data.materials["Material"].node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
tree = principled.id_data
lost = tree.nodes.new("EtalonStrange")
lost.name = "Newer"
if sys.argv[1] == "Color":
    tree.links.new(lost.outputs["Color"], principled.inputs["Base Color"])
else:
    tree.links.new(lost.outputs["Shader"], principled.outputs[0].links[0].to_socket)
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[2])
os._exit(0)  # Blender 4.5 as a module never ends where a node class is still registered
"""


def export(socket, folder, partial=False):
    """Export a file in which a node of an unknown type feeds a socket.

    The socket is 'Color' of a shader or 'Surface' of the output.
    """
    path = folder / "newer.blend"
    subprocess.run([sys.executable, "-c", SCRIPT, socket, path], check=True, capture_output=True)
    open_blend(path)
    with quiet():
        return with_render_depsgraph(bpy.context.scene, lambda depsgraph: export_scene(depsgraph, partial=partial))


@pytest.mark.parametrize("socket", ["Color", "Surface"])
def test_a_node_type_that_this_blender_lacks_is_refused_in_one_line(tmp_path, socket):
    with pytest.raises(Refused) as found:
        export(socket, tmp_path)
    (refusal,) = found.value.refusals
    assert "material 'Material': node 'Newer'" in str(refusal)
    assert f"this Blender ({bpy.app.version_string}) lacks its type" in str(refusal)
    assert "\n" not in str(refusal)


def test_a_partial_comparison_leaves_out_the_material_with_it(tmp_path):
    (material,) = export("Color", tmp_path, partial=True).materials
    assert "node 'Newer'" in material.unknown
