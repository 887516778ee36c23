# SPDX-License-Identifier: GPL-3.0-or-later
"""Both sides of one comparison on several machines.

The comparison asks for one replicate after the other, as on one machine. The replicates that it will probably ask for
next are rendered meanwhile, by other workers. A replicate depends on its number and the seed alone, so it does not
matter which worker renders it, or when.
"""

from __future__ import annotations

from concurrent.futures import Executor, Future, wait
from threading import Event
from typing import Any

from ..comparison.sides import Replicates
from ..film.rendering import Rendering
from ..film.windows import Windows
from ..progress import NO_PROGRESS, Progress
from ..sampling.streams import COUNTED
from .replicates import Ask, Request

# Seconds between two questions whether the user wants the work to end.
_LOOK = 0.5


class SpreadSide:
    """A renderer whose replicates come from workers, `ahead` of them at once.

    `local` gives the name and the settings. `ask` is called in threads of `pool`. No replicate from number `count` on is
    begun ahead.
    """

    def __init__(self, local: Replicates, ask: Ask, pool: Executor, ahead: int, count: int = COUNTED.count) -> None:
        self._local, self._ask, self._pool, self._ahead, self._count = local, ask, pool, ahead, count
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
        later = range(first.replicate + step, self._count, step)[: self._ahead - 1]
        return [Request(number, first.samples, first.windows) for number in (first.replicate, *later)]
