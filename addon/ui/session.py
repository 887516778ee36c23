# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of the window.

It is the comparison that runs, and for each scene the one that ran last.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy

from ...lib.comparison.compare import Comparison
from ...lib.errors import Refusal
from ...lib.film.parts import Part
from ...lib.report.headline import Phrase, details, headline
from ...lib.report.ranking import RankedRegion, rank_regions
from .. import job
from ..background_command import BackgroundCommand


@dataclass(frozen=True)
class Setup:
    """What a result depends on besides the scene's content.

    When one of these changes, the result is out of date.
    """

    engine: str
    size: tuple[int, int, int]
    frame: int
    camera: str

    @classmethod
    def of(cls, scene: bpy.types.Scene) -> Setup:
        """The setup of `scene` as it is now."""
        render = scene.render
        return cls(
            render.engine,
            (render.resolution_x, render.resolution_y, render.resolution_percentage),
            scene.frame_current,
            scene.camera.name if scene.camera else "",
        )


@dataclass(eq=False)
class Result:
    """The result of one comparison of a scene.

    `border` is the part of the frame that was compared: left, bottom, right, top, in shares of it. `is_changed` says that the scene has
    changed since the comparison began.
    """

    comparison: Comparison
    folder: Path
    setup: Setup
    border: tuple[float, float, float, float]
    is_changed: bool
    regions: list[RankedRegion] = field(init=False)
    headline: Phrase = field(init=False)
    details: list[Phrase] = field(init=False)
    _of_parts: dict[Part, list[RankedRegion]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        self.regions = rank_regions(self.comparison)
        self.headline, self.details = headline(self.comparison, self.regions), details(self.comparison)

    def regions_of(self, part: Part | None) -> list[RankedRegion]:
        """The regions in a part of the light, the worst first; those of the image where that part was not compared."""
        found = self.comparison.passes
        if found is None or part not in found.passes:
            return self.regions
        if part not in self._of_parts:
            self._of_parts[part] = rank_regions(self.comparison, part)
        return self._of_parts[part]

    def is_stale(self, scene: bpy.types.Scene) -> bool:
        """Whether the result may be another one by now."""
        return self.is_changed or Setup.of(scene) != self.setup


@dataclass(eq=False)
class Running:
    """A comparison under way.

    It has the scene's identifier in this session of Blender, and the scene's state when the comparison began.
    """

    job: job.BackgroundJob | BackgroundCommand
    uid: int
    setup: Setup
    border: tuple[float, float, float, float]
    is_changed: bool = False
    result: Result | None = None


@dataclass
class Session:
    """The one job that runs, and the results of earlier ones by scene.

    By a scene's identifier it has the last result, the errors or refusals of the last job, and what commands found.
    """

    running: Running | None = None
    results: dict[int, Result] = field(default_factory=dict)
    errors: dict[int, tuple[str, ...]] = field(default_factory=dict)
    refusals: dict[int, tuple[Refusal, ...]] = field(default_factory=dict)
    figures: dict[int, dict[str, Any]] = field(default_factory=dict)

    def begin(self, scene: bpy.types.Scene, started: job.BackgroundJob | BackgroundCommand) -> None:
        """Make `started` the comparison that counts from now on.

        The last result stays until there is a new one.
        """
        self.errors.pop(scene.session_uid, None)
        self.refusals.pop(scene.session_uid, None)
        self.running = Running(started, scene.session_uid, Setup.of(scene), compared_border(scene))

    def take_result(self) -> Result | None:
        """The result of the job that runs, once it is concluded.

        Its report may still be in the making. None if it is not concluded, or was taken before.
        """
        running = self.running
        if running is None or running.result is not None or running.job.comparison is None:
            return None
        running.result = Result(
            running.job.comparison, running.job.folder, running.setup, running.border, running.is_changed
        )
        self.results[running.uid] = running.result
        return running.result

    def end(self) -> Running:
        """End the job and keep its errors.

        A job without a comparison leaves the last result as it is.
        """
        ended, self.running = self.running, None
        if isinstance(ended.job, BackgroundCommand) and ended.job.figures is not None:
            self.figures.setdefault(ended.uid, {})[ended.job.command] = ended.job.figures
            refusals = ended.job.figures.get("refusals", ())
            ended.job.refusals = tuple(Refusal(**one) for one in refusals)
        if ended.job.refusals:
            self.refusals[ended.uid] = ended.job.refusals
        elif ended.job.errors:
            for error in ended.job.errors:
                self.add_error(ended.uid, error)
        return ended

    def add_error(self, uid: int, error: str) -> None:
        """Keep an error of a scene beside those of its job, once; an empty one is ignored."""
        known = self.errors.get(uid, ())
        if error and error not in known:
            self.errors[uid] = (*known, error)

    def mark_changed(self) -> None:
        """The content of the file has changed: all results may be others by now."""
        for result in self.results.values():
            result.is_changed = True
        if self.running is not None:
            self.running.is_changed = True

    def result_of(self, scene: bpy.types.Scene) -> Result | None:
        """The last result of `scene`."""
        return self.results.get(scene.session_uid)

    def is_running(self, scene: bpy.types.Scene) -> bool:
        """Whether a comparison of `scene` is under way."""
        return self.running is not None and self.running.uid == scene.session_uid

    def forget(self) -> None:
        """End what runs, and drop all results; reports that are written stay where they are."""
        if self.running is not None:
            self.running.job.cancel()
            self.running.job.wait()
        self.running = None
        self.results.clear()
        self.errors.clear()
        self.refusals.clear()
        self.figures.clear()


session = Session()


def compared_border(scene: bpy.types.Scene) -> tuple[float, float, float, float]:
    """The part of the frame that `scene` renders: left, bottom, right, top, in shares of it."""
    render = scene.render
    if not render.use_border:
        return 0.0, 0.0, 1.0, 1.0
    return render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y
