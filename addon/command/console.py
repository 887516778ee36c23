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


@contextmanager
def bar(description: str) -> Iterator[Callable[[float], None]]:
    """A progress bar on standard error; yields the function that takes the fraction done, 0 to 1."""
    interval = 0.1 if sys.stderr.isatty() else 10.0
    with tqdm(
        total=1.0, desc=description, bar_format=_BAR, file=sys.stderr, leave=False, mininterval=interval
    ) as shown:

        def progress(fraction: float) -> None:
            shown.update(min(max(fraction, shown.n), 1.0) - shown.n)

        yield progress


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
