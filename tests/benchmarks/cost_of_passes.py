# SPDX-License-Identifier: GPL-3.0-or-later
"""What light passes cost either renderer.

It is the processor time with all passes of a scene, relative to that without any.

    python tests/benchmarks/cost_of_passes.py --turns 8

renders each scene in turns without, with, with, without, so that both meet the machine in the same states. Processor
time counts, since the clock of a machine in use tells little. Other programs on the same processor still slow a
render down, never up: so the fastest renders of either kind are compared, and the medians beside them say how far
that can be trusted.
"""

import argparse
import time
from dataclasses import replace

import bpy
import numpy as np
from etalon.addon.command.opening import open_target
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.host.quiet import quiet
from etalon.addon.job import export
from etalon.lib.comparison.parts import asked_parts, choose_passes
from etalon.lib.settings.comparison import Settings
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.tuning import tune_process

SCENES = {
    "cornell_glossy": ("cornell_glossy", ()),
    "glossy_spheres": ("glossy_spheres", ()),
    "veach_plates": ("veach_plates", ()),
    "cornell_glossy, all Principled": ("cornell_glossy", ("ShaderNodeBsdfPrincipled",)),
    "cornell_glossy, one ball of glass": ("cornell_glossy", (None, "ShaderNodeBsdfGlass")),
    "cornell_glossy, Principled with coat and sheen": ("cornell_glossy", ("ShaderNodeBsdfPrincipled", "coat")),
}


def replace_shader(material, node_type):
    """Have the surface of a material scatter by one node of that type, with its colour."""
    tree = material.node_tree
    output = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
    before = output.inputs["Surface"].links[0].from_node
    if before.bl_idname == "ShaderNodeEmission":
        return None
    node = tree.nodes.new(node_type)
    color = next((one for one in before.inputs if one.name in ("Color", "Base Color")), None)
    if color is not None:
        node.inputs[0].default_value = color.default_value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return node


def change(how):
    """Change the materials of the open file as SCENES say."""
    materials = [one for one in bpy.data.materials if one.node_tree is not None and one.users]
    if how[:1] == ("ShaderNodeBsdfPrincipled",):
        for node in filter(None, [replace_shader(one, how[0]) for one in materials]):
            if how[1:]:
                node.inputs["Coat Weight"].default_value = 0.5
                node.inputs["Sheen Weight"].default_value = 0.5
    elif how:
        named = {obj.active_material for obj in bpy.data.objects if obj.type == "MESH" and len(obj.data.polygons) > 100}
        replace_shader(sorted(filter(None, named), key=lambda one: one.name)[0], how[1])


def measure(renderer, passes, samples, turns):
    """Seconds of processor time of each render, without passes and with: (2, renders)."""
    sides = renderer, renderer.with_passes(passes)
    spent, number = ([], []), 0
    for side in sides:
        side.render(number, samples)
    for _ in range(turns):
        for k in (0, 1, 1, 0):
            number += 1
            begin = time.process_time()
            sides[k].render(number, samples)
            spent[k].append(time.process_time() - begin)
    return np.array(spent)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--turns", type=int, default=8)
    parser.add_argument("--edge", type=int, default=128)
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--reference-samples", type=int, default=0)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--only", default="")
    asked = parser.parse_args()
    tune_process()
    for name, (target, how) in SCENES.items():
        if asked.only not in name:
            continue
        size = (f"scene.render.resolution_{axis}={asked.edge}" for axis in "xy")
        open_target(target, None, None, (*size, "scene.render.resolution_percentage=100"))
        change(how)
        scene = bpy.context.scene
        with quiet(), neutral(scene, threads=asked.threads):
            reference = ReferenceRenderer(export(scene), replace(Options(), threads=asked.threads))
            passes, choice = asked_parts(reference, Settings(passes="all")), choose_passes(reference, Settings())
            sides = {"Cycles": (CyclesRenderer(scene, threads=asked.threads), asked.samples)}
            if asked.reference_samples:
                sides["the reference"] = reference, asked.reference_samples
            found = {side: measure(one, passes, samples, asked.turns) for side, (one, samples) in sides.items()}
        for side, spent in found.items():
            fastest, median = (
                100 * (most[1] / most[0] - 1.0) for most in (spent.min(axis=1), np.median(spent, axis=1))
            )
            told = f"{len(passes)} passes, {spent[0].min():.2f} s a render"
            print(f"{name}, {side}: {fastest:+.1f} % (medians {median:+.1f} %), {told}", flush=True)
        print(f"  expected of Cycles: {100 * choice.cost:+.1f} %: {choice.passes}", flush=True)


if __name__ == "__main__":
    main()
