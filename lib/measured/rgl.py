# SPDX-License-Identifier: GPL-3.0-or-later
"""RGL's `.bsdf` files: a BRDF in the coordinates of its own microfacets.

Dupuy and Jakob 2018, section 5.

With the half vector m in the square's coordinates u(m), and the file's densities of visible normals warping it to a
uniform s, f |n.wi| = c(s) D(u(m)) / (4 sigma(u(wo))): `ndf` is D, `sigma` the projected area of the microfacets, c
the file's `rgb` or `spectra`. u has sqrt(2 theta / pi) along x and (phi + pi) / (2 pi) along y. The file's first
direction, which the tables depend on, is here wo.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import EtalonError
from ..sampling.wavelengths import COLORS, NODES
from ..vectors import dot
from .brdf import MeasuredBrdf, require_numbers
from .tensor_file import read_tensors
from .warp import SquareTable, SquareWarp

_SHAPES = {"phi_i": 1, "theta_i": 1, "ndf": 2, "sigma": 2, "vndf": 4, "luminance": 4, "jacobian": 1}


@dataclass(frozen=True)
class Rgl(MeasuredBrdf):
    """One RGL material.

    `color` is a table for red, green and blue each; `reduction` is how many times the azimuths repeat.
    """

    ndf: SquareTable
    sigma: SquareTable
    vndf: SquareWarp
    color: tuple[SquareTable, SquareTable, SquareTable]
    has_jacobian: bool
    isotropic: bool
    reduction: int

    def evaluate(self, wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
        """Return f |n.wi|, (3, n)."""
        lit = (wi[2] > 0.0) & (wo[2] > 0.0)
        wi, wo = _fold(wi, wo, self.reduction)
        m = wi + wo
        m = m / np.sqrt(np.maximum(dot(m, m), 1e-300))
        theta, phi = _angles(wo)
        x, y = _square(*_angles(m), phi if self.isotropic else 0.0)
        at = phi, theta
        s, t = self.vndf.to_uniform(x, y, at)
        value = np.stack([table.evaluate(s, t, at) for table in self.color])
        if self.has_jacobian:
            area = self.sigma.evaluate(*_square(theta, phi, 0.0))
            value *= self.ndf.evaluate(x, y) / (4.0 * np.maximum(area, 1e-300))
        return np.where(lit, value, 0.0)


def _fold(wi: np.ndarray, wo: np.ndarray, reduction: int) -> tuple[np.ndarray, np.ndarray]:
    """Turn (2 repeats) or mirror (4) both directions into the measured azimuths of wo.

    The part of the azimuths that was measured begins at -pi.
    """
    if reduction < 2:
        return wi, wo
    flip_y = np.where(wo[1] < 0.0, 1.0, -1.0)
    flip_x = np.where(wo[0] < 0.0, 1.0, -1.0) if reduction == 4 else flip_y
    flips = np.stack([flip_x, flip_y, np.ones_like(flip_x)])
    return wi * flips, wo * flips


def _angles(w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Theta in [0, pi] and phi in [-pi, pi] of unit directions, each (n,)."""
    return np.arctan2(np.hypot(w[0], w[1]), w[2]), np.arctan2(w[1], w[0])


def _square(theta: np.ndarray, phi: np.ndarray, turned: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """The square's coordinates of a direction whose azimuth is `phi` - `turned`, each (n,)."""
    y = (phi - turned + np.pi) / (2.0 * np.pi)
    return np.sqrt(theta * (2.0 / np.pi)), y - np.floor(y)


def read_rgl(path: Path) -> Rgl:
    """Read an RGL file with the field `rgb` or `spectra`.

    Raises EtalonError for a foreign or truncated file, for fields that are missing or do not fit together, and for values that are
    negative or not finite; OSError where the file cannot be read.
    """
    fields = read_tensors(path)
    for name, dimensions in _SHAPES.items():
        if name not in fields or fields[name].ndim != dimensions or 0 in fields[name].shape:
            raise EtalonError(f"{path}: field '{name}' is missing or malformed; give a .bsdf file of the RGL database")
    color = _color(path, fields)
    _require_fit(path, fields, color)
    for name in ("ndf", "sigma", "vndf"):
        require_numbers(path, f"'{name}'", fields[name])
    phi, theta = (fields[name].astype(float) for name in ("phi_i", "theta_i"))
    if not fields["vndf"].reshape(*fields["vndf"].shape[:2], -1).any(axis=-1).all():
        raise EtalonError(f"{path}: a density of visible normals is zero everywhere; fetch the file again")
    isotropic = len(phi) <= 2
    return Rgl(
        SquareTable(fields["ndf"]),
        SquareTable(fields["sigma"]),
        SquareWarp(fields["vndf"], (phi, theta)),
        (SquareTable(color[0], (phi, theta)), SquareTable(color[1], (phi, theta)), SquareTable(color[2], (phi, theta))),
        bool(fields["jacobian"][0]),
        isotropic,
        1 if isotropic else round(2.0 * np.pi / float(phi[-1] - phi[0])),
    )


def _color(path: Path, fields: dict[str, np.ndarray]) -> np.ndarray:
    """Return the colours, (3, phi, theta, height, width).

    They are the field `rgb`, or `spectra` seen under an even white light.
    """
    if "rgb" in fields and fields["rgb"].ndim == 5 and fields["rgb"].shape[2] == 3:
        require_numbers(path, "the colours", fields["rgb"])
        return np.moveaxis(fields["rgb"].astype(float), 2, 0)
    spectra, wavelengths = fields.get("spectra"), fields.get("wavelengths")
    if spectra is None or wavelengths is None or spectra.ndim != 5 or spectra.shape[2:3] != wavelengths.shape:
        raise EtalonError(
            f"{path}: neither 'rgb' nor 'spectra' with 'wavelengths'; give a .bsdf file of the RGL database"
        )
    require_numbers(path, "the spectra", spectra)
    return np.einsum("cw,ptwhx->cpthx", _rgb_weights(wavelengths.astype(float)), spectra)


def _rgb_weights(wavelengths: np.ndarray) -> np.ndarray:
    """Return what a spectrum adds to each colour under D65, (3, w).

    The spectrum is linear between increasing `wavelengths` (w,) in nm.
    """
    hats = np.array([np.interp(NODES, wavelengths, one) for one in np.eye(len(wavelengths))])
    steps = np.gradient(NODES)
    steps[[0, -1]] *= 0.5
    return (COLORS * steps) @ hats.T


def _require_fit(path: Path, fields: dict[str, np.ndarray], color: np.ndarray) -> None:
    slices = fields["phi_i"].shape + fields["theta_i"].shape
    for name, shape in (("vndf", fields["vndf"].shape[:2]), ("colours", color.shape[1:3])):
        if shape != slices:
            raise EtalonError(f"{path}: '{name}' has {shape} slices for {slices} directions; fetch the file again")
    grids = [fields["ndf"].shape, fields["sigma"].shape, fields["vndf"].shape[2:], color.shape[3:]]
    if min(min(grid) for grid in grids) < 2:
        raise EtalonError(f"{path}: a table with fewer than 2 x 2 values; fetch the file again")
    for name in ("phi_i", "theta_i"):
        if not (np.isfinite(fields[name]).all() and (np.diff(fields[name]) > 0.0).all()):
            raise EtalonError(f"{path}: '{name}' does not increase; fetch the file again")
