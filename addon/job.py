# SPDX-License-Identifier: GPL-3.0-or-later
"""One comparison as a job.

The command line runs it in its own thread, the panel beside the window.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path

import bpy

from ..lib.batch.process import find_blender
from ..lib.comparison.catchers import find_catcher_pixels, leave_out
from ..lib.comparison.caustics import scout
from ..lib.comparison.compare import Comparison, Renderer, compare
from ..lib.comparison.departures import alternatives
from ..lib.comparison.interim import BoundAt, Interim
from ..lib.comparison.memory import require_memory
from ..lib.comparison.parts import PassChoice, asked_parts, choose_passes, fit_memory
from ..lib.comparison.run import Stop, TimedRun
from ..lib.comparison.sides import Replicates
from ..lib.comparison.size import choose_divisor, images_of_search
from ..lib.comparison.unsupported import find_unsupported_light
from ..lib.effects.light_sources import has_one_light
from ..lib.errors import EtalonError, Refusal, Refused
from ..lib.files.atomic import replace_files
from ..lib.files.ownership import temporary_folder
from ..lib.film.light_passes import LightPass
from ..lib.film.parts import Part
from ..lib.film.view_transform import ViewTransform
from ..lib.progress import NO_PROGRESS, Progress
from ..lib.report import write_report
from ..lib.report.words import unexplained
from ..lib.report.write import EXRS
from ..lib.scene.scene import Scene
from ..lib.scene_check.check import check_scene
from ..lib.settings.common import Target
from ..lib.settings.comparison import CompareOptions, Settings
from ..lib.settings.reference import Options
from ..lib.settings.words import repeating_command
from ..lib.wavefront.coverage import coverage
from ..lib.wavefront.reach import reached
from ..lib.wavefront.render import ReferenceRenderer
from .background import Background, save_copy
from .cycles.renderer import CyclesRenderer, neutral
from .cycles.second_blender import SecondBlender
from .cycles.view_transform_elsewhere import elsewhere
from .export import export_scene, render_skies
from .export.minimal import seen, where, write_minimal
from .export.refusals import refuse_smoke
from .export.render_depsgraph import with_render_frames
from .export.set_aside import find_lines
from .export.view_transform import export_view_transform
from .host.blender_at_hand import require_readable_file

# A part of the scene that may show a difference is judged in this share of the time, and in so many seconds at least.
TRY_SHARE, TRY_LEAST = 0.05, 4.0
MINIMAL = "unexplained.blend"


def export(scene: bpy.types.Scene, partial: bool = False, motion_blur: bool = False) -> Scene:
    """Export the scene as it is set up for rendering.

    `partial` and `motion_blur` as in Settings.

    Raises Refused or EtalonError. Call it before `neutral` holds the scene: what that would switch off in silence is
    refused here by name.
    """
    require_readable_file()
    refuse_smoke(scene)
    lines = find_lines(scene)

    def read(depsgraph: bpy.types.Depsgraph, set_frame: Callable[[float], None]) -> Scene:
        return export_scene(depsgraph, partial=partial, set_frame=set_frame if motion_blur else None)

    try:
        found = render_skies(with_render_frames(scene, read))
    except Refused as refused:
        raise Refused(refused.refusals, allows_partial=not motion_blur) from refused
    return replace(found, findings=(*found.findings, *lines))


def _pass_by(comparison: Comparison) -> None:
    pass


# Of both renderers and how many times narrower and lower the image is: what renders the replicates that are compared.
Spread = Callable[[ReferenceRenderer, Renderer, int], tuple[Replicates, Replicates]]


def here(reference: ReferenceRenderer, candidate: Renderer, divisor: int) -> tuple[Replicates, Replicates]:
    """Both sides as they are: this machine renders them."""
    return reference, candidate


def _shrink(
    scene: Scene, reference: ReferenceRenderer, candidate: Renderer, divisor: int
) -> tuple[ReferenceRenderer, Renderer]:
    """Both renderers with an image that is `divisor` times narrower and lower."""
    size = scene.camera.width // divisor, scene.camera.height // divisor
    return reference.at_size(*size), candidate.at_size(*size)


def _with_parts(
    reference: ReferenceRenderer, candidate: Renderer, settings: Settings, run: TimedRun
) -> tuple[ReferenceRenderer, Renderer, tuple[Part, ...], PassChoice, int]:
    """Both renderers at the size to compare, with the parts to compare.

    Also the parts, why light passes are among them or not, and how many times narrower and lower the image is than
    the scene's. Raises EtalonError where memory is lacking, Cancelled when the run is to end.
    """
    with ThreadPoolExecutor(1) as pool:
        # Faces in one plane are searched for meanwhile.
        among = pool.submit(alternatives, reference)
        choice, divisor = choose_passes(reference, settings), 1
    parts = asked_parts(reference, replace(settings, passes=choice.passes))
    sides: tuple[ReferenceRenderer, Renderer] = reference.with_passes(parts), candidate.with_passes(parts)
    if settings.size == "auto" and settings.samples is None:
        divisor = choose_divisor(sides, reference.scene.camera, run, images_of_search(among.result()))
    if divisor > 1:
        sides = _shrink(reference.scene, *sides, divisor)
    size = sides[0].scene.camera.width, sides[0].scene.camera.height
    fitting = fit_memory(choice, parts, *size)
    if fitting != choice:
        parts = tuple(part for part in parts if not isinstance(part, LightPass))
        sides = sides[0].with_passes(parts), sides[1].with_passes(parts)
    require_memory(*size, len(parts))
    return *sides, parts, fitting, divisor


def judge(
    scene: Scene,
    candidate: Renderer,
    settings: Settings,
    folder: Path | None,
    repeat: str,
    progress: Progress,
    may_shrink: bool = True,
    name: str = "",
    transform: ViewTransform | None = None,
    conclude: Callable[[Comparison], None] = _pass_by,
    keep_exrs: bool = True,
    spread: Spread = here,
) -> Comparison:
    """Render the reference beside `candidate`, compare the two, and write the report.

    The report goes to `folder`, if there is one. Its title is `name`, or the scene's name where none is given.
    `repeat` is the command that does the same again; the report shows it. Where the time is short for a large image,
    and the settings and `may_shrink` allow it, a smaller one of the same view is compared. `transform` is how the
    scene wants its images shown in the report. `conclude` is called with the comparison before the report is written.
    Without `keep_exrs` the report comes without float images. `spread` may have workers render.
    """
    with nullcontext() if folder is None else replace_files(folder, without=(MINIMAL, *EXRS)) as beside:
        reference = ReferenceRenderer(scene, settings.part(Options))
        verdict, run = settings.part(CompareOptions), TimedRun(settings.time, progress)
        progress.begin("timing the renderers")
        asked = replace(settings, size=settings.size if may_shrink else "full")
        reference, candidate, passes, choice, divisor = _with_parts(reference, candidate, asked, run)
        caught = find_catcher_pixels(reference.kernel)
        progress.begin("looking for caustics")
        scouted = scout(reference.kernel, run)
        unsupported, left_out = find_unsupported_light(reference, run), None
        if unsupported is None and reference.kernel.has_unknown:
            left_out = reached(reference)
        covered = coverage(reference.kernel)
        # What came before is part of the time.
        verdict = replace(verdict, time=verdict.time and max(run.left, 0.5 * verdict.time))
        comparison = compare(
            reference.scene,
            *spread(reference, candidate, divisor),
            covered,
            verdict,
            progress,
            alternatives(reference),
            leave_out(left_out, caught),
            divisor,
            scouted,
            passes,
            unsupported,
        )
        about = {"options": settings.part(CompareOptions), "findings": check_scene(scene), "scene": name or scene.name}
        about |= {"pass_choice": choice, "caught": caught}
        comparison = replace(comparison, **about)
        conclude(comparison)
        if beside is not None:
            progress.begin("writing the report")
            write_report(comparison, reference.plan, beside, repeat, transform, keep_exrs)
    return comparison


def name_of_file(scene: bpy.types.Scene) -> str:
    """The name of the open file, with the scene's where there are several scenes.

    It is the scene's alone where the file was never saved.
    """
    file = bpy.path.basename(bpy.data.filepath)
    if not file:
        return scene.name
    return file if len(bpy.data.scenes) == 1 else f"{file}, scene {scene.name}"


def compare_here(
    scene: bpy.types.Scene,
    settings: Settings,
    folder: Path | None = None,
    repeat: str = "",
    progress: Progress = NO_PROGRESS,
    spread: Spread = here,
) -> Comparison:
    """Compare with Cycles in this process; the scene's own settings are restored afterwards.

    The report goes to `folder`, if there is one. Where something differs and no departure explains it, a small scene
    that shows it goes there too. `repeat` is the command that the report shows. `progress` receives the share that is
    done, and says whether to end. `spread` as for `judge`. Raises Refused or EtalonError.
    """
    progress.begin("reading the scene")
    exported = export(scene, settings.partial, settings.motion_blur)
    name, transform, blur = name_of_file(scene), export_view_transform(scene), settings.motion_blur
    state = {"threads": settings.threads, "motion_blur": blur, "one_light": has_one_light(exported)}
    with neutral(scene, **state):
        candidate = CyclesRenderer(scene, seed=settings.seed, **state)
        may_shrink = not scene.render.use_border
        about = {"may_shrink": may_shrink, "name": name, "transform": transform, "spread": spread}
        comparison = judge(exported, candidate, settings, folder, repeat, progress, **about)
        if folder is not None and comparison.stopped is not Stop.CANCELLED:
            if unexplained(comparison):
                progress.begin("looking for the smallest scene that shows it")
            show_unexplained(comparison, folder, partial(show, scene, settings))
        return comparison


def show_unexplained(
    comparison: Comparison, folder: Path, show: Callable[[tuple[int, int, int, int], list[str], Path], None]
) -> None:
    """Have `show` write a small scene into `folder` for what nothing explains.

    `show` receives a box of pixels, the objects in it, and the path.
    """
    box = where(comparison)
    if box is not None:
        # In pixels of the whole size, of which a smaller image was compared.
        times = comparison.divisor
        whole = box[0] * times, box[1] * times, (box[2] + 1) * times - 1, (box[3] + 1) * times - 1
        show(whole, seen(comparison, box), folder / MINIMAL)


def show(
    scene: bpy.types.Scene, settings: Settings, box: tuple[int, int, int, int], names: list[str], path: Path
) -> None:
    """Write the smallest part of `scene` that shows an unexplained difference.

    Short comparisons look for a difference that no departure explains.
    """
    write_minimal(scene, box, names, partial(_shows, settings), path)


def _shows(settings: Settings, part: bpy.types.Scene) -> bool:
    """Whether a short comparison finds that a part of the scene differs.

    Only a difference without a known cause counts.
    """
    verdict = settings.part(CompareOptions)
    if verdict.time is not None:
        verdict = replace(verdict, time=max(TRY_SHARE * verdict.time, TRY_LEAST))
    try:
        reference = ReferenceRenderer(export(part, settings.partial, settings.motion_blur), settings.part(Options))
        candidate = CyclesRenderer(part, seed=settings.seed, threads=settings.threads, motion_blur=settings.motion_blur)
        unsupported = find_unsupported_light(reference, TimedRun(verdict.time, NO_PROGRESS))
        rest = {"among": alternatives(reference), "unsupported": unsupported}
        rest["left_out"] = leave_out(None, find_catcher_pixels(reference.kernel))
        found = compare(reference.scene, reference, candidate, coverage(reference.kernel), verdict, **rest)
    except EtalonError:
        return False
    return bool(unexplained(found))


class BackgroundJob(Background):
    """A comparison that leaves the window alone.

    Export and Cycles run in a second Blender, the reference in a thread. Made and read by the main thread. `stage` is
    the name of what is under way, `fraction` the share of the time that is spent, `bounds` the bound at each look so
    far; `on_look` is called at each look, by the job's thread. `comparison` is there as soon as it is concluded,
    before its report is written. When `done`, either it or `errors` is there, or neither if the job was cancelled
    before there was anything to compare.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        settings: Settings,
        folder: Path,
        program: str | None = None,
        keep_exrs: bool = True,
    ) -> None:
        """Compare `scene`, and write the report to `folder`.

        `program` is another Blender than this one, `keep_exrs` as for `judge`.
        """
        super().__init__()
        self.folder = folder
        self._keep_exrs = keep_exrs
        self.fraction = 0.0
        self.stage = "reading the scene"
        self.bounds: list[BoundAt] = []
        self.comparison: Comparison | None = None
        self.errors: tuple[str, ...] = ()
        self.refusals: tuple[Refusal, ...] = ()
        self.on_look: Callable[[Interim], None] | None = None
        self._settings = settings
        self._began: float | None = None
        self._is_written = False
        self._name = name_of_file(scene)
        self._may_shrink = not scene.render.use_border
        # Of this Blender, not `program`: its colour configuration is for no older one.
        self._transform = elsewhere(export_view_transform(scene), find_blender() or program)
        self._temporary = ExitStack()
        self._repeat = repeating_command("compare", Target(bpy.data.filepath or "FILE.blend"), settings)
        copy = self._temporary.enter_context(temporary_folder()) / "scene.blend"
        save_copy(copy)
        self._blender = SecondBlender(copy, scene.name, settings, program)
        self._thread = threading.Thread(target=self._run, name="etalon", daemon=True)
        self._thread.start()

    @property
    def seconds_left(self) -> float | None:
        """Seconds until its time is spent; None before rendering has begun."""
        if self._began is None or self._settings.time is None:
            return None
        return max(self._settings.time - (time.monotonic() - self._began), 0.0)

    def cancel(self) -> None:
        """End the job: the second Blender at once, the reference after the tile at hand.

        What both sides finished is kept.
        """
        self._cancel.set()
        self._blender.stop()

    def _run(self) -> None:
        try:
            scene = self._blender.export()
            self._began = time.monotonic()
            judge(
                scene,
                self._blender,
                self._settings,
                self.folder,
                self._repeat,
                Progress(self._report, self._cancel.is_set, begin=self._begin, show=self._show),
                self._may_shrink,
                self._name,
                self._transform,
                self._conclude,
                self._keep_exrs,
            )
            self._is_written = True
            if self.comparison.stopped is not Stop.CANCELLED:
                self._begin("looking for the smallest scene that shows it")
                show_unexplained(self.comparison, self.folder, self._blender.show)
        except Refused as refused:
            self.refusals = refused.refusals
            self.errors = tuple(str(refusal) for refusal in refused.refusals)
        except EtalonError as error:
            # What ends early because it was told to is no error; a report that cannot be written is.
            is_expected = self._cancel.is_set() and (self.comparison is None or self._is_written)
            self.errors = () if is_expected else (str(error),)
        except Exception as error:
            self.errors = (f"{type(error).__name__}: {error}; please report it with the console's text",)
            raise
        finally:
            self._blender.close()
            self._temporary.close()

    def _report(self, fraction: float) -> None:
        self.fraction = fraction

    def _begin(self, stage: str) -> None:
        self.stage = stage

    def _show(self, interim: Interim) -> None:
        self.bounds.append(interim.bound)
        if self.on_look is not None:
            self.on_look(interim)

    def _conclude(self, comparison: Comparison) -> None:
        self.comparison = comparison
