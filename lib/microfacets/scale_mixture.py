# SPDX-License-Identifier: GPL-3.0-or-later
"""Distributions of slopes that are mixtures of Beckmann's.

Shifted gamma distributions, and exponential powers.
By Bernstein's theorem every completely monotone function of r^2 is a mixture of Gaussians exp(-s r^2), each of which is
a Beckmann distribution with 1 / sqrt(s) times the roughness. Smith's Lambda is then the mixture of their Lambdas, and a
visible normal chooses a scale by its share of what is visible, then a normal of that Beckmann distribution. D itself is
the closed form.

The integral over s is a sum over even steps of log s, which errs by about exp(-pi^2 / step), 1e-12.
"""

from __future__ import annotations

import functools
import math
from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from ..errors import EtalonError
from ..sampling.tables import LARGEST_UNIFORM
from .beckmann import Beckmann
from .directions import FLOOR, above_horizon, stretched_sine_squared
from .distribution import Alpha, Distribution
from .inverse_tables import MaskingTable
from .masking import HIDDEN

_STEP = 0.28
_LOWEST = -26.0  # of log t: what lies below has the scale of t = 0 to 5e-12
_CELLS = 2048
_SCALE = 0.02


class Components:
    """The Beckmann distributions of a mixture.

    Factors on alpha, `scales` (k,), and their `shares` of all slopes, (k,).
    """

    def __init__(self, scales: np.ndarray, shares: np.ndarray) -> None:
        self.scales, self.shares = scales, shares
        self._cumulative = np.cumsum(shares)
        self.masking = MaskingTable(_SCALE, _CELLS, lambda a: self._masked(a)[:, -1])
        kappa = np.minimum(np.linspace(0.0, 1.0, _CELLS + 1), 1.0 - 1e-4)
        a = self.masking.slope(kappa)
        # Of the components up to each: a + b under the bar keeps it bounded. Read between the nodes by straight lines, to 1e-5.
        self._parts = (self._masked(a) / (a + _SCALE)[:, None]).ravel()

    def _masked(self, a: np.ndarray) -> np.ndarray:
        """Sums of a Lambda(a) by shares over the first components, (m, k)."""
        cot = np.maximum(a, 1e-12)
        w = np.stack([1.0 / np.sqrt(1.0 + cot * cot), np.zeros_like(cot), cot / np.sqrt(1.0 + cot * cot)])
        w, alpha = np.repeat(w, self.scales.size, axis=1), np.tile(self.scales, a.size)
        each = Beckmann().smith_lambda(w, alpha, alpha).reshape(a.size, -1)
        return np.cumsum(each * self.shares * cot[:, None], axis=1)

    def choose(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The scale of a slope, (n,), and what is left of `u`."""
        wanted = u * self._cumulative[-1]
        index = np.minimum(np.searchsorted(self._cumulative, wanted, side="right"), self.scales.size - 1)
        rest = (wanted - (self._cumulative - self.shares)[index]) / self.shares[index]
        return self.scales[index], np.clip(rest, 0.0, LARGEST_UNIFORM)

    def choose_visible(self, sine: np.ndarray, cosine: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The scale of a slope that is seen from a view, (n,), and what is left of `u`.

        Arguments as for `MaskingTable`.
        """
        kappa, end = self.masking.coordinate(sine, cosine)
        at = kappa * _CELLS
        row = np.minimum(at.astype(np.intp), _CELLS - 1)
        at -= row
        row *= self.scales.size
        over = end / cosine

        def up_to(index: np.ndarray) -> np.ndarray:
            """Shares of slopes, and of what masks them, of the components up to `index`."""
            near = self._parts.take(row + index)
            near += at * (self._parts.take(row + index + self.scales.size) - near)
            return self._cumulative.take(index) + over * near

        last = np.full(u.shape, self.scales.size - 1)
        first = np.zeros_like(last)
        wanted = u * up_to(last)
        for _ in range(int(self.scales.size).bit_length()):
            middle = (first + last) >> 1
            beyond = up_to(middle) <= wanted
            first, last = np.where(beyond, np.minimum(middle + 1, last), first), np.where(beyond, last, middle)
        below = np.where(first > 0, up_to(np.maximum(first - 1, 0)), 0.0)
        rest = (wanted - below) / np.maximum(up_to(first) - below, FLOOR)
        return self.scales.take(first), np.clip(rest, 0.0, LARGEST_UNIFORM)


class ScaleMixture(Distribution):
    """A distribution with D = P(s) / (alpha_x alpha_y m.z^4), where P is a mixture.

    s = (m.x^2/alpha_x^2 + m.y^2/alpha_y^2) / m.z^2.
    """

    @abstractmethod
    def slopes(self, s: np.ndarray) -> np.ndarray:
        """Return P22 at roughness 1 of the squared slope `s`, (n,)."""

    @property
    @abstractmethod
    def components(self) -> Components:
        """The mixture that it is, made once for each value of its parameters."""

    def density(self, m: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """D(m), sr^-1, (n,); zero where m.z <= 0.

        `m` (3, n) unit, or of any length l, which gives D / l^4.
        """
        z2 = np.square(np.maximum(m[2], FLOOR))
        d = self.slopes((np.square(m[0] / alpha_x) + np.square(m[1] / alpha_y)) / z2)
        d /= np.square(z2) * (alpha_x * alpha_y)
        return above_horizon(m, d, 0.0)

    def smith_lambda(self, w: np.ndarray, alpha_x: Alpha, alpha_y: Alpha) -> np.ndarray:
        """Smith's Lambda(w), the mixture of Beckmann's, (n,), to 1e-10 of 1 + Lambda.

        `w` (3, n) unit; HIDDEN where w.z <= 0.
        """
        sine = np.sqrt(stretched_sine_squared(w, alpha_x, alpha_y))
        return above_horizon(w, self.components.masking(sine, np.clip(w[2], FLOOR, 1.0)), HIDDEN)

    def sample_d_cos(self, alpha_x: Alpha, alpha_y: Alpha, u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
        """Sample a microfacet normal, (3, n), with density D(m) (m.n).

        It chooses a scale by its share, then a normal of that Beckmann distribution.
        """
        scale, rest = self.components.choose(u2)
        return Beckmann().sample_d_cos(alpha_x * scale, alpha_y * scale, u1, rest)

    def sample_visible(
        self,
        wo: np.ndarray,
        alpha_x: Alpha,
        alpha_y: Alpha,
        u1: np.ndarray,
        u2: np.ndarray,
        lambda_o: np.ndarray | None = None,
    ) -> np.ndarray:
        """Sample a microfacet normal visible from `wo`, (3, n), z > 0.

        It chooses a scale by its share of what is visible, then a visible normal of that Beckmann distribution.
        `wo` (3, n) unit with wo.z > 0 (others give some valid normal); `lambda_o` is not used.
        """
        sine = np.sqrt(stretched_sine_squared(wo, alpha_x, alpha_y))
        scale, rest = self.components.choose_visible(sine, np.clip(wo[2], FLOOR, 1.0), u1)
        return Beckmann().sample_visible(wo, alpha_x * scale, alpha_y * scale, rest, u2)


@dataclass(frozen=True)
class ShiftedGamma(ScaleMixture):
    """Shifted gamma distribution of slopes: Bagher, Soler and Holzschuch 2012.

    P22 = exp(-q) q^-p / (pi Gamma(1 - p, shift)), q = shift + r^2 / alpha^2.
    Their SGD of roughness a is `shift` = a with alpha = sqrt(a): q = a + tan^2 / a. `p` in [0, 2], 0 being Beckmann's,
    `shift` in [1e-4, 10]. Gamma is the upper incomplete gamma function. A mixture since q^-p = 1 / Gamma(p) times the
    integral of t^(p - 1) exp(-t q) over t. Raises EtalonError for a parameter out of range.
    """

    p: float
    shift: float

    def __post_init__(self) -> None:
        _require("p", self.p, 0.0, 2.0)
        _require("shift", self.shift, 1e-4, 10.0)

    def slopes(self, s: np.ndarray) -> np.ndarray:
        """Return exp(-q) q^-p / (pi Gamma(1 - p, shift)) of the squared slope `s`, (n,)."""
        return np.exp(-s) * np.power(1.0 + s / self.shift, -self.p) * _gamma_factor(self.p, self.shift)

    @property
    def components(self) -> Components:
        """The Beckmann distributions with 1 / sqrt(1 + t) times alpha."""
        return _gamma_components(self.p, self.shift)


@dataclass(frozen=True)
class ExponentialPower(ScaleMixture):
    """Exponential power of the slopes; `b` in [0.3, 0.8], b = 1 would be Beckmann's.

    P22 = exp(-(r / alpha)^(2 b)) / (pi alpha_x alpha_y Gamma(1 + 1 / b)).
    A mixture by the positive stable law of exponent b, whose Laplace transform is exp(-x^b). Raises EtalonError for a b
    out of range.
    """

    b: float

    def __post_init__(self) -> None:
        _require("b", self.b, 0.3, 0.8)

    def slopes(self, s: np.ndarray) -> np.ndarray:
        """Return exp(-s^b) / (pi Gamma(1 + 1 / b)) of the squared slope `s`, (n,)."""
        return np.exp(-np.power(s, self.b)) * (1.0 / (math.pi * math.gamma(1.0 + 1.0 / self.b)))

    @property
    def components(self) -> Components:
        """The Beckmann distributions with 1 / sqrt(x) times alpha, x of the stable law."""
        return _stable_components(self.b)


def _require(name: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise EtalonError(f"{name} = {value:g} is out of range; give at least {low:g} and at most {high:g}")


@functools.lru_cache(maxsize=64)
def _gamma_factor(p: float, shift: float) -> float:
    """exp(-shift) shift^-p / (pi Gamma(1 - p, shift)).

    With 50 digits, since SciPy has no such function for p > 1.
    """
    from mpmath import mp

    with mp.workdps(50):
        gamma = mp.gammainc(1 - mp.mpf(p), shift)  # pyright: ignore[reportAttributeAccessIssue]  mpmath adds it when loaded
        return float(mp.exp(-mp.mpf(shift)) * mp.mpf(shift) ** -p / (mp.pi * gamma))


@functools.lru_cache(maxsize=16)
def _gamma_components(p: float, shift: float) -> Components:
    """Shares t^(p - 1) exp(-t shift) / (1 + t) of the scales 1 / sqrt(1 + t).

    With p = 0 there is t = 0 alone.
    """
    if p == 0.0:
        return Components(np.ones(1), np.ones(1))
    log_t = np.arange(_LOWEST, math.log(45.0 / shift), _STEP)
    t = np.exp(log_t)
    shares = np.exp(p * log_t - t * shift) / (1.0 + t)
    below = math.exp(p * (_LOWEST - _STEP)) / -math.expm1(-p * _STEP)
    scales, shares = np.append(1.0, 1.0 / np.sqrt(1.0 + t)), np.append(below, shares)
    return Components(scales, shares / shares.sum())


@functools.lru_cache(maxsize=16)
def _stable_components(b: float) -> Components:
    """Shares f(x) / x of the scales 1 / sqrt(x), f the density of the positive stable law.

    f(x) = c x^-(1 + c) / b times the mean over phi in (0, pi) of A(phi) exp(-A(phi) x^-c), with c = b / (1 - b) and
    A = (sin(b phi) / sin(phi))^(1 / (1 - b)) sin((1 - b) phi) / sin(b phi) (Zolotarev 1986, "One-dimensional stable distributions").
    """
    node, weight = np.polynomial.legendre.leggauss(400)
    phi, weight = 0.5 * np.pi * (1.0 + node), 0.5 * weight
    c = b / (1.0 - b)
    a = np.power(np.sin(b * phi) / np.sin(phi), 1.0 / (1.0 - b)) * np.sin((1.0 - b) * phi) / np.sin(b * phi)
    step = _STEP / max(c, 1.0)  # the narrower the law, the finer
    log_x = np.arange(math.log(_least_stable(b)), 30.0 / (1.0 + b), step)
    argument = a * np.exp(-c * log_x)[:, None]
    density = (argument * np.exp(-argument)) @ weight  # x f(x), up to a factor
    shares = density * np.exp(-log_x)
    kept = shares > 1e-16 * shares.max()
    return Components(np.exp(-0.5 * log_x[kept]), shares[kept] / shares[kept].sum())


def _least_stable(b: float) -> float:
    """The x below which the stable law has nothing.

    A x^-c is more than 60 there for the least A, at phi = 0.
    """
    c = b / (1.0 - b)
    least = b ** (1.0 / (1.0 - b)) * (1.0 - b) / b
    return (least / 60.0) ** (1.0 / c)
