# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon cost`: error against time of every way to render a scene, or what one error would take."""

from __future__ import annotations

import difflib
import time
from argparse import Namespace
from dataclasses import asdict
from pathlib import Path

from ...lib.comparison.run import Stop
from ...lib.cost.document import BASELINE, TARGETS, Extras
from ...lib.cost.measure import PAIRS, TRUTH_SHARE, Measurement, measure
from ...lib.cost.models import measure_forms
from ...lib.cost.verify import Verification, verify
from ...lib.cost.ways import BEST, Way, reference_ways
from ...lib.cost.write import table, took, write_cost
from ...lib.effects.plan import make_plan
from ...lib.errors import Cancelled, EtalonError
from ...lib.files.atomic import replace_files
from ...lib.progress import Progress
from .console import bar, ended_by_interrupt, interruptible, quiet

# Seconds for pilots where only a forecast is asked for: with what is under way when they are over, at most 30.
PILOTS = 24.0
PILOT_PAIRS = 3
PILOT_TRUTH = 0.12
WHOLE = 300.0


def run(arguments: Namespace) -> int:
    """Measure, print the table, leave the report."""
    if arguments.scene is not None and arguments.scene.endswith(".npz"):
        raise EtalonError(f"{arguments.scene}: Cycles cannot render a saved scene; give the .blend")
    if arguments.verify and arguments.target is None:
        raise EtalonError("--verify puts a forecast to the test; say for which error with --target")
    begin = time.perf_counter()
    with ended_by_interrupt():
        import bpy

        from ..cycles.settings import cycles_ways, traded
        from ..job import export, neutral
        from .opening import open_target
    name = open_target(arguments.scene, arguments.frame, arguments.camera, arguments.assignments)
    folder = arguments.out or Path("etalon-out") / name
    scene = bpy.context.scene
    users = traded(scene)
    opened = time.perf_counter() - begin
    with quiet():
        exported = export(scene)
    with replace_files(folder) as beside, quiet(), neutral(scene, threads=arguments.threads):
        ways = reference_ways(exported, arguments.seed, arguments.threads, time.perf_counter() - begin)
        ways += cycles_ways(scene, users, arguments.seed, arguments.threads, opened)
        measurement, verification = _measure(name, _chosen(ways, arguments.ways), arguments)
        extras = Extras(
            tuple(measure_forms()),
            make_plan(exported),
            TARGETS if arguments.target is None else (arguments.target,),
            verification,
            arguments.repeat,
        )
        figures = write_cost(measurement, extras, beside)
    print(table(figures))
    if verification is not None:
        print(_verdict(verification))
    elif arguments.verify:
        print("not verified: interrupted, or no way reaches the target")
    print(f"report: {folder / 'cost.html'}")
    return 0


def _measure(name: str, ways: list[Way], arguments: Namespace) -> tuple[Measurement, Verification | None]:
    pilots = arguments.target is not None
    budget = arguments.time or (PILOTS if pilots else WHOLE)
    with interruptible() as interrupted:
        with bar(f"{name}: {'pilots' if pilots else 'measuring'}") as report:
            pairs = PILOT_PAIRS if pilots else PAIRS
            measurement = measure(
                name,
                ways,
                BEST,
                budget,
                pairs,
                first=(BASELINE,),
                truth_share=PILOT_TRUTH if pilots else TRUTH_SHARE,
                progress=Progress(report, interrupted),
            )
        if not arguments.verify or measurement.stopped is Stop.CANCELLED:
            return measurement, None
        try:
            with bar(f"{name}: the cheapest way") as report:
                return measurement, verify(measurement, arguments.target, Progress(report, interrupted))
        except Cancelled:
            return measurement, None


def _chosen(ways: list[Way], keys: str | None) -> list[Way]:
    """The ways of the given keys, and the one that the truth comes from; all where none is given."""
    if keys is None:
        return ways
    wanted, known = [key.strip() for key in keys.split(",")], [way.key for way in ways]
    for key in wanted:
        if key not in known:
            near = difflib.get_close_matches(key, known, n=1)
            raise EtalonError(f"{key}: no way is called so; {f'did you mean {near[0]}?' if near else ', '.join(known)}")
    return [way for way in ways if way.key in wanted or way.key == BEST]


def _verdict(v: Verification) -> str:
    return (
        f"{v.label}: forecast {took(asdict(v.forecast.seconds))} with {v.samples} samples a pixel to {100 * v.forecast.target:g} %; "
        f"it took {v.seconds:.2f} s ({'inside' if v.held else 'outside'} the interval) "
        f"and the error is {100 * v.error:.3g} %; exactly {100 * v.forecast.target:g} % would have taken {v.to_target:.2f} s"
    )
