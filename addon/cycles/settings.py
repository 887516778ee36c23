# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles with its user's settings, and with its denoiser.

They trade error for time, and are measured beside the least biased state.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import bpy

from ...lib.cost.ways import Bias, Way
from ...lib.errors import EtalonError
from ...lib.film.rendering import Rendering
from .neutral import SEQUENCE, Changes
from .renderer import CHUNK, CyclesRenderer

# What a user trades for time or noise. All else, such as the pixel filter, says which image is wanted and stays neutral.
TRADED = (
    "use_adaptive_sampling",
    "sampling_pattern",
    "scrambling_distance",
    "auto_scrambling_distance",
    "max_bounces",
    "diffuse_bounces",
    "glossy_bounces",
    "transmission_bounces",
    "transparent_max_bounces",
    "sample_clamp_direct",
    "sample_clamp_indirect",
    "blur_glossy",
    "caustics_reflective",
    "caustics_refractive",
    "use_guiding",
    "use_fast_gi",
)


def traded(scene: bpy.types.Scene) -> dict[str, Any]:
    """The user's values of TRADED, as far as this Blender has them.

    Read them before `neutral` holds the scene.
    """
    return {name: getattr(scene.cycles, name) for name in TRADED if hasattr(scene.cycles, name)}


# A property of one datablock and the value that it is to have.
Assignment = tuple[Any, str, Any]


class CyclesWith(CyclesRenderer):
    """Cycles in its neutral state, except for some properties.

    They are `values` of `scene.cycles` and `others` of any data. Each replicate is one render call, as a user's is.
    Adaptive sampling may take fewer samples than requested. Raises EtalonError for a denoiser that does not exist.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        values: dict[str, Any],
        *,
        seed: int,
        threads: int,
        others: Sequence[Assignment] = (),
    ) -> None:
        if values.get("use_denoising") and not denoiser_is_there():
            raise EtalonError("this Blender was built without Open Image Denoise; use one from blender.org")
        super().__init__(scene, seed=seed, threads=threads)
        self._assignments = [*((scene.cycles, name, value) for name, value in values.items()), *others]
        self._samples = 1
        self.settings |= {f"cycles.{name}": value for name, value in values.items()}

    def render(self, replicate: int, samples: int, *how: Any) -> Rendering:
        """As CyclesRenderer."""
        self._samples = samples
        return super().render(replicate, samples, *how)

    @contextmanager
    def _state(self) -> Iterator[None]:
        with super()._state():
            cycles, changes = self.scene.cycles, Changes()
            try:
                for owner, name, value in self._assignments:
                    changes.set(owner, name, value)
                if cycles.use_adaptive_sampling and hasattr(cycles, "sample_subset_length"):
                    # Cycles makes the threshold stricter where it renders a part of the sequence only, as if others followed.
                    whole = noise_threshold(cycles.adaptive_threshold) * math.sqrt(SEQUENCE / self._samples)
                    changes.set(cycles, "adaptive_threshold", min(whole, 1.0))
                yield
            finally:
                changes.undo()

    def _per_call(self, pixels: int) -> int:
        return CHUNK


def noise_threshold(value: float) -> float:
    """Adaptive sampling's threshold; 0 stands for Cycles' own choice, at many samples."""
    return value or 0.001


def denoiser_is_there() -> bool:
    """Without it Cycles renders as if the denoiser were off."""
    import _cycles

    return bool(_cycles.with_openimagedenoise)


def cycles_ways(scene: bpy.types.Scene, users: dict[str, Any], seed: int, threads: int, opening: float) -> list[Way]:
    """Cycles in its least biased state and at the user's values, with or without denoiser.

    The user's values come from `traded`. What the denoiser, the noise threshold of adaptive sampling and clamping do
    to an error is only known where it is measured.
    """
    denoised = {"use_denoising": True}
    rungs: tuple[tuple[str, str, dict[str, Any], Bias], ...] = (
        ("cycles", "Cycles, least biased", {}, Bias.FLOOR),
        ("cycles-denoised", "Cycles, least biased, denoised", denoised, Bias.UNKNOWN),
        ("cycles-user", "Cycles, the file's settings", users, Bias.UNKNOWN),
        ("cycles-user-denoised", "Cycles, the file's settings, denoised", users | denoised, Bias.UNKNOWN),
    )
    ways = []
    for key, label, values, bias in rungs:

        def make(values: dict[str, Any] = values) -> CyclesRenderer:
            if not values:
                return CyclesRenderer(scene, seed=seed, threads=threads)
            return CyclesWith(scene, values, seed=seed, threads=threads)

        ways.append(Way(key, label, "Cycles", make, bias, None, opening))
    return ways
