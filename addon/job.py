# SPDX-License-Identifier: GPL-3.0-or-later
"""One comparison as a job: the command line runs it where it stands, the panel beside the window."""

from __future__ import annotations

import shlex
import tempfile
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import bpy

from ..lib.comparison.compare import CompareOptions, Comparison, Renderer, compare
from ..lib.departures.effects import alternatives
from ..lib.errors import EtalonError, Refused
from ..lib.files.results import folder_beside
from ..lib.report import write_report
from ..lib.report.words import unexplained
from ..lib.scene.scene import Scene
from ..lib.wavefront.coverage import coverage
from ..lib.wavefront.options import Options
from ..lib.wavefront.reach import reached
from ..lib.wavefront.render import ReferenceRenderer
from .blender_at_hand import require_readable_file
from .cycles.renderer import CyclesRenderer, neutral
from .cycles.second_blender import SecondBlender
from .export import export_scene, render_skies
from .export.minimal import seen, where, write_minimal
from .export.render_depsgraph import with_render_depsgraph

# A part of the scene that may show a difference is judged in this share of the time, and in so many seconds at least.
TRY_SHARE, TRY_LEAST = 0.05, 4.0
MINIMAL = "unexplained.blend"

Progress = Callable[[float], None]
Cancelled = Callable[[], bool]


@dataclass(frozen=True)
class Choices:
    """All that a user chooses about a comparison: the verdict's options and the reference's.

    `partial`: materials that are not simulated are no refusal; what shows them is left out.
    """

    verdict: CompareOptions
    reference: Options
    partial: bool = False


def export(scene: bpy.types.Scene, partial: bool = False) -> Scene:
    """The scene as it is set up for rendering, `partial` as in Choices; raises Refused or EtalonError.

    Call it before `neutral` holds the scene: what that would switch off in silence is refused here by name.
    """
    require_readable_file()
    return render_skies(with_render_depsgraph(scene, lambda depsgraph: export_scene(depsgraph, partial=partial)))


def judge(
    scene: Scene,
    candidate: Renderer,
    choices: Choices,
    folder: Path,
    repeat: str,
    progress: Progress,
    cancelled: Cancelled,
) -> Comparison:
    """Render the reference beside `candidate`, compare the two, and leave the report in `folder`.

    `repeat` is the command that does the same again; the report shows it.
    """
    with folder_beside(folder) as beside:
        reference = ReferenceRenderer(scene, choices.reference)
        comparison = compare(
            scene,
            reference,
            candidate,
            coverage(reference.kernel),
            choices.verdict,
            progress,
            cancelled,
            alternatives(reference),
            reached(reference) if reference.kernel.has_unknown else None,
        )
        write_report(comparison, reference.plan, beside, repeat)
    return comparison


def compare_here(
    scene: bpy.types.Scene,
    choices: Choices,
    folder: Path,
    repeat: str = "",
    progress: Progress = lambda fraction: None,
    cancelled: Cancelled = lambda: False,
) -> Comparison:
    """Compare with Cycles in this very process; its settings come back when it is done.

    The report goes to `folder`, and with it, where something differs and nothing explains it, a small scene that shows it.
    `repeat` is the command that the report shows; `progress` is told the share that is done. Raises Refused or EtalonError.
    """
    exported = export(scene, choices.partial)
    with neutral(scene, threads=choices.reference.threads):
        candidate = CyclesRenderer(scene, seed=choices.verdict.seed, threads=choices.reference.threads)
        comparison = judge(exported, candidate, choices, folder, repeat, progress, cancelled)
        if comparison.stopped == "cancelled":
            return comparison
        show_unexplained(comparison, folder, partial(show, scene, choices))
        return comparison


def show_unexplained(
    comparison: Comparison, folder: Path, show: Callable[[tuple[int, int, int, int], list[str], Path], None]
) -> None:
    """Have `show` write a small scene into `folder` for what nothing explains, from a box of pixels and the objects in it."""
    box = where(comparison)
    if box is None:
        (folder / MINIMAL).unlink(missing_ok=True)
    else:
        show(box, seen(comparison, box), folder / MINIMAL)


