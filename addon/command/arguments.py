# SPDX-License-Identifier: GPL-3.0-or-later
"""What each command takes: the arguments behind `etalon COMMAND`, their kinds, and what the help says of them."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import NoReturn

from ...lib.wavefront.options import DIRECT, MASKING, SAMPLERS, STRATEGIES, Options

BAD_INPUT = 2
EXIT_CODES = "exit code: 0 EQUIVALENT, 1 DIFFERENT, 3 UNDECIDED, 4 EXPLAINED, 2 refused or bad input"

BATCH = """\
Compare every scene at every combination of property values. PLAN.toml:

  out = "sweep"                              # folder for the results, beside the plan
  scenes = ["glossy_spheres", "room.blend"]  # reference scenes and files, beside the plan

  [options]                                  # any long option of `etalon compare`
  tolerance = 0.01
  time = 60

  [[vary]]                                   # any number of these; all combinations are run
  path = 'materials["Floor"].node_tree.nodes["Glossy BSDF"].inputs["Roughness"].default_value'
  values = [0.1, 0.3, 0.5]
  name = "roughness"                         # optional: what tables call it

A path is a data path from bpy.data, or from the open scene where it begins with `scene.`. Each comparison runs in a
process of its own; one that crashes is recorded as failed and the rest go on. Finished ones are kept in
OUT/journal.sqlite, so that the same command, after Ctrl-C or a crash, runs only what is missing. OUT holds a folder for
each comparison, batch.csv and batch.html.

exit code: the worst of all comparisons: 0 all EQUIVALENT, 4 some EXPLAINED, 1 some DIFFERENT, 3 some UNDECIDED, 2 some refused or failed"""


class Parser(argparse.ArgumentParser):
    """A parser whose complaint is one line."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and where to read more, and end with exit code 2."""
        self.exit(BAD_INPUT, f"{self.prog}: {message}; see {self.prog} --help\n")


def fraction(text: str) -> float:
    """A number between 0 and 1, written as such or in per cent."""
    try:
        value = float(text[:-1]) / 100 if text.endswith("%") else float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number between 0 and 1, such as 0.01 or 1%")
    return value


