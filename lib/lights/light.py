# SPDX-License-Identifier: GPL-3.0-or-later
"""What every kind of light offers to the integrator."""

from __future__ import annotations

from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from ..sampling.warps import uniform_disk
from ..vectors import dot, orthonormal_basis
from .cells import Parts

Pair = tuple[np.ndarray, np.ndarray]
"""Two uniforms (n,) for each ray."""


class LightSample(NamedTuple):
    """Directions towards a light, one for each point.

    wi (3, n) unit vectors; distance (n,) metres, inf for suns and worlds; radiance (3, n), W m^-2 sr^-1, zero where the light
    does not reach the point; pdf (n,) per steradian, always positive and finite. For a delta light pdf is 1 and
    radiance is what a surface facing the light receives, W m^-2.
    """

    wi: np.ndarray
    distance: np.ndarray
    radiance: np.ndarray
    pdf: np.ndarray


class Ball(NamedTuple):
    """A ball that holds what is to be lit.

    It has its `center` (3, 1), its `radius`, and the distance `away` at which rays from afar begin, in metres.
    """

    center: np.ndarray
    radius: float
    away: float


class Emitted(NamedTuple):
    """Rays that leave a light, for light tracing.

    origin, direction (3, n); weight (3, n), W: radiance times cosine over the densities of place and direction, so that its mean is the
    light's flux (of distant lights the flux through the ball's cross-section). brightness (n,): luminance of the radiance that a ray which
    meets the light there finds, inf for a light that no ray can meet.
    """

    origin: np.ndarray
    direction: np.ndarray
    weight: np.ndarray
    brightness: np.ndarray


class Emitter(Protocol):
    """What rays can start from.

    `power`: luminance of the flux it sends into the scene, W; it only steers which light is chosen.
    """

    power: float

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Return rays that leave the light; `ball` holds what is to be lit.

        The place and the direction are sampled by two uniforms (n,) each.
        """
        ...


@runtime_checkable
class Aimable(Emitter, Protocol):
    """A light in a place of its own, whose rays can be aimed."""

    @property
    def extent(self) -> Ball:
        """A ball about the light."""
        ...

    def emit_along(self, direction: np.ndarray, density: np.ndarray, place: Pair) -> Emitted:
        """Return rays of given directions (3, n), their place sampled by two uniforms.

        The directions were sampled with `density` (n,) per steradian.
        """
        ...


class LightSampler(Emitter, Protocol):
    """One light, ready to be sampled.

    `delta`: no ray meets it. `flux` (3,), W, not negative, is what `power` is the luminance of.
    """

    delta: bool
    flux: np.ndarray

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """Choose a direction from each `point` (3, n) towards the light by two uniforms in [0, 1)."""
        ...


@runtime_checkable
class Divided(LightSampler, Protocol):
    """A light of several parts, which can be chosen by the place that they are to light."""

    @property
    def parts(self) -> Parts:
        """The parts, none without power."""
        ...

    def sample_from(self, cell: np.ndarray, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """As `sample`, of parts that are chosen by the chances of the cells (n,)."""
        ...


@runtime_checkable
class Meetable(LightSampler, Protocol):
    """A light in a place of its own that rays meet by themselves."""

    def candidates(self, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Return the indices of all rays that may meet the light, and of few others.

        It is a cheap test before `intersect`.
        """
        ...

    def intersect(self, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the distance (n,) along unit `direction` (3, n), and the radiance met there.

        The distance is inf where the light is missed. The radiance is (3, n).
        """
        ...

    def pdf(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """Return the density per steradian with which `sample` returns a direction.

        It is that of a direction in which `intersect` met the light at `distance`; 0 elsewhere.
        """
        ...


def power_of(flux: np.ndarray) -> float:
    """Return the luminance, W, of a `flux` (3,), W."""
    return float(luminance(flux))


def bounding_ball(vertices: np.ndarray) -> Ball:
    """Return the ball about the middle of the bounds that holds all vertices (3, v).

    It is larger by a millionth. Rays from afar begin at its edge.
    """
    if vertices.shape[1] == 0:
        return Ball(np.zeros((3, 1)), 0.0, 0.0)
    center = 0.5 * (vertices.min(axis=1) + vertices.max(axis=1))[:, None]
    radius = (1.0 + 1e-6) * float(np.sqrt(np.square(vertices - center).sum(axis=0).max()))
    return Ball(center, radius, radius)


def emit_distant(sample: LightSample, ball: Ball, place: Pair) -> Emitted:
    """Return rays against the sampled directions.

    They are uniform over the disc that covers the ball and faces the directions.
    """
    x, y = uniform_disk(*place)
    t, s = orthonormal_basis(sample.wi)
    origin = ball.center + ball.radius * (t * x + s * y) + ball.away * sample.wi
    weight = sample.radiance * (np.pi * ball.radius**2 / sample.pdf)
    return Emitted(origin, -sample.wi, weight, luminance(sample.radiance))


def aimed_at_ball(center: np.ndarray, radius2: float, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Return the indices of the rays, (3, n) each, that pass through a ball or nearly do.

    They have max(0, o.d)^2 >= |o|^2 - r^2, with o from origin to center.

    The difference cancels for what is far and small; a millionth of a millionth of |o|^2 more than covers that.
    """
    offset = center - origin
    along = dot(offset, direction)
    np.clip(along, 0.0, None, out=along)
    along *= along
    beyond = dot(offset, offset)
    beyond *= 1.0 - 1e-12
    beyond -= radius2 * (1.0 + 1e-12)
    return np.flatnonzero(along >= beyond)


def luminance(color: np.ndarray) -> np.ndarray:
    """Luminance of colours (3, ...), linear Rec. 709."""
    return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2]


def column(vector: tuple[float, float, float]) -> np.ndarray:
    """A vector of three as a column (3, 1), to stand beside arrays (3, n)."""
    return np.array(vector, float).reshape(3, 1)
