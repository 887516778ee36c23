# SPDX-License-Identifier: GPL-3.0-or-later
"""All figures of a comparison as plain data: verdict.json.

Its published form is verdict.schema.json beside this file.
"""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from ..blender_versions import NEWEST_CHECKED, format_release
from ..comparison.compare import Comparison, Side
from ..effects.plan import Plan
from ..files.plain_data import make_plain
from ..relative import worst_channel
from ..verdict.causes import Shares, State
from ..verdict.outcome import Outcome
from .bound import level_names
from .causes import cause_sentences, is_shown, proof_seconds, strongest, unexplained
from .passes import choice_figures, pass_figures
from .summary import summarize
from .words import forecast_seconds, sentences

FORMAT = "etalon-verdict"
# Grows when a field comes, goes or changes its meaning; a reader compares it before it reads on (read.py does).
VERSION = 14
# What a reader of the version before must know, by version.
CHANGES = {
    2: "Version 2: exit code 4 and EXPLAINED; `departures`, `unexplained`, and each region's `causes` and `rest` say why regions differ.",
    3: "Version 3: `plan` lists the effects that the scene calls for; `replicates` of a side are the most that any region has, "
    "since sampling goes on where a region is open; `changes` is this list.",
    4: "Version 4: `left_out` counts the pixels that show light from materials that are not simulated, and names these.",
    5: "Version 5: `attribution` says what is known of causes: cause, partial cause, likely cause, rivals, and what a proof costs; the "
    "`share` of a departure has an interval, and `role` says what is claimed of it; a region has the `share` of what `attribution` names; "
    "`unexplained` is always a number; EXPLAINED asks for a share near 1, too; "
    "`blender` names the Blender under test, its build, and whether it is newer than the newest that was checked.",
    6: "Version 6: `bound` is the difference up to which all regions agree, level by level and look by look, and each region has its own; "
    "`floor` is one number for each channel; a region has `rare`, `blind_spot`, `largest_share`, `tail_shape`, `dark` and `caustics`; "
    "`withdrawn` lists claims that later data did not bear; `forecast` names the bound that it is for; `size` has a `divisor`; "
    "`summary` is the verdict in three sentences; `scene` is the file's name; "
    "regions of the kind 'cell' are those of coarser grids, and claims on all regions are tested together.",
    7: "Version 7: `scene_check` lists what in the scene is likely not meant or was set aside; each region has a `reason`: every difference is "
    "put down to departures, to the scene, or is 'unexplained'; `attribution.state` may be 'explained by rounding'.",
    8: "Version 8: `passes` says of each light pass, in the image and in every region with a name, whether it differs; "
    "null where none was compared.",
    9: "Version 9: the `role` of a departure may be 'acts on no pass that differs': it was not tried, since others explain the difference.",
    10: "Version 10: `passes` also has limits of bounces and the light of each lamp, emitting object and the world; `kind` says what each is.",
    11: "Version 11: a region has `unsupported`, room for the light of unsupported materials, and `blocked` where that keeps it undecided; "
    "`left_out` counts the pixels that show passive unsupported materials, and as before all that light reaches from others.",
    12: "Version 12: light passes are compared by default where they are cheap; `pass_choice` says what was asked for, what that "
    "stands for, and why none was compared where the default left them out.",
    13: "Version 13: `left_out` counts the pixels that show shadow catchers, too; its `shadow_catchers` says how many these are.",
    14: "Version 14: the `reason` of a region may be 'likely departures': those of a likely cause, which is not proved; it was 'unexplained'.",
}


def document(comparison: Comparison, plan: Plan, command: str) -> dict[str, Any]:
    """verdict.json as a dictionary; numbers that are not finite are None.

    `plan` is the reference's, of this scene.
    """
    verdict = comparison.verdict
    channel = int(worst_channel(verdict.difference[0]))
    return make_plain(
        {
            "format": FORMAT,
            "version": VERSION,
            "changes": [{"version": version, "change": change} for version, change in CHANGES.items()],
            "scene": comparison.scene,
            "verdict": verdict.outcome,
            "exit_code": verdict.outcome.exit_code,
            "summary": summarize(comparison),
            "sentences": sentences(comparison),
            "reasons": verdict.reasons,
            "tolerance": verdict.tolerance,
            "confidence": verdict.confidence,
            "floor": verdict.floor,
            "bound": _bound(comparison),
            "image": {
                "channel": "RGB"[channel],
                "difference": verdict.difference[0, channel],
                "interval": [verdict.low[0, channel], verdict.high[0, channel]],
            },
            "regions": [_region(comparison, k) for k in range(len(comparison.regions))],
            "passes": pass_figures(comparison),
            "pass_choice": choice_figures(comparison.pass_choice),
            "departures": _departures(comparison),
            "attribution": _attribution(comparison),
            "unexplained": len(unexplained(comparison)),
            "scene_check": [asdict(finding) for finding in comparison.findings],
            "plan": [asdict(decision) for decision in plan.decisions],
            "forecast": _forecast(comparison),
            "looks": [asdict(look) for look in verdict.looks],
            "reference": _side(comparison.reference),
            "candidate": _side(comparison.candidate),
            "excluded_pixels": int(comparison.excluded.sum()),
            "left_out": _left_out(comparison),
            "withdrawn": [asdict(one) for one in verdict.withdrawn],
            "size": {
                "width": comparison.regions.shape[1],
                "height": comparison.regions.shape[0],
                "divisor": comparison.divisor,
            },
            "options": asdict(comparison.options),
            "stopped": comparison.stopped,
            "started": comparison.started,
            "seconds": comparison.seconds,
            "pilot_seconds": comparison.pilot_seconds,
            "versions": comparison.versions,
            "blender": _blender(comparison),
            "command": command,
        }
    )


