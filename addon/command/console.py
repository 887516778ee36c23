# SPDX-License-Identifier: GPL-3.0-or-later
"""The terminal: a progress bar that shows the time left, and Ctrl-C as a request to finish early."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

from tqdm import tqdm

from ...lib.plain_text import one_line

_BAR = "{desc} {percentage:3.0f} %|{bar}| {elapsed} spent, {remaining} left"


class Bar:
    """A progress bar on standard error: `report` takes the fraction done, 0 to 1, `tell` what is known so far."""

    def __init__(self, description: str, shown: tqdm) -> None:
        self._description, self._shown = one_line(description), shown

    def report(self, fraction: float) -> None:
        """Move on to a fraction; never back."""
        self._shown.update(min(max(fraction, self._shown.n), 1.0) - self._shown.n)

    def tell(self, text: str) -> None:
        """Show a line of text beside the bar, or below one another where there is no terminal."""
        text = one_line(text)
        self._shown.set_description_str(f"{self._description}: {text}", refresh=sys.stderr.isatty())
        if not sys.stderr.isatty():
            print(f"{self._description}: {text}", file=sys.stderr, flush=True)


@contextmanager
def bar(description: str) -> Iterator[Bar]:
    """A progress bar that goes away at the end."""
    interval = 0.1 if sys.stderr.isatty() else 10.0
    with tqdm(
        total=1.0, desc=one_line(description), bar_format=_BAR, file=sys.stderr, leave=False, mininterval=interval
    ) as shown:
        yield Bar(description, shown)


@contextmanager
def ended_by_interrupt() -> Iterator[None]:
    """Let Ctrl-C end the process at once and without a word, where an exception would leave Blender half initialised."""
    with _handled((signal.SIGINT, *_orders()), signal.SIG_DFL):
        yield


@contextmanager
def interrupted_by_order() -> Iterator[None]:
    """Have an order to end (SIGTERM, a closed terminal) raise KeyboardInterrupt, as Ctrl-C does; the first one counts.

    `timeout` sends it twice, and a second exception would end the clearing up.
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
    """Take Ctrl-C, and an order to end, as a wish to end soon; Ctrl-C once more ends at once. Yields the question "is it wished?"."""
    wished = False

    def on_wish(number: int, _frame: object) -> None:
        nonlocal wished
        if wished and number == signal.SIGINT:
            raise KeyboardInterrupt
        wished = True

    with _handled((signal.SIGINT, *_orders()), on_wish):
        yield lambda: wished


def _orders() -> list[signal.Signals]:
    """The signals that systems send to have a process end, less those that it was started to ignore, as by nohup."""
    there = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name)]
    return [number for number in there if signal.getsignal(number) is not signal.SIG_IGN]


@contextmanager
def _handled(numbers: Iterable[signal.Signals], handler: Callable | signal.Handlers) -> Iterator[None]:
    """Handle signals so; only the main thread receives any. Those not handled from Python before get their default back."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, handler) for number in numbers}
    try:
        yield
    finally:
        for number, previous in before.items():
            signal.signal(number, signal.SIG_DFL if previous is None else previous)
