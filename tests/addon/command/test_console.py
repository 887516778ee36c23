# SPDX-License-Identifier: GPL-3.0-or-later
"""What the terminal shows.

These are progress with and without a terminal, colours, JSON, and the report in a browser.
"""

import io
import json
import math
import sys
from pathlib import Path

import pytest
from etalon.addon.command import console
from etalon.addon.command.console import bar, open_page, paint, print_json
from etalon.lib.settings.common import Terminal


class Screen(io.StringIO):
    """A stream that says that it is a terminal."""

    def isatty(self):
        return True


def work(shown):
    """What a comparison tells."""
    shown.begin("reading the scene")
    shown.begin("rendering")
    for k in range(11):
        shown.report(k / 10)
    shown.tell("within 3 % everywhere after 5 s")
    shown.begin("writing the report")


def test_without_a_terminal_progress_is_plain_lines(monkeypatch):
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    with bar("kitchen", Terminal()) as shown:
        work(shown)
    assert stream.getvalue().splitlines() == [
        "kitchen: reading the scene",
        "kitchen: rendering",
        "kitchen: within 3 % everywhere after 5 s",
        "kitchen: writing the report",
    ]
    assert "\r" not in stream.getvalue()


def test_on_a_terminal_no_bar_stands_at_100_percent(monkeypatch):
    stream = Screen()
    monkeypatch.setattr(sys, "stderr", stream)
    with bar("kitchen", Terminal()) as shown:
        work(shown)
    frames = [frame for frame in stream.getvalue().split("\r") if frame.strip()]
    assert any("kitchen: rendering" in frame and "%|" in frame for frame in frames)
    assert not any("100 %" in frame for frame in frames)
    last = [frame for frame in frames if "writing the report" in frame]
    assert last
    assert not any("%|" in frame for frame in last)


def test_quiet_shows_nothing(monkeypatch):
    stream = Screen()
    monkeypatch.setattr(sys, "stderr", stream)
    with bar("kitchen", Terminal(quiet=True)) as shown:
        work(shown)
    assert stream.getvalue() == ""


@pytest.mark.parametrize(
    ("stream", "variables", "coloured"),
    [
        (Screen(), {}, True),
        (Screen(), {"NO_COLOR": "1"}, False),
        (Screen(), {"TERM": "dumb"}, False),
        (io.StringIO(), {}, False),
    ],
)
def test_colours_are_for_terminals_whose_user_wants_them(monkeypatch, stream, variables, coloured):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys, "stdout", stream)
    assert (paint("DIFFERENT", "DIFFERENT") == "DIFFERENT") is not coloured


def test_json_has_no_number_that_is_not_finite(capsys):
    print_json({"a": math.inf, "path": Path("x")})
    assert json.loads(capsys.readouterr().out) == {"a": None, "path": "x"}


def test_a_page_is_opened_in_the_browser_or_named(monkeypatch, capsys, tmp_path):
    opened = []
    monkeypatch.setattr(console.webbrowser, "open", lambda url: opened.append(url) or True)
    open_page(tmp_path / "report.html")
    assert opened == [(tmp_path / "report.html").as_uri()]
    monkeypatch.setattr(console.webbrowser, "open", lambda url: False)
    open_page(tmp_path / "report.html")
    assert str(tmp_path / "report.html") in capsys.readouterr().err
