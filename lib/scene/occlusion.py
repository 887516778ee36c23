# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a material reads ambient occlusion, and whether one ray estimates what it makes of it.

The mean of a product of the occlusion and of what does not depend on it is exact with any number of rays. The mean of any
other function of it depends on the number of rays, and on how they are stratified: it takes as many as Cycles casts.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields, replace

from . import converters as cv
from . import expressions as ex
from .materials import (
    Closure,
    Diffuse,
    Emission,
    Glass,
    Glossy,
    Material,
    Refraction,
    Sheen,
    Subsurface,
    Toon,
    Translucent,
    Transparent,
    Velvet,
    WeightedClosure,
)
from .scene import Scene


@dataclass(frozen=True)
class _Form:
    """An expression as a function of the occlusion.

    `degree` of the polynomial, inf for other functions. All its channels are in `low` to `high`. `definite`: at each point
    the sign is the same whatever the occlusion.
    """

    degree: float
    low: float
    high: float
    definite: bool


_UNKNOWN = _Form(0.0, -math.inf, math.inf, True)
_CROOKED = _Form(math.inf, -math.inf, math.inf, False)
_ONE = _Form(0.0, 1.0, 1.0, True)
_SHARE = _Form(1.0, 0.0, 1.0, True)


def takes_one_ray(lobe: WeightedClosure) -> bool:
    """Whether the mean light of a folded lobe is the same however few rays estimate the ambient occlusion that it reads."""
    if lobe.weight == ex.ZERO:
        return True
    closure, forms = lobe.closure, _Forms()
    sockets = {f.name: getattr(closure, f.name) for f in fields(closure)}
    used = {name: forms(value).degree for name, value in sockets.items() if isinstance(value, ex.Expression)}
    weight, color = forms(lobe.weight), forms(getattr(closure, "color", ex.ONE))
    if any(degree for name, degree in used.items() if name != "color" or not _multiplies(closure)):
        return False
    product = _multiply(weight, color)
    return product.degree <= 1.0 and product.definite


def with_few_rays(scene: Scene) -> Scene:
    """Return the folded `scene` with one ray for each Ambient Occlusion node, where the mean light stays the same."""
    return replace(scene, materials=tuple(_with_few_rays(material) for material in scene.materials))


def _with_few_rays(material: Material) -> Material:
    if not all(takes_one_ray(lobe) for lobe in material.lobes):
        return material
    done: dict[int, tuple[ex.Expression, ex.Expression]] = {}

    def spared(node: ex.Expression) -> ex.Expression:
        if id(node) not in done:
            new = {name: spared(part) for name, part in _parts(node).items()}
            changed = any(new[name] is not getattr(node, name) for name in new)
            made = replace(node, **new) if changed else node
            done[id(node)] = node, replace(made, samples=1) if isinstance(made, ex.AmbientOcclusion) else made
        return done[id(node)][1]

    def lobe(one: WeightedClosure) -> WeightedClosure:
        sockets = {f.name: getattr(one.closure, f.name) for f in fields(one.closure)}
        new = {name: spared(value) for name, value in sockets.items() if isinstance(value, ex.Expression)}
        return WeightedClosure(replace(one.closure, **new), spared(one.weight))

    return replace(material, lobes=tuple(lobe(one) for one in material.lobes))


def find_misuse(lobe: WeightedClosure) -> str | None:
    """Return what of a folded lobe reads ambient occlusion and cannot be simulated, or None.

    Cycles gives the light that leaves emissive faces, and shadow rays through transparent ones, an occlusion of 1.
    """
    where = name_unasked(lobe.closure)
    if where is None or lobe.weight == ex.ZERO:
        return None
    forms, values = _Forms(), (lobe.weight, *vars(lobe.closure).values())
    reads = any(forms(value).degree for value in values if isinstance(value, ex.Expression))
    return where if reads else None


def name_unasked(closure: Closure) -> str | None:
    """Return what a closure does that Cycles evaluates without rays of its shader, or None."""
    return next((what for kind, what in _UNASKED.items() if isinstance(closure, kind)), None)


_UNASKED: dict[type[Closure], str] = {
    Emission: "its emission",
    Transparent: "what lets light straight through",
    Subsurface: "its subsurface scattering",
}


def _multiplies(closure: Closure) -> bool:
    """Whether the closure's colour is no more than a factor."""
    if isinstance(closure, Diffuse):
        return closure.roughness == ex.ZERO
    if isinstance(closure, Glossy):
        return closure.distribution != "MULTI_GGX" and closure.fresnel == "none"
    return isinstance(closure, Translucent | Sheen | Velvet | Toon | Refraction | Glass)


