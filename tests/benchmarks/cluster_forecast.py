# SPDX-License-Identifier: GPL-3.0-or-later
"""What 10,000 frames on 1,000 workers take.

This is an event simulation of `etalon batch --scheduler` with measured costs.

    python tests/benchmarks/cluster_forecast.py [--frames 10000] [--workers 1000] [--seconds 60]

The client sends each worker the scene's files once and takes every report; both share its network. A worker that dies
loses the comparison that it runs, which begins again on another worker; a new worker takes its place after a while
and needs the files again.
"""

from __future__ import annotations

import argparse
import heapq
import random
from dataclasses import dataclass, replace
from itertools import count

MB, GB = 1e6, 1e9


@dataclass(frozen=True)
class Costs:
    """Seconds and bytes of one comparison.

    They are what it takes beside its `seconds` of rendering, and what moves for it.
    """

    frames: int = 10_000
    workers: int = 1_000
    seconds: float = 60.0
    # Measured: docs/scaling.md says how.
    start: float = 5.0
    report: float = 1.4 * MB
    handling: float = 0.02
    # Assumed of a studio's network and machines.
    files: float = 200 * MB
    network: float = 1.25 * GB
    days_to_failure: float = 10.0
    restart: float = 60.0


@dataclass
class Forecast:
    """The forecast of a batch.

    It has hours of the whole, the shares of that time in which client and workers are busy, comparisons lost, and bytes
    sent and received.
    """

    hours: float
    client: float
    workers: float
    lost: int
    sent: float
    received: float


def simulate(costs: Costs, by_path: bool, seed: int = 0) -> Forecast:
    """Run the batch event by event.

    The client does one thing at a time: it sends files to a worker, or takes a report.
    """
    chance, order = random.Random(seed), count()
    free = 0.0  # the time at which the client is free again
    busy = rendering = end = sent = received = 0.0
    left, done, lost = costs.frames, 0, 0
    # Events by time: a worker that asks for its first comparison, one that finished, and one that died.
    events = [(0.0, next(order), "new") for _ in range(costs.workers)]
    heapq.heapify(events)

    def serve(now: float, seconds: float) -> float:
        nonlocal free, busy
        free = max(free, now) + seconds
        busy += seconds
        return free

    while events and done < costs.frames:
        now, _, kind = heapq.heappop(events)
        if kind == "new" and not by_path:
            now, sent = serve(now, costs.files / costs.network), sent + costs.files
        elif kind == "finished":
            end = serve(now, costs.report / costs.network + costs.handling)
            received, done = received + costs.report, done + 1
        elif kind == "died":
            left, lost = left + 1, lost + 1
            heapq.heappush(events, (now + costs.restart, next(order), "new"))
            continue
        if left == 0:
            continue
        left -= 1
        takes = costs.start + costs.seconds
        dies = chance.expovariate(1 / (costs.days_to_failure * 86400))
        rendering += min(takes, dies)
        heapq.heappush(events, (now + min(takes, dies), next(order), "died" if dies < takes else "finished"))
    return Forecast(end / 3600, busy / end, rendering / (end * costs.workers), lost, sent, received)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=int, default=Costs.frames)
    parser.add_argument("--workers", type=int, default=Costs.workers)
    parser.add_argument("--seconds", type=float, default=Costs.seconds)
    usual = Costs(**vars(parser.parse_args()))
    cases = {
        "files by content, 10 Gbit/s": (usual, False),
        "files by path": (usual, True),
        "by content, 1 Gbit/s": (replace(usual, network=usual.network / 10), False),
        "by content, 2 GB of files": (replace(usual, files=2 * GB), False),
        "by path, a tenth of the rendering": (replace(usual, seconds=usual.seconds / 10), True),
        "by path, a worker dies once an hour": (replace(usual, days_to_failure=1 / 24), True),
    }
    for workers in (1, 10, 100):
        cases[f"by path, {workers} workers"] = (replace(usual, workers=workers), True)
    print("case | hours | client busy | workers busy | lost and repeated | sent, received")
    for name, (costs, by_path) in cases.items():
        f = simulate(costs, by_path)
        moved = f"{f.sent / GB:.0f} GB, {f.received / GB:.0f} GB"
        print(f"{name} | {f.hours:.2f} | {f.client:.0%} | {f.workers:.0%} | {f.lost} | {moved}")


if __name__ == "__main__":
    main()
