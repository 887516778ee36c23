# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions that change values, vectors and colours at a point.

They are Blender's Converter and Color nodes.
"""

from __future__ import annotations

from dataclasses import dataclass

from .expressions import Expression


@dataclass(frozen=True)
class Component(Expression):
    """One of the three numbers of a vector or colour, a value; `index` 0, 1 or 2."""

    vector: Expression
    index: int


@dataclass(frozen=True)
class Combine(Expression):
    """A vector or colour of three values."""

    x: Expression
    y: Expression
    z: Expression


@dataclass(frozen=True)
class ColorModel(Expression):
    """A colour in another model.

    `kind`: 'RGB_TO_HSV', 'HSV_TO_RGB', 'RGB_TO_HSL', 'HSL_TO_RGB'.
    """

    color: Expression
    kind: str


@dataclass(frozen=True)
class MapRange(Expression):
    """Blender's Map Range on values, or on vectors by component; all sockets of one kind.

    `interpolation`: 'LINEAR', 'STEPPED', 'SMOOTHSTEP' or 'SMOOTHERSTEP'; `clamp` to the range of results (the first two).
    """

    value: Expression
    from_min: Expression
    from_max: Expression
    to_min: Expression
    to_max: Expression
    steps: Expression
    interpolation: str = "LINEAR"
    clamp: bool = False


@dataclass(frozen=True)
class VectorMath(Expression):
    """Blender's Vector Math; `operation` by Blender's identifier.

    A value for DOT_PRODUCT, DISTANCE and LENGTH, else a vector.
    """

    operation: str
    a: Expression
    b: Expression
    c: Expression
    scale: Expression


@dataclass(frozen=True)
class CosineBetween(Expression):
    """The cosine of the angle between two vectors, a value; NaN where one has no length, as in Cycles' Normal node."""

    a: Expression
    b: Expression


@dataclass(frozen=True)
class VectorRotate(Expression):
    """`vector` turned about `axis` through `center` by `angle` radians."""

    vector: Expression
    center: Expression
    axis: Expression
    angle: Expression


@dataclass(frozen=True)
class HueSaturation(Expression):
    """Blender's Hue/Saturation/Value node."""

    hue: Expression
    saturation: Expression
    value: Expression
    factor: Expression
    color: Expression


@dataclass(frozen=True)
class BrightContrast(Expression):
    """Blender's Brightness/Contrast node; the result is at least 0."""

    color: Expression
    brightness: Expression
    contrast: Expression


@dataclass(frozen=True)
class Curve:
    """A curve as Blender evaluates it.

    `table` has its values at evenly spaced places from `low` to `high`; it is linear between them.
    Beyond the ends it is a straight line: `start` and `end` are each its value at the end and its slope.
    """

    low: float
    high: float
    table: tuple[float, ...]
    start: tuple[float, float]
    end: tuple[float, float]


@dataclass(frozen=True)
class Curves(Expression):
    """Curves over the channels of `color` (RGB and Vector Curves).

    Or over a value where there is one (Float Curve).
    `combined` comes before those of the channels (RGB Curves). `factor` mixes the result with the input. `extends`: the
    curves go on beyond their ends, instead of staying constant.
    """

    factor: Expression
    color: Expression
    channels: tuple[Curve, ...]
    combined: Curve | None = None
    extends: bool = True


@dataclass(frozen=True)
class Blackbody(Expression):
    """Colour of a black body of `temperature` kelvin, linear Rec. 709.

    It has luminance 1, as Cycles fits it, and is at least 0.
    """

    temperature: Expression
