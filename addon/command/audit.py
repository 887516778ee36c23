# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon audit`: what each of the user's Cycles settings costs.

Each setting is compared with the least biased state, one at a time.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import bpy

from ...lib.audit.document import table
from ...lib.audit.measure import audit
from ...lib.audit.setting import FACTORY, FILE, Setting
from ...lib.audit.summary import summarize
from ...lib.audit.write import old_pictures, write_audit
from ...lib.files.atomic import replace_files
from ...lib.plain_text import one_line
from ...lib.plural import plural
from ...lib.progress import Progress
from ...lib.settings.audit import AuditOptions
from ...lib.settings.common import PageTerminal, Target, Terminal
from ...lib.settings.comparison import CompareOptions
from ...lib.settings.words import repeating_command
from ..cycles.audit_settings import CATALOGUE, DENOISER, MOST_BOUNCES, kept
from ..cycles.renderer import neutral
from ..cycles.settings import Assignment, CyclesWith, denoiser_is_there
from ..host.quiet import quiet
from .console import bar, interruptible, open_page, print_json
from .opening import as_opened, open_asked, refuse_archive, results_folder

# What `neutral` leaves alone, for it only adds noise or needs volumes, and an audit asks about.
NEUTRAL_BESIDES = {
    "light_sampling_threshold": 0.0,
    "volume_bounces": MOST_BOUNCES,
    "transparent_max_bounces": MOST_BOUNCES,
}


@dataclass
class Asked:
    """The settings to measure.

    `values` are settings with what each of them sets, `same` those that are as neutral.
    """

    values: list[tuple[Setting, list[Assignment]]] = field(default_factory=list)
    same: list[Setting] = field(default_factory=list)
    missing: list[Setting] = field(default_factory=list)


@dataclass(frozen=True)
class Found:
    """The results of an audit that the terminal shows.

    `figures` is the dictionary that is written to audit.json.
    """

    rounds: int
    samples: int
    stopped: str
    figures: dict[str, Any]


def settings(scene: bpy.types.Scene, factory: bool) -> Asked:
    """The settings of the file that are not as neutral.

    With `factory`, their factory values are included. Call it before `neutral` is in force.
    """
    asked = Asked()
    together: dict[str, list[Assignment]] = {FILE: [], FACTORY: []}
    for entry in CATALOGUE:
        values = entry.of_file(scene)
        if not values:
            continue
        defaults = entry.of_factory(scene)
        shown, statement = entry.shown(values), entry.statement
        needs = entry.needs(values)
        setting = Setting(entry.key, entry.label, shown, entry.neutral_shown, statement, needs=needs)
        wanted = [(setting, values)] if entry.departs(values) else []
        if not wanted:
            asked.same.append(setting)
        of_factory, needs = entry.shown(defaults), entry.needs(defaults)
        if factory and entry.departs(defaults) and not (wanted and of_factory == shown):
            key = f"{entry.key}-factory"
            wanted.append((replace(setting, key=key, value=of_factory, origin=FACTORY, needs=needs), defaults))
        if entry.key == DENOISER and not denoiser_is_there():
            missing = "this Blender was built without Open Image Denoise; use one from blender.org"
            asked.missing += [replace(candidate, missing=missing) for candidate, _ in wanted]
            continue
        asked.values += wanted
        together[FILE] += values
        together[FACTORY] += defaults
    for origin, label in ((FILE, "all your settings"), (FACTORY, "all factory settings")):
        count = sum(setting.origin == origin for setting, _ in asked.values)
        if count > 1:
            says = "All of them at once: what one hides another may show, so this is not the sum."
            setting = Setting(f"together-{origin}", label, "", "", says, origin, together=True)
            asked.values.append((setting, together[origin]))
    return asked


def run(target: Target, asked_for: AuditOptions, terminal: PageTerminal) -> int:
    """Open the scene, measure it, print the table and write the report.

    The user's settings are restored.
    """
    refuse_archive(target)
    name = open_asked(target)
    folder = results_folder(asked_for.out, name)
    found = measure_open_scene(
        name, asked_for, folder, repeating_command("audit", as_opened(target), asked_for), terminal
    )
    page = folder / "audit.html"
    if terminal.json:
        print_json(found.figures)
    else:
        print(one_line(f"{name}: {summarize(found.figures)}") + "\n")
        print(table(found.figures))
        samples = plural(found.samples, "sample")
        print(f"{plural(found.rounds, 'round')} of {samples} per pixel for each setting; ended by: {found.stopped}")
        print(one_line(f"report: {page}"))
    if terminal.open:
        open_page(page)
    return 0


def measure_open_scene(name: str, asked_for: AuditOptions, folder: Path, repeat: str, terminal: Terminal) -> Found:
    """Measure the settings of the open scene, and write the report to `folder`.

    The report shows the command `repeat`.
    """
    scene = bpy.context.scene
    asked, stays, samples = settings(scene, asked_for.all), kept(scene), scene.cycles.samples
    threads = asked_for.threads

    def made(assignments: list[Assignment]) -> CyclesWith:
        return CyclesWith(scene, {}, seed=asked_for.seed, threads=threads, others=assignments)

    with (
        replace_files(folder, without=old_pictures(folder)) as beside,
        interruptible() as interrupted,
        bar(name, terminal) as shown,
        quiet(),
        neutral(scene, max_bounces=MOST_BOUNCES, threads=threads) as changes,
    ):
        shown.begin("rendering each setting")
        changes.set_all("cycles", [scene.cycles], NEUTRAL_BESIDES)
        found = audit(
            name,
            made(stays),
            [(setting, made(stays + values)) for setting, values in asked.values],
            asked_for.part(CompareOptions),
            samples,
            tuple(asked.same),
            tuple(asked.missing),
            Progress(shown.report, interrupted, shown.tell, shown.begin),
        )
        return Found(found.rounds, found.samples, found.stopped.value, write_audit(found, beside, repeat))
