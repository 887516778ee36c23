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

# Another process makes the files, with a node type that is registered there alone.
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
for socket in ("Color", "Surface"):
    bpy.ops.wm.read_factory_settings()
    nodes = bpy.data.materials["Material"].node_tree.nodes
    (principled,) = (n for n in nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    tree = principled.id_data
    lost = tree.nodes.new("EtalonStrange")
    lost.name = "Newer"
    if socket == "Color":
        tree.links.new(lost.outputs["Color"], principled.inputs["Base Color"])
    else:
        tree.links.new(lost.outputs["Shader"], principled.outputs[0].links[0].to_socket)
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(sys.argv[1], socket + ".blend"))
os._exit(0)  # Blender 4.5 as a module never ends where a node class is still registered
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Files in which a node of an unknown type feeds a socket: 'Color' of a shader, 'Surface' of the output."""
    made = tmp_path_factory.mktemp("newer")
    subprocess.run([sys.executable, "-c", SCRIPT, made], check=True, capture_output=True)
    return made


def export(path, partial=False):
    """Export a file."""
    open_blend(path)
    with quiet():
        return with_render_depsgraph(bpy.context.scene, lambda depsgraph: export_scene(depsgraph, partial=partial))


@pytest.mark.parametrize("socket", ["Color", "Surface"])
def test_a_node_type_that_this_blender_lacks_is_refused_in_one_line(folder, socket):
    with pytest.raises(Refused) as found:
        export(folder / f"{socket}.blend")
    (refusal,) = found.value.refusals
    assert "material 'Material': node 'Newer'" in str(refusal)
    assert f"this Blender ({bpy.app.version_string}) lacks its type" in str(refusal)
    assert "\n" not in str(refusal)


def test_a_partial_comparison_leaves_out_the_material_with_it(folder):
    (material,) = export(folder / "Color.blend", partial=True).materials
    assert "node 'Newer'" in material.unknown
