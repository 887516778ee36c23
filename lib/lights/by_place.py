# SPDX-License-Identifier: GPL-3.0-or-later
"""The chances of lights, and of their parts, by the place that they are to light: a table with a row for each cell."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..sampling.tables import Rows
from .cells import Cells, Parts, Places
from .falling_off import FallingOff
from .light import Aimable, Divided, LightSampler, power_of

EVEN_SHARE = 1.0 / 16.0
"""What all lights that shine share evenly, whatever their power and place."""
NEAR_SHARE = 3.0 / 4.0
"""What of the rest goes by the light that a place can expect, and not by power alone."""
TOLD_APART = 0.1
"""Lights of which parts arrive that differ by less are alike: no grid is made for that."""
LEAST_GAIN = 1.5
"""Parts are chosen by place where a choice by power alone has at least so many times the second moment."""


def shares_of(flux: np.ndarray) -> np.ndarray:
    """Return the share (..., k) that each of k lights has of their `flux` (..., k, c), not negative.

    It is the mean over the channels in which any light shines: a verdict is about every channel, and a dim red lamp among bright green
    ones may be all of the red light. 0 where nothing shines.
    """
    total = flux.sum(axis=-2, keepdims=True)
    share = np.divide(flux, total, out=np.zeros(flux.shape), where=total > 0.0)
    return share.sum(axis=-1) / np.maximum((total > 0.0).sum(axis=-1), 1)


def chances_by_power(flux: np.ndarray) -> np.ndarray:
    """Return the chances (k,) of lights of `flux` (k, c), by `shares_of` it but for EVEN_SHARE.

    All lights that shine have an equal part of EVEN_SHARE.

    A lamp in a closed room is all of its light, however bright the sun outside is. By this defensive mixture
    (Hesterberg 1995) no sample weighs more than 1 / EVEN_SHARE times what it would by even chances. All 0 where
    nothing shines.
    """
    shines = flux.any(axis=1)
    return (1.0 - EVEN_SHARE) * shares_of(flux) + EVEN_SHARE * shines / max(shines.sum(), 1)


def chances_by_place(flux: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Return the chances (n, k) of lights in n cells, by the light that each cell can expect.

    `flux` (k, c); `expected` (n, k, c), not negative, 0 where the flux is. As `chances_by_power`, but NEAR_SHARE of what goes by power
    there goes by what is expected. The rest bounds what a sample weighs where walls hide the near lights.
    """
    by_power, near = _shares(flux, expected)
    return chances_by_power(flux) + (1.0 - EVEN_SHARE) * NEAR_SHARE * (near - by_power)


