# SPDX-License-Identifier: GPL-3.0-or-later
"""Another Blender as a process, which exports the scene and renders Cycles' side.

It serves a window that stays alive, and comparisons with other releases.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import suppress
from copy import copy as shallow_copy
from pathlib import Path
from typing import Any, Self

import numpy as np

from ...lib.batch.process import end, find_blender, last_lines, send, start
from ...lib.errors import EtalonError, Refusal, Refused
from ...lib.film.parts import Part, encode_part
from ...lib.film.rendering import Rendering
from ...lib.film.windows import Windows
from ...lib.progress import NO_PROGRESS, Progress
from ...lib.scene import archive
from ...lib.scene.scene import Scene
from ...lib.settings.comparison import Settings
from .worker import MARK

WORKER = Path(__file__).with_name("worker.py")
# Seconds that a process may take to end once it has closed its output.
_PATIENCE = 5.0


class BlenderEnded(EtalonError):
    """The process ended before it had answered."""


class AnotherBlender:
    """Cycles' side of a comparison, as a renderer, in a process of its own.

    Only its construction needs the main thread. `command` starts a Blender, or a Python that has Blender as a module,
    with `worker.py`; the `request` says which scene. Files that the two pass each other lie in `folder`. Errors call
    the process `title`. Unless it `exports`, it renders alone.
    """

    def __init__(
        self, command: Sequence[str], request: dict[str, Any], folder: Path, title: str, exports: bool = True
    ) -> None:
        self.name = "Cycles"
        self.title = title
        self.settings: dict[str, Any] = {}
        self.scene = ""
        self.may_shrink = False
        self._size: tuple[int, int] | None = None
        self._one_light = False
        self.passes: tuple[Part, ...] = ()
        self._log = folder / "second_blender.log"
        with self._log.open("w", encoding="utf-8") as log:
            self._process = start(
                [*command, json.dumps(request | {"folder": str(folder), "exports": exports})],
                temporary=folder,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log.fileno(),
            )

    def export(self) -> Scene:
        """The scene, exported there; raises Refused or EtalonError."""
        return archive.load(Path(self.open()["scene"]))

    def open(self) -> dict[str, Any]:
        """Wait until the scene is open there; what the process says of it. Raises as `export`."""
        reply = next(self._replies())
        if "refusals" in reply:
            raise Refused([Refusal(**refusal) for refusal in reply["refusals"]], reply["allows_partial"])
        if "error" in reply:
            raise EtalonError(reply["error"])
        self.name, self.settings = reply["name"], reply["settings"]
        self.scene, self.may_shrink = reply["title"], reply["may_shrink"]
        return reply

    def at_size(self, width: int, height: int) -> Self:
        """The same view with fewer pixels, from the same process."""
        smaller = shallow_copy(self)
        smaller._size = width, height
        return smaller

    def with_one_light(self) -> Self:
        """The same process for a scene of which is known that one light object is all that shines.

        A process that exports finds that itself.
        """
        other = shallow_copy(self)
        other._one_light = True
        return other

    def with_passes(self, passes: Sequence[Part]) -> Self:
        """The same process, whose images come with light passes and other parts."""
        more = shallow_copy(self)
        more.passes = tuple(passes)
        return more

    def render(
        self,
        replicate: int,
        samples: int,
        progress: Progress = NO_PROGRESS,
        windows: Windows | None = None,
    ) -> Rendering:
        """One replicate, or its part in `windows`.

        Raises EtalonError if the process ends before it has one; Cancelled if it was stopped because `progress` said so.
        """
        try:
            part = windows and [windows.shape, windows.boxes]
            wanted = {"replicate": replicate, "samples": samples, "windows": part, "size": self._size}
            passes = [encode_part(part) for part in self.passes]
            self._send(wanted | {"passes": passes, "one_light": self._one_light})
            for reply in self._replies():
                if "error" in reply:
                    raise EtalonError(reply["error"])
                if "progress" not in reply:
                    break
                progress.report(reply["progress"])
        except EtalonError:
            progress.check()
            raise
        with np.load(reply.pop("images")) as images:
            passes = {part: images[encode_part(part)] for part in self.passes}
            return Rendering(images["radiance"], images["nonfinite"], windows=windows, passes=passes, **reply)

    def show(self, box: tuple[int, int, int, int], names: list[str], path: Path) -> None:
        """Have a small scene written that shows a difference without a known cause.

        Raises EtalonError where that fails.
        """
        self._send({"show": {"box": box, "names": names, "path": str(path.resolve())}})
        reply = next(self._replies())
        if "error" in reply:
            raise EtalonError(reply["error"])

    def stop(self) -> None:
        """End the process at once; from any thread."""
        end(self._process)

    def close(self) -> None:
        """End the process and close its pipes; only from the thread that reads them."""
        self.stop()
        for pipe in (self._process.stdin, self._process.stdout):
            pipe.close()

    def _send(self, wanted: dict[str, Any]) -> None:
        try:
            send(self._process, json.dumps(wanted) + "\n")
        except OSError as error:
            raise self._gone() from error

    def _replies(self) -> Iterator[dict[str, Any]]:
        """What the worker says, from among all that Blender prints."""
        for line in self._process.stdout:
            if line.startswith(MARK):
                yield json.loads(line[len(MARK) :])
        raise self._gone()

    def _gone(self) -> BlenderEnded:
        """The error that says how the process ended, in its own last words."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(_PATIENCE)
        code = self._process.poll()
        try:
            words = last_lines(self._log.read_text(encoding="utf-8", errors="replace"))
        except OSError:
            words = ""
        if code is not None and code < 0:
            words = f"signal {-code}; {words}" if words else f"signal {-code}"
        words = words or "without a word"
        return BlenderEnded(f"{self.title} ended early ({words}); compare from the command line to see more")


class SecondBlender(AnotherBlender):
    """A second process of the Blender program that runs here, on a saved `copy` of the file."""

    def __init__(self, copy: Path, scene: str, settings: Settings, program: str | None = None) -> None:
        """Start on `copy`; `program` is another Blender than this one."""
        program = program or find_blender()
        if program is None:
            raise EtalonError("this is Python with Blender as a module; run the panel's comparison in Blender itself")
        # Factory settings: no add-on and no script of the user's runs, and none that is in the file.
        command = [
            program,
            "--background",
            "--factory-startup",
            "--disable-autoexec",
            str(copy),
            "--python",
            str(WORKER),
            "--",
        ]
        request = {"scene": scene, "settings": settings.to_json()}
        super().__init__(command, request, copy.parent, "the second Blender")
