# SPDX-License-Identifier: GPL-3.0-or-later
"""Files whose linked library is gone.

An object that has its faces is compared and reported, one that lacks them is refused by name.
"""

import bpy
import pytest
from etalon.addon.export.missing_libraries import find_missing_libraries
from etalon.lib.errors import Refused


@pytest.fixture
def linked(studio, tmp_path):
    """A function that takes a library away.

    It makes the library of an object and its material, and links them before.
    """

    def link(use):
        thing = studio.quad("shelf")
        paint = bpy.data.materials.new("paint")
        group = bpy.data.collections.new("set")
        group.objects.link(thing)
        library = tmp_path / "shop.blend"
        bpy.data.libraries.write(str(library), {thing, paint, group})
        for one in (thing.data, thing, paint, group):
            one.name = "old"
        bpy.data.objects.remove(thing)
        with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
            wanted.objects, wanted.materials, wanted.collections = ["shelf"], ["paint"], ["set"]
        found = {
            one.name: one for one in (*bpy.data.objects, *bpy.data.materials, *bpy.data.collections) if one.library
        }
        use(found)
        path = tmp_path / "room.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        library.unlink()
        bpy.ops.wm.open_mainfile(filepath=str(path))
        studio.scene = bpy.context.scene

    return link


def test_a_missing_material_is_a_finding(studio, linked):
    own = studio.quad("own")
    linked(lambda found: own.data.materials.append(found["paint"]))
    scene = studio.export()
    (finding,) = (one for one in scene.findings if one.check == "missing libraries")
    assert "missing with the library '//shop.blend': 'Material paint'." in str(finding)
    assert [material.name for material in scene.materials] == ["plain", "paint"]


def test_missing_meshes_and_collections_are_refused_by_name(studio, linked):
    studio.quad("own")

    def use(found):
        studio.scene.collection.objects.link(found["shelf"])
        studio.add("copy", found["shelf"].data)
        empty = studio.add("instance", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", found["set"]

    linked(use)
    with pytest.raises(Refused) as caught:
        studio.export()
    missing = {refusal.owner: refusal.what for refusal in caught.value.refusals}
    assert set(missing) == {"object 'shelf'", "object 'copy'", "object 'instance'"}
    assert all("of the library '//shop.blend', which is not there," in what for what in missing.values())
    assert missing["object 'instance'"].startswith("collection 'set'")
    bpy.data.objects["copy"].hide_render = True
    with pytest.raises(Refused) as caught:
        studio.export()
    assert len(caught.value.refusals) == 2


def test_a_file_without_libraries_has_no_such_finding(studio):
    studio.quad("own")
    studio.export()
    assert find_missing_libraries() == ()
