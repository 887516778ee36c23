# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that several commands share.

They are which scene, which random numbers, how many threads, and what the terminal shows.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import ClassVar

from .declaration import Declared, option
from .units import Flag, Texts, Unit, Whole

# The scheduler that is none: everything runs on this machine.
LOCAL = "local"
# The names of the reference scenes; each is a file in `reference_scenes/`.
REFERENCE_SCENES = (
    "glossy_spheres",
    "sigma_sweep",
    "furnace",
    "grazing_plane",
    "veach_plates",
    "cornell_glossy",
    "lambert_analytic",
    "far_from_origin",
)


def count_processors() -> int:
    """The number of processors of this machine, at least 1."""
    return os.cpu_count() or 1


@dataclass(frozen=True, kw_only=True)
class Seeded(Declared):
    """The one seed: of all scramblings of the reference, and of Cycles."""

    TITLE: ClassVar[str] = "random numbers and threads"

    seed: int = option(0, Whole("N"), "seed of the random numbers of the reference and of Cycles", advanced=True)


@dataclass(frozen=True, kw_only=True)
class Run(Seeded):
    """What every command that renders takes."""

    TITLE: ClassVar[str] = "random numbers and threads"

    threads: int = option(
        2, Whole("N", 1), "number of threads", absent="all processors", advanced=True, compute=count_processors
    )


@dataclass(frozen=True)
class Target(Declared):
    """The scene to work on, and what is set in it before it is rendered.

    `scene` is the name of a reference scene, a .blend file, or where no Blender is needed a scene saved as .npz; None is the file that
    is open in Blender. `assignments` are texts such as 'objects["Lamp"].location[2]=3.5': a data path and a value as in JSON.
    """

    scene: str | None = option(
        None,
        Unit("SCENE"),
        "name of a reference scene (see `etalon scenes`), or a .blend file",
        absent="inside Blender, the file that is open",
        positional=True,
    )
    frame: int | None = option(None, Whole("N"), "frame to render", absent="the file's current frame")
    camera: str | None = option(None, Unit("NAME"), "camera object to render from", absent="the file's active camera")
    view_layer: str | None = option(
        None, Unit("NAME"), "view layer to render", absent="the first one that is used for rendering", advanced=True
    )
    assignments: tuple[str, ...] = option(
        (),
        Texts("PATH=VALUE"),
        "set a property by its data path before rendering; write the value as in JSON; may be repeated",
        flag="set",
        advanced=True,
    )

    @property
    def is_archive(self) -> bool:
        """Whether the scene is one saved as .npz, which needs no Blender."""
        return self.scene is not None and self.scene.endswith(".npz")


@dataclass(frozen=True, kw_only=True)
class Terminal(Declared):
    """What a command shows on the terminal.

    It is the result in words or as JSON, and whether progress is shown.
    """

    TITLE: ClassVar[str] = "the terminal"

    json: bool = option(False, Flag(), "print the result as JSON")
    quiet: bool = option(False, Flag(), "show no progress")


@dataclass(frozen=True, kw_only=True)
class PageTerminal(Terminal):
    """The same for a command that writes a page."""

    TITLE: ClassVar[str] = "the terminal"

    open: bool = option(False, Flag(), "open the report in the web browser when it is written")