def _shares(flux: np.ndarray, expected: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each light's share (k,) of the flux, and (n, k) of what is expected; of the flux, too, where nothing is."""
    by_power, near = shares_of(flux), shares_of(expected)
    return by_power, np.where(near.any(axis=1, keepdims=True), near, by_power)


class PartChances:
    """Chances of the parts of one light in the cells of a grid, NEAR_SHARE of them by the light that a cell can expect.

    `power` (g,) of the parts, none 0; `expected` (c, g). The row after the last cell goes by power alone. `gain`: the second moment of
    what a sample brings by power alone, over that of one by what is expected, where parts hide nothing; the mean over the cells.
    """

    def __init__(self, power: np.ndarray, expected: np.ndarray) -> None:
        self._by_power, near = _shares(power[:, None], expected[..., None])
        self.gain = float((np.square(near) / self._by_power).sum(axis=1).mean())
        mixed = self._by_power + NEAR_SHARE * (near - self._by_power)
        self._rows = Rows(np.vstack([mixed, self._by_power]))
        self._over_power = self._rows.probability / np.maximum(self._by_power, 1e-300)

    def gain_at(self, expected: np.ndarray, cell: np.ndarray) -> float:
        """The gain by these chances at places in the cells (n,) that receive `expected` (n, g) of the parts.

        Its geometric mean, weighted by what they receive in all. The twentieth of them that receives most, such as what is
        behind a panel on a ceiling, counts alike.
        """
        share = np.square(_shares(self._by_power[:, None], expected[..., None])[1])
        received = expected.sum(axis=1)
        received = np.minimum(received, np.quantile(received, 0.95))
        by_power, by_place = (share / one for one in (np.maximum(self._by_power, 1e-300), self._rows.probability[cell]))
        gain = np.log(np.maximum(by_power.sum(axis=1), 1e-300) / np.maximum(by_place.sum(axis=1), 1e-300))
        return float(np.exp((received @ gain) / max(received.sum(), 1e-300)))

    def choose(self, cell: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the parts (n,) that uniforms `u` (n,) choose in the cells (n,), and the rest of `u`."""
        return self._rows.sample(cell, u)

    def over_power(self, part: np.ndarray, cell: np.ndarray) -> np.ndarray:
        """Probability (n,) of parts (n,) in the cells (n,), over their shares of the power."""
        return self._over_power[cell, part]


class LightGrid:
    """Chances of lights, and of their parts, in the cells of a grid over the part of the scene about the lights.

    `samplers`: at least one. `bounds` (2, 3): least and greatest coordinates of what is to be lit, metres. `radius`, metres: the scene's,
    as that of suns and worlds. `places` on what is to be lit, where they are known. The row `cells.everywhere` has chances that
    go by power alone. `useful`: whether the cells' chances of lights differ. `within` has the PartChances of samplers, by number, and
    what is gained by them at `places`, for those whose cells differ.

    What a cell expects of a light with a place is in `Cells.expect`, whatever its falloff, of a sun or a world its power over
    `radius`^2. Both are irradiance, but for a factor of pi. `arrives` (k,) is the part of a light that nothing hides; by default all.
    """

    def __init__(
        self,
        samplers: Sequence[LightSampler],
        bounds: np.ndarray,
        radius: float,
        places: Places | None = None,
        arrives: np.ndarray | None = None,
    ) -> None:
        flux, parts = _read(samplers)
        self._key = _key(flux, parts, bounds, radius, places, arrives)
        centers = np.hstack([one.center for one in parts.values()]) if parts else np.zeros((3, 1))
        self.cells = Cells(centers, bounds, len(parts))
        expected = np.empty((self.cells.everywhere, *flux.shape))
        expected[:] = flux / max(radius, 1e-150) ** 2
        self.within: dict[int, tuple[PartChances, float]] = {}
        for k, one in parts.items():
            of_parts = self.cells.expect(one)
            expected[:, k] = of_parts.sum(axis=1)[:, None] * (flux[k] / power_of(flux[k]))
            if one.power.size > 1 and self.cells.everywhere > 1 and places is not None:
                chances = PartChances(one.power, of_parts)
                gain = chances.gain_at(places.expect(one), self.cells.number(places.position))
                if max(chances.gain, gain) > LEAST_GAIN:
                    self.within[k] = chances, gain
        differs = self.cells.everywhere > 1 and any(not one.everywhere_alike for one in parts.values())
        if arrives is not None:
            expected *= arrives[:, None]
            # Black lights, which a plan may keep, tell nothing.
            shining = arrives[flux.any(axis=1)]
            differs |= shining.size > 1 and bool(np.ptp(shining) > TOLD_APART)
        self.useful = len(flux) > 1 and differs
        self._rows = Rows(np.vstack([chances_by_place(flux, expected), chances_by_power(flux)]))
        self._probability = self._rows.probability

    def is_of(
        self,
        samplers: Sequence[LightSampler],
        bounds: np.ndarray,
        radius: float,
        places: Places | None = None,
        arrives: np.ndarray | None = None,
    ) -> bool:
        """Whether a grid that is made of these would be the same."""
        return self._key == _key(*_read(samplers), bounds, radius, places, arrives)

    def choose(self, cell: np.ndarray, u: np.ndarray) -> np.ndarray:
        """The lights (n,) that the uniforms `u` (n,) choose in the cells (n,)."""
        return self._rows.sample(cell, u)[0]

    def probability(self, light: np.ndarray | int, cell: np.ndarray) -> np.ndarray:
        """Probability (n,) with which `choose` gives `light`, () or (n,), in the cells (n,)."""
        return self._probability[cell, light]


def _read(samplers: Sequence[LightSampler]) -> tuple[np.ndarray, dict[int, Parts]]:
    """The flux (k, 3) of lights over the greatest power, and the parts of those that shine and have places, by number."""
    power = np.array([sampler.power for sampler in samplers])
    greatest = max(float(power.max()), 1e-300)
    power, flux = power / greatest, np.array([sampler.flux for sampler in samplers]) / greatest
    parts = {}
    for k, sampler in enumerate(samplers):
        if power[k] > 0.0 and isinstance(sampler, Divided):
            share = sampler.parts.power / sampler.parts.power.sum()
            parts[k] = sampler.parts._replace(power=power[k] * share)
        elif power[k] > 0.0 and isinstance(sampler, FallingOff) and sampler.part is not None:
            parts[k] = sampler.part._replace(power=sampler.part.power / greatest)
        elif power[k] > 0.0 and isinstance(sampler, Aimable):
            parts[k] = Parts(power[k : k + 1], sampler.extent.center, np.array([sampler.extent.radius]))
    return flux, parts


def _key(
    flux: np.ndarray,
    parts: dict[int, Parts],
    bounds: np.ndarray,
    radius: float,
    places: Places | None,
    arrives: np.ndarray | None,
) -> tuple[object, ...]:
    """What a grid depends on, to be compared."""
    balls = tuple((k, *(array.tobytes() for array in one[:3]), one.falloff) for k, one in parts.items())
    given = (None if places is None else places.position), arrives
    return flux.tobytes(), balls, bounds.tobytes(), radius, *(None if one is None else one.tobytes() for one in given)
