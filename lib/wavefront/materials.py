# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials made ready for shading: sockets folded, lobes sorted by what they do, evaluated at surface points."""

from __future__ import annotations

import numpy as np

from ..bsdfs.compensated import Compensated, multiple_scattering
from ..bsdfs.lambert import Lambert
from ..bsdfs.microfacet import MicrofacetReflection
from ..bsdfs.mixture import Lobe, Mixture
from ..bsdfs.oren_nayar import OrenNayar
from ..bsdfs.rotated import Rotated, rotate_in
from ..bsdfs.specular import Mirror, SmoothDielectric
from ..effects.catalogue import adds_nothing
from ..microfacets import beckmann, ggx
from ..scene.expressions import Expression
from ..scene.materials import Closure, Diffuse, Emission, Glass, Glossy, Material, Refraction, Transparent
from ..textures.evaluate import evaluate
from ..textures.fold import fold
from ..textures.images import ImageSet
from ..vectors import dot
from .options import Options
from .surface import SurfacePoints

# Below this product of the alphas a lobe is a mirror, as in Cycles (bsdf_microfacet.h); D(0) would exceed 1.6e9.
MIRROR_ALPHA_PRODUCT = 2e-10


def folded(closure: Closure) -> Closure:
    """The closure with the constant parts of its sockets worked out."""
    sockets = {k: fold(v) for k, v in vars(closure).items() if isinstance(v, Expression)}
    return type(closure)(**{**vars(closure), **sockets})


class PreparedMaterial:
    """One material, ready to be asked at points."""

    def __init__(self, material: Material, images: ImageSet, options: Options) -> None:
        self.name = material.name
        self._images, self._options = images, options
        lobes = [(fold(x.weight), folded(x.closure)) for x in material.lobes if not adds_nothing(x)]
        self._emissions = [x for x in lobes if isinstance(x[1], Emission)]
        self._transparencies = [x for x in lobes if isinstance(x[1], Transparent)]
        self._scattering = [x for x in lobes if not isinstance(x[1], Emission | Transparent)]
        self.emits = bool(self._emissions)
        self.transparent = bool(self._transparencies)
        self.scatters = bool(self._scattering)

    def _evaluate(self, expression: Expression, points: SurfacePoints) -> np.ndarray:
        return evaluate(expression, points, self._images)

    def _color(self, weight: Expression, closure: Closure, points: SurfacePoints) -> np.ndarray:
        """Colour times weight, (3, 1) or (3, n)."""
        return np.atleast_1d(self._evaluate(weight, points)) * self._evaluate(closure.color, points)

    def emission(self, points: SurfacePoints) -> np.ndarray:
        """Radiance that the surface emits towards the viewer, (3, 1) or (3, n); negative radiance counts as zero."""
        total = np.zeros((3, 1))
        for weight, closure in self._emissions:
            strength = np.atleast_1d(self._evaluate(closure.strength, points))
            total = total + np.maximum(self._color(weight, closure, points) * strength, 0.0)
        return total

    def transparency(self, points: SurfacePoints) -> np.ndarray:
        """The factor on light that passes straight through, (3, 1) or (3, n)."""
        total = np.zeros((3, 1))
        for weight, closure in self._transparencies:
            total = total + self._color(weight, closure, points)
        return total

    def scattered_share(self, points: SurfacePoints) -> np.ndarray:
        """Mean colour of all scattering lobes together, () or (n,): how much they weigh beside transparency."""
        total = np.zeros(())
        for weight, closure in self._scattering:
            total = total + np.abs(self._color(weight, closure, points)).mean(axis=0)
        return total

    def mixture(self, points: SurfacePoints, wo: np.ndarray, t: np.ndarray, s: np.ndarray) -> Mixture:
        """The scattering lobes for local directions `wo` in the frame (t, s, n)."""
        lobes, colors = [], []
        for weight, closure in self._scattering:
            lobe, color = self._lobe(weight, closure, points, wo, t, s)
            lobes.append(lobe)
            colors.append(color)
        return Mixture(lobes, colors, points.size)

    def _lobe(
        self, weight: Expression, closure: Closure, points: SurfacePoints, wo: np.ndarray, t: np.ndarray, s: np.ndarray
    ) -> tuple[Lobe, np.ndarray]:
        if isinstance(closure, Glossy):
            return self._glossy(closure, points, wo, t, s), self._color(weight, closure, points)
        if isinstance(closure, Diffuse):
            roughness = np.clip(self._evaluate(closure.roughness, points), 0.0, 1.0)
            if not np.any(roughness):
                return Lambert(), self._color(weight, closure, points)
            color = np.clip(self._evaluate(closure.color, points), 0.0, 1.0)
            share = np.atleast_1d(self._evaluate(weight, points))
            return OrenNayar(wo, roughness, color), np.broadcast_to(share, (3, share.shape[0]))
        if isinstance(closure, Glass | Refraction):
            ior = np.maximum(np.atleast_1d(self._evaluate(closure.ior, points)), 1e-5)
            eta = np.where(points.backfacing, 1.0 / ior, ior)
            return SmoothDielectric(wo, eta, isinstance(closure, Glass)), self._color(weight, closure, points)
        raise TypeError(type(closure))

    def _glossy(self, closure: Glossy, points: SurfacePoints, wo: np.ndarray, t: np.ndarray, s: np.ndarray) -> Lobe:
        alpha = np.clip(self._evaluate(closure.roughness, points), 0.0, 1.0) ** 2
        anisotropy = np.clip(self._evaluate(closure.anisotropy, points), -0.99, 0.99)
        isotropic = not np.any(np.abs(anisotropy) > 1e-4)
        alpha_x, alpha_y = (alpha, alpha) if isotropic else anisotropic_alpha(alpha, anisotropy)
        if np.all(alpha_x * alpha_y <= MIRROR_ALPHA_PRODUCT):
            return Mirror(wo)
        floor = np.sqrt(MIRROR_ALPHA_PRODUCT)  # where a texture reaches zero roughness
        alpha_x, alpha_y = np.maximum(alpha_x, floor), np.maximum(alpha_y, floor)
        distribution = beckmann if closure.distribution == "BECKMANN" else ggx
        how = (distribution, self._options.masking, self._options.strategy)
        if isotropic:
            lobe = MicrofacetReflection(wo, alpha_x, alpha_y, *how)
        else:
            tangent, _ = points.tangent(closure.tangent, self._evaluate(closure.rotation, points))
            cos, sin = dot(tangent, t), dot(tangent, s)
            lobe = Rotated(MicrofacetReflection(rotate_in(wo, cos, sin), alpha_x, alpha_y, *how), cos, sin)
        if closure.distribution != "MULTI_GGX":
            return lobe
        color = np.clip(self._evaluate(closure.color, points), 0.0, 1.0)
        return Compensated(lobe, multiple_scattering(wo[2], np.sqrt(alpha_x * alpha_y), color))


def anisotropic_alpha(alpha: np.ndarray, anisotropy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """alpha_x and alpha_y of Blender's Glossy BSDF, each at most 1 (Cycles, svm_closure)."""
    stretch = np.where(anisotropy < 0.0, 1.0 / (1.0 + anisotropy), 1.0 - anisotropy)
    return np.minimum(alpha * stretch, 1.0), np.minimum(alpha / stretch, 1.0)
