# SPDX-License-Identifier: GPL-3.0-or-later
"""The candidates of a fit.

Each is a distribution, a masking and a Fresnel term, with their parameters. Colour c of f |n.wi| is
d_c (n.wi) / pi + M F_c, M the white microfacet lobe. d and, for most terms, F are linear in their parameters and are
solved for; alpha, the anisotropy, 1/g and the indices of metals are searched.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..bsdfs.microfacet import MicrofacetReflection
from ..microfacets import fresnel
from ..microfacets.albedo import directional_albedo
from ..microfacets.beckmann import Beckmann
from ..microfacets.distribution import Alpha, Distribution
from ..microfacets.ggx import GGX
from ..microfacets.student_t import StudentT
from .observations import Observations

DISTRIBUTIONS = ("beckmann", "ggx", "student-t")
MASKINGS = ("correlated", "separable", "torrance_sparrow")
FRESNELS = ("none", "schlick", "exact")
MULTI_GGX = "multi-ggx"
"""Blender's Multiscatter GGX: correlated masking and no Fresnel term, so one candidate alone."""
LEAST_ALPHA, LARGEST_ALPHA = 1e-3, 1.0
LEAST_INVERSE, LARGEST_INVERSE = 1e-4, 0.66
LARGEST_RATIO = 10.0
_TABLE_PAYS = 60_000


class ExactStudentT(StudentT):
    """Student-t distribution without a table, which would be used for one call."""

    def smith_lambda(self, w: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """Smith's Lambda(w) by the incomplete beta function, (n,)."""
        return self.smith_lambda_by_beta(w, alpha_x, alpha_y)


@dataclass(frozen=True)
class Candidate:
    """One model: names of its distribution, masking and Fresnel term.

    `anisotropic` gives it two alphas, along x and y.
    """

    distribution: str
    masking: str
    fresnel: str
    anisotropic: bool

    @property
    def names(self) -> tuple[str, ...]:
        """The searched parameters of its shape, in order."""
        shape = ("alpha", "anisotropy") if self.anisotropic else ("alpha",)
        return shape + (("1/g",) if self.distribution == "student-t" else ())

    def parameters(self, colors: int) -> int:
        """How many parameters are free.

        They are the diffuse albedo and reflectance of each colour, and those of the lobe's shape.
        """
        return len(self.names) + colors * (2 if self.fresnel != "exact" and self.distribution != MULTI_GGX else 3)

    def bounds(self, colors: int) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds of the searched vector.

        It holds log alpha, log ratio, 1/g, then log ior and log k of each colour.
        """
        limits = {
            "alpha": (np.log(LEAST_ALPHA), np.log(LARGEST_ALPHA)),
            "anisotropy": (-np.log(LARGEST_RATIO), np.log(LARGEST_RATIO)),
            "1/g": (LEAST_INVERSE, LARGEST_INVERSE),
        }
        pairs = [limits[name] for name in self.names]
        if self.fresnel == "exact":
            pairs += [(np.log(0.02), np.log(20.0)), (np.log(1e-3), np.log(20.0))] * colors
        low, high = zip(*pairs, strict=True)
        return np.array(low), np.array(high)

    def named(self, vector: np.ndarray) -> dict[str, float]:
        """The shape's parameters of a searched vector in their own units.

        The anisotropy is alpha_x / alpha_y.
        """
        found = dict(zip(self.names, map(float, vector), strict=False))
        return {name: value if name == "1/g" else float(np.exp(value)) for name, value in found.items()}

    def lobe(self, seen: Observations, vector: np.ndarray) -> np.ndarray:
        """The white lobe M = D G / (4 n.wo) at all directions, (m,)."""
        shape = dict(zip(self.names, vector, strict=False))
        alpha, ratio = np.exp(shape["alpha"]), np.exp(0.5 * shape.get("anisotropy", 0.0))
        distribution = _distribution(self.distribution, shape.get("1/g", 0.5), seen.wi.shape[1])
        lobe = MicrofacetReflection(seen.wo, alpha * ratio, alpha / ratio, distribution, self.masking, "uniform")
        return lobe.evaluate(seen.wi)[0][0]


def _distribution(name: str, inverse: float, directions: int) -> Distribution:
    if name == "beckmann":
        return Beckmann()
    if name in ("ggx", MULTI_GGX):
        return GGX()
    return StudentT(1.0 / inverse) if directions > _TABLE_PAYS else ExactStudentT(1.0 / inverse)


def design(
    candidate: Candidate, seen: Observations, vector: np.ndarray, lobe: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The linear columns (c, k, n) and the fixed part (c, n) for each colour.

    The first column is the diffuse one, the second, if any, belongs to the colour (no Fresnel term) or F0 (Schlick).
    The third of Multiscatter GGX is what facets reflect more than once, M (1 - E) / E. Its coefficient is free, since the mean
    over colours of what each gets back is not that of the mean colour. `lobe` is that of `vector`.
    """
    diffuse, white = seen.diffuse, seen.collect(lobe)
    if candidate.fresnel == "exact":
        indices = np.exp(vector[len(candidate.names) :]).reshape(seen.colors, 2)
        metals = [seen.collect(lobe * fresnel.conductor(seen.cosines, ior, k)) for ior, k in indices]
        return np.broadcast_to(diffuse, (seen.colors, 1, len(diffuse))), np.array(metals)
    rise = np.zeros_like(white)
    if candidate.fresnel == "schlick":
        rise = seen.collect(lobe * fresnel.schlick(seen.cosines, 0.0))
    columns = [diffuse, white - rise]
    if candidate.distribution == MULTI_GGX:
        alpha = float(np.exp(vector[candidate.names.index("alpha")]))
        albedo = directional_albedo(np.clip(seen.wo[2], 0.0, 1.0), alpha)
        columns.append(seen.collect(lobe * (1.0 - albedo) / albedo))
    columns = np.stack(columns)
    return np.broadcast_to(columns, (seen.colors, *columns.shape)), np.broadcast_to(rise, (seen.colors, len(rise)))
