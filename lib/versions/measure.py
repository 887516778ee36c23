# SPDX-License-Identifier: GPL-3.0-or-later
"""One scene under several Blenders: the rounds, and what they say of every change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..comparison.parts import asked_parts
from ..comparison.run import TimedRun
from ..comparison.sides import Renderer
from ..comparison.size import choose_divisor
from ..departures.catalogue import Departure, changed, relevant
from ..progress import Progress
from ..scene.archive import fingerprint
from ..scene.scene import Scene
from ..settings.comparison import CompareOptions, ComparisonSettings
from ..settings.reference import Options
from ..wavefront.coverage import coverage
from ..wavefront.render import ReferenceRenderer
from .changes import Change, judge
from .rounds import Contestant, Rounds, pairs_of, render_rounds


@dataclass(frozen=True)
class Opened:
    """A scene in one Blender.

    It has that version's label, the scene as it was exported there, and Cycles.
    """

    label: str
    scene: Scene
    cycles: Renderer
    may_shrink: bool


@dataclass(frozen=True)
class Measured:
    """All that is known of one scene.

    `labels` are the versions, in order; `is_same_scene` says whether all of them read the same scene from the file, `settings` are those of
    Cycles that are not the same in all. `divisor` is how many times narrower and lower the images are than the scene asks for.
    """

    labels: tuple[str, ...]
    rounds: Rounds
    changes: tuple[Change, ...]
    is_same_scene: bool
    settings: dict[str, tuple[Any, ...]]
    divisor: int


def measure(name: str, versions: Sequence[Opened], settings: ComparisonSettings, progress: Progress) -> Measured:
    """Render the scene called `name` in all `versions`, and judge each change.

    Raises EtalonError where nothing was rendered.
    """
    run = TimedRun(settings.time, progress)
    prints = [fingerprint(one.scene) for one in versions]
    by_print: dict[str, ReferenceRenderer] = {}
    for one, key in zip(versions, prints, strict=True):
        if key not in by_print:
            by_print[key] = ReferenceRenderer(one.scene, settings.part(Options))
    first = by_print[prints[0]]
    divisor = 1
    if settings.size == "auto" and settings.samples is None and all(one.may_shrink for one in versions):
        progress.begin("timing the renderers")
        divisor = choose_divisor((first, versions[0].cycles), first.scene.camera, run)
    size = first.scene.camera.width // divisor, first.scene.camera.height // divisor
    passes = asked_parts(first, settings)

    def sized(renderer: Any) -> Any:
        return (renderer if divisor == 1 else renderer.at_size(*size)).with_passes(passes)

    references = {key: sized(reference) for key, reference in by_print.items()}
    departures = _changed(versions, settings.masking)
    models = _models(versions, prints, references, settings) if any(departures) else [None] * len(versions)
    contestants = [
        Contestant(one.label, sized(one.cycles), references[key], model)
        for one, key, model in zip(versions, prints, models, strict=True)
    ]
    progress.begin("rendering every version")
    rounds = render_rounds(
        name, contestants, coverage(references[prints[0]].kernel), passes, settings.part(CompareOptions), run
    )
    return Measured(
        labels=tuple(one.label for one in versions),
        rounds=rounds,
        changes=judge(rounds, departures, settings.part(CompareOptions)),
        is_same_scene=len(by_print) == 1,
        settings=_unequal([one.cycles.settings for one in versions]),
        divisor=divisor,
    )


def _changed(versions: Sequence[Opened], masking: str) -> list[tuple[Departure, ...]]:
    """The departures that are not the same in both versions of each pair."""
    return [changed(versions[a].scene, versions[b].scene, masking) for a, b in pairs_of(len(versions))]


def _models(
    versions: Sequence[Opened], prints: Sequence[str], references: dict[str, Any], settings: ComparisonSettings
) -> list[ReferenceRenderer]:
    """For each version the reference with all departures that it has.

    References that are the same are one.
    """
    options, made = settings.part(Options), {}
    models = []
    for one, key in zip(versions, prints, strict=True):
        # Where rounding decides how much of a departure acts, nothing can be said beforehand.
        found = [d for d in relevant(one.scene, options.masking) if not d.by_rounding]
        which = key, tuple((d.name, d.form(one.scene.blender)) for d in found)
        if which not in made:
            departing = replace(options, departures=options.departures | {d.name for d in found})
            # The tables of a departure are those of the release that exported the scene.
            like = references[key]
            scene = replace(like.scene, blender=one.scene.blender)
            made[which] = ReferenceRenderer(scene, departing, like.plan, like.kernel, like.passes)
        models.append(made[which])
    return models


def _unequal(settings: Sequence[dict[str, Any]]) -> dict[str, tuple[Any, ...]]:
    """The settings that are not the same in all versions; None where one has no such setting."""
    names = dict.fromkeys(name for one in settings for name in one if name not in ("version", "build"))
    found = {name: tuple(one.get(name) for one in settings) for name in names}
    return {name: values for name, values in found.items() if any(value != values[0] for value in values)}
