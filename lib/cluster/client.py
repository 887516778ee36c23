# SPDX-License-Identifier: GPL-3.0-or-later
"""The client of a cluster: a connection to a scheduler of Dask, and calls to its workers.

It also sends the files that these calls need. A worker that lacks a file says so, and gets its content once. So workers
may come, die and start again at any time: the scheduler hands the call of a worker that died to another one, which says
in turn what it lacks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Lock
from typing import Any

from ..errors import Cancelled, EtalonError
from ..settings.common import LOCAL
from ..version import VERSION
from .worker import Lacks, describe_blender, keep

_CONNECT = "10s"
# Seconds between two questions whether the user wants the work to end.
_LOOK = 0.5
# So often a call is made again because the worker lacked files; each time another worker may have taken it.
_TURNS = 10


class Cluster:
    """The workers of one scheduler; its calls may be made from several threads."""

    def __init__(self, client: Any, address: str) -> None:
        self._client, self.address = client, address
        self._lock = Lock()
        self._sent: set[tuple[str, str]] = set()

    @property
    def slots(self) -> int:
        """How many calls run at once."""
        return sum(self._client.nthreads().values())

    def check(self, blender: str | None = None) -> None:
        """Raise EtalonError for a worker without this version of Étalon.

        Unless `blender` is None, every worker must have that release and build too.
        """
        # By name, so that a worker that has no Étalon can answer.
        from pydoc import locate

        for worker, version in self._ask(locate, "etalon.lib.version.VERSION").items():
            if version != VERSION:
                has = "has no Étalon" if version is None else f"has Étalon {version}"
                raise EtalonError(f"worker {worker} {has}; install Étalon {VERSION} there, as here")
        if blender is None:
            return
        for worker, found in self._ask(describe_blender).items():
            if found != blender:
                raise EtalonError(
                    f"worker {worker} has {'Blender ' + found if found else 'no Blender'}; install Blender {blender} there, as here"
                )

    def call(
        self,
        function: Callable[..., Any],
        arguments: tuple[Any, ...],
        contents: Mapping[str, Path | bytes],
        is_ending: Callable[[], bool],
    ) -> Any:
        """What `function` returns on some worker.

        Where it returns Lacks, that worker gets these of the `contents` (by SHA-256) and the call is made again. Raises Cancelled once
        `is_ending` says so, and EtalonError where workers die with it again and again, or the scheduler is gone.
        """
        preferred: list[str] = []
        for _ in range(_TURNS):
            where = {"workers": preferred, "allow_other_workers": True} if preferred else {}
            found = self._result(self._client.submit(function, *arguments, pure=False, **where), is_ending)
            if not isinstance(found, Lacks):
                return found
            preferred = [found.worker]
            for digest in found.digests:
                self._send(found.worker, digest, contents[digest])
        raise EtalonError(f"worker {found.worker} does not keep the files that it gets; check its local directory")

    def prepare(
        self, function: Callable[..., Any], arguments: tuple[Any, ...], contents: Mapping[str, Path | bytes]
    ) -> None:
        """Call `function` in every worker, and again once those that return Lacks have their files.

        Another worker answers for one that dies. Raises EtalonError as `call` does.
        """
        for _ in range(2):
            futures = [
                self._client.submit(function, *arguments, pure=False, workers=[worker], allow_other_workers=True)
                for worker in self._client.nthreads()
            ]
            for lacks in (one for one in [self._result(future, bool) for future in futures] if isinstance(one, Lacks)):
                for digest in lacks.digests:
                    self._send(lacks.worker, digest, contents[digest])

    def run_everywhere(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Run `function` once in every worker that is still there."""
        if self._client.status == "running":
            self._run(function, *arguments)

    def _result(self, future: Any, is_ending: Callable[[], bool]) -> Any:
        from distributed import CancelledError, KilledWorker

        try:
            # Not `result(timeout)`: one that times out takes the results away that other threads wait for.
            done = Event()
            future.add_done_callback(lambda _: done.set())
            while not is_ending():
                if done.wait(_LOOK):
                    return future.result()
                if self._client.status == "closed":
                    raise CancelledError
            raise Cancelled("cancelled")
        except KilledWorker as error:
            raise EtalonError(
                f"workers died with it, the last one {error.last_worker.address}; see their logs"
            ) from None
        except (CancelledError, OSError) as error:
            if isinstance(error, CancelledError) or self._client.status != "running":
                raise self._gone() from None
            raise
        finally:
            future.release()

    def _send(self, worker: str, digest: str, content: Path | bytes) -> None:
        with self._lock:
            if (worker, digest) in self._sent:
                return
            whole = content if isinstance(content, bytes) else content.read_bytes()
            self._run(keep, digest, whole, workers=[worker])
            self._sent.add((worker, digest))

    def _ask(self, function: Callable[..., Any], *arguments: Any) -> dict[str, Any]:
        """What `function` returns in each worker, by their addresses, but for those that die meanwhile."""
        found = {}
        for worker, answer in self._run(function, *arguments).items():
            if isinstance(answer, Exception) and not isinstance(answer, OSError):
                raise answer
            if not isinstance(answer, OSError):
                found[worker] = answer
        return found

    def _run(self, function: Callable[..., Any], *arguments: Any, workers: list[str] | None = None) -> dict[str, Any]:
        """What `function` returns or raises in `workers`, or in all; OSError stands for those that die meanwhile.

        Raises EtalonError where the scheduler is gone.
        """
        try:
            found = self._client.run(function, *arguments, workers=workers, on_error="return")
        except OSError:
            raise self._gone() from None
        return dict(found)

    def _gone(self) -> EtalonError:
        return EtalonError(f"the scheduler {self.address} is gone; start it, and run the same command again")


@contextmanager
def connect(address: str) -> Iterator[Cluster]:
    """Connect to the scheduler at `address` for the length of a block.

    The address is as tcp://host:8786. Raises EtalonError where Dask is not installed, nobody answers, or there is no
    worker.
    """
    try:
        from distributed import Client
    except ImportError:
        raise EtalonError(
            f"--scheduler {address} needs Dask; install it by `pip install etalon[cluster]`, or leave it at {LOCAL}"
        ) from None
    try:
        client = Client(address, timeout=_CONNECT, set_as_default=False)
    except (OSError, TimeoutError, ValueError):
        raise EtalonError(
            f"--scheduler {address}: no scheduler answers there; start one with `dask scheduler`, and give its address"
        ) from None
    with client:
        if not client.nthreads():
            raise EtalonError(f"--scheduler {address}: it has no workers; start some with `dask worker {address}`")
        yield Cluster(client, address)