def show(
    scene: bpy.types.Scene, choices: Choices, box: tuple[int, int, int, int], names: list[str], path: Path
) -> None:
    """Write the smallest part of `scene` in which short comparisons by `choices` find a difference for no known reason."""
    write_minimal(scene, box, names, partial(_shows, choices), path)


def _shows(choices: Choices, part: bpy.types.Scene) -> bool:
    """Whether a short comparison finds that a part of the scene differs, for no reason that is known."""
    verdict = choices.verdict
    if verdict.time is not None:
        verdict = replace(verdict, time=max(TRY_SHARE * verdict.time, TRY_LEAST))
    try:
        reference = ReferenceRenderer(export(part, choices.partial), choices.reference)
        candidate = CyclesRenderer(part, seed=verdict.seed, threads=choices.reference.threads)
        among = alternatives(reference)
        found = compare(reference.scene, reference, candidate, coverage(reference.kernel), verdict, among=among)
    except EtalonError:
        return False
    return bool(unexplained(found))


def repeat(blend: str, choices: Choices) -> str:
    """The command line that compares as the panel does."""
    verdict = choices.verdict
    words = ["etalon", "compare", blend or "FILE.blend", f"--tolerance={verdict.tolerance:g}"]
    words += [f"--confidence={verdict.confidence:g}", f"--time={verdict.time:g}"]
    return shlex.join([*words, "--partial"] if choices.partial else words)


class BackgroundJob:
    """A comparison that leaves the window alone: export and Cycles in a second Blender, the reference in a thread.

    Made and read by the main thread. `fraction` and `message` tell how far it is; when `done`, either `comparison` or
    `errors` is there, or neither if it was cancelled before there was anything to compare.
    """

    def __init__(self, scene: bpy.types.Scene, choices: Choices, folder: Path) -> None:
        self.folder = folder
        self.fraction = 0.0
        self.message = "Exporting"
        self.comparison: Comparison | None = None
        self.errors: tuple[str, ...] = ()
        self._choices = choices
        self._cancel = threading.Event()
        self._temporary = tempfile.TemporaryDirectory(prefix="etalon-", ignore_cleanup_errors=True)
        self._repeat = repeat(bpy.data.filepath, choices)
        copy = Path(self._temporary.name) / "scene.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(copy), copy=True, check_existing=False)
        self._blender = SecondBlender(
            copy, scene.name, choices.verdict.seed, choices.reference.threads, choices.partial
        )
        self._thread = threading.Thread(target=self._run, name="etalon", daemon=True)
        self._thread.start()

    @property
    def done(self) -> bool:
        """Whether the thread has ended."""
        return not self._thread.is_alive()

    def cancel(self) -> None:
        """End it: the second Blender at once, the reference after the tile at hand. What both sides finished is kept."""
        self._cancel.set()
        self.message = "Ending"
        self._blender.stop()

    def wait(self) -> None:
        """Wait until the thread has ended."""
        self._thread.join()

    def _run(self) -> None:
        try:
            scene = self._blender.export()
            self.message = "Rendering"
            self.comparison = judge(
                scene, self._blender, self._choices, self.folder, self._repeat, self._progress, self._cancel.is_set
            )
            if self.comparison.stopped != "cancelled":
                self.message = "Looking for the cause"
                show_unexplained(
                    self.comparison,
                    self.folder,
                    partial(self._blender.show, self._choices.verdict, self._choices.reference.threads),
                )
        except Refused as refused:
            self.errors = tuple(str(refusal) for refusal in refused.refusals)
        except EtalonError as error:
            self.errors = () if self._cancel.is_set() else (str(error),)
        except Exception as error:
            self.errors = (f"{type(error).__name__}: {error}; please report it with the console's text",)
            raise
        finally:
            self._blender.close()
            self._temporary.cleanup()

    def _progress(self, fraction: float) -> None:
        self.fraction = fraction
