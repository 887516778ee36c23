# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' side of one comparison on the workers of a cluster; nothing here imports bpy.

A worker renders in a process of its own, which stays open for the replicates that follow. Where that process dies,
another one takes its place once.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from threading import Lock
from typing import TypeVar
from uuid import uuid4

from ...lib.batch.remote import find_absolute
from ...lib.cluster.client import Cluster
from ...lib.cluster.replicates import Ask, Request, ask_reference
from ...lib.cluster.sides import SpreadSide
from ...lib.cluster.worker import Lacks, find_files, folder, require_version, worker_name
from ...lib.comparison.sides import Renderer, Replicates
from ...lib.effects.light_sources import has_one_light
from ...lib.errors import Cancelled, EtalonError
from ...lib.film.parts import Part
from ...lib.film.rendering import Rendering
from ...lib.sampling.streams import COUNTED
from ...lib.settings.common import Target
from ...lib.settings.comparison import ComparisonSettings
from ...lib.version import VERSION
from ...lib.wavefront.render import ReferenceRenderer
from .second_blender import WORKER, AnotherBlender, BlenderEnded

T = TypeVar("T")


@dataclass(frozen=True)
class Order:
    """What Cycles renders: a scene, its files by path with their digests, and the settings.

    `blender` is the version and build that every worker must have. No two orders have the same `key`.
    """

    key: str
    version: str
    blender: tuple[str, str]
    target: Target
    settings: ComparisonSettings
    files: Mapping[str, str]


# The process of this worker, by the key of its order, with the folder of its files. One thread uses it at a time.
_running: dict[str, tuple[AnotherBlender, tempfile.TemporaryDirectory[str]]] = {}
_using = Lock()
# The orders whose comparison has ended: a call that comes late opens no process that nobody would end.
_ended: set[str] = set()


@contextmanager
def spread_over(
    cluster: Cluster, blender: tuple[str, str], target: Target, settings: ComparisonSettings, files: Mapping[str, str]
) -> Iterator[Callable[[ReferenceRenderer, Renderer, int], tuple[Replicates, Replicates]]]:
    """Yield a function that has the workers render both sides of a comparison.

    It takes the two renderers and how many times narrower and lower than the scene's their image is. `files` are the
    paths of the scene's files with their digests, `blender` the version and build that workers must have. Workers open
    the scene before the block, so that its time budget pays for no start of Blender, and close it at the end.
    """
    begun: list[SpreadSide] = []
    order = Order(uuid4().hex, VERSION, blender, target, settings, files)
    ahead = cluster.slots + 1
    # Without `samples`, replicates of a first look come before those that `replicates` counts.
    is_counted = settings.samples is not None and settings.replicates is not None
    count = settings.replicates if is_counted else COUNTED.count

    def spread(
        pool: Executor, reference: ReferenceRenderer, candidate: Renderer, divisor: int
    ) -> tuple[Replicates, Replicates]:
        camera = reference.scene.camera
        size = None if divisor == 1 else (camera.width, camera.height)
        of_reference = ask_reference(cluster, reference.scene, reference.options, reference.passes)
        of_cycles = _ask_cycles(cluster, order, size, reference.passes, has_one_light(reference.scene))
        pairs = (reference, of_reference), (candidate, of_cycles)
        sides = [SpreadSide(local, ask, pool, ahead, count) for local, ask in pairs]
        begun.extend(sides)
        return sides[0], sides[1]

    try:
        cluster.prepare(prepare, (order,), _contents(order))
        with ThreadPoolExecutor(max_workers=4 * ahead) as pool:
            try:
                yield partial(spread, pool)
            finally:
                for side in begun:
                    side.close()
    finally:
        cluster.run_everywhere(end_order, order.key)


def _contents(order: Order) -> dict[str, Path | bytes]:
    return {digest: Path(path) for path, digest in order.files.items()}


def _ask_cycles(
    cluster: Cluster, order: Order, size: tuple[int, int] | None, passes: tuple[Part, ...], one_light: bool
) -> Ask:
    """A function that has a replicate rendered by Cycles on some worker."""
    contents = _contents(order)

    def ask(request: Request, is_ending: Callable[[], bool]) -> Rendering:
        return cluster.call(render_cycles, (order, size, passes, request, one_light), contents, is_ending)

    return ask


def prepare(order: Order) -> Lacks | None:
    """Open the order's scene on this worker."""
    require_version(order.version)
    places = find_files(order.files)
    if isinstance(places, Lacks):
        return places
    _use(order, places, lambda blender: None)
    return None


def render_cycles(
    order: Order, size: tuple[int, int] | None, passes: tuple[Part, ...], request: Request, one_light: bool = False
) -> Rendering | Lacks:
    """Render one replicate by Cycles on the worker that this call came to.

    `one_light`: one light object is all that shines in the scene.
    """
    require_version(order.version)
    places = find_files(order.files)
    if isinstance(places, Lacks):
        return places

    def render(blender: AnotherBlender) -> Rendering:
        sized = blender.with_one_light() if one_light else blender
        sized = sized if size is None else sized.at_size(*size)
        return sized.with_passes(passes).render(request.replicate, request.samples, windows=request.windows)

    return _use(order, places, render)


def end_order(key: str) -> None:
    """End this worker's process for an order, and open no other one for it."""
    _ended.add(key)
    if key in _running:
        _running[key][0].stop()
    # Otherwise the thread that uses the process closes it: it finds that it has ended.
    if _using.acquire(blocking=False):
        try:
            _close(key)
        finally:
            _using.release()


def _use(order: Order, places: Mapping[str, Path], work: Callable[[AnotherBlender], T]) -> T:
    """What `work` makes of the process that has the order's scene open.

    Where the process dies, another one does the work again, once. Raises EtalonError, with the last words of the second
    one where that dies too.
    """

    def attempt() -> T:
        try:
            return work(_opened(order, places))
        except EtalonError:
            # It may have ended: the next call opens another one.
            _close(order.key)
            raise

    with _using:
        try:
            return attempt()
        except BlenderEnded:
            return attempt()


def _close(key: str) -> None:
    blender, made = _running.pop(key, (None, None))
    if blender is not None and made is not None:
        blender.close()
        made.cleanup()


def _opened(order: Order, places: Mapping[str, Path]) -> AnotherBlender:
    """The process that has the order's scene open; it takes the place of another order's.

    Raises Cancelled where the order has ended.
    """
    if order.key in _running:
        return _running[order.key][0]
    for key in list(_running):
        _close(key)
    scene = order.target.scene or ""
    found = str(places.get(scene, scene))
    if found != scene and (message := find_absolute(scene, found)):
        raise EtalonError(message)
    made = tempfile.TemporaryDirectory(dir=folder())
    request = {"target": replace(order.target, scene=found).to_json(), "settings": order.settings.to_json()}
    title = f"Blender of worker {worker_name()}"
    blender = AnotherBlender([sys.executable, str(WORKER), "--"], request, Path(made.name), title, exports=False)
    _running[order.key] = blender, made
    # Either this sees that the order has ended, or whoever ends it sees the process.
    if order.key in _ended:
        raise Cancelled("the comparison has ended")
    blender.open()
    build = str(blender.settings["version"]), str(blender.settings["build"])
    if build != order.blender:
        raise EtalonError(
            f"worker {worker_name()} has Blender {' '.join(build)}; install Blender {' '.join(order.blender)} there, as here"
        )
    return blender
