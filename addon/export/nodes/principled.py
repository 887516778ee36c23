# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader of the Principled BSDF: a stack of layers becomes a flat list of lobes.

Each lobe is weighed by what the layers above leave. From top to bottom: alpha, sheen, coat, emission, metal,
transmission, specular, subsurface and diffuse (Cycles, kernel/svm/closure.h).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import bpy

from ....lib.blender_versions import Versions
from ....lib.scene import expressions as ex
from ....lib.scene import materials as mt
from ....lib.scene.converters import VectorMath
from ....lib.scene.layers import BeneathLayer, BeneathSheen, CoatTint
from ....lib.textures.fold import is_constant
from .shader_reader import ShaderReader
from .subsurface import make_subsurface, parts_of, read_method
from .tree import Scope

_STRETCHES_GLASS = Versions("5.3")  # where Anisotropic stretches transmission too
_LARGEST_ROOT = 0.99**0.5
_HALF = ex.Constant(0.5)
# Light passes a coat of weight w, albedo A and transmittance T by 1 - w + w min((1 - A) T, 1); before, by (1 - w A) (1 - w + w T).
_COATS_THAT_COVER = Versions("5.3")


@dataclass(frozen=True)
class _Weight:
    """What reaches a layer: a value, and a colour where a coat has tinted it."""

    value: ex.Expression
    color: ex.Expression | None = None

    def times(self, factor: ex.Expression) -> _Weight:
        """Less by a value."""
        return replace(self, value=_product(self.value, factor))

    def without(self, share: ex.Expression) -> _Weight:
        """What a layer that takes `share` leaves."""
        return self.times(ex.Math("SUBTRACT", ex.ONE, share, ex.ZERO))

    @property
    def expression(self) -> ex.Expression:
        """Value or colour."""
        return self.value if self.color is None else _tinted(self.color, ex.ValueToColor(self.value))


def _product(a: ex.Expression, b: ex.Expression) -> ex.Expression:
    return ex.Math("MULTIPLY", a, b, ex.ZERO)


def _tinted(a: ex.Expression, b: ex.Expression) -> ex.Expression:
    return ex.Mix(ex.ONE, a, b, blend="MULTIPLY")


def _clamped(value: ex.Expression) -> ex.Expression:
    return ex.Math("ADD", value, ex.ZERO, ex.ZERO, clamp=True)