class _Forms:
    """The forms of expressions; each node object is looked at once."""

    def __init__(self) -> None:
        self._done: dict[int, tuple[ex.Expression, _Form]] = {}

    def __call__(self, node: ex.Expression) -> _Form:
        waiting = [node]  # chains of nodes are longer than Python's stack
        while waiting:
            last = waiting[-1]
            open_ = [part for part in _parts(last).values() if id(part) not in self._done]
            if open_ and id(last) not in self._done:
                waiting += open_
                continue
            waiting.pop()
            if id(last) not in self._done:
                self._done[id(last)] = (last, self._form(last))
        return self._done[id(node)][1]

    def _form(self, node: ex.Expression) -> _Form:
        if isinstance(node, ex.Constant):
            channels = node.value if isinstance(node.value, tuple) else (node.value,)
            return _Form(0.0, min(channels), max(channels), True)
        parts = {name: self._done[id(part)][1] for name, part in _parts(node).items()}
        varies = any(part.degree for part in parts.values())
        if isinstance(node, ex.AmbientOcclusion):
            return _CROOKED if varies else _SHARE
        if isinstance(node, ex.ImageTexture) and not varies:
            return _Form(0.0, 0.0, math.inf, True)
        known = next((find for kind, find in _KNOWN.items() if isinstance(node, kind)), None)
        form = None if known is None else known(node, parts)
        return form if form is not None else _CROOKED if varies else _UNKNOWN


def _parts(node: ex.Expression) -> dict[str, ex.Expression]:
    """The expressions that an expression is made of, by their fields."""
    return {f.name: part for f in fields(node) if isinstance(part := getattr(node, f.name), ex.Expression)}


def _add(a: _Form, b: _Form) -> _Form:
    degree, low, high = max(a.degree, b.degree), a.low + b.low, a.high + b.high
    return _Form(degree, low, high, degree == 0.0 or low >= 0.0 or high <= 0.0)


def _negate(a: _Form) -> _Form:
    return _Form(a.degree, -a.high, -a.low, a.definite)


def _multiply(a: _Form, b: _Form) -> _Form:
    ends = [x * y if x and y else 0.0 for x in (a.low, a.high) for y in (b.low, b.high)]
    return _Form(a.degree + b.degree, min(ends), max(ends), a.definite and b.definite)


def _mix(t: _Form, a: _Form, b: _Form) -> _Form:
    whole = _add(_multiply(_add(_ONE, _negate(t)), a), _multiply(t, b))
    if t.low < 0.0 or t.high > 1.0:
        return whole
    return _Form(whole.degree, min(a.low, b.low), max(a.high, b.high), whole.definite)


def _clamp(a: _Form) -> _Form:
    if a.low >= 0.0 and a.high <= 1.0:
        return a
    return _CROOKED if a.degree else _Form(0.0, 0.0, 1.0, True)


def _of_math(node: ex.Math, parts: dict[str, _Form]) -> _Form | None:
    a, b, c = parts["a"], parts["b"], parts["c"]
    if node.operation == "DIVIDE" and isinstance(node.b, ex.Constant) and node.b.value:
        inverse = 1.0 / node.b.number
        form = _multiply(a, _Form(0.0, inverse, inverse, True))
    elif node.operation in _SUMS:
        form = _SUMS[node.operation](a, b, c)
    else:
        return None
    return _clamp(form) if node.clamp else form


_SUMS: dict[str, Callable[[_Form, _Form, _Form], _Form]] = {
    "ADD": lambda a, b, c: _add(a, b),
    "SUBTRACT": lambda a, b, c: _add(a, _negate(b)),
    "MULTIPLY": lambda a, b, c: _multiply(a, b),
    "MULTIPLY_ADD": lambda a, b, c: _add(_multiply(a, b), c),
}
_BLENDS: dict[str, Callable[[_Form, _Form, _Form], _Form]] = {
    "MIX": _mix,
    "MULTIPLY": lambda t, a, b: _multiply(a, _mix(t, _ONE, b)),
    "ADD": lambda t, a, b: _add(a, _multiply(t, b)),
    "SUBTRACT": lambda t, a, b: _add(a, _negate(_multiply(t, b))),
}


def _of_mix(node: ex.Mix, parts: dict[str, _Form]) -> _Form | None:
    if node.blend not in _BLENDS:
        return None
    factor = _clamp(parts["factor"]) if node.clamp_factor else parts["factor"]
    form = _BLENDS[node.blend](factor, parts["a"], parts["b"])
    return _clamp(form) if node.clamp_result else form


def _of_ramp(node: ex.ColorRamp, parts: dict[str, _Form]) -> _Form | None:
    """A straight ramp from 0 to 1 mixes its two colours."""
    if (node.interpolation, node.mode, node.positions) != ("LINEAR", "RGB", (0.0, 1.0)):
        return None
    ends = (_Form(0.0, min(stop), max(stop), True) for stop in node.colors)
    return _mix(_clamp(parts["factor"]), *ends)


def _of_channels(node: ex.Expression, parts: dict[str, _Form]) -> _Form:
    """Each channel of the result is a channel of one of the parts."""
    forms = parts.values()
    return _Form(
        max(form.degree for form in forms),
        min(form.low for form in forms),
        max(form.high for form in forms),
        all(form.definite for form in forms),
    )


def _of_mean(node: ex.Expression, parts: dict[str, _Form]) -> _Form:
    """A mean of the channels of one part."""
    (part,) = parts.values()
    one_sign = part.degree == 0.0 or part.low >= 0.0 or part.high <= 0.0
    return _Form(part.degree, part.low, part.high, part.definite and one_sign)


_KNOWN: dict[type[ex.Expression], Callable[..., _Form | None]] = {
    ex.Math: _of_math,
    ex.Mix: _of_mix,
    ex.ColorRamp: _of_ramp,
    ex.ValueToColor: _of_channels,
    cv.Component: _of_channels,
    cv.Combine: _of_channels,
    ex.ColorToValue: _of_mean,
    ex.VectorToValue: _of_mean,
}
