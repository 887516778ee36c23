# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's view transform, applied in another process.

OpenImageIO reads the colour configuration anew for each image. Up to version 2.5 it holds Python's lock meanwhile, about
0.6 s, in which a window could not be drawn.
"""

from __future__ import annotations

import dataclasses
import json
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...lib.batch.process import end, start
from ...lib.errors import EtalonError
from ...lib.files.ownership import temporary_folder
from ...lib.film.view_transform import ViewTransform
from .second_blender import WORKER
from .worker import CODES, MARK, RADIANCE


@dataclass(frozen=True)
class ViewTransformElsewhere(ViewTransform):
    """A view transform that a Blender of its own applies: `program`, without a window and without the user's add-ons."""

    program: str = ""

    def apply(self, radiance: np.ndarray) -> np.ndarray:
        """Return the same code values as ViewTransform.apply; this process keeps Python's lock free meanwhile.

        Raises EtalonError where the configuration lacks the view or the look, or the process ends early.
        """
        with temporary_folder() as folder:
            np.save(folder / RADIANCE, radiance)
            reply = self._ask(folder)
            if "error" in reply:
                raise EtalonError(reply["error"])
            return np.load(folder / CODES)

    def _ask(self, folder: Path) -> dict[str, Any]:
        """What the other process says once it has applied the transform to the image in `folder`."""
        values = {one.name: getattr(self, one.name) for one in dataclasses.fields(ViewTransform)}
        request = {"display": values | {"config": str(self.config)}, "folder": str(folder)}
        command = [self.program, "--background", "--factory-startup", "--disable-autoexec", "--python", str(WORKER)]
        log = (folder / "display.log").open("w", encoding="utf-8")
        with (
            log,
            start(
                [*command, "--", json.dumps(request)],
                temporary=folder,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log.fileno(),
            ) as process,
        ):
            try:
                said = [line for line in process.stdout if line.startswith(MARK)]
            finally:
                end(process)
        if not said:
            raise EtalonError(f"view transform '{self.name}' cannot be applied (its process ended early)")
        return json.loads(said[-1].removeprefix(MARK))


def elsewhere(transform: ViewTransform, program: str) -> ViewTransformElsewhere:
    """`transform`, applied by the Blender that `program` starts."""
    values = {one.name: getattr(transform, one.name) for one in dataclasses.fields(ViewTransform)}
    return ViewTransformElsewhere(**values, program=program)
