# SPDX-License-Identifier: GPL-3.0-or-later
"""Replicates of the reference on several machines, and the image that they make.

Each call renders one replicate, and the film takes them in their order.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from threading import Event, Lock

from ..errors import Cancelled, EtalonError
from ..film.film import Film
from ..film.parts import Part
from ..film.rendering import Rendering
from ..film.windows import Windows
from ..progress import NO_PROGRESS, Progress
from ..rendering.replicates import Estimator, make_renderer, render_film
from ..sampling.streams import COUNTED
from ..scene import archive
from ..scene.scene import Scene
from ..settings.common import LOCAL
from ..settings.reference import PHOTON_MAPPING, Options, RenderOptions
from ..version import VERSION
from ..wavefront.render import ReferenceRenderer
from .client import Cluster, connect
from .worker import Lacks, digest_of, find_content, require_version, watch_task, worker_name

# A worker's threads share one renderer, which uses all its processors.
_RENDERING = Lock()


@dataclass(frozen=True)
class Request:
    """One replicate: its number, its samples per pixel, and its windows (None: the whole image)."""

    replicate: int
    samples: int
    windows: Windows | None = None


Ask = Callable[[Request, Callable[[], bool]], Rendering]
"""Has a replicate rendered on some worker, and ends early once its second argument says so."""


def render_where_asked(scene: Scene, options: RenderOptions, progress: Progress = NO_PROGRESS) -> Film:
    """Render the film of `options` on this machine, or on the workers of their scheduler.

    The two are the same bit for bit. Raises EtalonError as `connect` and `render_film_on_cluster` do.
    """
    if options.scheduler == LOCAL:
        return render_film(scene, options, progress)
    with connect(options.scheduler) as cluster:
        cluster.check()
        return render_film_on_cluster(cluster, scene, options, progress)


def render_film_on_cluster(
    cluster: Cluster, scene: Scene, options: RenderOptions, progress: Progress = NO_PROGRESS
) -> Film:
    """Render the film that `render_film` makes, bit for bit, on workers.

    Some worker renders each replicate. A replicate depends on its number and the seed alone, and the film takes
    replicate after replicate, whichever is done first. Cancelling keeps those that are done before the first that is
    not. Raises EtalonError where workers fail, and for photon mapping, whose stated bias is measured over all
    replicates of one renderer.
    """
    if options.strategy == PHOTON_MAPPING:
        raise EtalonError(f"--strategy {PHOTON_MAPPING} states its bias on one machine only; leave out --scheduler")
    film = Film.empty(scene.camera.height, scene.camera.width, options.samples)
    ask = ask_reference(cluster, scene, options)
    try:
        for k, rendering in enumerate(_renderings(ask, 2 * cluster.slots, options, progress), 1):
            film.add(rendering)
            progress.report(k / options.replicates)
    except Cancelled:
        pass
    return film


def _renderings(ask: Ask, ahead: int, options: RenderOptions, progress: Progress) -> Iterator[Rendering]:
    """Yield the replicates in their order.

    `ahead` of them are under way or wait, so that memory is bounded.
    """
    stop = Event()

    def is_ending() -> bool:
        return stop.is_set() or progress.is_cancelled

    def ask_number(k: int) -> Rendering:
        return ask(Request(COUNTED.number(k), options.samples), is_ending)

    with ThreadPoolExecutor(max_workers=ahead) as pool:
        waiting = [pool.submit(ask_number, k) for k in range(min(ahead, options.replicates))]
        try:
            for k in range(options.replicates):
                yield waiting.pop(0).result()
                if k + ahead < options.replicates:
                    waiting.append(pool.submit(ask_number, k + ahead))
        finally:
            stop.set()


def ask_reference(cluster: Cluster, scene: Scene, options: Options, passes: Sequence[Part] = ()) -> Ask:
    """A function that has a replicate of the reference rendered on some worker."""
    with tempfile.TemporaryDirectory() as made:
        path = Path(made) / "scene.npz"
        archive.save(scene, path)
        content = path.read_bytes()
    digest = digest_of(content)

    def ask(request: Request, is_ending: Callable[[], bool]) -> Rendering:
        arguments = (VERSION, digest, options, tuple(passes), request)
        return cluster.call(render_replicate, arguments, {digest: content}, is_ending)

    return ask


def render_replicate(
    version: str, digest: str, options: Options, passes: tuple[Part, ...], request: Request
) -> Rendering | Lacks:
    """Render one replicate of the reference on the worker that this call came to.

    It is of the saved scene with that digest. Only path tracing has `passes` and windows.
    """
    require_version(version)
    path = find_content(digest)
    if path is None:
        return Lacks(worker_name(), (digest,))
    with _RENDERING:
        renderer, progress = _renderer(path, options, passes), Progress(is_cancelled=watch_task())
        if isinstance(renderer, ReferenceRenderer):
            return renderer.render(request.replicate, request.samples, progress, request.windows)
        return renderer.render(request.replicate, request.samples, progress)


@lru_cache(maxsize=1)
def _renderer(path: Path, options: Options, passes: tuple[Part, ...]) -> Estimator:
    return make_renderer(archive.load(path), options, passes)
