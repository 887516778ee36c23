# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: `etalon`, `python -m etalon`, and `blender FILE.blend --command etalon`."""

from __future__ import annotations

import argparse
import shlex
import sys
import traceback
from collections.abc import Sequence

from ...lib.errors import EtalonError, Refused
from .arguments import BAD_INPUT, EXIT_CODES, Parser, add_commands

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
  etalon audit kitchen.blend                 what each of its Cycles settings costs, in bias, noise and seconds
  etalon plan kitchen.blend                  the effects the scene calls for, without rendering
  blender kitchen.blend --background --command etalon compare"""


def parser(prog: str = "etalon") -> argparse.ArgumentParser:
    """The whole command line."""
    from ... import __version__

    top = Parser(
        prog=prog,
        description=DESCRIPTION,
        epilog=f"{EXAMPLES}\n\n{EXIT_CODES}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"etalon {__version__}")
    commands = top.add_subparsers(dest="command", metavar="COMMAND", required=True, parser_class=Parser)
    add_commands(commands)
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
        from ..blender_at_hand import require_supported_blender
        from . import commands
    try:
        require_supported_blender()
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
