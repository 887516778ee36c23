# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as they are stored, with the encoding that says how to read them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Image:
    """Pixels (height, width, 4), float32, row 0 at the bottom.

    Alpha is straight (not multiplied in) unless `multiplied`.
    `encoding`: 'SRGB' (code values in 0..1, to be decoded), 'LINEAR' (linear Rec. 709) or 'DATA' (numbers, never
    decoded). Where `multiplied`, colours are stored times alpha (code values times alpha), and a colour may be left
    where alpha is 0.
    """

    name: str
    pixels: np.ndarray
    encoding: str
    multiplied: bool = field(default=False, kw_only=True)
