# SPDX-License-Identifier: GPL-3.0-or-later
"""The terminal: Blender's own chatter kept out of it, one progress bar with the time left, Ctrl-C as a wish to end."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout

from tqdm import tqdm

_BAR = "{desc} {percentage:3.0f} %|{bar}| {elapsed} spent, {remaining} left"


def _flush_c_stdout() -> None:
    """Write out what C code has left in its buffer: Blender prints through C's stdout, not through Python's."""
    library = ctypes.cdll.ucrtbase if sys.platform == "win32" else ctypes.CDLL(None)
    library.fflush(None)


@contextmanager
def quiet() -> Iterator[None]:
    """Send what anybody writes to standard output to nowhere; Blender reports every step of a render there."""
    sys.stdout.flush()
    _flush_c_stdout()
    kept = os.dup(1)
    with open(os.devnull, "w", encoding="utf-8") as nowhere, redirect_stdout(nowhere):
        os.dup2(nowhere.fileno(), 1)
        try:
            yield
        finally:
            _flush_c_stdout()
            os.dup2(kept, 1)
            os.close(kept)


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
