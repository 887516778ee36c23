# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's view transform (Standard, AgX, Filmic, ...).

OpenColorIO inside OpenImageIO applies it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO

from ..errors import EtalonError

# The display of the pages, whatever the user's is; and the space of all radiance here.
DISPLAY, LINEAR = "sRGB", "Linear Rec.709"


@dataclass(frozen=True)
class ViewTransform:
    """How a scene wants its linear images shown.

    `config` is an OpenColorIO configuration that has the view `view` for an sRGB display and, unless it is empty, the `look`. `exposure` is in
    stops; the code values are raised to 1 / `gamma`. `omitted` names settings of the scene that are not applied.
    """

    config: Path
    view: str
    look: str = ""
    exposure: float = 0.0
    gamma: float = 1.0
    omitted: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The view and, where there is one, the look, as Blender calls them."""
        return f"{self.view}, {self.look}" if self.look else self.view

    def apply(self, radiance: np.ndarray) -> np.ndarray:
        """Return code values, uint8, of radiance (height, width, 3) in linear Rec. 709.

        Pixels that are not finite are black.

        Raises EtalonError where the configuration lacks the view or the look.
        """
        height, width, _ = radiance.shape
        finite = np.isfinite(radiance).all(axis=2, keepdims=True)
        source = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(width, height, 3, "float"))
        scaled = np.where(finite, radiance, 0.0) * 2.0**self.exposure
        source.set_pixels(OpenImageIO.ROI(), scaled.astype(np.float32))
        config = str(self.config)
        if self.look:  # by itself, since OpenImageIO 3.0 ignores the look of a display
            source = OpenImageIO.ImageBufAlgo.ociolook(source, self.look, LINEAR, LINEAR, False, False, "", "", config)
        shown = OpenImageIO.ImageBufAlgo.ociodisplay(
            source, DISPLAY, self.view, LINEAR, "", False, False, "", "", config
        )
        for step in (source, shown):
            if step.has_error:
                raise EtalonError(f"view transform '{self.name}' cannot be applied ({step.geterror().strip()})")
        codes = np.clip(shown.get_pixels(OpenImageIO.FLOAT), 0.0, 1.0) ** (1.0 / self.gamma)
        return np.rint(255 * codes).astype(np.uint8)
