# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions: the values that feed a closure's sockets, as a tree of frozen nodes.

An expression is a *value* (one number a point) or a *colour* (three numbers a point; vectors too).
`lib.textures` evaluates them. Where Blender converts between socket types in silence, the exporter
writes the conversion as a node, so a tree is always well typed. A node's inputs are expressions;
everything else about it is plain data.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Expression:
    """Base of all nodes."""


@dataclass(frozen=True)
class Constant(Expression):
    """A value (float) or a colour or vector (three floats), the same at every point."""

    value: float | tuple[float, float, float]

    @property
    def number(self) -> float:
        """The value of a constant that is one number; raises TypeError for a colour or vector."""
        if isinstance(self.value, tuple):
            raise TypeError(f"{self.value} are three numbers")
        return float(self.value)


@dataclass(frozen=True)
class Coordinates(Expression):
    """Texture coordinates of the point, a vector.

    `kind`: 'UV' (the map `uv_map`, third component 0), 'GENERATED', 'OBJECT', 'NORMAL' (of the object's space), 'POSITION',
    'SHADING_NORMAL', 'TRUE_NORMAL' or 'INCOMING' (to the viewer). In the world, 'GENERATED' is the unit direction of the ray.
    """

    kind: str
    uv_map: str = ""


@dataclass(frozen=True)
class Attribute(Expression):
    """A named attribute of the mesh ('' is the active render colour), mixed from the corners.

    It is 0 where a mesh has none.
    `output`: 'COLOR', or one of the values 'FACTOR', 'ALPHA' (1 where a mesh has none) and 'PRESENCE' (0 or 1).
    """

    name: str
    output: str = "COLOR"


@dataclass(frozen=True)
class ObjectInfo(Expression):
    """A fact of the object that the point lies on.

    The vectors 'LOCATION' and 'COLOR', the values 'ALPHA', 'INDEX' and 'RANDOM'.
    """

    output: str


@dataclass(frozen=True)
class NormalMap(Expression):
    """Blender's Normal Map node: a unit vector of the world.

    `space` by Blender's identifier ('TANGENT', 'OBJECT', ...).
    """

    color: Expression
    strength: Expression
    space: str = "TANGENT"
    uv_map: str = ""
    invert_green: bool = False


@dataclass(frozen=True)
class Bump(Expression):
    """Blender's Bump node: the normal of the surface raised by the value `height`.

    The surface is that of `normal`, or of the shading normal.
    """

    height: Expression
    strength: Expression
    distance: Expression
    normal: Expression | None = None
    invert: bool = False


@dataclass(frozen=True)
class Undisplaced(Expression):
    """The `expression` where the point was before its vertices were displaced."""

    expression: Expression


@dataclass(frozen=True)
class SurfaceNormal(Expression):
    """The `normal` that the bump of a displacement gives the whole surface.

    In Cycles it takes the shading normal's place.
    """

    normal: Expression


@dataclass(frozen=True)
class NormalScale(Expression):
    """Metres along the shading normal for a unit along it in the object's space, a value."""


@dataclass(frozen=True)
class Mapping(Expression):
    """Blender's Mapping node.

    `kind`: 'POINT', 'TEXTURE', 'VECTOR', 'NORMAL'; rotation in radians, XYZ Euler.
    """

    vector: Expression
    location: Expression
    rotation: Expression
    scale: Expression
    kind: str = "POINT"


@dataclass(frozen=True)
class ImageTexture(Expression):
    """Colour (or alpha, a value) of an image at `vector`'s x and y.

    `image` is an index into `Scene.images`.
    `interpolation`: 'LINEAR', 'CLOSEST' or 'CUBIC' (B-spline); `extension`: 'REPEAT', 'EXTEND', 'CLIP' or 'MIRROR';
    `output`: 'COLOR' or 'ALPHA'. `projection`: 'FLAT', 'SPHERE', 'TUBE' or 'BOX', which needs the `normal` in the
    object's space and blends its faces over `blend` (0..1).
    `association`: 'SEPARATE' (the colour knows nothing of alpha), 'MULTIPLIED' (the texels' colours times alpha are
    interpolated) or 'WEIGHTED' (alpha weighs the texels in the interpolation).
    """

    vector: Expression
    image: int
    interpolation: str = "LINEAR"
    extension: str = "REPEAT"
    output: str = "COLOR"
    association: str = "SEPARATE"
    projection: str = "FLAT"
    normal: Expression | None = None
    blend: float = 0.0


@dataclass(frozen=True)
class Tile(Expression):
    """`inside` where `vector` lies in tile `number` of a tiled image, and `outside` elsewhere.

    The number is that of UDIM: 1001 + column + 10 rows.
    There are 10 columns. As in Cycles, what is above -1 belongs to the first column or row.
    """

    vector: Expression
    number: int
    inside: Expression
    outside: Expression


@dataclass(frozen=True)
class EnvironmentTexture(Expression):
    """Colour of an image of all directions in direction `vector` (need not be of unit length).

    `projection`: 'EQUIRECTANGULAR' or 'MIRROR_BALL'; `interpolation` and `association` are ImageTexture's.
    """

    vector: Expression
    image: int
    interpolation: str = "LINEAR"
    projection: str = "EQUIRECTANGULAR"
    association: str = "SEPARATE"


