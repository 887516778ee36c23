# SPDX-License-Identifier: GPL-3.0-or-later
"""The progress of a piece of work, and whether its user wants it to end.

One object goes all the way down.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .errors import Cancelled


def _report_nothing(fraction: float) -> None:
    pass


def _never() -> bool:
    return False


def _tell_nobody(text: str) -> None:
    pass


def _show_nobody(found: Any) -> None:
    pass


class Progress:
    """Receives the progress and findings of the work, and says whether it is to end.

    `begin` takes the name of the stage that begins; `report` takes the share that is done, 0 to 1; `tell` takes what is known so far, in
    one line; `show` takes the same as an object of the work's own, such as compare.Interim; `is_cancelled` says whether the user wants the
    work to end. All may be called from any thread.

    >>> told = []
    >>> Progress(told.append).within(0.5, 1.0).report(0.5)
    >>> told
    [0.75]
    """

    def __init__(
        self,
        report: Callable[[float], None] = _report_nothing,
        is_cancelled: Callable[[], bool] = _never,
        tell: Callable[[str], None] = _tell_nobody,
        begin: Callable[[str], None] = _tell_nobody,
        show: Callable[[Any], None] = _show_nobody,
    ) -> None:
        self.report = report
        self.tell = tell
        self.begin = begin
        self.show = show
        self._is_cancelled = is_cancelled

    @property
    def is_cancelled(self) -> bool:
        """Whether the user wants the work to end."""
        return self._is_cancelled()

    def check(self) -> None:
        """Raise Cancelled if the work is to end."""
        if self._is_cancelled():
            raise Cancelled("cancelled before the image was finished; nothing of it is kept")

    def within(self, first: float, last: float) -> Progress:
        """The progress of a part of the work.

        The part takes the share from `first` to `last` of the whole.
        """

        def report(fraction: float) -> None:
            self.report(first + (last - first) * fraction)

        return Progress(report, self._is_cancelled, self.tell, self.begin, self.show)

    @property
    def silent(self) -> Progress:
        """A progress that says whether to end, and passes on no reports."""
        return Progress(is_cancelled=self._is_cancelled)


NO_PROGRESS = Progress()
"""Nobody is told, and nothing ends early."""
