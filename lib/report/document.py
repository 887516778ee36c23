# SPDX-License-Identifier: GPL-3.0-or-later
"""All figures of a comparison as plain data: verdict.json, whose published form is verdict.schema.json beside this file."""

from __future__ import annotations

import math
from dataclasses import asdict
from enum import Enum
from typing import Any

import numpy as np

from ..comparison.compare import Comparison, Side
from ..effects.plan import Plan
from .words import forecast_seconds, sentences, strongest, unexplained, worst_channel

FORMAT = "etalon-verdict"
# Grows when a field comes, goes or changes its meaning; a reader compares it before it reads on (read.py does).
VERSION = 4
# What a reader of the version before must know, by version.
CHANGES = {
    2: "Version 2: exit code 4 and EXPLAINED; `departures`, `unexplained`, and each region's `causes` and `rest` say why regions differ.",
    3: "Version 3: `plan` lists the effects that the scene calls for; `replicates` of a side are the most that any region has, "
    "since sampling goes on where a region is open; `changes` is this list.",
    4: "Version 4: `left_out` counts the pixels that show light from materials that are not simulated, and names these.",
}


def document(comparison: Comparison, plan: Plan, command: str) -> dict[str, Any]:
    """verdict.json as a dictionary; numbers that are not finite are None. `plan` is the reference's, of this scene."""
    verdict = comparison.verdict
    channel = int(worst_channel(verdict.difference[:1])[0])
    return plain(
        {
            "format": FORMAT,
            "version": VERSION,
            "changes": [{"version": version, "change": change} for version, change in CHANGES.items()],
            "scene": comparison.scene,
            "verdict": verdict.outcome,
            "exit_code": verdict.outcome.exit_code,
            "sentences": sentences(comparison),
            "reasons": verdict.reasons,
            "tolerance": verdict.tolerance,
            "confidence": verdict.confidence,
            "floor": verdict.floor,
            "image": {
                "channel": "RGB"[channel],
                "difference": verdict.difference[0, channel],
                "interval": [verdict.low[0, channel], verdict.high[0, channel]],
            },
            "regions": [_region(comparison, k) for k in range(len(comparison.regions))],
            "departures": _departures(comparison),
            "unexplained": None if comparison.explanation is None else len(unexplained(comparison)),
            "plan": [asdict(decision) for decision in plan.decisions],
            "forecast": _forecast(comparison),
            "looks": [asdict(look) for look in verdict.looks],
            "reference": _side(comparison.reference),
            "candidate": _side(comparison.candidate),
            "excluded_pixels": int(comparison.excluded.sum()),
            "left_out": {
                "pixels": int(comparison.left_out.sum()),
                "materials": [{"name": name, "what": what} for name, what in comparison.unknown.items()],
            },
            "size": {"width": comparison.regions.shape[1], "height": comparison.regions.shape[0]},
            "options": asdict(comparison.options),
            "stopped": comparison.stopped,
            "started": comparison.started,
            "seconds": comparison.seconds,
            "pilot_seconds": comparison.pilot_seconds,
            "versions": comparison.versions,
            "command": command,
        }
    )


def plain(value: Any) -> Any:
    """`value` in JSON's own types: arrays as lists, enumerations as their values, non-finite numbers as None, else text."""
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, dict):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int, str)) else str(value)


def _region(comparison: Comparison, k: int) -> dict[str, Any]:
    regions, verdict = comparison.regions, comparison.verdict
    return {
        "kind": regions.kinds[k],
        "name": regions.names[k],
        "box": regions.boxes[k],
        "pixels": regions.sizes[k],
        "excluded_pixels": verdict.excluded[k],
        "outcome": verdict.outcomes[k],
        "decided_at": verdict.decided_at[k],
        "reference": verdict.reference[k],
        "candidate": verdict.candidate[k],
        "difference": verdict.difference[k],
        "low": verdict.low[k],
        "high": verdict.high[k],
        "causes": [] if comparison.explanation is None else comparison.explanation.causes[k],
        "rest": None if comparison.explanation is None else comparison.explanation.rest[k],
    }


def _departures(comparison: Comparison) -> list[dict[str, Any]]:
    """Every departure that was tried, with the region in which it does most."""
    why, regions, found = comparison.explanation, comparison.regions, []
    for k, departure in enumerate(() if why is None else why.departures):
        explained = [i for i, causes in enumerate(why.causes) if departure.name in causes]
        where = strongest(comparison, k)
        channel = int(worst_channel(why.effect[k, where][None])[0])
        found.append(
            {
                "name": departure.name,
                "statement": departure.statement,
                "source": departure.source,
                "versions": str(departure.versions),
                "chosen": departure.name in why.chosen,
                "share": why.share[k, where],
                "largest": {"region": where, "channel": "RGB"[channel], "effect": why.effect[k, where, channel]},
                "regions": [
                    {"region": i, "kind": regions.kinds[i], "name": regions.names[i], "share": why.share[k, i]}
                    for i in explained
                ],
            }
        )
    return found


def _forecast(comparison: Comparison) -> dict[str, Any] | None:
    forecast, ends = comparison.verdict.forecast, forecast_seconds(comparison)
    if forecast is None or ends is None:
        return None
    return {**asdict(forecast), "seconds": dict(zip(("low", "median", "high", "most"), ends, strict=True))}


def _side(side: Side) -> dict[str, Any]:
    film = side.film
    return {
        "name": side.name,
        "settings": side.settings,
        "replicates": side.replicates,
        "replicates_of_all": side.whole,
        "samples_per_replicate": film.samples,
        "samples_per_pixel": film.samples * side.replicates,
        "seconds": film.seconds,
        "stages": film.stages,
        "camera_samples": film.camera_samples,
        "rays": film.rays,
        "nonfinite_pixels": int((film.nonfinite > 0).sum()),
        "nonfinite_samples": int(film.nonfinite.sum()),
    }
