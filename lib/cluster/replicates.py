# SPDX-License-Identifier: GPL-3.0-or-later
"""One image of the reference on several machines.

Each call renders one replicate, and the film takes them in their order.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from pathlib import Path
from threading import Event, Lock

from ..errors import Cancelled, EtalonError
from ..film.film import Film
from ..film.rendering import Rendering
from ..progress import NO_PROGRESS, Progress
from ..rendering.replicates import Estimator, make_renderer
from ..sampling.streams import COUNTED
from ..scene import archive
from ..scene.scene import Scene
from ..settings.reference import PHOTON_MAPPING, RenderOptions
from ..version import VERSION
from .client import Cluster
from .worker import Lacks, digest_of, find_content, require_version, watch_task, worker_name

# A worker's threads share one renderer, which uses all its processors.
RENDERING = Lock()


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
    with tempfile.TemporaryDirectory() as made:
        path = Path(made) / "scene.npz"
        archive.save(scene, path)
        content = path.read_bytes()
    film = Film.empty(scene.camera.height, scene.camera.width, options.samples)
    try:
        for k, rendering in enumerate(_renderings(cluster, content, options, progress), 1):
            film.add(rendering)
            progress.report(k / options.replicates)
    except Cancelled:
        pass
    return film


def _renderings(cluster: Cluster, content: bytes, options: RenderOptions, progress: Progress) -> Iterator[Rendering]:
    """Yield the replicates in their order.

    Twice as many as workers are under way or wait, so that memory is bounded.
    """
    digest, stop, ahead = digest_of(content), Event(), 2 * cluster.slots

    def is_ending() -> bool:
        return stop.is_set() or progress.is_cancelled

    def ask(k: int) -> Rendering:
        return cluster.call(render_replicate, (VERSION, digest, options, k), {digest: content}, is_ending)

    with ThreadPoolExecutor(max_workers=ahead) as pool:
        waiting = [pool.submit(ask, k) for k in range(min(ahead, options.replicates))]
        try:
            for k in range(options.replicates):
                yield waiting.pop(0).result()
                if k + ahead < options.replicates:
                    waiting.append(pool.submit(ask, k + ahead))
        finally:
            stop.set()


def render_replicate(version: str, digest: str, options: RenderOptions, replicate: int) -> Rendering | Lacks:
    """Render replicate number `replicate` on the worker that this call came to.

    It is of the saved scene with that digest.
    """
    require_version(version)
    path = find_content(digest)
    if path is None:
        return Lacks(worker_name(), (digest,))
    with RENDERING:
        renderer = _renderer(path, options)
        return renderer.render(COUNTED.number(replicate), options.samples, Progress(is_cancelled=watch_task()))


@lru_cache(maxsize=1)
def _renderer(path: Path, options: RenderOptions) -> Estimator:
    return make_renderer(archive.load(path), options)
