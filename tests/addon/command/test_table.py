# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of commands.

Each row has a file with `run`, help for every option, and its part of docs/options.md.
"""

import ast
import importlib
import inspect
import re
from pathlib import Path

import pytest
from etalon.addon.command import cli
from etalon.addon.command.documentation import document
from etalon.addon.command.table import COMMANDS
from etalon.lib.exit_codes import ExitCode
from etalon.lib.verdict.outcome import Outcome

ROOT = Path(__file__).resolve().parents[3]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_a_command_has_a_file_that_runs_on_its_settings(command):
    module = importlib.import_module(f"etalon.addon.command.{command.name}")
    parameters = inspect.signature(module.run, eval_str=True).parameters.values()
    assert [parameter.annotation for parameter in parameters] == list(command.settings)


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_the_long_help_shows_every_option(command, capsys):
    has_more = any(declared.advanced for kind in command.settings for declared in kind.options())
    assert cli.main([command.name, "--help-all" if has_more else "--help"]) == 0
    shown = capsys.readouterr().out
    for kind in command.settings:
        for declared in kind.options():
            assert (declared.unit.metavar if declared.positional else f"--{declared.flag}") in shown


def test_the_page_of_commands_has_every_command_and_every_exit_code_of_a_comparison():
    rows = re.findall(r"^\| (.*?) \|", (ROOT / "docs" / "commands.md").read_text(), re.MULTILINE)
    named = {re.match(r"`(\w+)", part)[1] for row in rows if row.startswith("`") for part in row.split(", ")}
    assert named == {command.name for command in COMMANDS}
    assert [int(row) for row in rows if row.isdigit()] == sorted(
        {ExitCode.BAD_INPUT, *(ExitCode[outcome.name] for outcome in Outcome)}
    )


def test_the_documentation_is_what_the_declarations_say():
    path = ROOT / "docs" / "options.md"
    regenerate = "run `python -m etalon.addon.command.documentation > docs/options.md`"
    assert path.read_text(encoding="utf-8") == document(), regenerate


def test_exit_codes_of_verdicts_are_distinct_and_none_is_that_of_an_error():
    codes = [outcome.exit_code for outcome in Outcome]
    assert sorted(codes) == [0, 1, 3, 4]
    assert not {ExitCode.BAD_INPUT, ExitCode.INTERNAL_ERROR, ExitCode.INTERRUPTED} & set(codes)


def test_no_function_of_the_command_line_is_longer_than_60_lines():
    for path in (ROOT / "addon" / "command").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                assert node.end_lineno - node.lineno < 60, f"{path.name}: {node.name}"


def test_an_unknown_command_suggests_a_near_one(capsys):
    assert cli.main(["comapre"]) == ExitCode.BAD_INPUT
    assert "unknown command 'comapre'; did you mean 'compare'?" in capsys.readouterr().err