def read_principled(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    """The lobes of a Principled BSDF node."""
    return _Principled(reader, node, scope).lobes(weight)


_Add = Callable[[mt.Closure, _Weight], None]


class _Principled:
    def __init__(self, reader: ShaderReader, node: bpy.types.Node, scope: Scope) -> None:
        self._reader, self._node, self._scope = reader, node, scope
        self._normal = reader.normal(node, scope)
        self._film = reader.film(node, scope)
        self._distribution = node.distribution if node.distribution == "MULTI_GGX" else "GGX"

    def _socket(self, name: str, absent: ex.Expression = ex.ZERO) -> ex.Expression:
        """The folded content of a socket, or `absent` in a Blender that has none of the name."""
        return self._reader.read(self._node, name, self._scope) if name in self._node.inputs else absent

    def _share(self, name: str) -> ex.Expression:
        return self._reader.folder(_clamped(self._socket(name)))

    def lobes(self, weight: ex.Expression) -> list[mt.WeightedClosure]:
        found: list[mt.WeightedClosure] = []
        fold = self._reader.folder

        def add(closure: mt.Closure, layer: _Weight) -> None:
            """The lobe, unless nothing reaches it."""
            reaches = fold(layer.expression)
            if reaches not in (ex.ZERO, ex.BLACK):
                found.append(self._reader.lobe(closure, reaches))

        rest = _Weight(weight)
        alpha = self._share("Alpha")
        add(mt.Transparent(), rest.without(alpha))
        rest = rest.times(alpha)
        rest = self._coat(self._sheen(rest, add), add)
        strength = self._socket("Emission Strength")
        add(
            mt.Emission(self._socket("Emission Color", ex.WHITE), strength),
            rest if strength != ex.ZERO else _Weight(ex.ZERO),
        )
        metallic = self._share("Metallic")
        add(self._metal(), rest.times(metallic))
        rest = rest.without(metallic)
        transmission = self._share("Transmission Weight")
        if fold(rest.times(transmission).value) != ex.ZERO:
            add(self._glass(), rest.times(transmission))
        rest = rest.without(transmission)
        if fold(rest.value) != ex.ZERO:
            rest, ior = self._specular(rest, add)
            rest = self._subsurface(rest, ior, add)
            add(mt.Diffuse(self._socket("Base Color"), self._socket("Diffuse Roughness"), self._normal), rest)
        return found

    def _sheen(self, rest: _Weight, add: _Add) -> _Weight:
        weight = self._reader.folder(ex.Math("MAXIMUM", self._socket("Sheen Weight"), ex.ZERO, ex.ZERO))
        if weight == ex.ZERO:
            return rest
        tint, roughness, normal = (
            self._socket("Sheen Tint", ex.WHITE),
            self._socket("Sheen Roughness"),
            self._sheen_normal(),
        )
        add(mt.Sheen(tint, roughness, normal), rest.times(weight))
        return rest.times(BeneathSheen(tint, roughness, weight, normal))

    def _sheen_normal(self) -> ex.Expression | None:
        """The node's normal, turned towards the coat's by the coat's weight."""
        share = self._share("Coat Weight")
        coat = self._reader.normal(self._node, self._scope, "Coat Normal")
        if share == ex.ZERO or coat == self._normal:
            return self._normal
        shading = ex.Coordinates("SHADING_NORMAL")
        mixed = ex.Mix(share, self._normal or shading, coat or shading)
        return VectorMath("NORMALIZE", mixed, ex.BLACK, ex.BLACK, ex.ONE)

    def _coat(self, rest: _Weight, add: _Add) -> _Weight:
        weight = self._reader.folder(ex.Math("MAXIMUM", self._socket("Coat Weight"), ex.ZERO, ex.ZERO))
        if weight == ex.ZERO:
            return rest
        ior, roughness = self._constant("Coat IOR"), self._socket("Coat Roughness")
        ior = ex.Constant(max(ior.value, 1.0))
        tint = self._socket("Coat Tint")
        normal = self._reader.normal(self._node, self._scope, "Coat Normal")
        add(mt.Specular("MULTI_GGX", ior, ex.WHITE, roughness, normal=normal), rest.times(weight))

        def beneath(share: ex.Expression) -> ex.Expression:
            return BeneathLayer(ior, ex.WHITE, roughness, share, "MULTI_GGX", normal, coat=True)

        if tint == ex.WHITE:
            return rest.times(beneath(weight))
        if bpy.app.version[:2] in _COATS_THAT_COVER:
            through = _tinted(CoatTint(ior, tint, ex.ONE, normal), ex.ValueToColor(beneath(ex.ONE)))
            at_most_one = ex.Mix(ex.ONE, through, ex.WHITE, blend="DARKEN")
            return replace(rest, color=ex.Mix(weight, ex.WHITE, at_most_one))
        return replace(rest.times(beneath(weight)), color=CoatTint(ior, tint, weight, normal))

    def _constant(self, name: str) -> ex.Constant:
        """The content of a socket that may not vary from point to point."""
        content = self._socket(name)
        if is_constant(content):
            return content
        self._reader.values.refuse(self._node, self._scope, f", socket '{name}' (textured),", f"unlink {name}")
        return _HALF

    def _stretch(self) -> dict[str, object]:
        """Roughness and what turns and stretches the lobe."""
        anisotropy = self._share("Anisotropic")
        if anisotropy == ex.ZERO:
            return {"roughness": self._socket("Roughness")}
        return {
            "roughness": self._socket("Roughness"),
            "anisotropy": anisotropy,
            "rotation": self._socket("Anisotropic Rotation"),
            "tangent": self._reader.tangent(self._node, self._scope),
        }

    def _metal(self) -> mt.Metallic:
        base, edge = self._socket("Base Color"), self._socket("Specular Tint", ex.WHITE)
        return mt.Metallic(self._distribution, "F82", base, edge, normal=self._normal, **self._stretch(), **self._film)

    def _dispersion(self) -> ex.Expression:
        """The reciprocal of the glass's Abbe number.

        Zero where scale or number is not positive. Blender 5.3 and later.
        """
        scale, abbe = (self._socket(f"Transmission Dispersion {name}") for name in ("Scale", "Abbe Number"))
        scale, abbe = (ex.Math("MAXIMUM", socket, ex.ZERO, ex.ZERO) for socket in (scale, abbe))
        dispersion = self._reader.folder(ex.Math("DIVIDE", scale, abbe, ex.ZERO))  # by zero it gives zero
        if self._distribution == "MULTI_GGX" and not is_constant(dispersion):
            what = ", sockets 'Transmission Dispersion' (textured),"
            self._reader.values.refuse(self._node, self._scope, what, "unlink them, or choose GGX")
            return ex.ZERO
        return dispersion

    def _glass(self) -> mt.Glass:
        ior = self._constant("IOR") if self._distribution == "MULTI_GGX" else self._socket("IOR")
        return mt.Glass(
            ex.WHITE,
            ior,
            self._socket("Roughness"),
            self._distribution,
            transmission=ex.Gamma(self._base_in_range(), _HALF),
            tint=self._socket("Specular Tint", ex.WHITE),
            normal=self._normal,
            dispersion=self._dispersion(),
            **self._film,
            **(self._glass_stretch() if bpy.app.version in _STRETCHES_GLASS else {}),
        )

    def _glass_stretch(self) -> dict[str, object]:
        """The fields that turn and stretch the glass, as on the Glass BSDF.

        The anisotropy a becomes sqrt(1 - 0.9 a) - 1, so that alpha along x is divided by sqrt(1 - 0.9 a).
        """
        stretch = self._stretch()
        del stretch["roughness"]
        if stretch:
            squared = ex.Math("MULTIPLY_ADD", stretch["anisotropy"], ex.Constant(-0.9), ex.ONE)
            root = ex.Math("SQRT", squared, ex.ZERO, ex.ZERO)
            stretch["anisotropy"] = ex.Math("SUBTRACT", root, ex.ONE, ex.ZERO)
        return stretch

    def _base_in_range(self) -> ex.Expression:
        return ex.Mix(ex.ZERO, self._socket("Base Color"), ex.WHITE, clamp_result=True)

    def _subsurface(self, rest: _Weight, ior: ex.Expression, add: _Add) -> _Weight:
        """Add what scatters below the surface, and return the weight that is left.

        Light enters by the index `ior` unless the method has one of its own.
        """
        share = self._share("Subsurface Weight")
        if self._reader.folder(rest.times(share).value) == ex.ZERO:
            return rest
        method = read_method(self._node, "subsurface_method")
        roughness = self._socket("Roughness")
        closure = make_subsurface(
            method,
            self._base_in_range(),
            self._socket("Subsurface Radius"),
            self._socket("Subsurface Scale"),
            self._socket("Subsurface Anisotropy"),
            self._socket("Subsurface IOR") if method.is_skin else ior,
            _product(_clamped(roughness), _clamped(roughness)),
            self._normal,
        )
        for part, weight in parts_of(closure):
            add(part, rest.times(share).times(weight))
        return rest.without(share)

    def _specular(self, rest: _Weight, add: _Add) -> tuple[_Weight, ex.Constant]:
        """The dielectric's own layer, what it leaves, and its index.

        Level 0.5 leaves the index as it is, others scale the reflectance at normal incidence.
        """
        ior, level = max(self._constant("IOR").value, 1e-5), max(self._constant("Specular IOR Level").value, 0.0)
        if level != 0.5:
            root = (ior - 1.0) / (ior + 1.0) * (2.0 * level) ** 0.5
            root = min(max(root, -_LARGEST_ROOT), _LARGEST_ROOT)
            ior = (1.0 + root) / (1.0 - root)
        if ior == 1.0 and not self._film:
            return rest, ex.ONE
        if not all(map(is_constant, self._film.values())):
            what = ", sockets 'Thin Film' (textured) above a diffuse base,"
            self._reader.values.refuse(
                self._node, self._scope, what, "unlink them, or make it all metal or transmission"
            )
            self._film = {}
        eta, tint = ex.Constant(ior), self._socket("Specular Tint", ex.WHITE)
        closure = mt.Specular(self._distribution, eta, tint, normal=self._normal, **self._stretch(), **self._film)
        add(closure, rest)
        roughness, distribution = self._socket("Roughness"), self._distribution
        below = BeneathLayer(eta, tint, roughness, ex.ONE, distribution, self._normal, **self._film)
        return rest.times(below), eta
