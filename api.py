# SPDX-License-Identifier: GPL-3.0-or-later
"""The public functions and classes.

`import etalon` gives these names, in Blender and outside it.

`scene` is everywhere the name of a reference scene, the path of a .blend file, or None for the file that is open in
Blender. A `Target` also chooses the frame and the camera, and sets properties. Opening a file replaces the one that
is open. Errors are EtalonError, whose text is one line, or its subclass Refused, for a scene that asks for what is
not supported.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from .addon.command.exported import read_scene
from .addon.command.observed import observe_file
from .lib.batch.plan import BatchPlan, read_plan, read_words
from .lib.cluster.client import connect
from .lib.cluster.replicates import render_where_asked
from .lib.comparison.compare import Comparison
from .lib.cost.result import Cost
from .lib.effects.plan import Plan, make_plan
from .lib.errors import Cancelled
from .lib.errors import EtalonError as EtalonError
from .lib.errors import Refused as Refused
from .lib.film.film import Film
from .lib.fit.identify import Identification, identify
from .lib.probe.result import ProbeResult
from .lib.progress import NO_PROGRESS, Progress
from .lib.settings.common import LOCAL, REFERENCE_SCENES, Target
from .lib.settings.comparison import Settings
from .lib.settings.cost import CostOptions
from .lib.settings.fit import FitSettings
from .lib.settings.probe import ProbeOptions
from .lib.settings.reference import RenderOptions
from .lib.settings.words import repeating_command
from .lib.verdict.outcome import Outcome as Outcome


def compare(
    scene: str | Path | Target | None = None,
    settings: Settings | None = None,
    progress: Progress = NO_PROGRESS,
) -> Comparison:
    """Render a scene with the reference and with Cycles, and compare the images.

    `progress` receives the share that is done, 0 to 1, and says whether to stop. If `settings.out` is a folder, the
    report is written there; otherwise no file is written. The settings of the scene are restored. With
    `settings.scheduler`, the workers of a Dask scheduler render the replicates, as in `etalon compare --scheduler`.

    Returns the Comparison: `verdict.outcome` is EQUIVALENT, DIFFERENT, UNDECIDED or EXPLAINED, `verdict` has intervals for every
    region, `reference.film` and `candidate.film` have both images. Raises EtalonError or Refused.

    >>> import etalon
    >>> target = etalon.Target("lambert_analytic", assignments=("scene.render.resolution_percentage=25",))
    >>> comparison = etalon.compare(target, etalon.Settings(tolerance=0.2, samples=4, replicates=4))
    >>> comparison.scene
    'lambert_analytic'
    >>> comparison.verdict.outcome in etalon.Outcome
    True
    """
    chosen = settings or Settings()
    target = _target(scene)
    _open(target)
    from .addon.command.comparing import compare_opened

    return compare_opened(target, chosen, chosen.out, progress)


def render(
    scene: str | Path | Target | None = None,
    options: RenderOptions | None = None,
    progress: Progress = NO_PROGRESS,
) -> Film:
    """Render a scene with the reference alone.

    A path that ends in .npz is a scene saved by `etalon plan --save`; it needs no Blender. With `options.scheduler`, the
    workers of a Dask scheduler render the replicates, as in `etalon render --scheduler`.

    Returns the Film: `moments.mean` is the radiance (height, width, 3) in W m^-2 sr^-1, linear Rec. 709, and `moments.n` the number of
    replicates, fewer than requested if it was cancelled. Raises EtalonError or Refused.

    >>> import etalon
    >>> target = etalon.Target("lambert_analytic", assignments=("scene.render.resolution_percentage=10",))
    >>> film = etalon.render(target, etalon.RenderOptions(samples=2, replicates=2))
    >>> film.moments.n
    2
    >>> film.moments.mean.shape == (*film.shape, 3)
    True
    """
    return render_where_asked(read_scene(_target(scene)), options or RenderOptions(), progress)


def plan(scene: str | Path | Target | None = None) -> Plan:
    """List the effects that a scene needs, without rendering.

    Returns the Plan: its `decisions` have the fields `effect`, `needed` and `fact`, which decided it.
    Raises EtalonError or Refused.

    >>> import etalon
    >>> etalon.plan("lambert_analytic").needs("Lambert")
    True
    """
    return make_plan(read_scene(_target(scene)))


def cost(
    scene: str | Path | Target | None = None,
    options: CostOptions | None = None,
    progress: Progress = NO_PROGRESS,
) -> Cost:
    """Measure the time that accuracy takes, or forecast it.

    It is measured with every sampling strategy and with Cycles. If `options.out` is a folder, the report is written
    there; otherwise no file is written. The settings of the scene are restored.

    Returns the Cost: `measurement` has error and seconds of every strategy, `figures` the same as a dictionary, with
    forecasts for each target. Raises EtalonError, Refused, or Cancelled where nothing was measured.

    >>> import etalon
    >>> target = etalon.Target("lambert_analytic", assignments=("scene.render.resolution_percentage=10",))
    >>> found = etalon.cost(target, etalon.CostOptions(time=2, ways=("mis",)))
    >>> [way["key"] for way in found.figures["ways"]]
    ['mis']
    """
    chosen = options or CostOptions()
    target = _target(scene)
    name, opened = _open(target)
    from .addon.command.opening import as_opened
    from .addon.cost import measure_cost

    repeat = repeating_command("cost", as_opened(target), chosen)
    return measure_cost(name, opened, chosen, chosen.out, repeat, lambda words: nullcontext(progress))


def fit(file: str | Path, settings: FitSettings | None = None, progress: Progress = NO_PROGRESS) -> Identification:
    """Find the model and the parameters behind a measured BRDF.

    It also finds those behind a sphere that Cycles renders.

    `file` is a MERL .binary, an RGL .bsdf, or a .blend with one sphere under one sun of angle 0; only the last needs
    Blender, and replaces the file that is open.

    Returns the Identification: `best` is a model with its parameters, `intervals` are their 95 % intervals, `fits`
    says whether the model explains the data, `equivalent` has the models that the data cannot tell apart.
    Raises EtalonError or Refused.

    >>> import etalon
    >>> try:
    ...     etalon.fit("gold.binary")
    ... except etalon.EtalonError as error:
    ...     print(error)
    gold.binary: no such file; check the path
    """
    chosen = settings or FitSettings()
    return identify(observe_file(Path(file), chosen, progress.within(0.0, 0.5)), progress.within(0.5, 1.0))


def probe(
    scene: str | Path | Target | None,
    options: ProbeOptions,
    progress: Progress = NO_PROGRESS,
) -> ProbeResult:
    """Split the light of a pixel by light pass, bounce and light.

    This is done in the reference and in Cycles. `options.pixel` is the pixel's column and row, counted from the upper
    left corner. No file is written. The settings of the scene are restored.

    Returns the ProbeResult: `probe.readings` have the radiances of both sides with their standard errors, `lights`
    every lamp in W, W/sr, cd and lm, `figures` all of it as a dictionary, `lines` the table as text.
    Raises EtalonError or Refused.

    >>> import etalon
    >>> target = etalon.Target("lambert_analytic", assignments=("scene.render.resolution_percentage=10",))
    >>> found = etalon.probe(target, etalon.ProbeOptions(pixel=(2, 3), time=1, bounces=(0, 0)))
    >>> found.probe.readings[0].name
    'all of it'
    >>> found.figures["box"]
    (2, 3, 2, 3)
    """
    name, opened = _open(_target(scene))
    from .addon.probe import probe_here

    return probe_here(name, opened, options, progress)


@dataclass(frozen=True)
class BatchResult:
    """One comparison of a plan.

    It has its `label`, scene and `values` by their names; a `comparison`, or the `error` why there is none.
    """

    label: str
    scene: str
    values: dict[str, Any]
    comparison: Comparison | None
    error: EtalonError | None


def batch(plan: str | Path, progress: Progress = NO_PROGRESS, scheduler: str = LOCAL) -> Iterator[BatchResult]:
    """Compare every scene of a PLAN.toml at every combination of values.

    The comparisons run one after the other in this process. The whole plan is read before the first one, and no file is
    written. `etalon batch` has a process for each comparison, limits, Blenders of other versions, and a journal.
    With a `scheduler`, the workers of that Dask scheduler render the replicates of each comparison, as `compare` does
    with it; `etalon batch --scheduler` gives whole comparisons to workers.

    Yields a BatchResult for each, as it is done. Raises EtalonError for a plan that is wrong, or names Blenders, and for
    a scheduler that does not answer, has no workers, or has one with another Étalon.

    >>> import etalon, pathlib, tempfile
    >>> text = '''
    ... scenes = ["lambert_analytic"]
    ... [options]
    ... samples = 4
    ... replicates = 2
    ... tolerance = 0.2
    ... set = ["scene.render.resolution_percentage=10"]
    ... masking = ["correlated", "separable"]
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "plan.toml"
    ...     _ = path.write_text(text)
    ...     [result.label for result in etalon.batch(path) if result.comparison]
    ['lambert_analytic masking=correlated', 'lambert_analytic masking=separable']
    """
    read = read_plan(Path(plan))
    read.require_scenes(REFERENCE_SCENES)
    if read.blenders:
        raise EtalonError(
            f"{plan}: names Blenders, and this process has one; run `etalon batch`, or leave 'blenders' out"
        )
    if scheduler != LOCAL:
        with connect(scheduler) as cluster:
            cluster.check()
    return _compare_units(read, progress, scheduler)


def _compare_units(plan: BatchPlan, progress: Progress, scheduler: str) -> Iterator[BatchResult]:
    units = list(plan.units())
    for number, unit in enumerate(units):
        words = [*unit.words, *plan.options]
        target = replace(read_words(Target, words), scene=unit.target)
        share = progress.within(number / len(units), (number + 1) / len(units))
        found: tuple[Comparison | None, EtalonError | None]
        try:
            found = compare(target, replace(read_words(Settings, words), scheduler=scheduler), share), None
        except Cancelled:
            raise
        except EtalonError as error:
            found = None, error
        values = {v.name: value for v, value in unit.assignments}
        yield BatchResult(unit.label, unit.scene, values, *found)


def _target(scene: str | Path | Target | None) -> Target:
    if isinstance(scene, Target):
        return scene
    return Target(None if scene is None else str(scene))


def _open(target: Target) -> tuple[str, Any]:
    """Open the scene in Blender; return its name, and the scene itself, a bpy.types.Scene."""
    from .addon.host.blender import load_blender

    bpy = load_blender()
    from .addon.command.opening import open_asked, refuse_archive

    refuse_archive(target)
    name = open_asked(target)
    return name, bpy.context.scene
