# SPDX-License-Identifier: GPL-3.0-or-later
"""The distributions of microfacet normals by the names that closures use."""

from __future__ import annotations

from ..errors import EtalonError
from .beckmann import Beckmann
from .distribution import Distribution
from .ggx import GGX

DISTRIBUTIONS: dict[str, Distribution] = {
    "BECKMANN": Beckmann(),
    "GGX": GGX(),
    "MULTI_GGX": GGX(),
}
"""One row for each name. The light that MULTI_GGX gives back is a factor outside the lobe: `bsdfs.compensated`."""


def distribution_by_name(name: str) -> Distribution:
    """Return the distribution that closures call `name`.

    Raises EtalonError where there is none.
    """
    if name not in DISTRIBUTIONS:
        raise EtalonError(f"unknown microfacet distribution {name!r}; choose one of {', '.join(DISTRIBUTIONS)}")
    return DISTRIBUTIONS[name]
