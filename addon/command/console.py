# SPDX-License-Identifier: GPL-3.0-or-later
"""The terminal: a progress bar that shows the time left, and Ctrl-C as a request to finish early."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from tqdm import tqdm

_BAR = "{desc} {percentage:3.0f} %|{bar}| {elapsed} spent, {remaining} left"


class Bar:
    """A progress bar on standard error: `report` takes the fraction done, 0 to 1, `tell` what is known so far."""

    def __init__(self, description: str, shown: tqdm) -> None:
        self._description, self._shown = description, shown

    def report(self, fraction: float) -> None:
        """Move on to a fraction; never back."""
        self._shown.update(min(max(fraction, self._shown.n), 1.0) - self._shown.n)

    def tell(self, text: str) -> None:
        """Show a line of text beside the bar, or below one another where there is no terminal."""
        self._shown.set_description_str(f"{self._description}: {text}", refresh=sys.stderr.isatty())
        if not sys.stderr.isatty():
            print(f"{self._description}: {text}", file=sys.stderr, flush=True)


@contextmanager
def bar(description: str) -> Iterator[Bar]:
    """A progress bar that goes away at the end."""
    interval = 0.1 if sys.stderr.isatty() else 10.0
    with tqdm(
        total=1.0, desc=description, bar_format=_BAR, file=sys.stderr, leave=False, mininterval=interval
    ) as shown:
        yield Bar(description, shown)


@contextmanager
def ended_by_interrupt() -> Iterator[None]:
    """Let Ctrl-C end the process at once and without a word, where an exception would leave Blender half initialised."""
    if threading.current_thread() is not threading.main_thread():  # which alone receives signals
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        yield
    finally:
        _restore(before)


@contextmanager
def interruptible() -> Iterator[Callable[[], bool]]:
    """Take the first Ctrl-C as a wish to end soon; the second one ends at once. Yields the question "was it pressed?"."""
    pressed = False

    def on_interrupt(_signal: int, _frame: object) -> None:
        nonlocal pressed
        if pressed:
            raise KeyboardInterrupt
        pressed = True

    before = signal.signal(signal.SIGINT, on_interrupt)
    try:
        yield lambda: pressed
    finally:
        _restore(before)


def _restore(before: signal.Handlers | Callable | None) -> None:
    """Put a handler of Ctrl-C back; None stands for one that was not set from Python, such as Blender's own."""
    signal.signal(signal.SIGINT, signal.SIG_DFL if before is None else before)
