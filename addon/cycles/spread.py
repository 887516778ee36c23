# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' side of one comparison on the workers of a cluster; nothing here imports bpy.

A worker renders in a process of its own, which stays open for the replicates that follow.
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
from typing import Any
from uuid import uuid4

from ...lib.batch.remote import find_absolute
from ...lib.cluster.client import Cluster
from ...lib.cluster.sides import Ask, Request, SpreadSide, ask_reference
from ...lib.cluster.worker import Lacks, find_files, folder, require_version, worker_name
from ...lib.comparison.sides import Renderer, Replicates
from ...lib.errors import EtalonError, Refused
from ...lib.film.parts import Part
from ...lib.film.rendering import Rendering
from ...lib.settings.common import Target
from ...lib.settings.comparison import Settings
from ...lib.version import VERSION
from ...lib.wavefront.render import ReferenceRenderer
from .second_blender import WORKER, AnotherBlender


@dataclass(frozen=True)
class Order:
    """What Cycles renders: a scene, its files by path with their digests, and the settings.

    `blender` is the version and build that every worker must have. No two orders have the same `key`.
    """

    key: str
    version: str
    blender: tuple[str, str]
    target: Target
    settings: Settings
    files: Mapping[str, str]


# The process of this worker, by the key of its order, with the folder of its files. One thread uses it at a time.
_running: dict[str, tuple[AnotherBlender, tempfile.TemporaryDirectory[str]]] = {}
_using = Lock()


@contextmanager
def spread_over(
    cluster: Cluster, blender: tuple[str, str], target: Target, settings: Settings, files: Mapping[str, str]
) -> Iterator[Callable[[ReferenceRenderer, Renderer, int], tuple[Replicates, Replicates]]]:
    """Yield a function that has the workers render both sides of a comparison.

    It takes the two renderers and how many times narrower and lower than the scene's their image is. `files` are the
    paths of the scene's files with their digests, `blender` the version and build that workers must have. Workers open
    the scene before the block, so that its time budget pays for no start of Blender, and close it at the end.
    """
    begun: list[SpreadSide] = []
    order = Order(uuid4().hex, VERSION, blender, target, settings, files)
    cluster.prepare(prepare, (order,), _contents(order))
    ahead = cluster.slots + 1

    def spread(
        pool: Executor, reference: ReferenceRenderer, candidate: Renderer, divisor: int
    ) -> tuple[Replicates, Replicates]:
        camera = reference.scene.camera
        size = None if divisor == 1 else (camera.width, camera.height)
        asks = ask_reference(cluster, reference), _ask_cycles(cluster, order, size, reference.passes)
        sides = [SpreadSide(one, ask, pool, ahead) for one, ask in zip((reference, candidate), asks, strict=True)]
        begun.extend(sides)
        return sides[0], sides[1]

    try:
        with ThreadPoolExecutor(max_workers=4 * ahead) as pool:
            try:
                yield partial(spread, pool)
            finally:
                for side in begun:
                    side.close()
    finally:
        cluster.run_everywhere(close_order, order.key)


def _contents(order: Order) -> dict[str, Path | bytes]:
    return {digest: Path(path) for path, digest in order.files.items()}


def _ask_cycles(cluster: Cluster, order: Order, size: tuple[int, int] | None, passes: tuple[Part, ...]) -> Ask:
    """A function that has a replicate rendered by Cycles on some worker."""
    contents = _contents(order)

    def ask(request: Request, is_ending: Callable[[], bool]) -> Rendering:
        return cluster.call(render_cycles, (order, size, passes, request), contents, is_ending)

    return ask


def prepare(order: Order) -> Lacks | None:
    """Open the order's scene on this worker."""
    require_version(order.version)
    places = find_files(order.files)
    if isinstance(places, Lacks):
        return places
    with _using:
        _opened(order, places)
    return None


def render_cycles(
    order: Order, size: tuple[int, int] | None, passes: tuple[Part, ...], request: Request
) -> Rendering | Lacks:
    """Render one replicate by Cycles on the worker that this call came to."""
    require_version(order.version)
    places = find_files(order.files)
    if isinstance(places, Lacks):
        return places
    with _using:
        blender: Any = _opened(order, places).with_passes(passes)
        if size is not None:
            blender = blender.at_size(*size)
        try:
            return blender.render(request.replicate, request.samples, windows=request.windows)
        except EtalonError:
            # It may have ended: the next call opens another one.
            close_order(order.key)
            raise


def close_order(key: str) -> None:
    """End this worker's process for an order, where there is one."""
    blender, made = _running.pop(key, (None, None))
    if blender is not None and made is not None:
        blender.stop()
        made.cleanup()


def _opened(order: Order, places: Mapping[str, Path]) -> AnotherBlender:
    """The process that has the order's scene open; it takes the place of another order's."""
    if order.key in _running:
        return _running[order.key][0]
    for key in list(_running):
        close_order(key)
    scene = order.target.scene or ""
    found = str(places.get(scene, scene))
    if found != scene and (message := find_absolute(scene, found)):
        raise EtalonError(message)
    made = tempfile.TemporaryDirectory(dir=folder())
    request = {"target": replace(order.target, scene=found).to_json(), "settings": order.settings.to_json()}
    title = f"Blender of worker {worker_name()}"
    blender = AnotherBlender([sys.executable, str(WORKER), "--"], request, Path(made.name), title)
    _running[order.key] = blender, made
    try:
        blender.export()
        build = str(blender.settings["version"]), str(blender.settings["build"])
        if build != order.blender:
            raise EtalonError(
                f"worker {worker_name()} has Blender {' '.join(build)}; install Blender {' '.join(order.blender)} there, as here"
            )
    except Refused as refused:
        close_order(order.key)
        raise EtalonError(str(refused)) from None
    except EtalonError:
        close_order(order.key)
        raise
    return blender