def positive(text: str) -> float:
    """A finite number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number above 0")
    return value


def count(text: str) -> int:
    """A whole number of at least 1."""
    if not text.isascii() or not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number of at least 1")
    return int(text)


def _add_scene(parser: argparse.ArgumentParser, what: str) -> None:
    parser.add_argument("scene", nargs="?", metavar="SCENE", help=f"{what}; left out, the file that is open in Blender")
    parser.add_argument("--frame", type=int, help="frame to render (the file's current one)")
    parser.add_argument("--camera", metavar="NAME", help="camera object to render from (the file's active one)")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="PATH=VALUE",
        dest="assignments",
        help="set a property by its data path before rendering, value as in JSON; may be given again",
    )


def _add_model(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("the reference")
    group.add_argument("--masking", choices=MASKING, default=MASKING[0], help="masking-shadowing (%(default)s)")
    group.add_argument(
        "--strategy", choices=STRATEGIES, default=STRATEGIES[0], help="sampling of glossy lobes (%(default)s)"
    )
    group.add_argument(
        "--depart",
        action="append",
        default=[],
        metavar="NAME",
        help="have the reference err as Cycles does, by a departure that a report names; may be given again",
    )
    group.add_argument("--direct", choices=DIRECT, default=DIRECT[0], help="sampling of direct light (%(default)s)")
    group.add_argument("--sampler", choices=SAMPLERS, default=SAMPLERS[0], help="random numbers (%(default)s)")
    group.add_argument(
        "--russian-roulette",
        action=argparse.BooleanOptionalAction,
        default=Options.russian_roulette,
        help="end faint paths early; the mean stays as it is",
    )
    _add_run(group)


def _add_claims(group: argparse._ActionsContainer, confidence: str) -> None:
    group.add_argument(
        "--tolerance", type=fraction, default=0.01, help="relative difference that counts as equal (1%%)"
    )
    group.add_argument("--confidence", type=fraction, default=0.99, help=f"{confidence} (0.99)")
    group.add_argument("--time", type=positive, default=120.0, metavar="S", help="budget in seconds (%(default)g)")


def _add_run(group: argparse._ActionsContainer) -> None:
    group.add_argument("--seed", type=int, default=0, help="seed of all scramblings and of Cycles (%(default)s)")
    group.add_argument("--threads", type=count, default=os.cpu_count() or 1, metavar="N", help="threads (%(default)s)")


def _compare(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser("compare", help="render with both and give the verdict", epilog=EXIT_CODES)
    _add_scene(parser, "a reference scene (see `etalon scenes`) or a .blend file")
    group = parser.add_argument_group("the verdict")
    _add_claims(group, "of the whole verdict, all regions together")
    group.add_argument(
        "--samples", type=count, metavar="N", help="samples a pixel in each replicate (what the time allows)"
    )
    group.add_argument("--replicates", type=count, metavar="R", help="independent renders on each side (chosen)")
    group.add_argument(
        "--partial",
        action="store_true",
        help="with materials that are not simulated, compare the pixels that their light does not reach",
    )
    group.add_argument(
        "--out", type=Path, metavar="FOLDER", help="folder for report, verdict.json and images (etalon-out/SCENE)"
    )
    _add_model(parser)


def _render(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "render",
        help="write the reference alone",
        description="Channels of the EXR: radiance (R, G, B), its standard error (error.R ...) and the sample count (samples).",
    )
    _add_scene(parser, "a reference scene, a .blend file, or a scene saved as .npz")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.exr", help="the image to write")
    parser.add_argument(
        "--samples", type=count, default=64, metavar="N", help="samples a pixel in each replicate (%(default)s)"
    )
    parser.add_argument(
        "--replicates", type=count, default=8, metavar="R", help="independent scramblings (%(default)s)"
    )
    _add_model(parser)


def _cost(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "cost",
        help="measure what accuracy costs in time, or forecast it",
        description="Error against seconds for every way to sample the scene, for Cycles, and for Cycles' denoiser.",
    )
    _add_scene(parser, "a reference scene or a .blend file")
    parser.add_argument(
        "--time", type=positive, metavar="S", help="budget in seconds (300; 30 for the pilots of a forecast)"
    )
    parser.add_argument(
        "--target",
        type=fraction,
        metavar="ERROR",
        help="say how long each way takes to this relative RMSE, such as 1%%",
    )
    parser.add_argument(
        "--verify", action="store_true", help="then run the cheapest way and show what came beside the forecast"
    )
    parser.add_argument(
        "--ways", metavar="KEY,...", help="measure only these ways; their keys stand in cost.json (all)"
    )
    parser.add_argument(
        "--out", type=Path, metavar="FOLDER", help="folder for cost.html, .json, .csv and pictures (etalon-out/SCENE)"
    )
    _add_run(parser)


def _audit(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "audit",
        help="say what each Cycles setting of a file costs: bias, noise, seconds",
        description="Cycles against Cycles: the file's own settings, one at a time, against the least biased state.",
        epilog="exit code: 0 done, 2 bad input",
    )
    _add_scene(parser, "a reference scene or a .blend file")
    _add_claims(parser, "of all that is said of any bias, all settings and places together")
    parser.add_argument("--all", action="store_true", help="measure the values that Blender starts with, too")
    parser.add_argument(
        "--samples", type=count, metavar="N", help="samples a pixel in each render (what the time allows)"
    )
    parser.add_argument("--replicates", type=count, metavar="R", help="rounds of renders (what the time allows)")
    parser.add_argument(
        "--out", type=Path, metavar="FOLDER", help="folder for audit.html, audit.json and maps (etalon-out/SCENE)"
    )
    _add_run(parser)


def _others(commands: argparse._SubParsersAction) -> None:
    scenes = commands.add_parser("scenes", help="list the reference scenes, or save one as a .blend")
    scenes.add_argument("--save", nargs=2, metavar=("NAME", "FILE.blend"), help="build scene NAME and save it")
    plan = commands.add_parser("plan", help="say which effects a scene calls for, and why, without rendering")
    _add_scene(plan, "a reference scene or a .blend file")
    plan.add_argument("--json", action="store_true", help="print JSON")
    plan.add_argument("--save", type=Path, metavar="FILE.npz", help="save what the reference sees, for etalon render")
    batch = commands.add_parser(
        "batch",
        help="compare scenes over property values, resumably",
        description=BATCH,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    batch.add_argument("plan", type=Path, metavar="PLAN.toml", help="what to run")
    stability = commands.add_parser(
        "stability",
        help="measure the reference's own errors, and those of the same equations in float32",
        description="Every equation against 50 digits over its whole domain, identities, and scenes at the edge, one line a case.",
        epilog="exit code: 0 every bound held, 1 the reference broke one, 2 bad input",
    )
    stability.add_argument(
        "--points", type=count, default=200, metavar="N", help="places for each equation (%(default)s)"
    )
    stability.add_argument(
        "--no-scenes", action="store_true", help="leave out the scenes at the edge, which need Blender"
    )
    stability.add_argument(
        "--out",
        type=Path,
        default=Path("etalon-out/stability"),
        metavar="FOLDER",
        help="folder for stability.html and stability.json (%(default)s)",
    )


def add_commands(commands: argparse._SubParsersAction) -> None:
    """Add every command and its arguments."""
    for add in (_compare, _render, _cost, _audit, _others):
        add(commands)
