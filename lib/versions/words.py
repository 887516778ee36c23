# SPDX-License-Identifier: GPL-3.0-or-later
"""What `etalon versions` found, in sentences: the same on the terminal and on the page."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..pages.formats import format_percent
from ..plural import plural
from ..report.language import listed
from ..verdict.outcome import Outcome

UNCHANGED, CHANGED, KNOWN, OPEN = "unchanged", "changed", "changed, for a known reason", "undecided"
WORDS = {
    Outcome.EQUIVALENT.value: UNCHANGED,
    Outcome.DIFFERENT.value: CHANGED,
    Outcome.EXPLAINED.value: KNOWN,
    Outcome.UNDECIDED.value: OPEN,
}


def summarize(figures: Mapping[str, Any]) -> str:
    """Whether anything changed, over all scenes, in one sentence."""
    scenes = figures["scenes"]
    changed = [one["scene"] for one in scenes if any(change["has_changed"] for change in one["changes"])]
    missing = sum(not one["changes"] for one in scenes)
    rest = f" {plural(missing, 'scene')} could not be compared." if missing else ""
    limit = format_percent(figures["tolerance"], sign=False)
    if changed:
        few = listed(changed) if len(changed) <= 3 else f"{listed(changed[:3])} and others"
        return f"{len(changed)} of {plural(len(scenes), 'scene')} changed by more than {limit}: {few}.{rest}"
    if missing == len(scenes):
        return f"Nothing was compared.{rest}"
    if any(change["outcome"] == Outcome.UNDECIDED.value for one in scenes for change in one["changes"]):
        return f"No change of more than {limit} was found, and some regions are too noisy to exclude one.{rest}"
    return f"No scene changed by more than {limit} in any region.{rest}"


def scene_sentence(scene: Mapping[str, Any]) -> str:
    """One scene in one sentence."""
    if scene["error"]:
        return f"Not compared: {scene['error']}"
    changed = [f"{one['from']} to {one['to']}" for one in scene["changes"] if one["has_changed"]]
    if changed:
        return f"Changed from {listed(changed)}."
    same = all(one["is_same"] for one in scene["changes"])
    if any(one["outcome"] == Outcome.UNDECIDED.value for one in scene["changes"]):
        return "No change was found; some regions are too noisy to exclude one."
    return "All versions render the same image, bit for bit." if same else "Unchanged within the tolerance."


def change_sentences(change: Mapping[str, Any]) -> list[str]:
    """Sentences on one pair of versions.

    They say how much changed and where, why, and which version is nearer to the reference.
    """
    if change["is_same"]:
        return ["Both render the same image, bit for bit."]
    if not change["has_changed"]:
        open_ = change["regions"][Outcome.UNDECIDED.value]
        if not open_ and change["outcome"] == Outcome.UNDECIDED.value:
            return ["No region changed by more than the tolerance; some parts of the light are too noisy to decide."]
        if open_:
            return [
                f"No change was found; {plural(open_, 'region')} of {sum(change['regions'].values())} still too noisy."
            ]
        return ["No region changed by more than the tolerance."]
    return [*_where(change), *_why(change), *_which(change)]


def describe(one: Mapping[str, Any]) -> str:
    """A relative change with its interval."""
    low, high = one["interval"]
    if one["difference"] is None:
        return "unbounded"
    if low is None or high is None:
        return f"{format_percent(one['difference'])} (no interval)"
    return f"{format_percent(one['difference'])} ({100 * low:+.3g} to {100 * high:+.3g})"


def _where(change: Mapping[str, Any]) -> list[str]:
    """What changed, and by how much."""
    moved = change["regions"][Outcome.DIFFERENT.value] + change["regions"][Outcome.EXPLAINED.value]
    total = plural(sum(change["regions"].values()), "region")
    worst = change["worst"]
    said = [f"{moved} of {total} changed."] if moved else []
    if moved:
        said.append(f"Most in {_name(worst)}: {describe(worst)} in channel {worst['channel']}.")
    passes = [
        one["pass"] for one in change["passes"] if one["outcome"] in (Outcome.DIFFERENT.value, Outcome.EXPLAINED.value)
    ]
    if passes:
        said.append(f"Parts of the light that changed: {listed(passes)}.")
    return said


def _name(region: Mapping[str, Any]) -> str:
    """A region as a sentence names it."""
    return {"image": "the whole image", "block": f"the block {region['name']}"}.get(
        region["kind"], f"{region['kind']} '{region['name']}'"
    )


def _why(change: Mapping[str, Any]) -> list[str]:
    """The departures that differ between both versions, and whether they explain the change."""
    if not change["departures"]:
        return ["No known departure of Cycles from the model is different in these versions on this scene."]
    names = listed([f"{one['name']} ({_when(one)})" for one in change["departures"]])
    unexplained = change["regions"][Outcome.DIFFERENT.value]
    if not unexplained:
        return [f"The reference, made to depart as each version does, changes in the same way: {names}."]
    return [f"Different in these versions, but not enough to explain {plural(unexplained, 'region')}: {names}."]


def _when(departure: Mapping[str, Any]) -> str:
    """The releases of a departure, or of its forms."""
    forms = [f"another form from {first} on" for first in departure["forms"]]
    return listed(forms) if forms else departure["versions"]


def _which(change: Mapping[str, Any]) -> list[str]:
    """Which version is nearer to the reference."""
    first, second, count = change["from"], change["to"], change["nearer"]
    whole = change["image"]["nearer"]
    said = []
    if whole == "mixed":
        said.append(f"In the whole image {first} is nearer to the reference in one channel and {second} in another.")
    elif whole:
        said.append(f"{whole} is nearer to the reference in the whole image.")
    total = sum(count.values())
    sure = [f"{label} in {count[label]}" for label in (first, second) if count[label]]
    if sure:
        said.append(f"Of {plural(total, 'region')} that changed, nearer to the reference: {listed(sure)}.")
    elif not said:
        said.append("Which version is nearer to the reference is not known yet; give more time.")
    return said
