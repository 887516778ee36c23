# SPDX-License-Identifier: GPL-3.0-or-later
"""Options declared as the fields of a frozen class, and checked in one place.

    @dataclass(frozen=True, kw_only=True)
    class Example(Declared):
        time: float = option(120.0, Seconds(), "time budget")

The command line, the panel, the JSON for a second Blender, the [options] of a batch and docs/options.md are made from these fields.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import Any, Self, TypeVar, cast

from ..errors import EtalonError
from .units import Unit, UnknownName

_KEY = "etalon option"
T = TypeVar("T")
D = TypeVar("D", bound="Declared")


@dataclass(frozen=True)
class Panel:
    """How an option shows in Blender's panel.

    It has a label, and limits and a default where they are not the option's own. `low` and `high` limit what can be
    typed, `soft_high` what can be dragged to. All are in the option's own unit. `group` is the sub-panel that it
    stands in: 'target', 'model' or 'passes'.
    """

    label: str
    low: float | None = None
    high: float | None = None
    soft_high: float | None = None
    default: Any = None
    help: str = ""
    group: str = "target"


@dataclass(frozen=True)
class Option:
    """The declaration of one option.

    `name` is the class's field; `flag` is the name on the command line and in a batch. `help` completes "this option is the ...".
    `absent` says what happens where no value is given, in place of a default. `nullable` options take None although their default
    is something else. `positional` options have no flag. `advanced` options stand in the long help only.
    """

    unit: Unit
    help: str
    name: str = ""
    flag: str = ""
    default: Any = None
    required: bool = False
    absent: str = ""
    nullable: bool = False
    panel: Panel | None = None
    positional: bool = False
    advanced: bool = False

    @property
    def optional(self) -> bool:
        """Whether None is a value."""
        return self.nullable or (self.default is None and not self.required)

    def check(self, value: Any) -> Any:
        """`value` in the option's own type.

        Raises EtalonError, in one line that begins with the option's name.
        """
        if value is None and self.optional:
            return None
        try:
            return self.unit.check(value)
        except UnknownName as error:
            raise EtalonError(str(error)) from None
        except ValueError as error:
            raise EtalonError(f"{self.flag}: {error}") from None

    @property
    def shown_default(self) -> str:
        """The default as help texts show it, '' where there is none to show."""
        if self.absent or self.required or self.default is None or isinstance(self.default, (bool, tuple, frozenset)):
            return self.absent
        return self.unit.show(self.default)


def option(
    default: T,
    unit: Unit,
    help: str,
    *,
    flag: str = "",
    absent: str = "",
    nullable: bool = False,
    panel: Panel | None = None,
    positional: bool = False,
    advanced: bool = False,
    compute: Callable[[], T] | None = None,
) -> T:
    """Declare an option as the default of a dataclass field.

    `compute` finds a default that depends on the machine.
    """
    declared = Option(
        unit,
        help,
        flag=flag,
        default=default,
        absent=absent,
        nullable=nullable,
        panel=panel,
        positional=positional,
        advanced=advanced,
    )
    if compute is not None:
        return cast(T, field(default_factory=compute, metadata={_KEY: declared}))
    return cast(T, field(default=default, metadata={_KEY: declared}))


def required(unit: Unit, help: str, *, flag: str = "", positional: bool = False) -> Any:
    """Declare an option that must be given."""
    declared = Option(unit, help, flag=flag, required=True, positional=positional)
    return field(metadata={_KEY: declared})


def again(owner: type[Declared], name: str, **changes: Any) -> Any:
    """Declare the option `name` of `owner` again, with another help text or default."""
    found = next(f for f in fields(owner) if f.name == name)
    declared = replace(cast(Option, found.metadata[_KEY]), **changes)
    return field(default=declared.default, metadata={_KEY: declared})


@dataclass(frozen=True)
class Declared:
    """A frozen class whose fields are declared options.

    Every value is checked when an object is made. Raises EtalonError for a value out of range, in one line that names
    the option and the remedy.
    """

    def __post_init__(self) -> None:
        for declared in self.options():
            object.__setattr__(self, declared.name, declared.check(getattr(self, declared.name)))

    @classmethod
    def options(cls) -> tuple[Option, ...]:
        """The declared options, in order."""
        return tuple(
            replace(cast(Option, f.metadata[_KEY]), name=f.name, flag=f.metadata[_KEY].flag or f.name.replace("_", "-"))
            for f in fields(cls)
            if _KEY in f.metadata
        )

    @classmethod
    def groups(cls) -> dict[str, list[Option]]:
        """The options by the title of the class that declares them, as help texts show them.

        This class comes first, its bases after it.
        """
        found: dict[str, list[Option]] = {}
        for declared in cls.options():
            owner = next(c for c in reversed(cls.__mro__) if declared.name in vars(c).get("__annotations__", {}))
            found.setdefault(vars(owner).get("TITLE", ""), []).append(declared)
        return dict(reversed(found.items()))

    def part(self, kind: type[D]) -> D:
        """The same values as an object of `kind`, a class whose options are all among these."""
        return kind(**{f.name: getattr(self, f.name) for f in fields(kind)})

    def changed(self) -> dict[str, Any]:
        """The values that are not the defaults, by field name."""
        found = {}
        for f in fields(self):
            default = f.default if f.default_factory is MISSING else f.default_factory()
            if getattr(self, f.name) != default:
                found[f.name] = getattr(self, f.name)
        return found

    def to_json(self) -> dict[str, Any]:
        """The values in the types of JSON, by field name."""
        values = {declared: getattr(self, declared.name) for declared in self.options()}
        return {d.name: None if v is None else d.unit.plain(v) for d, v in values.items()}

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> Self:
        """The object whose `to_json` gave `values`; raises EtalonError as the class does."""
        return cls(**values)
