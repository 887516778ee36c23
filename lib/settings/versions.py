# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of `etalon versions` beside those of a comparison."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..errors import EtalonError
from .common import Target
from .comparison import ComparisonSettings
from .declaration import Declared, again, option, required
from .units import FilePath, Texts


@dataclass(frozen=True)
class VersionsTarget(Declared):
    """The scenes, the Blenders, and what is set in each scene before it is rendered."""

    scenes: tuple[str, ...] = required(Texts("FILE"), ".blend files, or names of reference scenes", positional=True)
    blender: tuple[str, ...] = required(
        Texts("VERSION|PATH"),
        "a Blender: a release such as 4.5, installed if it is missing, or the path of a Blender, or of a Python with bpy; give two or more",
    )
    frame: int | None = again(Target, "frame")
    camera: str | None = again(Target, "camera")
    view_layer: str | None = again(Target, "view_layer")
    assignments: tuple[str, ...] = again(Target, "assignments")

    def __post_init__(self) -> None:
        super().__post_init__()
        if len(self.blender) < 2:
            raise EtalonError("name at least two Blenders, such as --blender 4.5 --blender 5.2")


@dataclass(frozen=True, kw_only=True)
class VersionsSettings(ComparisonSettings):
    """The options of a comparison, for all scenes.

    out: folder for versions.html, versions.json and the reports.
    """

    tolerance: float = again(ComparisonSettings, "tolerance", help="largest relative change that counts as none")
    confidence: float = again(
        ComparisonSettings, "confidence", help="confidence of all claims on the changes of a scene together"
    )
    time: float | None = again(
        ComparisonSettings,
        "time",
        help="time budget of a scene; one half goes to comparisons with the reference, one to comparing the versions",
        nullable=False,
    )
    passes: str = again(
        ComparisonSettings,
        "passes",
        help="light passes to compare beside the image; auto: those of comparisons with the reference, none between versions",
    )
    out: Path = option(
        Path("etalon-out/versions"), FilePath("FOLDER"), "folder for versions.html, versions.json and the reports"
    )
