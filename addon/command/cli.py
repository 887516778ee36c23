# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line.

It is `etalon`, `python -m etalon`, and `blender FILE.blend --command etalon`.
"""

from __future__ import annotations

import argparse
import importlib
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress

from ...lib.errors import EtalonError, Refused
from ...lib.exit_codes import RESULTS, ExitCode
from ...lib.plain_text import one_line
from ...lib.refusals import describe_refusals
from ...lib.settings.common import Target
from ...lib.version import VERSION
from ...lib.wavefront.tuning import tune_process
from ..host.libraries import explain_import
from ..host.own_process import Orders, gather_temporary_files, is_ahead, is_fork_server, watch_leash
from .arguments import check_words, make_parser, read_arguments, read_words
from .scene_choice import require_scene
from .streams import dependable_streams
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


def parser(everything: bool = False) -> argparse.ArgumentParser:
    """The whole command line, whose help shows the common options, or `everything`."""
    return make_parser("etalon", DESCRIPTION, f"{EXAMPLES}\n\n{VERDICTS}", f"etalon {VERSION}", everything)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    Every error that a user can cause is one line on standard error.
    """
    words = list(sys.argv[1:] if argv is None else argv)
    if is_fork_server():
        from ..host.fork_server import fork_as_asked

        fork_as_asked()
    return _serve(words[0]) if is_ahead() else _answer(words)


def _answer(words: list[str]) -> int:
    with dependable_streams() as output:
        code = _main(words)
        output.flush()
        if output.error is not None and not isinstance(output.error, BrokenPipeError):
            return _fail(f"standard output cannot be written ({output.error.strerror}); make room or write elsewhere")
        return code


def _serve(name: str) -> int:
    """Load Blender and a command, then run it for each line of words that comes.

    What fails to load fails again, and is reported, when the command runs. Only a command that has given its result is
    followed by another one: any other end is the end of the process, with that exit code.
    """
    from ..host.blender import load_blender

    with suppress(EtalonError, ImportError, OSError):
        gather_temporary_files()
        load_blender()
        importlib.import_module(f".{name}", __package__)
    orders = Orders()
    while True:
        code = _answer([name, *orders.receive()])
        if code not in RESULTS or not orders.answer(code):
            return code


def _fail(message: str) -> int:
    """Say in one line what went wrong; returns the exit code."""
    print(f"etalon: {one_line(message)}", file=sys.stderr)
    return ExitCode.BAD_INPUT


def _main(words: list[str]) -> int:
    top = parser(everything="--help-all" in words)
    if not words:
        top.print_help()
        return ExitCode.BAD_INPUT
    try:
        check_words(top, words)
        arguments = read_words(top, words)
    except SystemExit as end:
        return int(end.code or 0)
    try:
        from .console import interrupted_by_order

        with interrupted_by_order():
            return _run(arguments)
    except Refused as refused:
        for line in describe_refusals(refused):
            _fail(line)
        return ExitCode.BAD_INPUT
    except EtalonError as error:
        return _fail(str(error))
    except OSError as error:
        return _fail(
            f"{error.filename or 'file'}: {error.strerror or error}; check the path, its permissions and the disk"
        )
    except MemoryError:
        return _fail("out of memory; lower the resolution or simplify the scene")
    except KeyboardInterrupt:
        print("etalon: interrupted", file=sys.stderr)
        return ExitCode.INTERRUPTED
    except Exception as error:
        missing = explain_import(error) if isinstance(error, ImportError) else ""
        if missing:
            return _fail(missing)
        # Python would end with 1, which is a verdict.
        traceback.print_exc()
        print("etalon: this is an error in etalon itself; please report it with the text above", file=sys.stderr)
        return ExitCode.INTERNAL_ERROR


def _run(arguments: argparse.Namespace) -> int:
    """Import the command's file, which may import Blender, and run it."""
    command = next(command for command in COMMANDS if command.name == arguments.command)
    settings = read_arguments(command, arguments)
    for target in settings:
        if isinstance(target, Target):
            require_scene(command.name, target)
    from .console import ended_by_interrupt

    watch_leash()
    gather_temporary_files()
    with ended_by_interrupt():
        if command.blender:
            from ..host.blender import load_blender

            load_blender()
            from ..host.blender_at_hand import require_supported_blender

            require_supported_blender()
        module = importlib.import_module(f".{command.name}", __package__)
    tune_process()
    return int(module.run(*settings))
