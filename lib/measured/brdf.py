# SPDX-License-Identifier: GPL-3.0-or-later
"""What the rest asks of a measured BRDF, and the checks that all files share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path

import numpy as np

from ..errors import EtalonError
from ..plural import plural


class MeasuredBrdf(ABC):
    """A BRDF that is a table.

    `isotropic` says that it depends on the azimuths' difference alone.
    """

    isotropic: bool

    @abstractmethod
    def evaluate(self, wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
        """Return f |n.wi|, linear Rec. 709, (3, n), for unit directions (3, n) in the local frame.

        Zero where one of the two lies below the horizon; NaN where the file has no measurement.
        """


def require_numbers(path: Path, what: str, values: np.ndarray) -> None:
    """Raise EtalonError where `values` are not finite or are negative."""
    missing = int(np.count_nonzero(~np.isfinite(values)))
    if missing:
        raise EtalonError(f"{path}: {plural(missing, 'value')} of {what} not finite; fetch the file again")
    negative = int(np.count_nonzero(values < 0.0))
    if negative:
        raise EtalonError(f"{path}: {plural(negative, 'value')} of {what} negative; a BRDF has none")
