# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan of a batch, read from PLAN.toml.

It is checked as a whole before anything is rendered.
"""

from __future__ import annotations

import itertools
import json
import math
import re
import tomllib
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from ..errors import EtalonError, unknown
from ..settings.common import Target
from ..settings.comparison import ComparisonSettings
from ..settings.declaration import Declared, Option
from ..settings.units import Seconds
from ..settings.words import read_table

# The axes that have entries of their own, with the option of `etalon compare` that each one sets.
AXES = {"frames": "frame", "cameras": "camera", "view_layers": "view-layer"}
ENTRIES = ("out", "scenes", *AXES, "blenders", "per_process", "options", "vary", "limits")
VARIED = ("path", "values", "name")
LIMITED = ("time", "memory")
_FRAMES = re.compile(r"(-?\d+)-(-?\d+)(?::(\d+))?")
_MEMORY = re.compile(r"(\d+(?:\.\d*)?)\s*GB")
# Blender has no frames beyond this.
MOST_FRAME = 1048574
_HELP = "see `etalon batch --help`"
D = TypeVar("D", bound=Declared)


@dataclass(frozen=True)
class Variation:
    """One axis: a property, an option or the Blender, and the values it takes.

    `name` is what tables call it, `path` the data path of the property, the flag of the option, or '--blender'; `words` are what each value
    adds to the command line.
    """

    name: str
    path: str
    values: tuple[Any, ...]
    words: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Unit:
    """One comparison: a scene, as the plan names it, and the values of all axes.

    `words` are what these add to the command line.
    """

    scene: str
    target: str
    assignments: tuple[tuple[Variation, Any], ...]
    words: tuple[str, ...] = ()

    def arguments(self) -> list[str]:
        """The part of the command line that makes this unit what it is."""
        return [self.target, *self.words]

    @property
    def blender(self) -> str | None:
        """The Blender that it runs in, as the plan names it; None for the one at hand."""
        return next((value for v, value in self.assignments if v.path == BLENDER), None)

    @property
    def label(self) -> str:
        """What the user calls it."""
        return " ".join([self.scene, *(f"{v.name}={value}" for v, value in self.assignments)])


BLENDER = "--blender"
"""The path of the axis of Blenders."""


@dataclass(frozen=True)
class BatchPlan:
    """The content of a PLAN.toml.

    `time_limit` (seconds) and `memory_limit` (bytes) are those of one comparison, None without one. A process runs up to
    `per_process` comparisons.
    """

    out: Path
    scenes: tuple[str, ...]
    folder: Path
    options: tuple[str, ...]
    variations: tuple[Variation, ...]
    time_limit: float | None = None
    memory_limit: int | None = None
    per_process: int = 1

    def target(self, scene: str) -> str:
        """What `etalon compare` calls a scene of the plan."""
        return str(self.folder / scene) if scene.endswith(".blend") else scene

    def units(self) -> Iterator[Unit]:
        """All combinations, scene by scene."""
        for scene in self.scenes:
            for places in itertools.product(*(range(len(v.values)) for v in self.variations)):
                chosen = list(zip(self.variations, places, strict=True))
                words = tuple(word for v, k in chosen for word in v.words[k])
                yield Unit(scene, self.target(scene), tuple((v, v.values[k]) for v, k in chosen), words)

    @property
    def blenders(self) -> tuple[str, ...]:
        """The Blenders of the plan, as it names them; none for the one at hand."""
        return next((v.values for v in self.variations if v.path == BLENDER), ())

    @property
    def asked(self) -> list[str]:
        """The words that have `etalon plan` set every value of every property.

        They set one after the other.
        """
        flags = {flag for declared in Target.options() for flag in _flags(declared.flag)}
        options = [word for word in self.options if word.partition("=")[0] in flags]
        return [*options, *(word for v in self.variations if v.path[:2] != "--" for words in v.words for word in words)]

    def check_facts(self, scene: str, facts: dict[str, Any]) -> None:
        """Raise EtalonError where a scene lacks frames, cameras or view layers of the plan.

        `facts` are what `etalon plan` found.
        """
        for v in self.variations:
            if v.path == "--frame" and "frames" in facts:
                first, last = facts["frames"]
                for frame in v.values:
                    if not first <= frame <= last:
                        raise EtalonError(
                            f"{scene}: frame {frame} is outside its frames {first} to {last}; change 'frames' of the plan"
                        )
            for path, key in (("--camera", "cameras"), ("--view-layer", "view_layers")):
                for name in v.values if v.path == path and key in facts else ():
                    if name not in facts[key]:
                        raise EtalonError(
                            f"{scene}: {unknown(key[:-1].replace('_', ' '), name, facts[key] or ['none'])}"
                        )

    def require_scenes(self, known: Collection[str]) -> None:
        """Raise EtalonError for an unknown scene.

        A scene must be a reference scene, one of `known`, or a file that exists.
        """
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
    words, axes = _options(options)
    axes = [*_axes(data), *axes, *map(_variation, vary)]
    limits = _limits(data.get("limits", {}))
    share = _per_process(data.get("per_process", 1))
    plan = BatchPlan(folder / out, _find_scenes(folder, scenes), folder, words, tuple(axes), *limits, share)
    _refuse_twice("scene", plan.scenes)
    _refuse_twice("name in [[vary]]", [v.name for v in plan.variations])
    _refuse_twice("path in [[vary]]", [v.path for v in plan.variations])
    return plan


def _find_scenes(folder: Path, scenes: list[str]) -> tuple[str, ...]:
    """The scenes, with the files that patterns stand for.

    A file that several patterns or links lead to counts once.
    """
    found: list[str] = []
    seen: set[Path] = set()
    for text in scenes:
        if not re.search(r"[*?\[]", text):
            found.append(text)
            continue
        if Path(text).is_absolute():
            raise EtalonError(f"the pattern {text!r} is not relative; write it relative to the folder of the plan")
        files = [path for path in sorted(folder.glob(text)) if path.suffix == ".blend" and path.is_file()]
        if not files:
            raise EtalonError(f"no .blend file fits {text!r} in {folder}")
        for file in files:
            name = file.relative_to(folder).as_posix()
            if file.resolve() not in seen and name not in found:
                found.append(name)
            seen.add(file.resolve())
    return tuple(found)


def _axes(data: dict[str, Any]) -> Iterator[Variation]:
    """The axes that have entries of their own."""
    for entry, flag in AXES.items():
        if entry in data:
            values = _frames(data[entry]) if entry == "frames" else _texts(entry, data[entry])
            _refuse_twice(f"value of '{entry}'", values)
            yield Variation(flag, f"--{flag}", tuple(values), tuple(read_table((Target,), {flag: v}) for v in values))
    if "blenders" in data:
        values = _texts("blenders", data["blenders"])
        _refuse_twice("value of 'blenders'", values)
        yield Variation("blender", BLENDER, tuple(values), ((),) * len(values))


def _texts(entry: str, values: Any) -> list[str]:
    if not isinstance(values, list) or not values or not all(isinstance(v, str) and v for v in values):
        raise EtalonError(f"'{entry}' must be a list of texts that is not empty")
    return values


def _frames(values: Any) -> list[int]:
    """Frames from a list of numbers and of texts such as '1-100' or '1-100:10'."""
    if not isinstance(values, list) or not values:
        raise EtalonError("'frames' must be a list that is not empty, such as [1, 24] or [\"1-100:10\"]")
    found: list[int] = []
    for value in values:
        parts = _FRAMES.fullmatch(value) if isinstance(value, str) else None
        if parts:
            first, last, step = int(parts[1]), int(parts[2]), int(parts[3] or 1)
            if first > last or step == 0:
                raise EtalonError(f"'frames': {value!r} has no frame; write FIRST-LAST or FIRST-LAST:STEP")
        elif isinstance(value, int) and not isinstance(value, bool):
            first = last = value
            step = 1
        else:
            raise EtalonError(f"'frames': {value!r} is no frame; give numbers, or texts such as '1-100:10'")
        if max(abs(first), abs(last)) > MOST_FRAME:
            raise EtalonError(f"'frames': {value!r} is out of range; Blender has frames up to {MOST_FRAME}")
        found += range(first, last + 1, step)
    return found


def _limits(table: Any) -> tuple[float | None, int | None]:
    """Seconds and bytes that one comparison may take."""
    if not isinstance(table, dict):
        raise EtalonError(f"'limits' is a table; {_HELP}")
    for name in table.keys() - set(LIMITED):
        raise EtalonError(unknown("entry of [limits]", name, LIMITED))
    try:
        seconds = Seconds().check(table["time"]) if "time" in table else None
    except ValueError as error:
        raise EtalonError(f"[limits]: time: {error}") from None
    memory = table.get("memory")
    size = _MEMORY.fullmatch(memory) if isinstance(memory, str) else None
    if memory is not None and (size is None or float(size[1]) == 0.0):
        raise EtalonError(f"[limits]: memory: {memory!r} is not a size; write it as '8 GB'")
    return seconds, None if size is None else int(float(size[1]) * 1e9)


def _per_process(count: Any) -> int:
    if type(count) is not int or count < 1:
        raise EtalonError(f"'per_process': {count!r} is no number of comparisons; 1 gives each a process of its own")
    return count


def _refuse_twice(what: str, values: Collection[Any]) -> None:
    """Raise EtalonError for a value that stands twice in a list."""
    shown = [json.dumps(value) for value in values]
    for value in shown:
        if shown.count(value) > 1:
            raise EtalonError(f"the {what} {value} is listed twice; remove one")


def _options(table: dict[str, Any]) -> tuple[tuple[str, ...], list[Variation]]:
    """Read the table [options].

    It gives words for `etalon compare`, and an axis for each option that has a list of values. --out is the batch's
    own.
    """
    if "out" in table:
        raise EtalonError("[options] cannot set 'out'; each comparison gets a folder below the plan's own 'out'")
    known = {declared.flag: declared for kind in (Target, ComparisonSettings) for declared in kind.options()}
    single = {flag: value for flag, value in table.items() if not _is_axis(known.get(flag), value)}
    several = {flag: value for flag, value in table.items() if flag not in single}
    axes = []
    try:
        words = read_table((Target, ComparisonSettings), single)
        _check_words(words)
        for flag, values in several.items():
            if not values:
                raise EtalonError(f"the list of '{flag}' is empty; give at least one value")
            _refuse_twice(f"value of '{flag}'", values)
            of_values = tuple(read_table((Target, ComparisonSettings), {flag: value}) for value in values)
            for one in of_values:
                _check_words((*words, *one))
            shown = tuple(tuple(v) if isinstance(v, list) else v for v in values)
            axes.append(Variation(flag, f"--{flag}", shown, of_values))
    except EtalonError as error:
        raise EtalonError(f"[options]: {error}") from None
    return words, axes


def _is_axis(declared: Option | None, value: Any) -> bool:
    """Whether a value of [options] is a list of values, each for comparisons of its own."""
    if declared is None or not isinstance(value, list):
        return False
    return not declared.unit.repeats or (bool(value) and all(isinstance(one, list) for one in value))


def _check_words(words: tuple[str, ...]) -> None:
    for kind in (Target, ComparisonSettings):
        read_words(kind, words)


def read_words(kind: type[D], words: Sequence[str]) -> D:
    """The settings that `words` give, as for `etalon compare`.

    Raises EtalonError where they do not fit together.
    """
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
    return kind(**values)


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
    if path.startswith("-"):
        raise EtalonError(f"{path!r} is not a data path; an option is varied by a list in [options]")
    shown = tuple(tuple(v) if isinstance(v, list) else v for v in values)
    words = tuple((f"--set={path}={json.dumps(value)}",) for value in values)
    return Variation(entry.get("name", path), path, shown, words)


def _is_value(value: Any) -> bool:
    return isinstance(value, (bool, int, str)) or (isinstance(value, float) and math.isfinite(value))
