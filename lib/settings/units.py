# SPDX-License-Identifier: GPL-3.0-or-later
"""Kinds of option values: how each one is read from text, checked, and written back.

Every problem is a ValueError whose text completes a sentence that begins with the option's name.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import unknown

_SECONDS = {"": 1.0, "s": 1.0, "min": 60.0, "m": 60.0, "h": 3600.0}
_DURATION = re.compile(r"(\d+(?:\.\d*)?|\.\d+)\s*(h|min|m|s|)\s*")


@dataclass(frozen=True)
class Unit:
    """A kind of value. This one is any text, taken as it is.

    `metavar` is what help texts call the value. `repeats` says that the option may be given several times.
    """

    metavar: str = "TEXT"
    repeats = False

    def read(self, text: str) -> Any:
        """The value that a person writes as `text`; raises ValueError."""
        return self.check(text)

    def check(self, value: Any) -> Any:
        """`value` in the type that the option has; raises ValueError where it cannot be one."""
        if not isinstance(value, str):
            raise ValueError(f"{value!r} is not a text")
        return value

    def write(self, value: Any) -> str:
        """The text that `read` turns into `value`."""
        return str(value)

    def show(self, value: Any) -> str:
        """The value as help texts show it."""
        return self.write(value)

    def plain(self, value: Any) -> Any:
        """`value` in the types of JSON, which `check` accepts."""
        return value


def _number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


@dataclass(frozen=True)
class Share(Unit):
    """A number from `low` to 1, as 0.01 or the text 1%; excluded are 1, and `low` if it is 0."""

    metavar: str = "SHARE"
    low: float = 0.0

    def read(self, text: str) -> float:
        """The share that `text` says, as a number or in per cent."""
        percent = text.strip().endswith("%")
        try:
            value = float(text.strip().rstrip("%")) / (100 if percent else 1)
        except ValueError:
            raise ValueError(f"'{text}' is not a number; {self._remedy()}") from None
        return self._inside(value, text)

    def check(self, value: Any) -> float:
        """A share, given as a number or as text."""
        if isinstance(value, str):
            return self.read(value)
        if not _number(value):
            raise ValueError(f"{value!r} is not a number; {self._remedy()}")
        return self._inside(float(value), str(value))

    def write(self, value: float) -> str:
        """The share as a number, with all digits that it needs."""
        return repr(float(value))

    def show(self, value: float) -> str:
        """The share in per cent."""
        return f"{100 * value:g}%"

    def _inside(self, value: float, shown: str) -> float:
        if not (self.low <= value < 1 and value > 0):
            raise ValueError(f"{shown} is out of range; {self._remedy()}")
        return value

    def _remedy(self) -> str:
        if self.low:
            return f"give at least {self.low:g} and less than 1, such as 0.99 or 99%"
        return "give more than 0 and less than 1, such as 0.01 or 1%"


@dataclass(frozen=True)
class Alpha(Share):
    """The alpha of a microfacet distribution, between 0 and 1, both excluded."""

    metavar: str = "ALPHA"

    def show(self, value: float) -> str:
        """Alpha as a number."""
        return f"{value:g}"


@dataclass(frozen=True)
class Seconds(Unit):
    """A time in seconds above 0, such as 90; as a text also 90s, 2m or 1h30m."""

    metavar: str = "TIME"

    def read(self, text: str) -> float:
        """Seconds in a text such as '90', '2m', '1.5 h' or '1h30m'."""
        parts = list(_DURATION.finditer(text.strip()))
        bare = len(parts) > 1 and any(not part[2] for part in parts)
        if not parts or bare or "".join(part[0] for part in parts) != text.strip():
            raise ValueError(f"'{text}' is not a time; {self._remedy()}")
        return self._positive(math.fsum(float(part[1]) * _SECONDS[part[2]] for part in parts), text)

    def check(self, value: Any) -> float:
        """Seconds, given as a number or as text."""
        if isinstance(value, str):
            return self.read(value)
        if not _number(value):
            raise ValueError(f"{value!r} is not a time; {self._remedy()}")
        return self._positive(float(value), f"{value} s")

    def write(self, value: float) -> str:
        """Seconds as a number without a unit."""
        return repr(int(value)) if value == int(value) else repr(float(value))

    def show(self, value: float) -> str:
        """The time as a person writes it, such as 90s or 2m."""
        return f"{value / 60:g}m" if value >= 60 and value % 60 == 0 else f"{value:g}s"

    def _positive(self, value: float, shown: str) -> float:
        if not 0 < value < math.inf:
            raise ValueError(f"{shown} is out of range; {self._remedy()}")
        return value

    def _remedy(self) -> str:
        return "give seconds above 0, or a text such as 90s, 2m or 1h30m"


@dataclass(frozen=True)
class Whole(Unit):
    """A whole number, of at least `least` where that is given."""

    metavar: str = "N"
    least: int | None = None

    def read(self, text: str) -> int:
        """The whole number that `text` says in decimal digits."""
        if re.fullmatch(r"[+-]?[0-9]+", text.strip()) is None:
            raise ValueError(f"'{text}' is not a whole number{self._remedy()}")
        return self.check(int(text))

    def check(self, value: Any) -> int:
        """A whole number, given as such or as text."""
        if isinstance(value, str):
            return self.read(value)
        if isinstance(value, bool) or not isinstance(value, int):
            raise ValueError(f"{value!r} is not a whole number{self._remedy()}")
        if self.least is not None and value < self.least:
            raise ValueError(f"{value} is out of range{self._remedy()}")
        return value

    def _remedy(self) -> str:
        return "" if self.least is None else f"; give at least {self.least}"


@dataclass(frozen=True)
class WholeOrPair(Unit):
    """A whole number, at least `least`; in a script also a pair: for the reference and Cycles."""

    metavar: str = "N"
    least: int | None = None

    def read(self, text: str) -> int:
        """The whole number that `text` says."""
        return Whole(least=self.least).read(text)

    def check(self, value: Any) -> int | tuple[int, int]:
        """A whole number or a pair."""
        whole = Whole(least=self.least)
        if not isinstance(value, (tuple, list)):
            return whole.check(value)
        if len(value) != 2:
            raise ValueError(f"{value!r} is not a pair; give one number, or one for each side")
        try:
            return whole.check(value[0]), whole.check(value[1])
        except ValueError as error:
            raise ValueError(f"{tuple(value)}: {error}") from None

    def plain(self, value: int | tuple[int, int]) -> int | list[int]:
        """A number, or a list of two."""
        return list(value) if isinstance(value, tuple) else value


@dataclass(frozen=True)
class WholeRange(Unit):
    """Whole numbers from one to another, at least 0, such as 0..4; or one number alone."""

    metavar: str = "FIRST..LAST"

    def read(self, text: str) -> tuple[int, int]:
        """The first and the last number in a text such as '0..4' or '2'."""
        first, dots, last = text.strip().partition("..")
        if re.fullmatch(r"[0-9]{1,4}", first) is None or (dots and re.fullmatch(r"[0-9]{1,4}", last) is None):
            raise ValueError(f"'{text}' is not a range; {self._remedy()}")
        return self._ordered(int(first), int(last or first))

    def check(self, value: Any) -> tuple[int, int]:
        """A pair of numbers, or text."""
        if isinstance(value, str):
            return self.read(value)
        if isinstance(value, int) and not isinstance(value, bool):
            value = value, value
        if not isinstance(value, (tuple, list)) or len(value) != 2 or not all(type(one) is int for one in value):
            raise ValueError(f"{value!r} is not a range; {self._remedy()}")
        return self._ordered(*value)

    def write(self, value: tuple[int, int]) -> str:
        """The range with two dots."""
        return f"{value[0]}..{value[1]}"

    def plain(self, value: tuple[int, int]) -> list[int]:
        """The two numbers as a list."""
        return list(value)

    def _ordered(self, first: int, last: int) -> tuple[int, int]:
        if not 0 <= first <= last:
            raise ValueError(f"{first}..{last} is out of range; {self._remedy()}")
        return first, last

    def _remedy(self) -> str:
        return "give the first and the last, such as 0..4"


@dataclass(frozen=True)
class Flag(Unit):
    """Yes or no."""

    metavar: str = ""

    def check(self, value: Any) -> bool:
        """A boolean."""
        if not isinstance(value, bool):
            raise ValueError(f"{value!r} is neither true nor false")
        return value


class UnknownName(ValueError):
    """An unknown name; its text is the whole sentence."""


@dataclass(frozen=True)
class Choice(Unit):
    """One of `names`, each of which is a `what`."""

    what: str = "value"
    names: tuple[str, ...] = ()

    def check(self, value: Any) -> str:
        """One of the names, exactly."""
        if value not in self.names:
            raise UnknownName(unknown(self.what, str(value), self.names))
        return value


@dataclass(frozen=True)
class Names(Unit):
    """A set of names; the option is repeated for each. `known` looks up the valid names."""

    metavar: str = "NAME"
    what: str = "name"
    known: Callable[[], Collection[str]] = tuple
    repeats = True

    def read(self, text: str) -> str:
        """One name, which is looked up when all are there."""
        return text

    def check(self, value: Any) -> frozenset[str]:
        """A set of known names, from any collection."""
        if isinstance(value, str) or not isinstance(value, Collection) or not all(isinstance(n, str) for n in value):
            raise ValueError(f"{value!r} is not a list of names")
        for name in sorted(value):
            if name not in self.known():
                raise UnknownName(unknown(self.what, name, sorted(self.known())))
        return frozenset(value)

    def plain(self, value: frozenset[str]) -> list[str]:
        """The names in order."""
        return sorted(value)


@dataclass(frozen=True)
class Texts(Unit):
    """Texts in order; the option is repeated for each."""

    repeats = True

    def read(self, text: str) -> str:
        """One text as it is."""
        return text

    def check(self, value: Any) -> tuple[str, ...]:
        """A tuple of texts, from a tuple or a list."""
        if not isinstance(value, (tuple, list)) or not all(isinstance(one, str) for one in value):
            raise ValueError(f"{value!r} is not a list of texts")
        return tuple(value)

    def plain(self, value: tuple[str, ...]) -> list[str]:
        """The texts as a list."""
        return list(value)


@dataclass(frozen=True)
class Keys(Unit):
    """Names in one text, separated by commas."""

    metavar: str = "KEY,..."

    def read(self, text: str) -> tuple[str, ...]:
        """The names between the commas."""
        return self.check([key.strip() for key in text.split(",")])

    def check(self, value: Any) -> tuple[str, ...]:
        """A tuple of names, from a tuple, a list or one text."""
        if isinstance(value, str):
            return self.read(value)
        if not isinstance(value, (tuple, list)) or not all(isinstance(one, str) and one for one in value):
            raise ValueError(f"{value!r} is not a list of keys; separate them by commas")
        return tuple(value)

    def write(self, value: tuple[str, ...]) -> str:
        """The names with commas between them."""
        return ",".join(value)

    def plain(self, value: tuple[str, ...]) -> list[str]:
        """The names as a list."""
        return list(value)


@dataclass(frozen=True)
class FilePath(Unit):
    """A file or folder."""

    metavar: str = "FILE"

    def check(self, value: Any) -> Path:
        """A path, from a path or a text."""
        if not isinstance(value, (str, Path)) or not str(value):
            raise ValueError(f"{value!r} is not a path")
        return Path(value)

    def plain(self, value: Path) -> str:
        """The path as text."""
        return str(value)


@dataclass(frozen=True)
class Pair(Unit):
    """Two texts, called by the two words of `metavar`."""

    def check(self, value: Any) -> tuple[str, str]:
        """A pair of texts."""
        if not isinstance(value, (tuple, list)) or len(value) != 2 or not all(isinstance(one, str) for one in value):
            raise ValueError(f"{value!r} is not a pair of texts; give {self.metavar}")
        return value[0], value[1]

    def plain(self, value: tuple[str, str]) -> list[str]:
        """The texts as a list."""
        return list(value)


@dataclass(frozen=True)
class Pixel(Pair):
    """A column and a row, each a whole number of at least 0."""

    def check(self, value: Any) -> tuple[int, int]:
        """Two whole numbers, given as such or as texts."""
        if not isinstance(value, (tuple, list)) or len(value) != 2:
            raise ValueError(f"{value!r} is not a pixel; give {self.metavar}")
        whole = Whole(least=0)
        return whole.check(value[0]), whole.check(value[1])

    def plain(self, value: tuple[int, int]) -> list[int]:
        """The two numbers as a list."""
        return list(value)
