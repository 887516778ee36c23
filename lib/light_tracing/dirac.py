# SPDX-License-Identifier: GPL-3.0-or-later
"""Which closures may scatter into single directions, which no connection finds."""

from __future__ import annotations

from ..scene.expressions import Constant
from ..scene.materials import Closure, Glass, Microfacets, Refraction

# Generous against the limits below which lobes are built as mirrors: alpha^2 of 2e-10, an index within 1e-4 of 1.
_LEAST_ROUGHNESS, _LEAST_CONTRAST = 0.01, 1e-3


def may_be_dirac(closure: Closure) -> bool:
    """Whether a closure is smooth anywhere, or bends nothing; True where a texture decides."""
    if not isinstance(closure, Microfacets) or closure.distribution == "ASHIKHMIN_SHIRLEY":
        return False
    if not isinstance(closure.roughness, Constant) or closure.roughness.number < _LEAST_ROUGHNESS:
        return True
    if not isinstance(closure, Glass | Refraction):
        return False
    return not isinstance(closure.ior, Constant) or abs(closure.ior.number - 1.0) < _LEAST_CONTRAST


def varies(closure: Closure) -> bool:
    """Whether the roughness of a glossy closure depends on the place."""
    return isinstance(closure, Microfacets) and not isinstance(closure.roughness, Constant)
