# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: one emitter for each path, and the ray that leaves it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..lights.by_place import chances_by_power
from ..lights.light import Aimable, Ball, Emitted, Emitter, LightSample, Pair, emit_distant, luminance
from ..sampling.tables import Distribution1D
from ..sampling.warps import uniform_sphere
from ..wavefront.kernel import Kernel
from .aim import Aim

# Above this solid angle, in steradians, a light's own distribution of directions serves as well as aiming.
WIDEST_AIM = np.pi


class ConstantSky:
    """A world of one radiance (3, 1); every direction is as likely."""

    def __init__(self, radiance: np.ndarray, ball: Ball) -> None:
        self._radiance = radiance
        self.power = 4.0 * np.pi**2 * ball.radius**2 * float(luminance(np.abs(radiance))[0])

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Through the ball, from everywhere."""
        wi = uniform_sphere(*heading)
        density = np.full(wi.shape[1], 1.0 / (4.0 * np.pi))
        radiance = np.broadcast_to(self._radiance, wi.shape)
        return emit_distant(LightSample(wi, np.full(wi.shape[1], np.inf), radiance, density), ball, place)


class _Aimed:
    """A light whose rays are aimed at targets."""

    def __init__(self, light: Aimable, aim: Aim) -> None:
        self._light, self._aim = light, aim
        self.power = light.power * aim.solid_angle / (4.0 * np.pi)

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Towards the targets."""
        direction, density = self._aim.sample(heading)
        return self._light.emit_along(direction, density, place)


class Emitters:
    """All that shines on a `ball`, chosen by power: `emitters` of `power` (k,), not all 0."""

    def __init__(self, ball: Ball, emitters: Sequence[Emitter], power: np.ndarray) -> None:
        self._ball, self._emitters = ball, emitters
        self._choice = Distribution1D(chances_by_power(power[:, None]))

    def emit(self, choice: np.ndarray, place: Pair, heading: Pair) -> Emitted:
        """Return the ray (n,) of each path.

        `choice` (n,) picks the emitter, whose chance divides the weight.
        """
        index = self._choice.index(choice)
        count = choice.size
        whole = Emitted(np.empty((3, count)), np.empty((3, count)), np.empty((3, count)), np.empty(count))
        for k in np.unique(index):
            at = np.flatnonzero(index == k)
            emitted = self._emitters[k].emit(self._ball, *((u[at], v[at]) for u, v in (place, heading)))
            for array, part in zip(whole, emitted, strict=True):
                array[..., at] = part
            whole.weight[:, at] /= self._choice.probability[k]
        return whole


def gather_emitters(kernel: Kernel, ball: Ball, with_sky: bool, targets: Sequence[Ball] = ()) -> Emitters | None:
    """All that shines on a `ball`; None where nothing does.

    `with_sky`: a constant world is among it. With `targets` only light that may reach one of those balls is wanted: rays are aimed at
    them where the light has a place of its own, and lights are chosen by what they send there, roughly.
    """
    emitters: list[Emitter] = [_aim(light, targets) for light in kernel.lights]
    if with_sky and kernel.sky is not None:
        emitters.append(ConstantSky(kernel.sky, ball))
    from_afar = (ball.radius / max(kernel.caster.radius, 1e-300)) ** 2
    power = np.array([_power(emitter, from_afar) for emitter in emitters])
    return Emitters(ball, emitters, power) if power.any() else None


def _aim(light: Emitter, targets: Sequence[Ball]) -> Emitter:
    """Return the light with its rays aimed at the targets.

    It is the light itself where there are no targets, or where they fill more of its view than aiming is worth.
    """
    if not targets or not isinstance(light, Aimable):
        return light
    aim = Aim(light.extent, targets)
    return _Aimed(light, aim) if aim.solid_angle < WIDEST_AIM else light


def _power(emitter: Emitter, from_afar: float) -> float:
    """Estimate the power that a light sends to the ball or to the targets.

    Suns and worlds have it for a ball whose area is less by `from_afar`.
    """
    return emitter.power if isinstance(emitter, Aimable | ConstantSky | _Aimed) else emitter.power * from_afar
