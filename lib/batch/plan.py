# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan of a batch: read from PLAN.toml, and checked as a whole before anything is rendered."""

from __future__ import annotations

import itertools
import json
import math
import tomllib
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import EtalonError, unknown
from ..settings.common import Target
from ..settings.comparison import Settings
from ..settings.declaration import Declared
from ..settings.words import read_table
from .asked import ask_plan

ENTRIES = ("out", "scenes", "options", "vary")
VARIED = ("path", "values", "name")
_HELP = "see `etalon batch --help`"


@dataclass(frozen=True)
class Variation:
    """One property and the values it takes; `name` is what tables call it."""

    name: str
    path: str
    values: tuple[Any, ...]


@dataclass(frozen=True)
class Unit:
    """One comparison: a scene, as the plan names it, and the values of all varied properties."""

    scene: str
    target: str
    assignments: tuple[tuple[Variation, Any], ...]

    def arguments(self) -> list[str]:
        """The part of the command line that makes this unit what it is."""
        return [self.target, *(_assignment(v, value) for v, value in self.assignments)]

    @property
    def label(self) -> str:
        """What the user calls it."""
        return " ".join([self.scene, *(f"{v.name}={value}" for v, value in self.assignments)])


def _assignment(variation: Variation, value: Any) -> str:
    """The word of a command line that sets a property to a value."""
    return f"--set={variation.path}={json.dumps(value)}"


@dataclass(frozen=True)
class BatchPlan:
    """What a PLAN.toml says."""

    out: Path
    scenes: tuple[str, ...]
    folder: Path
    options: tuple[str, ...]
    variations: tuple[Variation, ...]

    def target(self, scene: str) -> str:
        """What `etalon compare` calls a scene of the plan."""
        return str(self.folder / scene) if scene.endswith(".blend") else scene

    def units(self) -> Iterator[Unit]:
        """All combinations, scene by scene."""
        for scene in self.scenes:
            for values in itertools.product(*(v.values for v in self.variations)):
                yield Unit(scene, self.target(scene), tuple(zip(self.variations, values, strict=True)))

    def require_properties(self, scenes: Collection[str]) -> None:
        """Raise EtalonError for one of `scenes` that cannot be read, or in which a varied property cannot have one of its values."""
        if not self.variations:
            return
        flags = {flag for declared in Target.options() for flag in _flags(declared.flag)}
        options = [word for word in self.options if word.partition("=")[0] in flags]
        values = [_assignment(v, value) for v in self.variations for value in v.values]
        for scene in scenes:
            answer = ask_plan(self.target(scene), [*options, *values])
            if answer.found is None:
                raise EtalonError(f"{scene}: {answer.error.removeprefix(f'{scene}: ')}")

    def require_scenes(self, known: Collection[str]) -> None:
        """Raise EtalonError for a scene that is neither a reference scene, one of `known`, nor a file that is there."""
        for scene in self.scenes:
            if scene.endswith(".blend"):
                if not Path(self.target(scene)).is_file():
                    raise EtalonError(f"{self.target(scene)}: no such file; check 'scenes' of the plan")
            elif scene not in known:
                raise EtalonError(unknown("reference scene", scene, tuple(known)))


def read_plan(path: Path) -> BatchPlan:
    """Read a PLAN.toml; raise EtalonError naming the entry that is wrong."""
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise EtalonError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    except (ValueError, RecursionError) as error:
        raise EtalonError(f"{path}: is not TOML ({error}); {_HELP}") from error
    try:
        return _plan(path, data)
    except EtalonError as error:
        raise EtalonError(f"{path}: {error}") from error


