# SPDX-License-Identifier: GPL-3.0-or-later
"""Both sides of one comparison on several machines.

The comparison asks for one replicate after the other, as on one machine. The replicates that it will probably ask for
next are rendered meanwhile, by other workers. A replicate depends on its number and the seed alone, so it does not
matter which worker renders it, or when.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future, wait
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from threading import Event
from typing import Any

from ..comparison.sides import Replicates
from ..film.parts import Part
from ..film.rendering import Rendering
from ..film.windows import Windows
from ..progress import NO_PROGRESS, Progress
from ..sampling.streams import COUNTED
from ..scene import archive
from ..settings.reference import Options
from ..version import VERSION
from ..wavefront.render import ReferenceRenderer
from .client import Cluster
from .replicates import RENDERING
from .worker import Lacks, digest_of, find_content, require_version, watch_task, worker_name

# Seconds between two questions whether the user wants the work to end.
_LOOK = 0.5


@dataclass(frozen=True)
class Request:
    """One replicate of a side: its number, its samples per pixel, and its windows (None: the whole image)."""

    replicate: int
    samples: int
    windows: Windows | None = None


Ask = Callable[[Request, Callable[[], bool]], Rendering]


class SpreadSide:
    """A renderer whose replicates come from workers, `ahead` of them at once.

    `local` gives the name and the settings. `ask` has one replicate rendered on some worker, and ends early once its
    second argument says so; it is called in threads of `pool`.
    """

    def __init__(self, local: Replicates, ask: Ask, pool: Executor, ahead: int) -> None:
        self._local, self._ask, self._pool, self._ahead = local, ask, pool, ahead
        self._waiting: dict[Request, tuple[Future[Rendering], Event]] = {}
        self._usual = 1

    @property
    def name(self) -> str:
        """What the report calls it."""
        return self._local.name

    @property
    def settings(self) -> dict[str, Any]:
        """What the report prints."""
        return self._local.settings

    def render(
        self,
        replicate: int,
        samples: int,
        progress: Progress = NO_PROGRESS,
        windows: Windows | None = None,
    ) -> Rendering:
        """Render one replicate on a worker, and have the next ones begun.

        Raises Cancelled when asked to stop, and EtalonError where workers fail.
        """
        wanted = self._foresee(Request(replicate, samples, windows))
        for request in self._waiting.keys() - set(wanted):
            self._waiting.pop(request)[1].set()
        for request in wanted:
            if request not in self._waiting:
                stop = Event()
                self._waiting[request] = self._pool.submit(self._ask, request, stop.is_set), stop
        future, stop = self._waiting.pop(wanted[0])
        try:
            while not wait((future,), timeout=_LOOK).done:
                progress.check()
            rendering = future.result()
            progress.report(1.0)
            return rendering
        finally:
            stop.set()

    def close(self) -> None:
        """End all that was begun ahead."""
        for _, stop in self._waiting.values():
            stop.set()
        self._waiting.clear()

    def _foresee(self, first: Request) -> list[Request]:
        """`first`, and those that will probably follow it while nothing else changes.

        Calls that are only timed have no followers. In windows, one replicate has the weight of several.
        """
        if first.replicate >= COUNTED.count:
            return [first]
        if first.windows is None:
            self._usual = first.samples
        step = max(first.samples // self._usual, 1)
        numbers = range(first.replicate, COUNTED.count, step)[: self._ahead]
        return [Request(number, first.samples, first.windows) for number in numbers]


def ask_reference(cluster: Cluster, reference: ReferenceRenderer) -> Ask:
    """A function that has a replicate of `reference` rendered on some worker."""
    with tempfile.TemporaryDirectory() as made:
        path = Path(made) / "scene.npz"
        archive.save(reference.scene, path)
        content = path.read_bytes()
    digest = digest_of(content)

    def ask(request: Request, is_ending: Callable[[], bool]) -> Rendering:
        arguments = (VERSION, digest, reference.options, reference.passes, request)
        return cluster.call(render_reference, arguments, {digest: content}, is_ending)

    return ask


def render_reference(
    version: str, digest: str, options: Options, passes: Sequence[Part], request: Request
) -> Rendering | Lacks:
    """Render one replicate of the reference on the worker that this call came to.

    It is of the saved scene with that digest.
    """
    require_version(version)
    path = find_content(digest)
    if path is None:
        return Lacks(worker_name(), (digest,))
    with RENDERING:
        renderer = _reference(path, options, tuple(passes))
        progress = Progress(is_cancelled=watch_task())
        return renderer.render(request.replicate, request.samples, progress, request.windows)


@lru_cache(maxsize=1)
def _reference(path: Path, options: Options, passes: tuple[Part, ...]) -> ReferenceRenderer:
    return ReferenceRenderer(archive.load(path), options, passes=passes)
