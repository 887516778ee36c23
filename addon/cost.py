# SPDX-License-Identifier: GPL-3.0-or-later
"""One cost measurement of the scene that is open; the command line and scripts share it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path

import bpy

from ..lib.comparison.run import Stop
from ..lib.cost.document import BASELINE, TARGETS, Extras, document
from ..lib.cost.estimators import estimator_ways
from ..lib.cost.measure import PAIRS, TRUTH_SHARE, Measurement, measure
from ..lib.cost.models import measure_forms
from ..lib.cost.result import Cost
from ..lib.cost.verify import Verification, verify
from ..lib.cost.ways import BEST, Way, reference_ways
from ..lib.cost.write import STAGE_PICTURES, write_cost
from ..lib.effects.plan import make_plan
from ..lib.errors import Cancelled, EtalonError, unknown
from ..lib.files.atomic import replace_files
from ..lib.progress import NO_PROGRESS, Progress
from ..lib.settings.cost import CostOptions
from .cycles.renderer import neutral
from .cycles.settings import cycles_ways, traded
from .host.quiet import quiet
from .job import export

# Seconds for pilots where only a forecast is asked for: with what is under way when they are over, at most 30.
PILOTS = 24.0
PILOT_PAIRS = 3
PILOT_TRUTH = 0.12
WHOLE = 300.0

# Opens the display of one phase, by its name, and gives the progress of it.
Phases = Callable[[str], AbstractContextManager[Progress]]


@contextmanager
def silent(phase: str) -> Iterator[Progress]:
    """Show no progress."""
    yield NO_PROGRESS


def measure_cost(
    name: str,
    scene: bpy.types.Scene,
    options: CostOptions,
    folder: Path | None = None,
    repeat: str = "",
    phases: Phases = silent,
    opened: float = 0.0,
) -> Cost:
    """Measure `scene`, called `name`, with the reference and with Cycles.

    The scene's own settings are restored afterwards. The report goes to `folder`, if there is one; `repeat` is the
    command that it shows. `opened` are the seconds that opening the file took. Raises EtalonError, Refused, or
    Cancelled where nothing was measured.
    """
    begin = time.perf_counter()
    users = traded(scene)
    with quiet():
        exported = export(scene)
    beside_folder = nullcontext() if folder is None else replace_files(folder, without=STAGE_PICTURES)
    with beside_folder as beside, quiet(), neutral(scene, threads=options.threads):
        exporting = opened + time.perf_counter() - begin
        ways = reference_ways(exported, options.seed, options.threads, exporting)
        ways += cycles_ways(scene, users, options.seed, options.threads, opened)
        ways += estimator_ways(exported, options.seed, options.threads, exporting)
        measurement, verification = _measure(name, choose_ways(ways, options.ways), options, phases)
        extras = Extras(
            tuple(measure_forms()),
            make_plan(exported),
            TARGETS if options.target is None else (options.target,),
            verification,
            repeat,
        )
        figures = document(measurement, extras) if beside is None else write_cost(measurement, extras, beside)
    return Cost(measurement, verification, figures)


def _measure(
    name: str, ways: list[Way], options: CostOptions, phases: Phases
) -> tuple[Measurement, Verification | None]:
    pilots = options.target is not None
    with phases("pilots" if pilots else "measuring") as progress:
        measurement = measure(
            name,
            ways,
            BEST,
            options.time or (PILOTS if pilots else WHOLE),
            PILOT_PAIRS if pilots else PAIRS,
            first=(BASELINE,),
            truth_share=PILOT_TRUTH if pilots else TRUTH_SHARE,
            progress=progress,
        )
    if options.target is None or not options.verify or measurement.stopped is Stop.CANCELLED:
        return measurement, None
    try:
        with phases("the cheapest strategy") as progress:
            return measurement, verify(measurement, options.target, progress)
    except Cancelled:
        return measurement, None


def choose_ways(ways: list[Way], keys: tuple[str, ...] | None) -> list[Way]:
    """The strategies of the given keys, and the one that the truth comes from.

    All strategies where None is given.
    """
    if keys is None:
        return ways
    known = [way.key for way in ways]
    for key in keys:
        if key not in known:
            raise EtalonError(unknown("strategy", key, known))
    return [way for way in ways if way.key in keys or way.key == BEST]
