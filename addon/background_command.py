# SPDX-License-Identifier: GPL-3.0-or-later
"""A command of the command line on a copy of the open file, in a second Blender.

The window stays alive meanwhile.
"""

from __future__ import annotations

import json
import re
import subprocess
import threading
import time
from contextlib import ExitStack
from typing import Any

import bpy

from ..lib.batch.process import end, find_blender, start
from ..lib.comparison.compare import Comparison
from ..lib.comparison.interim import BoundAt
from ..lib.errors import EtalonError, Refusal
from ..lib.files.ownership import temporary_folder
from ..lib.refusals import is_for_command_line
from ..lib.settings.declaration import Declared
from ..lib.settings.words import write_changes
from .background import Background, save_copy

_SHARE = re.compile(r"(.*?)\s*(\d+)%")


class BackgroundCommand(Background):
    """`etalon COMMAND --json` beside the window.

    It is the same function as on a terminal, with the same options. Made and read by the main thread. `stage` and
    `fraction` say how far it is. When `done`, either `figures`, what the command prints as JSON, is there, or
    `errors`, or neither if it was cancelled.
    """

    def __init__(self, command: str, settings: tuple[Declared, ...], seconds: float | None) -> None:
        super().__init__()
        program = find_blender()
        if program is None:
            raise EtalonError("this is Python with Blender as a module; use the command line")
        self.command = command
        self.stage = "reading the scene"
        self.fraction = 0.0
        self.figures: Any = None
        self.errors: tuple[str, ...] = ()
        self.refusals: tuple[Refusal, ...] = ()
        # What a comparison has besides.
        self.bounds: list[BoundAt] = []
        self.comparison: Comparison | None = None
        self._seconds, self._began = seconds, time.monotonic()
        self._temporary = ExitStack()
        folder = self._temporary.enter_context(temporary_folder())
        copy = folder / (bpy.path.basename(bpy.data.filepath) or "scene.blend")
        save_copy(copy)
        words = [program, str(copy), "--background", "--disable-autoexec", "--command", "etalon", command, "--json"]
        self._process = start(
            [*words, *write_changes(*settings)],
            temporary=folder,
            leash=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        self._thread = threading.Thread(target=self._run, name=f"etalon {command}", daemon=True)
        self._thread.start()

    @property
    def seconds_left(self) -> float | None:
        """Seconds until its time is spent; None where it has none."""
        return None if self._seconds is None else max(self._seconds - (time.monotonic() - self._began), 0.0)

    def cancel(self) -> None:
        """End it at once."""
        self._cancel.set()
        end(self._process)

    def _run(self) -> None:
        words: list[str] = []
        listener = threading.Thread(target=self._listen, args=(words,), daemon=True)
        listener.start()
        try:
            text = self._process.stdout.read()
            self._process.wait()
            listener.join()
            if not self._cancel.is_set():
                self._read(text, words)
        finally:
            for pipe in (self._process.stdin, self._process.stdout, self._process.stderr):
                pipe.close()
            self._temporary.close()

    def _listen(self, words: list[str]) -> None:
        """Follow the progress on standard error, and keep what it says last."""
        for line in self._process.stderr:
            said = line.strip()
            if said.startswith("etalon: "):
                words.append(said.removeprefix("etalon: "))
            elif ": " in said:
                said = said.partition(": ")[2]
                share = _SHARE.fullmatch(said)
                self.stage = share[1] if share else said
                self.fraction = int(share[2]) / 100 if share else self.fraction

    def _read(self, text: str, words: list[str]) -> None:
        """Take the object of JSON out of all that Blender prints."""
        begin = next((n for n, line in enumerate(text.split("\n")) if line == "{"), None)
        if begin is None:
            said = tuple(line for line in words if not is_for_command_line(line))
            self.errors = said or (f"etalon {self.command}: the second Blender ended early",)
            return
        lines = text.split("\n")[begin:]
        self.figures = json.loads("\n".join(lines[: lines.index("}") + 1]))