def _plan(path: Path, data: dict[str, Any]) -> BatchPlan:
    for name in data.keys() - set(ENTRIES):
        raise EtalonError(unknown("entry", name, ENTRIES))
    scenes, out = data.get("scenes"), data.get("out", path.stem)
    if not isinstance(scenes, list) or not scenes or not all(isinstance(s, str) and s for s in scenes):
        raise EtalonError("'scenes' must be a list of names or .blend files")
    options, vary = data.get("options", {}), data.get("vary", [])
    if not isinstance(options, dict) or not isinstance(vary, list) or not isinstance(out, str):
        raise EtalonError(f"'out' is a text, 'options' a table, 'vary' a list of tables; {_HELP}")
    for text in (*scenes, out):
        if not text.isprintable() or text.startswith("-"):
            raise EtalonError(f"{text!r} is not the name of a scene or a folder; {_HELP}")
    folder = path.resolve().parent
    if (folder / out).resolve() == folder:
        raise EtalonError(f"'out' is the folder of the plan; name another one, such as {path.stem!r}")
    plan = BatchPlan(folder / out, tuple(scenes), folder, _options(options), tuple(map(_variation, vary)))
    _refuse_twice("scene", plan.scenes)
    _refuse_twice("name in [[vary]]", [v.name for v in plan.variations])
    _refuse_twice("path in [[vary]]", [v.path for v in plan.variations])
    return plan


def _refuse_twice(what: str, values: Collection[Any]) -> None:
    """Raise EtalonError for a value that stands twice in a list."""
    shown = [json.dumps(value) for value in values]
    for value in shown:
        if shown.count(value) > 1:
            raise EtalonError(f"the {what} {value} is listed twice; remove one")


def _options(table: dict[str, Any]) -> tuple[str, ...]:
    """The table [options] as words for `etalon compare`; --out is the batch's own."""
    if "out" in table:
        raise EtalonError("[options] cannot set 'out'; each comparison gets a folder below the plan's own 'out'")
    try:
        words = read_table((Target, Settings), table)
        for kind in (Target, Settings):
            _read_words(kind, words)
    except EtalonError as error:
        raise EtalonError(f"[options]: {error}") from None
    return words


def _read_words(kind: type[Declared], words: tuple[str, ...]) -> None:
    """Make the settings that `words` give, as `etalon compare` will; raises EtalonError where they do not fit together."""
    values: dict[str, Any] = {}
    for declared in kind.options():
        unit = declared.unit
        given = [word.partition("=") for word in words if word.partition("=")[0] in _flags(declared.flag)]
        for flag, equals, text in given:
            if not equals:
                values[declared.name] = flag == f"--{declared.flag}"
                continue
            try:
                value = unit.read(text)
            except ValueError as error:
                raise EtalonError(f"{declared.flag}: {error}") from None
            values[declared.name] = [*values.get(declared.name, ()), value] if unit.repeats else value
    kind(**values)


def _flags(flag: str) -> tuple[str, str]:
    return f"--{flag}", f"--no-{flag}"


def _variation(entry: Any) -> Variation:
    """One [[vary]] table."""
    if (
        not isinstance(entry, dict)
        or not isinstance(entry.get("path"), str)
        or not isinstance(entry.get("values"), list)
        or not isinstance(entry.get("name", ""), str)
    ):
        raise EtalonError(f"each [[vary]] needs a text 'path' and a list 'values', and may have a text 'name'; {_HELP}")
    for name in entry.keys() - set(VARIED):
        raise EtalonError(unknown("entry of [[vary]]", name, VARIED))
    path, values = entry["path"], entry["values"]
    if not values:
        raise EtalonError(f"'values' of {path} is empty; give at least one")
    for value in values:
        if not _is_value(value) and not (isinstance(value, list) and all(map(_is_value, value))):
            raise EtalonError(f"'values' of {path}: {value} is no number, text, true or false, nor a list of them")
    _refuse_twice(f"value of {path}", values)
    return Variation(entry.get("name", path), path, tuple(tuple(v) if isinstance(v, list) else v for v in values))


def _is_value(value: Any) -> bool:
    return isinstance(value, (bool, int, str)) or (isinstance(value, float) and math.isfinite(value))
