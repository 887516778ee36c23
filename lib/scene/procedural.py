# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions that make textures out of coordinates alone: Blender's procedural textures."""

from __future__ import annotations

from dataclasses import dataclass

from .expressions import ONE, ZERO, Expression


@dataclass(frozen=True)
class Noise(Expression):
    """Blender's Noise texture.

    `dimensions` 1 to 4 (1 reads `w` alone); `kind` by Blender's identifier ('FBM', ...).
    `output`: 'COLOR' or 'FACTOR' (a value).
    """

    vector: Expression
    w: Expression
    scale: Expression
    detail: Expression
    roughness: Expression
    lacunarity: Expression
    offset: Expression = ZERO
    gain: Expression = ONE
    distortion: Expression = ZERO
    dimensions: int = 3
    kind: str = "FBM"
    normalize: bool = True
    output: str = "FACTOR"


@dataclass(frozen=True)
class WhiteNoise(Expression):
    """A random number for each coordinate, by its bits in single precision.

    `output`: 'COLOR' or 'FACTOR'.
    """

    vector: Expression
    w: Expression
    dimensions: int = 3
    output: str = "FACTOR"


@dataclass(frozen=True)
class Gradient(Expression):
    """Blender's Gradient texture, a value in [0, 1].

    `kind` by Blender's identifier ('LINEAR', 'RADIAL', ...).
    """

    vector: Expression
    kind: str = "LINEAR"


@dataclass(frozen=True)
class Wave(Expression):
    """Blender's Wave texture, a value.

    `kind`: 'BANDS' or 'RINGS', `direction` and `profile` by Blender's identifiers.
    """

    vector: Expression
    scale: Expression
    distortion: Expression
    detail: Expression
    detail_scale: Expression
    detail_roughness: Expression
    phase: Expression
    kind: str = "BANDS"
    direction: str = "X"
    profile: str = "SIN"


@dataclass(frozen=True)
class Magic(Expression):
    """Blender's Magic texture, a colour; `depth` 0 to 10."""

    vector: Expression
    scale: Expression
    distortion: Expression
    depth: int = 2


@dataclass(frozen=True)
class Brick(Expression):
    """Blender's Brick texture. `output`: 'COLOR' or 'FACTOR' (a value: 1 in the mortar)."""

    vector: Expression
    color1: Expression
    color2: Expression
    mortar: Expression
    scale: Expression
    mortar_size: Expression
    mortar_smooth: Expression
    bias: Expression
    brick_width: Expression
    row_height: Expression
    offset: float = 0.5
    offset_frequency: int = 2
    squash: float = 1.0
    squash_frequency: int = 2
    output: str = "COLOR"


@dataclass(frozen=True)
class Voronoi(Expression):
    """Blender's Voronoi texture.

    `feature`, `metric` by Blender's identifiers; `dimensions` 1 to 4 (1 reads `w` alone).
    `output`: 'DISTANCE', 'COLOR', 'POSITION', 'W' or 'RADIUS'. `hashing`: 'PCG' (Blender 5.0 on) or 'LOOKUP3' (before).
    """

    vector: Expression
    w: Expression
    scale: Expression
    detail: Expression
    roughness: Expression
    lacunarity: Expression
    smoothness: Expression
    exponent: Expression
    randomness: Expression
    dimensions: int = 3
    feature: str = "F1"
    metric: str = "EUCLIDEAN"
    normalize: bool = False
    output: str = "DISTANCE"
    hashing: str = "PCG"
