# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: `etalon`, `python -m etalon`, and `blender FILE.blend --command etalon`."""

from __future__ import annotations

import argparse
import importlib
import sys
import traceback
from collections.abc import Sequence

from ...lib.errors import EtalonError, Refused
from ...lib.exit_codes import ExitCode
from ...lib.refusals import describe_refusals
from ...lib.version import VERSION
from ...lib.wavefront.tuning import tune_process
from .arguments import find_command, make_parser, read_arguments
from .table import COMMANDS, VERDICTS

DESCRIPTION = """\
Render a Blender scene with an independent reference integrator and with Cycles, and say where the two agree, to what
tolerance and with what confidence."""

EXAMPLES = """\
examples:
  etalon compare glossy_spheres              a reference scene, two minutes, a verdict and a folder with the report
  etalon compare kitchen.blend --time 10m    any file, ten minutes
  etalon render cornell_glossy --out c.exr   the reference alone
  etalon cost glossy_spheres --target 1%     how long each sampling strategy takes to that error
  etalon audit kitchen.blend                 what each of its Cycles settings costs, in bias, noise and seconds
  etalon plan kitchen.blend                  the effects that the scene needs, without rendering
  blender kitchen.blend --background --command etalon compare"""


def parser(prog: str = "etalon") -> argparse.ArgumentParser:
    """The whole command line."""
    return make_parser(prog, DESCRIPTION, f"{EXAMPLES}\n\n{VERDICTS}", f"etalon {VERSION}")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; every error that a user can cause is one line on standard error."""
    words = list(sys.argv[1:] if argv is None else argv)
    top = parser()
    try:
        find_command(top, words)
        arguments = top.parse_args(words)
    except SystemExit as end:
        return int(end.code or 0)
    try:
        return _run(arguments)
    except Refused as refused:
        for line in describe_refusals(refused):
            print(f"etalon: {line}", file=sys.stderr)
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
        return ExitCode.INTERRUPTED
    except Exception:
        # Python would end with 1, which is a verdict.
        traceback.print_exc()
        print("etalon: this is an error in etalon itself; please report it with the text above", file=sys.stderr)
        return ExitCode.INTERNAL_ERROR
    return ExitCode.BAD_INPUT


def _run(arguments: argparse.Namespace) -> int:
    """Import the command's file, which may import Blender, and run it."""
    command = next(command for command in COMMANDS if command.name == arguments.command)
    settings = read_arguments(command, arguments)
    from .console import ended_by_interrupt

    with ended_by_interrupt():
        if command.blender:
            from ..host.blender import load_blender

            load_blender()
            from ..host.blender_at_hand import require_supported_blender

            require_supported_blender()
        module = importlib.import_module(f".{command.name}", __package__)
    tune_process()
    return int(module.run(*settings))
