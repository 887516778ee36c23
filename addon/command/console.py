# SPDX-License-Identifier: GPL-3.0-or-later
"""The terminal: progress, results, colours and Ctrl-C.

Progress goes to standard error, results to standard output. Ctrl-C asks to finish early.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import time
import webbrowser
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

from tqdm import tqdm

from ...lib.files.plain_data import make_plain
from ...lib.plain_text import one_line
from ...lib.settings.common import Terminal
from ..host.own_process import leave

_BAR = "{desc} {percentage:3.0f} %|{bar}| {elapsed} spent, {remaining} left"
_STAGE = "{desc} ..."
# Where standard error is no terminal, the share that is done is printed once in so many seconds.
_LINE_SECONDS = 30.0
_COLOURS = {"bold": "1", "dim": "2", "EQUIVALENT": "32", "DIFFERENT": "31", "UNDECIDED": "33", "EXPLAINED": "36"}


class Bar:
    """Progress on a terminal.

    It shows the stage by its name, a bar while the share that is done is known, and what is known so far.
    """

    def __init__(self, description: str, shown: tqdm) -> None:
        self._description, self._shown = one_line(description), shown
        self._stage, self._known = "", ""

    def begin(self, stage: str) -> None:
        """Show the name of a stage, without a bar until its progress is known."""
        self._stage = one_line(stage)
        self._draw(_STAGE)

    def report(self, fraction: float) -> None:
        """Move on to a fraction; never back. At 1 the bar goes: what has begun is still finished."""
        if fraction >= 1.0:
            self._draw(_STAGE)
            return
        if self._shown.bar_format != _BAR:
            self._draw(_BAR)
        self._shown.update(max(fraction - self._shown.n, 0.0))

    def tell(self, text: str) -> None:
        """Show what is known so far beside the stage."""
        self._known = one_line(text)
        self._draw(self._shown.bar_format)

    def _draw(self, form: str) -> None:
        said = ", ".join(filter(None, (self._stage, self._known)))
        self._shown.bar_format = form
        self._shown.set_description_str(f"{self._description}: {said}" if said else self._description)


class Lines:
    """Progress where standard error is no terminal.

    There is one plain line for each stage and each thing learned.
    """

    def __init__(self, description: str) -> None:
        self._description, self._stage = one_line(description), ""
        self._last = time.monotonic()

    def begin(self, stage: str) -> None:
        """Print the name of a stage."""
        if stage != self._stage:
            self._stage = stage
            self._print(stage)

    def report(self, fraction: float) -> None:
        """Print the share that is done, seldom."""
        if time.monotonic() - self._last >= _LINE_SECONDS:
            self._print(f"{self._stage or 'done'} {min(fraction, 1.0):.0%}")

    def tell(self, text: str) -> None:
        """Print what is known so far."""
        self._print(text)

    def _print(self, text: str) -> None:
        self._last = time.monotonic()
        print(f"{self._description}: {one_line(text)}", file=sys.stderr, flush=True)


class Silent:
    """Nobody is shown any progress."""

    def begin(self, stage: str) -> None:
        """Show nothing."""

    def report(self, fraction: float) -> None:
        """Show nothing."""

    def tell(self, text: str) -> None:
        """Show nothing."""


@contextmanager
def bar(description: str, terminal: Terminal) -> Iterator[Bar | Lines | Silent]:
    """The progress of a piece of work, on standard error; a bar goes away at the end."""
    if terminal.quiet:
        yield Silent()
    elif not sys.stderr.isatty():
        yield Lines(description)
    else:
        with tqdm(total=1.0, desc=one_line(description), bar_format=_STAGE, file=sys.stderr, leave=False) as shown:
            yield Bar(description, shown)


def has_colours(stream: TextIO) -> bool:
    """Whether a stream is a terminal that shows colours.

    The user must not have set NO_COLOR (no-color.org).
    """
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def paint(text: str, style: str) -> str:
    """`text` for standard output, in the style of that name where colours are shown."""
    return f"\x1b[{_COLOURS[style]}m{text}\x1b[0m" if has_colours(sys.stdout) else text


def print_json(figures: Any) -> None:
    """Print figures as JSON on standard output; numbers that are not finite are null."""
    print(json.dumps(make_plain(figures), indent=2, allow_nan=False))


def open_page(path: Path) -> None:
    """Open a page in the web browser, or say on standard error where it is."""
    if not webbrowser.open(path.resolve().as_uri()):
        print(f"etalon: no web browser was found; open {one_line(str(path))} yourself", file=sys.stderr)


@contextmanager
def ended_by_interrupt() -> Iterator[None]:
    """Let Ctrl-C, or an order to end, end the process at once and without a message.

    An exception would leave Blender half initialised.
    """
    with _handled((signal.SIGINT, *_orders()), lambda number, frame: leave()):
        yield


@contextmanager
def interrupted_by_order() -> Iterator[None]:
    """Have an order to end raise KeyboardInterrupt, as Ctrl-C does; the first one counts.

    Orders are SIGTERM and a closed terminal. `timeout` sends SIGTERM twice, and a second exception would end the
    clearing up.
    """
    ordered = False

    def on_order(_signal: int, _frame: object) -> None:
        nonlocal ordered
        if not ordered:
            ordered = True
            raise KeyboardInterrupt

    with _handled(_orders(), on_order):
        yield


@contextmanager
def interruptible() -> Iterator[Callable[[], bool]]:
    """Take Ctrl-C, and an order to end, as a wish to end soon.

    Ctrl-C once more ends at once. Yields a function that returns whether the wish was made.
    """
    wished = False

    def on_wish(number: int, _frame: object) -> None:
        nonlocal wished
        if wished and number == signal.SIGINT:
            raise KeyboardInterrupt
        wished = True

    with _handled((signal.SIGINT, *_orders()), on_wish):
        yield lambda: wished


def _orders() -> list[signal.Signals]:
    """The signals that systems send to have a process end.

    Those that the process was started to ignore, as by nohup, are left out.
    """
    there = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name)]
    return [number for number in there if signal.getsignal(number) is not signal.SIG_IGN]


@contextmanager
def _handled(numbers: Iterable[signal.Signals], handler: Callable | signal.Handlers) -> Iterator[None]:
    """Handle signals with `handler`.

    Only the main thread receives any. Those not handled from Python before get their default back.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, handler) for number in numbers}
    try:
        yield
    finally:
        for number, previous in before.items():
            signal.signal(number, signal.SIG_DFL if previous is None else previous)
