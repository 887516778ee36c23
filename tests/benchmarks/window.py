# SPDX-License-Identifier: GPL-3.0-or-later
"""Times in a window of the real program.

They are redraws, first progress, cancelling, drawing the panel, a long list, and the bound that half a minute gives.

    python -m pytest -p etalon.tests.blender.conftest -m blender -n 0 -s tests/benchmarks/window.py

It prints what was measured beside what issue 18 asks for, and the load of the machine. It asserts no time. Other work
makes all of it slower.
"""

import itertools
import os

import pytest
from etalon.tests.blender.hand import RUN, START, STOP, settle, wait_until

pytestmark = pytest.mark.blender

WATCH = """
import time
import bl_ext.user_default.etalon.addon.ui.panels as panels

log = bpy.app.driver_namespace["log"] = {}
plain = panels._Main.draw


def draw(self, context):
    begin = time.thread_time()
    plain(self, context)
    if context.area.type == "VIEW_3D" and "draws" in log:
        log["draws"].append(time.monotonic())
        log["took"].append(time.thread_time() - begin)


def look():
    running = session.running
    if running is not None:
        bound = running.job.bounds[-1].bound if running.job.bounds else None
        log["seen"].append((time.monotonic(), running.job.stage, running.job.fraction, bound, running.job.is_cancelled))
        if running.result is not None:
            log.setdefault("shown", time.monotonic())
    elif log.get("seen") and "ended" not in log:
        log["ended"] = time.monotonic()
    return 0.02


panels._Main.draw = draw
bpy.app.timers.register(look)
"""
PREPARE = """
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = SIZE
scene.etalon.time = TIME
"""
PRESS = """
import time
log = bpy.app.driver_namespace["log"]
log.clear()
log.update(draws=[], took=[], seen=[])
log["pressed"] = time.monotonic()
bpy.ops.etalon.compare("INVOKE_DEFAULT")
log["returned"] = time.monotonic()
"""
LOG = "bpy.app.driver_namespace['log']"
# What Blender opens with, made here: the window opens another file.
DEFAULT = """
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
bpy.ops.mesh.primitive_cube_add()
bpy.ops.object.light_add(type="POINT", location=(4.08, 1.01, 5.9))
bpy.context.object.data.energy, bpy.context.object.data.shadow_soft_size = 1000.0, 0.1
bpy.ops.object.camera_add(location=(7.36, -6.93, 4.96), rotation=(1.109, 0.0, 0.815))
bpy.context.scene.camera = bpy.context.object
bpy.context.object.data.lens = 50.0
world = bpy.context.scene.world or bpy.data.worlds.new("World")
bpy.context.scene.world, world.use_nodes = world, True
world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.05, 0.05, 0.05, 1.0)
"""


# As many regions as there can be, listed at once.
MANY = """
import time
from bl_ext.user_default.etalon.addon.ui.regions import fill_tables
result = session.results[bpy.context.scene.session_uid]
result.regions = (result.regions * (1 + 10000 // len(result.regions)))[:10000]
log = bpy.app.driver_namespace["log"]
log["took"], log["draws"] = [], []
begin = time.perf_counter()
fill_tables(bpy.context.window_manager)
filled = time.perf_counter() - begin
begin = time.perf_counter()
bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
[len(result.regions), filled, time.perf_counter() - begin, max(log["took"])]
"""


def load():
    """What else the machine is doing, beside each figure."""
    return f"[load {os.getloadavg()[0]:.1f}]"


def measure(window, size, seconds, cancel=""):
    """Run one comparison, and cancel it where `cancel` holds.

    Returns the report of its end, and its log.
    """
    window.ask(PREPARE.replace("SIZE", repr(size)).replace("TIME", repr(seconds)))
    settle(window, 60)  # without a graphics card, the 3D view is drawn for seconds after a change
    window.ask(PRESS, seconds=STOP)
    if cancel:
        wait_until(window, f"session.running is not None and {cancel}", questions=1200)
        window.ask(f"import time\n{LOG}['cancelled'] = time.monotonic()\nsession.running.job.cancel()")
    ended = window.wait_for("ended", seconds=RUN)
    wait_until(window, f"'ended' in {LOG}")
    return ended, window.ask(LOG)


def describe_redraws(log):
    """How often the panel was drawn while the job ran, in all and in each stage.

    Also the longest time without a redraw.
    """
    lines, stages = [], {}
    for after, stage, *_ in log["seen"]:
        stages.setdefault(stage, after)
    ends = [*list(stages.values())[1:], log["ended"]]
    for name, begin, end in [("all", log["pressed"], log["ended"]), *zip(stages, stages.values(), ends, strict=True)]:
        during = [begin, *(one for one in log["draws"] if begin < one < end), end]
        gap = max(b - a for a, b in itertools.pairwise(during))
        lines.append(f"{name} {(len(during) - 2) / max(end - begin, 1e-3):.1f} (gap {gap:.2f} s)")
    return ", ".join(lines)


def describe_times(log):
    """When each stage began, and the bound at each look.

    They are in seconds after the button was pressed.
    """
    begin, stages = log["pressed"], {}
    for after, stage, *_ in log["seen"]:
        stages.setdefault(stage, round(after - begin, 2))
    bounds = {s[3]: round(s[0] - begin, 1) for s in log["seen"] if s[3] is not None}
    within = next((f"{s[0] - begin:.1f} s" for s in log["seen"] if s[3] is not None and s[3] <= 0.05), "never")
    return f"within 5 % after {within} (asked: 30 s); stages {stages}; bounds {bounds}"


def test_times_of_the_panel(window):
    window.wait_for("ready", seconds=START)
    window.ask(DEFAULT)
    window.ask(WATCH)
    ended, log = measure(window, (1920, 1080, 100), 30.0)
    took = sorted(log["took"])
    first = next(s[0] for s in log["seen"] if s[1] != "reading the scene") - log["pressed"]
    say(f"default scene, 1920 x 1080, 30 s: {ended['outcome']}, {ended['errors'] or 'no error'}")
    say(f"button held for {log['returned'] - log['pressed']:.2f} s; scene read after {first:.2f} s (asked: 2 s)")
    say(f"redraws per second (asked: 10): {describe_redraws(log)}")
    say(
        f"panel draw: median {1e3 * took[len(took) // 2]:.2f} ms, longest {1e3 * took[-1]:.2f} ms of processor time (asked: 2 ms)"
    )
    say(describe_times(log))
    count, filled, drawn, longest = window.ask(MANY)
    say(f"{count} regions: {filled:.3f} s to fill, {drawn:.3f} s until drawn, panel draw {1e3 * longest:.2f} ms")
    for name, condition in (
        ("in the first look", "session.running.job.stage == 'first look' and session.running.job.fraction > 0.02"),
        ("while rendering", "session.running.job.bounds and session.running.job.stage.startswith('rendering')"),
    ):
        ended, log = measure(window, (3840, 2160, 100), 60.0, cancel=condition)
        shown, after = (log.get(name, log["ended"]) - log["cancelled"] for name in ("shown", "ended"))
        say(f"3840 x 2160, cancelled {name}: {ended['outcome']}, result shown {shown:.2f} s after (asked: 1 s)")
        last = {stage: round(t - log["cancelled"], 2) for t, stage, *_ in reversed(log["seen"]) if t > log["cancelled"]}
        say(f"report written {after:.2f} s after; stages since {last}; errors {ended['errors']}")


def say(line):
    print(f"\n{line} {load()}", end="", flush=True)
