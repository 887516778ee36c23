# SPDX-License-Identifier: GPL-3.0-or-later
"""The script that runs inside another Blender, or a Python that has Blender as a module.

The one argument after `--` is JSON. `scene` or `target`: open that scene, export it where `exports` says so, then
render one replicate for each line on standard input. `words`: run that command line of `etalon`. `display`: apply
that view transform to an image in `folder`. `probe`: say which Blender this is, and which of these modules it lacks.
`packages` is a folder with modules that it lacks.

It is run as a script, so it makes the package around it importable first, under the name it has outside Blender.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import json
import os
import queue
import sys
import threading
from pathlib import Path
from typing import Any

MARK = "etalon: "
# The image that a view transform is applied to, and its code values.
RADIANCE, CODES = "radiance.npy", "codes.npy"


def _package() -> str:
    """Make the package that this file lies in importable, and return its name."""
    root = Path(__file__).resolve().parents[2]
    spec = importlib.util.spec_from_file_location(
        "etalon", root / "__init__.py", submodule_search_locations=[str(root)]
    )
    sys.modules["etalon"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules["etalon"])
    return "etalon"


def _requests() -> queue.SimpleQueue[str]:
    """The lines of standard input.

    Where its other end is closed, nobody waits for an answer, and this process ends at once.
    """
    lines: queue.SimpleQueue[str] = queue.SimpleQueue()

    def read() -> None:
        for line in sys.stdin:
            lines.put(line)
        os._exit(0)

    threading.Thread(target=read, name="requests", daemon=True).start()
    return lines


def _serve(request: dict[str, Any], package: str) -> None:
    """Answer the other process, in marked lines of JSON, until its end of the pipe closes."""
    import bpy
    import numpy as np

    load = importlib.import_module
    cycles, job = (load(f"{package}.addon.{name}") for name in ("cycles.renderer", "job"))
    names = ("errors", "progress", "film.windows", "film.parts", "settings.comparison")
    errors, progress, windows, parts, options = (load(f"{package}.lib.{name}") for name in names)
    quiet = load(f"{package}.addon.host.quiet")
    load(f"{package}.lib.wavefront.tuning").tune_process()
    folder = Path(request["folder"])
    settings = options.Settings.from_json(request["settings"])
    requests = _requests()
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")

    def say(**answer: Any) -> None:
        answers.write(f"{MARK}{json.dumps(answer)}\n")
        answers.flush()

    with quiet.quiet(), contextlib.ExitStack() as stack:
        try:
            scene = bpy.data.scenes[request["scene"]] if "scene" in request else _open(request["target"], package)
            state = {"threads": settings.threads, "motion_blur": settings.motion_blur}
            if request["exports"]:
                exported = job.export(scene, settings.partial, settings.motion_blur)
                state["one_light"] = _save(exported, folder, package)
            stack.enter_context(cycles.neutral(scene, **state))
            renderer = cycles.CyclesRenderer(scene, seed=settings.seed, **state)
            about = {"title": job.name_of_file(scene), "may_shrink": not scene.render.use_border}
            say(name=renderer.name, settings=renderer.settings, scene=str(folder / "scene.npz"), **about)
            while True:
                wanted = json.loads(requests.get())
                if "show" in wanted:
                    shown = wanted["show"]
                    job.show(scene, settings, tuple(shown["box"]), shown["names"], Path(shown["path"]))
                    say(shown=True)
                    continue
                part = wanted["windows"] and windows.Windows(*wanted["windows"])
                sized = renderer.with_one_light() if wanted["one_light"] else renderer
                sized = sized.at_size(*wanted["size"]) if wanted["size"] else sized
                sized = sized.with_passes([parts.decode_part(name) for name in wanted["passes"]])
                done = sized.render(
                    wanted["replicate"], wanted["samples"], progress.Progress(lambda f: say(progress=f)), part
                )
                passes = {parts.encode_part(part): image for part, image in done.passes.items()}
                np.savez(folder / "images.npz", radiance=done.radiance, nonfinite=done.nonfinite, **passes)
                say(
                    images=str(folder / "images.npz"),
                    seconds=done.seconds,
                    stages=done.stages,
                    camera_samples=done.camera_samples,
                    rays=done.rays,
                )
        except errors.Refused as refused:
            say(refusals=[vars(one) for one in refused.refusals], allows_partial=refused.allows_partial)
        except errors.EtalonError as error:
            say(error=str(error))


def _save(exported: Any, folder: Path, package: str) -> bool:
    """Save an exported scene in `folder`, and return whether one lamp is all that shines in it."""
    names = "scene.archive", "effects.light_sources"
    archive, sources = (importlib.import_module(f"{package}.lib.{name}") for name in names)
    archive.save(exported, folder / "scene.npz")
    return sources.has_one_light(exported)


def _open(target: dict[str, Any], package: str) -> Any:
    """Open the scene that a command line would open for the values of a Target.

    Raises EtalonError as the command line does.
    """
    import bpy

    common = importlib.import_module(f"{package}.lib.settings.common")
    opening = importlib.import_module(f"{package}.addon.command.opening")
    importlib.import_module(f"{package}.addon.host.blender_at_hand").require_supported_blender()
    asked = common.Target.from_json(target)
    opening.open_asked(asked)
    return bpy.context.scene


def _run(words: list[str], package: str) -> None:
    """Run a command line and end this process with its exit code.

    Blender would not pass the code on.
    """
    code = importlib.import_module(f"{package}.addon.command.cli").main(words)
    if "--background" not in sys.argv:
        sys.exit(code)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def _display(request: dict[str, Any], package: str) -> None:
    """Apply a view transform to the image in a folder, say when that is done, and end this process."""
    import numpy as np

    errors, view = (importlib.import_module(f"{package}.lib.{name}") for name in ("errors", "film.view_transform"))
    _requests()
    folder, values = Path(request["folder"]), request["display"]
    transform = view.ViewTransform(**values | {"config": Path(values["config"])})
    try:
        np.save(folder / CODES, transform.apply(np.load(folder / RADIANCE)))
        answer = {"applied": True}
    except errors.EtalonError as error:
        answer = {"error": str(error)}
    sys.stdout.write(f"{MARK}{json.dumps(answer)}\n")
    sys.stdout.flush()
    os._exit(0)  # a thread still reads standard input


def _probe(modules: list[str]) -> None:
    """Print which Blender this is, and which of the modules are missing."""
    import bpy

    missing = []
    for name in modules:
        try:
            importlib.import_module(name)
        except ImportError:
            missing.append(name)
    build = f"{bpy.app.build_hash.decode('utf-8', 'replace')}, {bpy.app.build_date.decode('utf-8', 'replace')}"
    python = ".".join(map(str, sys.version_info[:2]))
    version = list(bpy.app.version)
    told = {"version": version, "shown": bpy.app.version_string, "build": build, "python": python, "missing": missing}
    sys.stdout.write(f"{MARK}{json.dumps(told)}\n")
    sys.stdout.flush()


def _main(request: dict[str, Any]) -> None:
    if request.get("packages"):
        sys.path.append(request["packages"])
    if "probe" in request:
        _probe(request["probe"])
    elif "words" in request:
        _run(request["words"], _package())
    elif "display" in request:
        _display(request, _package())
    else:
        _serve(request, _package())


if __name__ == "__main__":
    _main(json.loads(sys.argv[sys.argv.index("--") + 1]))
