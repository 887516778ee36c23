# SPDX-License-Identifier: GPL-3.0-or-later
"""The arguments of the command line, made from declared options."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any, NoReturn

from ...lib.errors import unknown
from ...lib.exit_codes import ExitCode
from ...lib.settings.declaration import Declared, Option
from ...lib.settings.units import Flag, Pair, Unit
from .table import COMMANDS, Command


class Parser(argparse.ArgumentParser):
    """A parser whose error message is one line."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and where to read more, and end with exit code 2."""
        self.exit(ExitCode.BAD_INPUT, f"{self.prog}: {message}; see {self.prog} --help\n")


def _reader(unit: Unit) -> Callable[[str], Any]:
    """The unit's `read` for argparse, which shows the text of this error and of no other."""

    def read(text: str) -> Any:
        try:
            return unit.read(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None

    return read


def help_text(declared: Option) -> str:
    """The help of an option with its default at the end."""
    default = declared.shown_default
    return f"{declared.help} (default: {default})" if default else declared.help


def _add(group: argparse._ActionsContainer, declared: Option) -> None:
    """Add one option; an argument that is not given leaves no trace, since defaults are the settings' own."""
    unit = declared.unit
    about: dict[str, Any] = {"default": argparse.SUPPRESS, "help": help_text(declared).replace("%", "%%")}
    if declared.positional:
        nargs = None if declared.required else "?"
        group.add_argument(declared.name, nargs=nargs, metavar=unit.metavar, type=_reader(unit), **about)
        return
    about["dest"] = declared.name
    if declared.required:
        about["required"] = True
    if isinstance(unit, Flag):
        about["action"] = argparse.BooleanOptionalAction if declared.default else "store_true"
    elif isinstance(unit, Pair):
        about |= {"nargs": 2, "metavar": tuple(unit.metavar.split())}
    else:
        about |= {"action": "append" if unit.repeats else "store", "metavar": unit.metavar, "type": _reader(unit)}
    group.add_argument(f"--{declared.flag}", **about)


def add_settings(parser: argparse.ArgumentParser, kind: type[Declared]) -> None:
    """Add every option of a settings class, under the title of the class that declares it."""
    for title, options in kind.groups().items():
        group = parser.add_argument_group(title) if title else parser
        for declared in options:
            _add(group, declared)


def make_parser(prog: str, description: str, epilog: str, version: str) -> argparse.ArgumentParser:
    """The whole command line."""
    top = Parser(
        prog=prog, description=description, epilog=epilog, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    top.add_argument("--version", action="version", version=version)
    added = top.add_subparsers(dest="command", metavar="COMMAND", required=True, parser_class=Parser)
    for command in COMMANDS:
        parser = added.add_parser(
            command.name,
            help=command.help,
            description=command.description or command.help[0].upper() + command.help[1:] + ".",
            epilog=command.epilog,
            formatter_class=argparse.RawDescriptionHelpFormatter
            if "\n" in command.description
            else argparse.HelpFormatter,
        )
        for kind in command.settings:
            add_settings(parser, kind)
    return top


def find_command(top: argparse.ArgumentParser, words: list[str]) -> None:
    """End with one line where the first word that is not an option is the name of no command."""
    name = next((word for word in words if not word.startswith("-")), None)
    names = [command.name for command in COMMANDS]
    if name is not None and name not in names:
        top.error(unknown("command", name, names))


def read_arguments(command: Command, arguments: argparse.Namespace) -> tuple[Declared, ...]:
    """The settings that the arguments give; raises EtalonError where they do not fit together."""
    given = vars(arguments)
    return tuple(
        kind(**{declared.name: given[declared.name] for declared in kind.options() if declared.name in given})
        for kind in command.settings
    )
