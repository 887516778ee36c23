# SPDX-License-Identifier: GPL-3.0-or-later
"""What a lobe asks of a distribution of microfacet normals.

A distribution is a frozen dataclass: its fields are the parameters of its shape, the same for all points (GGX and Beckmann have none).
The roughness may differ from point to point, so that alpha_x and alpha_y are arguments: in (0, 1], () or (n,), the documents' sigma,
Blender's roughness squared. Normals and directions are (3, n) in the local frame; uniforms (n,) in [0, 1].
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TypeAlias

import numpy as np

Alpha: TypeAlias = float | np.ndarray


class Distribution(ABC):
    """Distribution of normals that stretches with alpha.

    Its shape at roughness 1 determines it for all roughnesses (Heitz 2014, section 5.3).
    """

    @abstractmethod
    def density(self, m: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """Return D(m), sr^-1, (n,); for `m` of length l D / l^4; zero where m.z <= 0."""

    @abstractmethod
    def smith_lambda(self, w: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """Return Smith's Lambda(w), (n,), of unit `w`; `masking.HIDDEN` where w.z <= 0."""

    @abstractmethod
    def sample_d_cos(self, alpha_x: Alpha, alpha_y: Alpha, u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
        """Sample a normal with density D(m) (m.n), (3, n), z > 0."""

    @abstractmethod
    def sample_visible(
        self,
        wo: np.ndarray,
        alpha_x: Alpha,
        alpha_y: Alpha,
        u1: np.ndarray,
        u2: np.ndarray,
        lambda_o: np.ndarray | None = None,
    ) -> np.ndarray:
        """Sample a normal visible from `wo`, density `densities.pdf_visible`, (3, n), z > 0.

        `wo` unit with wo.z > 0 (others give some valid normal); `lambda_o` is Lambda(wo) where it is known.
        """


class BoundedDistribution(Distribution):
    """Distribution whose visible normals can leave out many that reflect below the horizon."""

    @abstractmethod
    def bound(self, wo: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """Return k, (n,), which is in the density of the reflected direction.

        The density is D(m) / (2 wo.z (k + 1 + 2 Lambda(o))).
        """

    @abstractmethod
    def sample_bounded(
        self,
        wo: np.ndarray,
        alpha_x: Alpha,
        alpha_y: Alpha,
        u1: np.ndarray,
        u2: np.ndarray,
        lambda_o: np.ndarray | None = None,
    ) -> np.ndarray:
        """Sample a visible normal, (3, n), with that density; arguments as for `sample_visible`."""