@dataclass(frozen=True)
class Checker(Expression):
    """Blender's Checker texture.

    `output`: 'COLOR' or 'FACTOR' (a value: 1 where `color1` shows).
    """

    vector: Expression
    color1: Expression
    color2: Expression
    scale: Expression
    output: str = "COLOR"


@dataclass(frozen=True)
class Math(Expression):
    """Blender's Math node on values.

    `operation` by Blender's identifier ('ADD', 'POWER', 'WRAP', ...).
    """

    operation: str
    a: Expression
    b: Expression
    c: Expression
    clamp: bool = False


@dataclass(frozen=True)
class Mix(Expression):
    """Blender's Mix node: values if a and b are values, else colours.

    `factor` is a value, or a vector (non-uniform).
    `blend` by Blender's identifier ('MIX', 'MULTIPLY', 'SCREEN', ...), 'MIX' alone for values and vectors.
    """

    factor: Expression
    a: Expression
    b: Expression
    blend: str = "MIX"
    clamp_factor: bool = True
    clamp_result: bool = False


@dataclass(frozen=True)
class ColorRamp(Expression):
    """Blender's Color Ramp over `factor`: `positions` ascending, `colors` RGBA of the stops.

    `interpolation`: 'LINEAR', 'CONSTANT', 'EASE', 'CARDINAL', 'B_SPLINE'; `mode`: 'RGB', 'HSV', 'HSL';
    `hue`: Blender's hue_interpolation; `output`: 'COLOR' or 'ALPHA' (a value).
    """

    factor: Expression
    positions: tuple[float, ...]
    colors: tuple[tuple[float, float, float, float], ...]
    interpolation: str = "LINEAR"
    mode: str = "RGB"
    hue: str = "NEAR"
    output: str = "COLOR"


@dataclass(frozen=True)
class Gamma(Expression):
    """Blender's Gamma node: each channel of `color` above 0 raised to `gamma`.

    Other channels stay as they are.
    """

    color: Expression
    gamma: Expression


@dataclass(frozen=True)
class FresnelFactor(Expression):
    """Exact unpolarised dielectric reflectance at |n.wo|.

    n is `normal`, or the shading normal. The index is inverted on back faces.
    """

    ior: Expression
    normal: Expression | None = None


@dataclass(frozen=True)
class LayerWeight(Expression):
    """Blender's Layer Weight node, at |n.wo|.

    n is `normal`, or the shading normal. `output`: 'FRESNEL' or 'FACING'.
    """

    blend: Expression
    output: str = "FRESNEL"
    normal: Expression | None = None


@dataclass(frozen=True)
class Wireframe(Expression):
    """1 near an edge of the point's triangle, else 0 (a value).

    Near means within half of |`size`| metres. Diagonals that Blender adds count, too.
    """

    size: Expression


@dataclass(frozen=True)
class PixelWidth(Expression):
    """How wide a pixel is at the point, in metres across the view (a value), as Cycles follows it along a path.

    It is that of a cone whose angle is the pixel's, and stays so whatever scatters.
    """


@dataclass(frozen=True)
class AmbientOcclusion(Expression):
    """The share of the hemisphere about the normal where no face is within `distance` metres (a value).

    It is weighted by the cosine. 1 where the distance is not above 0. n is `normal`, or the shading normal, and points to
    the other side where `inside`. `only_local`: only faces of the point's own object count. It is estimated by so many
    `samples` at each point where a path meets it, as in Cycles, since the mean of what is made of it may depend on their number.
    """

    distance: Expression
    normal: Expression | None = None
    inside: bool = False
    only_local: bool = False
    samples: int = 1


@dataclass(frozen=True)
class Bevel(Expression):
    """Blender's Bevel node: the mean normal of the object's faces within `radius` metres, a unit vector of the world.

    It is estimated by so many `samples` at each point where a path meets it, as in Cycles, since the mean of what is made
    of it depends on their number. What it differs from the shading normal by is added to `normal`, if there is one.
    """

    radius: Expression
    samples: int = 4
    normal: Expression | None = None


@dataclass(frozen=True)
class Backfacing(Expression):
    """1 where the ray meets the back of the face, else 0 (a value)."""


@dataclass(frozen=True)
class RayFlag(Expression):
    """1 where the ray that meets the point is of a kind, else 0 (a value).

    `flag` is a name in rays.FLAGS.
    """

    flag: str


@dataclass(frozen=True)
class RayCount(Expression):
    """The number of times that a path has scattered, or the length of its last ray (a value).

    The path is the one that meets the point; the length is in metres.

    `count` is a name in rays.COUNTS.
    """

    count: str


@dataclass(frozen=True)
class AfterDiffuse(Expression):
    """1 where a diffuse lobe has reflected the path that meets the point, else 0 (a value)."""


@dataclass(frozen=True)
class ColorToValue(Expression):
    """A colour's luminance (linear Rec. 709), Blender's conversion from colour to value."""

    color: Expression


@dataclass(frozen=True)
class VectorToValue(Expression):
    """A vector's mean component, Blender's conversion from vector to value."""

    vector: Expression


@dataclass(frozen=True)
class ValueToColor(Expression):
    """A value three times over."""

    value: Expression


ZERO = Constant(0.0)
ONE = Constant(1.0)
WHITE = Constant((1.0, 1.0, 1.0))
BLACK = Constant((0.0, 0.0, 0.0))
