# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles as one side of a comparison.

It renders independent replicates, gives linear float pixels, and describes its settings in its own words.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ...lib.errors import EtalonError
from ...lib.files.ownership import temporary_folder
from ...lib.film.exr import read_exr
from ...lib.film.film import finite_pixels
from ...lib.film.light_passes import LightPass
from ...lib.film.parts import BounceLimit, EmitterLight, Part
from ...lib.film.rendering import Rendering
from ...lib.film.windows import Box, Windows
from ...lib.progress import NO_PROGRESS, Progress
from ...lib.sampling.streams import CYCLES_REPLICATES
from ..host.frame import full_frame, rendered_region
from ..host.quiet import quiet
from .light_groups import light_groups, read_emitter
from .light_passes import ask_for_passes, combined, read_pass
from .neutral import SEQUENCE, Changes, neutral

__all__ = ["CyclesRenderer", "neutral"]

# Cycles adds samples up in float32; longer sums drift (5e-5 here, 6e-4 at 65,536).
CHUNK = SEQUENCE // 2
# Camera samples in one call, a few seconds: in between the renderer tells its progress and can be cancelled.
CALL = 1 << 23


class CyclesRenderer:
    """Cycles on the CPU in its least biased state, one side of a comparison.

    `max_bounces`, `threads`, `motion_blur` and `one_light` as for `neutral`; `seed` of the whole. Hold one `neutral` around many replicates:
    alone each of them sets and puts back everything. Raises EtalonError where the scene has no camera or no view layer to render.
    """

    name = "Cycles"

    def __init__(
        self,
        scene: bpy.types.Scene,
        *,
        seed: int = 0,
        max_bounces: int | None = None,
        threads: int | None = None,
        motion_blur: bool = False,
        one_light: bool = False,
    ) -> None:
        layers = [layer.name for layer in scene.view_layers if layer.use]
        if scene.camera is None:
            raise EtalonError(f"{scene.name}: the scene has no camera; add one and make it the active camera")
        if not layers:
            raise EtalonError(f"{scene.name}: no view layer is used for rendering; switch one on")
        self.scene = scene
        self.seed = seed
        self._layer = layers[0]
        self._neutral = {"max_bounces": max_bounces, "threads": threads}
        self._neutral |= {"motion_blur": motion_blur, "one_light": one_light}
        self._size: tuple[int, int] | None = None
        self.passes: tuple[Part, ...] = ()
        with neutral(scene, **self._neutral) as changes:
            build = f"{_text(bpy.app.build_hash)}, {_text(bpy.app.build_date)}"
            self.settings: dict[str, Any] = {
                "version": bpy.app.version_string,
                "build": build,
                "seed": seed,
                **changes.settings,
            }
        if changes.refused:
            self.settings["not editable"] = ", ".join(changes.refused)

    def at_size(self, width: int, height: int) -> CyclesRenderer:
        """The same view with fewer pixels, whose numbers divide the frame's.

        Not for a scene with a render border.
        """
        smaller = copy(self)
        smaller._size = width, height
        return smaller

    def with_one_light(self) -> CyclesRenderer:
        """The same renderer for a scene of which is known that one light object is all that shines."""
        other = copy(self)
        other._neutral = {**self._neutral, "one_light": True}
        return other

    def with_passes(self, passes: Sequence[Part]) -> CyclesRenderer:
        """The same renderer, whose images come with light passes and other parts.

        The user's own settings of passes are restored.
        """
        more = copy(self)
        more.passes = tuple(passes)
        return more

    def render(
        self,
        replicate: int,
        samples: int,
        progress: Progress = NO_PROGRESS,
        windows: Windows | None = None,
    ) -> Rendering:
        """Render replicate number `replicate` with `samples` per pixel.

        With `windows`, only their pixels are rendered. Different numbers are independent.

        `seconds` is the time inside Cycles, `stages` adds what the settings and the way of the pixels through a file
        cost. Cycles does not tell how many rays it traced: `rays` is 0. A pixel's non-finite samples cannot be told
        apart either: one is counted for each partial image in which the pixel was not finite. Raises EtalonError
        where Cycles cannot render, Cancelled when asked to end.
        """
        limits = [part for part in self.passes if isinstance(part, BounceLimit)]
        if limits:
            others = self.with_passes([part for part in self.passes if part not in limits])
            return others._with_limits(
                limits, others.render(replicate, samples, progress, windows), replicate, samples, progress
            )
        begin = time.perf_counter()
        rendering = reading = 0.0
        with self._state(), temporary_folder() as folder:
            path = folder / "cycles.exr"
            left, bottom, width, height = rendered_region(self.scene.render, *full_frame(self.scene.render))
            whole = Windows((height, width), ((0, 0, width - 1, height - 1),))
            total, nonfinite = np.zeros((height, width, 3)), np.zeros((height, width), np.int32)
            passes = {name: np.zeros((height, width, 3)) for name in self.passes}
            work = list(self._calls(whole if windows is None else windows, samples))
            for number, (box, done, count) in enumerate(work):
                progress.check()
                with self._border(None if windows is None else box, left, bottom + height):
                    rendering += self._call(path, replicate, done, samples, count)
                start = time.perf_counter()
                part = slice(box[1], box[3] + 1), slice(box[0], box[2] + 1)
                if not done:  # what an overlapping rectangle left there is the same
                    total[part] = nonfinite[part] = 0
                    for image in passes.values():
                        image[part] = 0
                here = {name: image[part] for name, image in passes.items()}
                _add(path, count / samples, total[part], nonfinite[part], here)
                reading += time.perf_counter() - start
                progress.report((number + 1) / len(work))
        settings = time.perf_counter() - begin - rendering - reading
        stages = {"render": rendering, "read": reading, "settings": settings}
        pixels = (whole if windows is None else windows).pixels
        return Rendering(total, nonfinite, rendering, stages, pixels * samples, windows=windows, passes=passes)

    def _with_limits(
        self, limits: Sequence[BounceLimit], whole: Rendering, replicate: int, samples: int, progress: Progress
    ) -> Rendering:
        """Add renders with fewer bounces to the `whole` image.

        Each is a render of its own with the same random numbers.
        """
        passes, seconds = dict(whole.passes), whole.seconds
        with self._state() as changes:
            most = changes.settings["cycles.max_bounces"]
        for part in limits:
            if part.bounces == most:
                passes[part] = whole.radiance
                continue
            fewer = self.with_passes(())
            fewer._neutral = {**self._neutral, "max_bounces": part.bounces}
            found = fewer.render(replicate, samples, progress, whole.windows)
            seconds += found.seconds
            passes[part] = np.where(found.nonfinite[..., None] > 0, np.nan, found.radiance)
        return replace(whole, passes=passes, seconds=seconds)

    @contextmanager
    def _state(self) -> Iterator[Changes]:
        """The settings under which it renders; those of the neutral state are given."""
        changes = Changes()
        emitters = [part for part in self.passes if isinstance(part, EmitterLight)]
        with neutral(self.scene, **self._neutral) as held, ExitStack() as stack:
            try:
                if self._size is not None:
                    render = self.scene.render
                    changes.set(render, "resolution_x", self._size[0])
                    changes.set(render, "resolution_y", self._size[1])
                    changes.set(render, "resolution_percentage", 100)
                if self.passes:
                    lights = [part for part in self.passes if isinstance(part, LightPass)]
                    ask_for_passes(changes, self.scene, self._layer, lights)
                if emitters:
                    stack.enter_context(light_groups(changes, self.scene, self._layer, emitters))
                yield held
            finally:
                changes.undo()

    def _calls(self, windows: Windows, samples: int) -> Iterator[tuple[Box, int, int]]:
        """Yield each render call.

        It is a rectangle, the samples that are done before it, and those that it adds.
        """
        for box in windows.boxes:
            most = self._per_call((box[2] - box[0] + 1) * (box[3] - box[1] + 1))
            for done in range(0, samples, most):
                yield box, done, min(most, samples - done)

    def _per_call(self, pixels: int) -> int:
        """The most samples of one call that renders so many pixels: a power of two."""
        return min(CHUNK, _power_of_two(max(CALL // pixels, 1) + 1) // 2)

    @contextmanager
    def _border(self, box: Box | None, left: int, top: int) -> Iterator[None]:
        """Render only the pixels of `box`; None: all of them.

        The upper left corner of the box's image is (`left`, `top`) in the frame, y up.
        """
        changes = Changes()
        try:
            if box is not None:
                render = self.scene.render
                width, height = full_frame(render)
                # Blender cuts off what is left of a pixel, so half of one is added.
                changes.set(render, "use_border", True)
                changes.set(render, "border_min_x", (left + box[0] + 0.5) / width)
                changes.set(render, "border_max_x", min((left + box[2] + 1.5) / width, 1.0))
                changes.set(render, "border_min_y", (top - box[3] - 0.5) / height)
                changes.set(render, "border_max_y", min((top - box[1] + 0.5) / height, 1.0))
            yield
        finally:
            changes.undo()

    def _call(self, path: Path, replicate: int, done: int, samples: int, count: int) -> float:
        """Render `count` samples from sample `done` on into a file; return the seconds it took.

        The replicate has `samples` in all. Cycles' seeds only deal one sequence out to the pixels in another order,
        so a replicate takes its own part of the sequence too. Parts of a power of two that start at a multiple of
        themselves are nets: sample 0, which is not random, is never among them.
        """
        chunk, within = divmod(done, CHUNK)
        part = min(_power_of_two(samples), CHUNK)
        changes = Changes()
        try:
            changes.set(
                self.scene.cycles, "seed", (_hash(self.seed) + replicate + chunk * CYCLES_REPLICATES) % (1 << 31)
            )
            changes.set(self.scene.cycles, "sample_offset", CHUNK + (replicate * part) % CHUNK + within)
            # Blender before 4.4 has no subset: there, `samples` counts those after the offset.
            length = "sample_subset_length" if hasattr(self.scene.cycles, "sample_subset_length") else "samples"
            changes.set(self.scene.cycles, length, count)
            changes.set(self.scene.render, "filepath", str(path))
            # Asked for one layer by name, Blender shows another one's image, or that of the time before.
            for layer in self.scene.view_layers:
                changes.set(layer, "use", layer.name == self._layer)
            # Without the tag, persistent data renders the settings of the time before.
            self.scene.update_tag()
            with quiet():
                start = time.perf_counter()
                try:
                    bpy.ops.render.render(write_still=True, scene=self.scene.name)
                except RuntimeError as error:
                    reason = str(error).strip().splitlines()[-1].removeprefix("Error: ")
                    raise EtalonError(
                        f"{self.scene.name}: Cycles cannot render it ({reason}); try F12 in Blender"
                    ) from error
                return time.perf_counter() - start
        finally:
            changes.undo()


def _add(
    path: Path, weight: float, radiance: np.ndarray, nonfinite: np.ndarray, passes: dict[Part, np.ndarray]
) -> None:
    """Add the image in the file `path`, times `weight`, to the sums.

    The sums are `radiance` and each of `passes`, (height, width, 3). What is not finite is counted in `nonfinite`.
    """
    try:
        channels = read_exr(path)
    except EtalonError as error:
        raise EtalonError(
            f"Cycles' image cannot be read back from {path.parent}; make room there, or set TMPDIR to another folder"
        ) from error
    path.unlink()
    image = combined(channels) if passes else np.stack([channels[name] for name in "RGB"], axis=2)
    radiance += np.multiply(image, weight, dtype=np.float64)
    nonfinite += ~finite_pixels(image)
    emitters = [part for part in passes if isinstance(part, EmitterLight)]
    for name, light in passes.items():
        found = read_emitter(channels, emitters.index(name)) if name in emitters else read_pass(channels, name)
        light += found * weight


def _text(value: bytes) -> str:
    """What Blender tells about its build, as text."""
    return value.decode("utf-8", "replace")


def _power_of_two(n: int) -> int:
    """The smallest power of two that is not less than `n`."""
    return 1 << (n - 1).bit_length()


def _hash(seed: int) -> int:
    """31 bits of a seed, so that neighbouring seeds do not share their replicates."""
    return int(np.random.SeedSequence(seed).generate_state(1)[0]) & 0x7FFFFFFF
