# SPDX-License-Identifier: GPL-3.0-or-later
"""The data that a fit is made from.

They are a measured BRDF, read without Blender, or a .blend file, which is opened for Cycles to render its sphere.
"""

from __future__ import annotations

from pathlib import Path

from ...lib.errors import EtalonError
from ...lib.fit.measured import observe_brdf
from ...lib.fit.observations import Observations
from ...lib.progress import Progress
from ...lib.settings.fit import FitSettings
from .scene_choice import describe_missing


def observe_file(path: Path, settings: FitSettings, progress: Progress) -> Observations:
    """Observations of a MERL, RGL or .blend file; raises EtalonError or Refused."""
    if not path.is_file():
        raise EtalonError(describe_missing(path))
    if path.suffix.lower() != ".blend":
        if settings.object is not None:
            raise EtalonError(f"--object {settings.object}: {path} has no objects; give a .blend file, or leave it out")
        progress.begin("reading")
        return observe_brdf(path, settings.noise)
    from ..host.blender import load_blender

    bpy = load_blender()
    from ..sphere import observe_sphere
    from .opening import open_target

    open_target(str(path))
    return observe_sphere(bpy.context.scene, settings, progress, str(path))
