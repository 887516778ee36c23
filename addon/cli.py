# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: `etalon`, `python -m etalon`, and `blender FILE.blend --command etalon`."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from ..lib.errors import EtalonError, Refused
from ..lib.wavefront.options import DIRECT, MASKING, SAMPLERS, STRATEGIES, Options

EXIT_CODES = "exit code: 0 EQUIVALENT, 1 DIFFERENT, 3 UNDECIDED, 4 EXPLAINED, 2 refused or bad input"
BAD_INPUT = 2
INTERNAL_ERROR = 70
INTERRUPTED = 130

DESCRIPTION = """\
Render a Blender scene by the book, have Cycles render it too, and say where the two agree, to what tolerance and with
what confidence."""

EXAMPLES = """\
examples:
  etalon compare glossy_spheres              a reference scene, two minutes, a verdict and a folder with the report
  etalon compare kitchen.blend --time 600    any file, ten minutes
  etalon render cornell_glossy --out c.exr   the reference alone
  etalon cost glossy_spheres --target 1%     how long each way to render it takes to that error
  etalon plan kitchen.blend                  the effects the scene calls for, without rendering
  blender kitchen.blend --background --command etalon compare"""


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
    group.add_argument("--seed", type=int, default=0, help="seed of all scramblings and of Cycles (%(default)s)")
    group.add_argument("--threads", type=count, default=os.cpu_count() or 1, metavar="N", help="threads (%(default)s)")


def _compare(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser("compare", help="render with both and give the verdict", epilog=EXIT_CODES)
    _add_scene(parser, "a reference scene (see `etalon scenes`) or a .blend file")
    group = parser.add_argument_group("the verdict")
    group.add_argument(
        "--tolerance", type=fraction, default=0.01, help="relative difference that counts as equal (1%%)"
    )
    group.add_argument(
        "--confidence", type=fraction, default=0.99, help="of the whole verdict, all regions together (0.99)"
    )
    group.add_argument("--time", type=positive, default=120.0, metavar="S", help="budget in seconds (%(default)g)")
    group.add_argument(
        "--samples", type=count, metavar="N", help="samples a pixel in each replicate (what the time allows)"
    )
    group.add_argument("--replicates", type=count, metavar="R", help="independent renders on each side (chosen)")
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
    parser.add_argument("--seed", type=int, default=0, help="seed of all scramblings and of Cycles (%(default)s)")
    parser.add_argument("--threads", type=count, default=os.cpu_count() or 1, metavar="N", help="threads (%(default)s)")


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


def parser(prog: str = "etalon") -> argparse.ArgumentParser:
    """The whole command line."""
    from .. import __version__

    top = Parser(
        prog=prog,
        description=DESCRIPTION,
        epilog=f"{EXAMPLES}\n\n{EXIT_CODES}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"etalon {__version__}")
    commands = top.add_subparsers(dest="command", metavar="COMMAND", required=True, parser_class=Parser)
    _compare(commands)
    _render(commands)
    _cost(commands)
    _others(commands)
    return top


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; every error a user can meet is one line on standard error."""
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        arguments = parser().parse_args(words, argparse.Namespace(repeat=shlex.join(["etalon", *words])))
    except SystemExit as end:
        return int(end.code or 0)
    from .console import ended_by_interrupt

    with ended_by_interrupt():
        from . import commands
    try:
        return commands.COMMANDS[arguments.command](arguments)
    except Refused as refused:
        for refusal in refused.refusals:
            print(f"etalon: {refusal}", file=sys.stderr)
    except EtalonError as error:
        print(f"etalon: {error}", file=sys.stderr)
    except OSError as error:
        print(
            f"etalon: {error.filename or 'file'}: {error.strerror}; check the path, its permissions and the disk",
            file=sys.stderr,
        )
    except MemoryError:
        print("etalon: out of memory; lower the resolution or simplify the scene", file=sys.stderr)
    except KeyboardInterrupt:
        print("etalon: interrupted", file=sys.stderr)
        return INTERRUPTED
    except Exception:
        # Python would end with 1, which is a verdict.
        traceback.print_exc()
        print("etalon: this is an error in etalon itself; please report it with the text above", file=sys.stderr)
        return INTERNAL_ERROR
    return BAD_INPUT