def _left_out(comparison: Comparison) -> dict[str, Any]:
    """The pixels that are not compared, with the unsupported materials and the shadow catchers that they show."""
    caught = comparison.caught
    return {
        "pixels": int(comparison.left_out.sum()),
        "materials": [{"name": name, "what": what} for name, what in comparison.unknown.items()],
        "shadow_catchers": None if caught is None else {"pixels": caught.count, "objects": list(caught.names)},
    }


def _blender(comparison: Comparison) -> dict[str, Any]:
    """Version and build of the Blender under test.

    It also says whether that is newer than the newest that was checked.
    """
    settings, release = comparison.candidate.settings, comparison.blender
    return {
        "version": settings.get("version"),
        "build": settings.get("build"),
        "newest_checked": format_release(NEWEST_CHECKED),
        "is_newer_than_checked": release is not None and release > NEWEST_CHECKED,
    }


def _bound(comparison: Comparison) -> dict[str, Any]:
    """The bound on all regions, on each level of them, and at each look."""
    verdict, levels = comparison.verdict, []
    for family, name in level_names(comparison):
        members = (verdict.families == family) & ~np.isnan(verdict.bounds)
        levels.append(
            {
                "level": name,
                "regions": int(members.sum()),
                "equivalent": int((members & (verdict.outcomes == Outcome.EQUIVALENT)).sum()),
                "bound": float(verdict.bounds[members].max()) if members.any() else None,
            }
        )
    agree = (verdict.outcomes == Outcome.EQUIVALENT) & (verdict.blind > 0)
    return {
        "value": verdict.bound,
        "levels": levels,
        "blind_spot": float(verdict.blind[agree].min()) if agree.any() else None,
        "history": [asdict(one) for one in comparison.history],
    }


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
        "bound": verdict.bounds[k],
        "rare": verdict.rare[k],
        "unsupported": verdict.unsupported[k],
        "blocked": bool(verdict.blocked[k]),
        "blind_spot": verdict.blind[k],
        "largest_share": verdict.tails[k],
        "tail_shape": verdict.shapes[k],
        "dark": bool(verdict.dark[k]),
        "caustics": None if comparison.caustics is None else comparison.caustics[k],
        "reason": _reason(comparison, k),
        "causes": [] if comparison.explanation is None else comparison.explanation.causes[k],
        "share": _share(comparison, k),
        "rest": None if comparison.explanation is None else comparison.explanation.rest[k],
    }


def _reason(comparison: Comparison, k: int) -> str | None:
    """The reason for the difference of region k; None where it is not shown to differ."""
    outcome, why = comparison.verdict.outcomes[k], comparison.explanation
    if outcome is Outcome.EXPLAINED and why is not None:
        return "scene" if why.rounded[k] else "departures"
    if outcome is not Outcome.DIFFERENT:
        return None
    return "likely departures" if why is not None and why.state is State.LIKELY else "unexplained"


def _share(comparison: Comparison, k: int) -> dict[str, Any] | None:
    """The share of what is named in region k.

    None where nothing is named or the region agrees.
    """
    why = comparison.explanation
    if why is None or why.of_named is None or comparison.verdict.outcomes[k] is Outcome.EQUIVALENT:
        return None
    return _interval(why.of_named, k, why.state is not State.LIKELY)


def _interval(shares: Shares, k: int, simultaneous: bool) -> dict[str, Any]:
    low, high = (shares.low[k], shares.high[k]) if simultaneous else shares.alone[:, k]
    return {"value": shares.value[k], "low": low, "high": high, "simultaneous": simultaneous}


def _attribution(comparison: Comparison) -> dict[str, Any] | None:
    """What is known of causes; None where no region differs."""
    why = comparison.explanation
    said = cause_sentences(comparison)
    if not said:
        return None
    if why is None:
        return {**dict.fromkeys(_ATTRIBUTION), "state": "not searched", "named": [], "rivals": [], "sentences": said}
    k = None if why.of_named is None else strongest(comparison, why.of_named)
    proof = None
    if why.state is State.LIKELY:
        proof = {"factor": why.proof, "seconds": proof_seconds(comparison)}
    return {
        "state": why.state,
        "named": why.named,
        "region": k,
        "share": None if k is None else _share(comparison, k),
        "rest": None if k is None else why.rest[k],
        "rivals": why.alternatives,
        "small": why.limit,
        "proof": proof,
        "pairs": why.pairs,
        "samples_per_pair": why.samples,
        "seconds": why.seconds,
        "sentences": said,
    }


_ATTRIBUTION = ("region", "share", "rest", "small", "proof", "pairs", "samples_per_pair", "seconds")


def _departures(comparison: Comparison) -> list[dict[str, Any]]:
    """Every departure that applies, with the region in which its share is known best."""
    why, regions, found = comparison.explanation, comparison.regions, []
    if why is None:
        return found
    for k, departure in enumerate(why.departures):
        explained = [i for i, causes in enumerate(why.causes) if departure.name in causes]
        shares = why.shares[k]
        where = strongest(comparison, shares)
        channel = int(worst_channel(why.effect[k, where]))
        found.append(
            {
                "name": departure.name,
                "statement": departure.statement,
                "source": departure.source,
                "versions": str(departure.versions),
                "chosen": departure.name in why.chosen,
                "role": why.roles[k],
                "share": None if shares is None else _interval(shares, where, is_shown(why, k)),
                "clearest": {"region": where, "channel": "RGB"[channel], "effect": why.effect[k, where, channel]},
                "regions": [
                    {"region": i, "kind": regions.kinds[i], "name": regions.names[i], "share": shares.value[i]}
                    for i in explained
                    if shares is not None
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
