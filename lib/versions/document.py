# SPDX-License-Identifier: GPL-3.0-or-later
"""All figures of `etalon versions` as plain data: versions.json.

Its published form is versions.schema.json beside this file.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..batch.comparison import VERDICTS
from ..errors import EtalonError
from ..exit_codes import ExitCode
from ..files.plain_data import make_plain
from ..relative import worst_channel
from ..report.read import read_verdict
from ..settings.comparison import CompareOptions
from ..verdict.outcome import Outcome
from ..version import VERSION as ETALON
from .changes import SEVERITY, Change, Nearer, PassChange
from .measure import Measured
from .programs import Blender
from .words import change_sentences, scene_sentence, summarize

FORMAT = "etalon-versions"
# Grows when a field changes its meaning or goes; a reader compares it before it reads on.
VERSION = 1


def document(
    scenes: Sequence[dict[str, Any]], blenders: Sequence[Blender], options: CompareOptions, seconds: float, command: str
) -> dict[str, Any]:
    """versions.json as a dictionary; numbers that are not finite are None.

    `scenes` are made by `scene_figures`.
    """
    figures = make_plain(
        {
            "format": FORMAT,
            "version": VERSION,
            "tolerance": options.tolerance,
            "confidence": options.confidence,
            "seed": options.seed,
            "etalon": ETALON,
            "blenders": [{"label": b.label, "asked": b.asked, "build": b.build} for b in blenders],
            "scenes": list(scenes),
            "seconds": seconds,
            "command": command,
        }
    )
    outcomes = [Outcome(change["outcome"]) for scene in figures["scenes"] for change in scene["changes"]]
    worst = max(outcomes, key=SEVERITY.index, default=None)
    failed = any(_has_failed(scene) for scene in figures["scenes"])
    code = ExitCode.BAD_INPUT if failed or worst is None else worst.exit_code
    figures |= {"verdict": worst and worst.value, "exit_code": int(code)}
    return figures | {"summary": summarize(figures)}


def _has_failed(scene: Mapping[str, Any]) -> bool:
    """Whether something of a scene has no result."""
    return bool(scene["error"]) or any(one["status"] != "finished" for one in scene["versions"])


def scene_figures(
    name: str, versions: Sequence[dict[str, Any]], measured: Measured | None, error: str
) -> dict[str, Any]:
    """One scene: its `versions`, and what was measured.

    `versions` are made by `version_figures`; `error` says why nothing was measured.
    """
    found: dict[str, Any] = {"scene": name, "error": error, "versions": list(versions), "changes": []}
    if measured is None:
        return found | {"sentence": scene_sentence(found)}
    rounds = measured.rounds
    found["changes"] = [_change(measured, change) for change in measured.changes]
    found |= {
        "size": {
            "width": rounds.regions.shape[1],
            "height": rounds.regions.shape[0],
            "divisor": measured.divisor,
        },
        "rounds": rounds.count,
        "samples": rounds.samples,
        "stopped": rounds.stopped.value,
        "seconds": rounds.seconds,
        "nonfinite_pixels": int(rounds.bad.sum()),
        "is_same_scene": measured.is_same_scene,
        "settings": {key: dict(zip(measured.labels, of, strict=True)) for key, of in measured.settings.items()},
    }
    return found | {"sentence": scene_sentence(found)}


def version_figures(label: str, folder: Path, below: Path, status: str, code: int, message: str) -> dict[str, Any]:
    """The result of comparing one version with the reference.

    Its report lies in `folder`; paths are relative to `below`, the folder of the page.
    """
    found: dict[str, Any] = {"label": label, "status": status, "message": message, "report": None}
    found |= dict.fromkeys(("verdict", "bound", "image", "causes"))
    if status != "finished":
        return found
    try:
        figures = read_verdict(folder / "verdict.json")
    except EtalonError as error:
        return found | {"status": "failed", "message": str(error)}
    attribution = figures["attribution"] or {"named": [], "state": None}
    return found | {
        "verdict": VERDICTS[ExitCode(code)],
        "bound": figures["bound"]["value"],
        "image": figures["image"],
        "causes": {"state": attribution["state"], "names": attribution["named"]},
        "report": (folder / "report.html").relative_to(below).as_posix(),
    }


def _change(measured: Measured, change: Change) -> dict[str, Any]:
    """One pair of versions."""
    labels = measured.labels[change.first], measured.labels[change.second]
    place, channel = change.worst
    regions = measured.rounds.regions
    moved = (change.outcomes == Outcome.DIFFERENT) | (change.outcomes == Outcome.EXPLAINED)
    counts, nearer = Counter(change.outcomes), Counter(change.nearer[moved])
    found = {
        "from": labels[0],
        "to": labels[1],
        "outcome": change.outcome.value,
        "has_changed": change.has_changed,
        "is_same": change.is_same,
        "regions": {outcome.value: counts[outcome] for outcome in SEVERITY},
        "image": _region(measured, change, 0, int(worst_channel(change.difference[0]))),
        "worst": _region(measured, change, place, channel),
        "places": [_region(measured, change, k, c) for k, c in _places(change, len(regions.named))],
        "nearer": {
            labels[0]: nearer[Nearer.FIRST],
            labels[1]: nearer[Nearer.SECOND],
            "mixed": nearer[Nearer.BOTH],
            "not known": nearer[Nearer.OPEN],
        },
        "departures": [
            {"name": d.name, "statement": d.statement, "versions": str(d.versions), "forms": list(d.forms)}
            for d in change.departures
        ],
        "passes": [_pass(measured, str(name), one) for name, one in change.passes.items()],
    }
    return found | {"sentences": change_sentences(found)}


def _places(change: Change, named: int) -> list[tuple[int, int]]:
    """The regions with a name that changed, and the channel of each that changed most.

    The largest sure change is first.
    """
    sure = np.nan_to_num(np.maximum(np.maximum(change.low, -change.high), 0.0))
    moved = (change.outcomes == Outcome.DIFFERENT) | (change.outcomes == Outcome.EXPLAINED)
    found = [k for k in range(1, named) if moved[k]]
    return [(k, int(sure[k].argmax())) for k in sorted(found, key=lambda k: -sure[k].max())]


def _region(measured: Measured, change: Change, k: int, channel: int) -> dict[str, Any]:
    regions = measured.rounds.regions
    nearer = {Nearer.FIRST: change.first, Nearer.SECOND: change.second}
    of = nearer.get(change.nearer[k])
    return {
        "kind": regions.kinds[k],
        "name": regions.names[k],
        "box": regions.boxes[k],
        "outcome": change.outcomes[k].value,
        "nearer": "mixed" if change.nearer[k] is Nearer.BOTH else None if of is None else measured.labels[of],
        **_interval(change, k, channel),
    }


def _interval(of: Change | PassChange, k: int, channel: int) -> dict[str, Any]:
    return {
        "channel": "RGB"[channel],
        "difference": of.difference[k, channel],
        "interval": [of.low[k, channel], of.high[k, channel]],
    }


def _pass(measured: Measured, name: str, one: PassChange) -> dict[str, Any]:
    """The figures of one light pass.

    They have the claim on it in the image and the regions with a name together, and where it changed most.
    """
    sure = np.nan_to_num(np.maximum(np.maximum(one.low, -one.high), 0.0))
    size = sure if sure.any() else np.nan_to_num(np.abs(one.difference))
    k, channel = (int(n) for n in np.unravel_index(np.argmax(size), size.shape))
    regions = measured.rounds.regions
    outcome = next(outcome for outcome in reversed(SEVERITY) if (one.outcomes == outcome).any())
    return {
        "pass": name,
        "outcome": outcome.value,
        "kind": regions.kinds[k],
        "name": regions.names[k],
        **_interval(one, k, channel),
    }
