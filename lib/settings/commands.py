# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of several small commands.

They are `etalon plan`, `scenes`, `batch`, `stability`, `microsurface`, `illustrate` and `completion`.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from ..errors import EtalonError
from .common import LOCAL, Seeded
from .declaration import Declared, option, required
from .units import Alpha, Choice, FilePath, Flag, Pair, Unit, Whole

FIGURES = ("densities", "facets", "uniform", "inversions", "slips", "illustrations", "caches", "masking")
SHELLS = ("bash", "zsh", "fish", "tcsh", "powershell")


@dataclass(frozen=True)
class PlanOutput(Declared):
    """What `etalon plan` does besides listing."""

    save: Path | None = option(None, FilePath("FILE.npz"), "save the exported scene, for `etalon render`")
    csv: Path | None = option(None, FilePath("FILE.csv"), "of a folder: save the table of its files")


@dataclass(frozen=True)
class ScenesOptions(Declared):
    """What `etalon scenes` does besides listing."""

    save: tuple[str, str] | None = option(
        None, Pair("NAME FILE.blend"), "build the reference scene NAME and save it as a .blend"
    )


@dataclass(frozen=True)
class BatchOptions(Declared):
    """The plan of a batch, and how it is run."""

    plan: Path | None = option(
        None, FilePath("PLAN.toml"), "scenes, options and property values to compare", positional=True
    )
    example: bool = option(False, Flag(), "print a plan to begin with, and end")
    dry_run: bool = option(False, Flag(), "check the plan, and list what would be run and how long that takes")
    jobs: int | None = option(
        None, Whole("N", 1), "comparisons that run side by side", absent="as many as processors and memory allow"
    )
    scheduler: str = option(
        LOCAL, Unit("ADDRESS"), "run comparisons on the workers of a Dask scheduler, such as tcp://host:8786"
    )
    force: bool = option(False, Flag(), "run all comparisons again")
    retry_failed: bool = option(False, Flag(), "run comparisons again that were refused or failed")
    against: Path | None = option(None, FilePath("EARLIER"), "folder of an earlier batch: say what has changed since")
    fail_on: str | None = option(
        None,
        Unit("RULE"),
        "exit code 1 by a rule alone, 0 otherwise: different, changed (with --against), or bound:2%",
        absent="the exit code of the worst comparison",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.plan is None and not self.example:
            raise EtalonError("name a plan, as in etalon batch PLAN.toml; --example prints one, --help explains it")


@dataclass(frozen=True)
class StabilityOptions(Declared):
    """How much of the atlas is measured, and where its report goes."""

    points: int = option(200, Whole("N", 1), "number of points at which each equation is measured", advanced=True)
    scenes: bool = option(True, Flag(), "render the scenes at the edge too, which needs Blender")
    out: Path = option(Path("etalon-out/stability"), FilePath("FOLDER"), "folder for stability.html and stability.json")


@dataclass(frozen=True, kw_only=True)
class MicrosurfaceOptions(Seeded):
    """The surface whose facets are traced, and from where.

    `correlation` is the length over which heights are alike, in cells of the grid: the longer, the smoother are facets, and the fewer of
    them are on a field.
    """

    TITLE: ClassVar[str] = ""
    STEEPEST: ClassVar[int] = 88
    LONGEST: ClassVar[int] = 32

    alpha: float = option(0.6, Alpha(), "alpha of Beckmann's distribution: roughness squared")
    angle: int | None = option(
        None, Whole("DEGREES", 0), "angle from the normal, up to 88", absent="30, 60, 75 and 82 degrees"
    )
    fields: int = option(8, Whole("N", 2), "independent height fields, whose differences give the errors")
    correlation: int = option(
        8, Whole("CELLS", 4), "length of correlation in cells of the grid, up to 32", advanced=True
    )
    mesh: Path | None = option(
        None,
        FilePath("FILE.ply"),
        "also write the first height field as a mesh, to render it elsewhere",
        absent="no file",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.angle is not None and self.angle > self.STEEPEST:
            raise EtalonError(f"--angle: {self.angle} is out of range; give 0 to {self.STEEPEST} degrees")
        if self.correlation > self.LONGEST:
            raise EtalonError(f"--correlation: {self.correlation} is out of range; give 4 to {self.LONGEST} cells")
        if self.mesh is not None and self.mesh.suffix.lower() != ".ply":
            raise EtalonError(f"--mesh: {self.mesh} is not a PLY file; name a file that ends in .ply")


@dataclass(frozen=True, kw_only=True)
class IllustrateOptions(Seeded):
    """Which figures are made, and where the page goes."""

    TITLE: ClassVar[str] = ""

    out: Path = option(Path("etalon-out/lecture.html"), FilePath("FILE.html"), "the page, one file")
    only: str | None = option(
        None, Choice("FIGURE", "figure", FIGURES), f"one figure alone: {', '.join(FIGURES)}", absent="all figures"
    )


@dataclass(frozen=True)
class CompletionOptions(Declared):
    """The shell that completes the words of `etalon`."""

    shell: str = required(Choice("SHELL", "shell", SHELLS), f"one of {', '.join(SHELLS)}", positional=True)
