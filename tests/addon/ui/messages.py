# SPDX-License-Identifier: GPL-3.0-or-later
"""The messages that the sources can make, read from their syntax.

They are whole errors, what refusals name, and what they advise. A value that is only known at run time is {} in a template.
"""

import ast
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import etalon

ROOT = Path(etalon.__file__).parent
# What a panel never runs: other commands of the command line, other strategies, and reading their files.
ELSEWHERE = (
    *("addon/command", "addon/probe.py", "addon/versions.py", "addon/ui", "addon/host/blender.py"),
    *("lib/batch", "lib/cluster", "lib/fit", "lib/lecture", "lib/measured", "lib/microsurface", "lib/stability"),
    *("lib/versions", "lib/probe", "lib/photon_mapping", "lib/metropolis", "lib/light_tracing", "lib/rendering"),
    *("lib/report/read.py", "lib/report/browser.py", "lib/settings/commands.py", "lib/settings/versions.py"),
)
ERRORS = {"EtalonError", "SceneError", "Cancelled", "BlenderEnded"}


def sources() -> Iterator[Path]:
    """The files whose messages a user of the panel can meet."""
    for path in sorted((*ROOT.glob("addon/**/*.py"), *ROOT.glob("lib/**/*.py"))):
        if not path.relative_to(ROOT).as_posix().startswith(ELSEWHERE):
            yield path


class Module:
    """One file.

    Names stand for all that is assigned to them, and functions for all that they return.
    """

    def __init__(self, path: Path) -> None:
        self.tree = ast.parse(path.read_text(encoding="utf-8"))
        self.assigned: dict[str, list[ast.expr]] = {}
        self.functions: dict[str, ast.FunctionDef] = {}
        self.called: list[ast.Call] = []
        for node in ast.walk(self.tree):
            if isinstance(node, ast.FunctionDef):
                self.functions[node.name] = node
            elif isinstance(node, ast.Call):
                self.called.append(node)
            elif isinstance(node, ast.Assign):
                self._assign(node.targets[0], node.value)

    def _assign(self, target: ast.expr, value: ast.expr) -> None:
        if isinstance(target, ast.Name):
            self.assigned.setdefault(target.id, []).append(value)
        elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            for one, other in zip(target.elts, value.elts, strict=False):
                self._assign(one, other)

    def texts(self, node: ast.expr, seen: frozenset[str] = frozenset()) -> set[str]:
        """The templates that an expression can be; none where it comes from elsewhere."""
        match node:
            case ast.Constant(value=str(text)):
                return {text}
            case ast.JoinedStr(values=parts):
                return {"".join(one) for one in product(*(self._pieces(part, seen) for part in parts))}
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                return {a + b for a in self.texts(left, seen) for b in self.texts(right, seen)}
            case ast.IfExp(body=body, orelse=other):
                return self.texts(body, seen) | self.texts(other, seen)
            case ast.BoolOp(values=values):
                return set().union(*(self.texts(one, seen) for one in values))
            case ast.Name(id=name) if name not in seen:
                return set().union(*(self.texts(one, seen | {name}) for one in self.assigned.get(name, ())))
            case ast.Dict(values=values):
                return set().union(*(self.texts(one, seen) for one in values))
            case ast.Tuple(elts=parts) | ast.List(elts=parts):
                return set().union(*(self.texts(one, seen) for one in parts))
            case ast.Subscript(value=ast.Name(id=name), slice=ast.Constant(value=int(at))) if name not in seen:
                return set().union(*(self._part(one, at, seen | {name}) for one in self.assigned.get(name, ())))
            case ast.Subscript(value=value):
                return self.texts(value, seen)
            case ast.Call(func=ast.Attribute(value=value, attr="get"), args=[_, *default]):
                return set().union(self.texts(value, seen), *(self.texts(one, seen) for one in default))
            case ast.Call(func=ast.Name(id=name), args=arguments) if name not in seen:
                told = set().union(*(self.texts(one, seen) for one in arguments))
                return told | self._returned(name, seen | {name})
        return set()

    def calls(self, *names: str) -> Iterator[ast.Call]:
        """The calls of functions or methods of these names."""
        for node in self.called:
            is_named = getattr(node.func, "id", getattr(node.func, "attr", "")) in names
            if is_named and not any(isinstance(one, ast.Starred) for one in node.args):
                yield node

    def _pieces(self, node: ast.expr, seen: frozenset[str]) -> set[str]:
        """A piece of an f-string: its text, or {} for a value."""
        return {node.value} if isinstance(node, ast.Constant) else {"{}"}

    def _returned(self, name: str, seen: frozenset[str], at: int | None = None) -> set[str]:
        function = self.functions.get(name)
        ends = [n.value for n in ast.walk(function) if isinstance(n, ast.Return) and n.value] if function else []
        return set().union(*(self.texts(one, seen) if at is None else self._part(one, at, seen) for one in ends))

    def _part(self, node: ast.expr, at: int, seen: frozenset[str]) -> set[str]:
        """Number `at` of what an expression of tuples can be."""
        match node:
            case ast.Tuple(elts=parts) if at < len(parts):
                return self.texts(parts[at], seen)
            case ast.Call(func=ast.Name(id=name)):
                return self._returned(name, seen | {name}, at)
        return set()


def find_messages() -> tuple[set[str], set[str], set[str]]:
    """Whole errors, what refusals name, and what they advise.

    A function whose docstring contains the word remedy gives the last two.
    """
    errors, whats, remedies = set(), set(), set()
    for path in sources():
        module = Module(path)
        pairs = [(node.args[-2], node.args[-1]) for node in module.calls("refuse") if len(node.args) > 1]
        pairs += [tuple(node.args[1:3]) for node in module.calls("Refusal") if len(node.args) > 2]
        pairs += [
            pair
            for one in module.functions.values()
            if "remedy" in (ast.get_docstring(one) or "")
            for pair in told_by(one)
        ]
        for what, remedy in pairs:
            whats |= module.texts(what)
            remedies |= module.texts(remedy)
        for node in module.calls(*ERRORS):
            errors |= module.texts(node.args[0]) if node.args else set()
    return errors, whats, remedies


def told_by(function: ast.FunctionDef) -> Iterator[tuple[ast.expr, ast.expr]]:
    """The pairs that a function returns or yields."""
    for node in ast.walk(function):
        if isinstance(node, ast.Return | ast.Yield):
            for value in (node.value.body, node.value.orelse) if isinstance(node.value, ast.IfExp) else (node.value,):
                if isinstance(value, ast.Tuple) and len(value.elts) in (2, 3):
                    yield value.elts[0], value.elts[1]
