# SPDX-License-Identifier: GPL-3.0-or-later
"""Light and shadow linking against Cycles.

Collections include and exclude lamps, glowing faces and instances.
"""

import bpy
import numpy as np
import pytest
from etalon.lib.errors import Refused
from etalon.lib.scene.links import EVERY_SET, Links
from etalon.tests.addon.export.test_ray_visibility import stage
from etalon.tests.addon.export.test_visibility import FEW_SAMPLES, apart, shader
from mathutils import Matrix


def collect(name, included=(), excluded=(), children=()):
    """A collection of objects and (collection, state) that it includes or excludes."""
    made = bpy.data.collections.new(name)
    for child, _ in children:
        made.children.link(child)
    for thing in (*included, *excluded):
        made.objects.link(bpy.data.objects[thing])
    states = ["INCLUDE"] * len(included) + ["EXCLUDE"] * len(excluded)
    for link, state in zip(made.collection_objects, states, strict=True):
        link.light_linking.link_state = state
    for link, (_, state) in zip(made.collection_children, children, strict=True):
        link.light_linking.link_state = state
    return made


def nested():
    """A child collection is left out, but for one of its objects, which is named itself."""
    child = collect("child", ("floor", "card"))
    return collect("parent", ("floor",), (), ((child, "EXCLUDE"),))


def receivers(thing, make):
    return lambda: setattr(bpy.data.objects[thing].light_linking, "receiver_collection", make())


def blockers(thing, make):
    return lambda: setattr(bpy.data.objects[thing].light_linking, "blocker_collection", make())


def through_a_card():
    """A mirror that shows the lamp behind an upright card, which does not hide it."""
    bpy.data.materials["wall"].node_tree.nodes["Glossy BSDF"].inputs["Roughness"].default_value = 0.0
    bpy.data.lights["lamp"].shadow_soft_size = 0.4
    bpy.data.objects["card"].matrix_world = Matrix.Translation((-1.5, 1.2, 2.5)) @ Matrix.Rotation(np.pi / 2, 4, "X")
    blockers("lamp", lambda: collect("some", (), ("card",)))()


CASES = {
    "a lamp that the card does not hide from a mirror": through_a_card,
    "a lamp for the floor": receivers("lamp", lambda: collect("some", ("floor",))),
    "a lamp for all but the floor": receivers("lamp", lambda: collect("some", (), ("floor",))),
    "a lamp for the floor and not the card": receivers("lamp", lambda: collect("some", ("floor", "wall"), ("card",))),
    "a lamp for a part of a collection": receivers("lamp", nested),
    "a panel for all but the floor": receivers("panel", lambda: collect("some", (), ("floor",))),
    "a panel for the wall": receivers("panel", lambda: collect("some", ("wall",))),
    "a lamp that the card does not hide": blockers("lamp", lambda: collect("some", (), ("card",))),
    "a lamp that the wall alone hides": blockers("lamp", lambda: collect("some", ("wall",))),
    "a panel that the card does not hide": blockers("panel", lambda: collect("some", (), ("card",))),
}

# Of the default run: an included and an excluded object, a lamp and a panel, light and shadow.
QUICK = ("a lamp for a part of a collection",)


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=() if case in QUICK else pytest.mark.slow) for case in CASES]
)
def test_what_is_linked_is_lit_as_in_cycles(studio, case):
    """And the comparison notices a reference that knows nothing of it."""
    card, panel, lamp, _ = stage(studio)
    bpy.data.objects.remove(lamp if "panel" in case else panel)
    if "panel" in case:
        card.location = (1.5, 1.0, 1.0)
    if "hide" in case:
        bpy.data.objects.remove(bpy.data.objects["pane"])
    unaware = studio.export()
    CASES[case]()
    aware, blind = apart(studio, studio.export(), unaware, samples=FEW_SAMPLES)
    assert aware < 1.5
    assert blind > 1.9


def test_links_are_read(studio):
    stage(studio)
    lamp, panel = bpy.data.objects["lamp"], bpy.data.objects["panel"]
    lamp.light_linking.receiver_collection = collect("lit", ("floor", "wall"), ("card",))
    lamp.light_linking.blocker_collection = collect("empty")
    bpy.data.objects["pane"].data.materials[0] = bpy.data.materials["grey"]
    panel.light_linking.blocker_collection = collect("hiding", (), ("card", "pane"))
    read = studio.export()
    things = {thing.name: thing for thing in read.mesh.objects}
    (light,) = read.lights
    lit = {name for name, thing in things.items() if light.links.receivers >> thing.receiver & 1}
    assert lit == {"floor", "wall"}
    assert light.links.blockers == EVERY_SET
    hiding = {name for name, thing in things.items() if things["panel"].links.blockers >> thing.blocker & 1}
    assert hiding == {"floor", "wall", "panel"}
    assert things["card"].links == Links()


def test_an_instance_is_lit_as_its_instancer_is(studio):
    """Where that is in no collection, as the object itself."""
    _, _, lamp, _ = stage(studio)
    inner = bpy.data.collections.new("inner")
    inner.objects.link(bpy.data.objects.new("thing", studio.quad().data))
    for name in ("empty", "other"):
        instancer = studio.add(name, None)
        instancer.instance_type, instancer.instance_collection = "COLLECTION", inner
    lamp.light_linking.receiver_collection = collect("some", ("thing",), ("empty",))
    read = studio.export()
    (light,) = read.lights
    lit = [light.links.receivers >> one.receiver & 1 for one in read.mesh.objects if one.name == "thing"]
    assert sorted(lit) == [0, 1]


def test_glowing_faces_that_a_mirror_may_show_behind_what_does_not_hide_them_are_refused(studio):
    _, panel, _, _ = stage(studio)
    panel.light_linking.blocker_collection = collect("some", (), ("card",))
    with pytest.raises(Refused, match="object 'panel': shadow linking of its faces beside the smooth material 'pane'"):
        studio.export()
    bpy.data.objects["pane"].data.materials[0] = shader("rough", "BsdfGlass", Roughness=0.5)
    studio.export()


def test_more_sets_than_blender_tells_apart_are_refused(studio):
    stage(studio)
    for k in range(64):
        lamp = studio.add(f"lamp {k}", bpy.data.lights.new("lamp", "POINT"))
        lamp.light_linking.receiver_collection = collect(f"some {k}", ("floor",))
    with pytest.raises(Refused, match="light linking with more than 63 collections or sets of objects"):
        studio.export()
