# SPDX-License-Identifier: GPL-3.0-or-later
"""The arguments of the command line, made from declared options."""

from __future__ import annotations

import argparse
import difflib
import textwrap
from collections.abc import Callable
from typing import Any, NoReturn

from ...lib.errors import unknown
from ...lib.exit_codes import ExitCode
from ...lib.settings.declaration import Declared, Option
from ...lib.settings.units import Flag, Pair, Unit
from .table import COMMANDS, HELP_WIDTH, Command


class Parser(argparse.ArgumentParser):
    """A parser whose error message is one line."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and where to read more, and end with exit code 2."""
        self.exit(ExitCode.BAD_INPUT, f"{self.prog}: {message.rstrip('.')}; see {self.prog} --help\n")


def _reader(unit: Unit) -> Callable[[str], Any]:
    """The unit's `read` for argparse, which shows the text of this error and of no other."""

    def read(text: str) -> Any:
        if text is argparse.SUPPRESS:  # argparse reads the default of a positional argument that is not given, too
            return text
        try:
            return unit.read(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None

    return read


def help_text(declared: Option) -> str:
    """The help of an option with its default at the end."""
    default = declared.shown_default
    return f"{declared.help} (default: {default})" if default else declared.help


def _add(group: argparse._ActionsContainer, declared: Option, everything: bool) -> None:
    """Add one option to a group.

    An argument that is not given leaves no trace, since defaults are the settings' own.
    """
    unit, is_shown = declared.unit, everything or not declared.advanced
    text = help_text(declared).replace("%", "%%") if is_shown else argparse.SUPPRESS
    about: dict[str, Any] = {"default": argparse.SUPPRESS, "help": text}
    if declared.positional:
        nargs = ("+" if unit.repeats else None) if declared.required else "?"
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


def add_settings(parser: argparse.ArgumentParser, kind: type[Declared], everything: bool = True) -> None:
    """Add every option of a settings class, under the title of the class that declares it.

    Help shows the common ones, or `everything`.
    """
    for title, options in kind.groups().items():
        group = parser.add_argument_group(title) if title else parser
        for declared in options:
            _add(group, declared, everything)


def make_parser(
    prog: str, description: str, epilog: str, version: str, everything: bool = False
) -> argparse.ArgumentParser:
    """The whole command line, whose help shows the common options, or `everything`."""
    top = Parser(
        prog=prog,
        usage=f"{prog} COMMAND [options]",
        description=description,
        epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    top.add_argument("--version", action="version", version=version)
    added = top.add_subparsers(dest="command", metavar="COMMAND", parser_class=Parser, prog=prog)
    for command in COMMANDS:
        _add_command(added, prog, command, everything)
    return top


def _add_command(added: argparse._SubParsersAction, prog: str, command: Command, everything: bool) -> None:
    options = [declared for kind in command.settings for declared in kind.options()]
    given = [declared.unit.metavar + "..." * declared.unit.repeats for declared in options if declared.positional]
    given += [f"--{declared.flag} {declared.unit.metavar}" for declared in options if _is_needed_flag(declared)]
    has_more = any(declared.advanced for declared in options)
    more = f"\n\nmore options: {prog} {command.name} --help-all" if has_more and not everything else ""
    parser = added.add_parser(
        command.name,
        usage=" ".join([prog, command.name, *given, "[options]"]),
        help=command.help,
        description=command.description or command.help[0].upper() + command.help[1:] + ".",
        epilog=f"{_filled(command.epilog)}{more}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    if has_more:
        parser.add_argument("--help-all", action="help", help="show all options and exit")
    for kind in command.settings:
        add_settings(parser, kind, everything)


def _is_needed_flag(declared: Option) -> bool:
    return declared.required and not declared.positional


def _filled(text: str) -> str:
    """A paragraph broken into lines of a terminal."""
    return textwrap.fill(text, HELP_WIDTH)


def check_words(top: argparse.ArgumentParser, words: list[str]) -> None:
    """End with one line where a word names no command or no option of its command.

    The line suggests the nearest name.
    """
    name = next((word for word in words if not word.startswith("-")), None)
    names = [command.name for command in COMMANDS]
    if name is None:
        return
    if name not in names:
        top.error(unknown("command", name, names))
    parser = command_parsers(top)[name]
    for word in words[words.index(name) + 1 :]:
        flag = word.partition("=")[0]
        if word == "--":
            return
        if _is_option(flag) and flag not in parser._option_string_actions:
            parser.error(f"unknown option '{flag}'{_suggestion(flag, parser)}")


def read_words(top: argparse.ArgumentParser, words: list[str]) -> argparse.Namespace:
    """Read the arguments that the words give.

    Ends with one line where they give no command, or a word too many.
    """
    arguments, left = top.parse_known_args(words)
    if arguments.command is None:
        top.error("name a command")
    if left:
        command_parsers(top)[arguments.command].error(f"unexpected '{left[0]}'; quote a name that has spaces")
    return arguments


def command_parsers(top: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """The parser of each command, by its name."""
    (commands,) = (action for action in top._actions if isinstance(action, argparse._SubParsersAction))
    return commands.choices


def _is_option(word: str) -> bool:
    """Whether a word can only be an option: a negative number and a lone dash are values."""
    return word.startswith("-") and len(word) > 1 and not word[1].isdigit() and word[1] != "."


def _suggestion(flag: str, parser: argparse.ArgumentParser) -> str:
    known = [option for option in parser._option_string_actions if option.startswith("--")]
    begun = [option for option in known if option.startswith(f"--{flag.lstrip('-')}")]
    near = begun or difflib.get_close_matches(f"--{flag.lstrip('-')}", known, n=1)
    return f"; did you mean '{near[0]}'?" if near else ""


def read_arguments(command: Command, arguments: argparse.Namespace) -> tuple[Declared, ...]:
    """The settings that the arguments give; raises EtalonError where they do not fit together."""
    given = vars(arguments)
    return tuple(
        kind(**{declared.name: given[declared.name] for declared in kind.options() if declared.name in given})
        for kind in command.settings
    )
