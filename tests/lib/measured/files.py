# SPDX-License-Identifier: GPL-3.0-or-later
"""Small measured materials that tests write: tensor files and MERL files of given tables."""

import struct

import numpy as np
from etalon.lib.measured.merl import SCALES, SHAPE, directions_of_angles

_KINDS = {"u1": 1, "f4": 10}


def write_tensors(path, fields):
    """Write a tensor file of `fields` by name.

    They are arrays of bytes and of floats in single precision.
    """
    arrays = {name: np.ascontiguousarray(a, "<u1" if a.dtype == np.uint8 else "<f4") for name, a in fields.items()}
    head = 18 + sum(2 + len(name) + 2 + 1 + 8 + 8 * a.ndim for name, a in arrays.items())
    out, body = [struct.pack("<12sBBI", b"tensor_file", 1, 0, len(arrays))], []
    for name, a in arrays.items():
        offset = head + sum(len(b) for b in body)
        out.append(
            struct.pack("<H", len(name)) + name.encode() + struct.pack("<HBQ", a.ndim, _KINDS[a.dtype.str[1:]], offset)
        )
        out.append(struct.pack("<" + "Q" * a.ndim, *a.shape))
        body.append(a.tobytes())
    path.write_bytes(b"".join(out + body))
    return path


def wavy_fields(phis, thetas):
    """The fields of an RGL file whose tables are smooth waves, all different.

    Colour k is what Mitsuba reads at 400 + 100 k nm.
    """
    phi, theta = np.asarray(phis, float), np.asarray(thetas, float)

    def wave(rows, columns, *more):
        axes = np.meshgrid(
            *[np.asarray(m, float) for m in more], np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij"
        )
        y, x = axes[-2:]
        phase = sum((0.7 + 0.4 * i) * a for i, a in enumerate(axes[:-2]))
        return 1.2 + np.sin(5.0 * x + 3.0 * y + phase) * np.cos(2.0 * y - x)

    vndf, colors, sigma = wave(9, 7, phi, theta), wave(6, 6, phi, theta, [0.0, 1.0, 2.0]), wave(4, 6)
    if len(phi) == 1:
        sigma[:] = sigma[0]
    return {
        "phi_i": phi, "theta_i": theta, "ndf": wave(5, 8), "sigma": sigma, "vndf": vndf,
        "luminance": wave(6, 6, phi, theta), "rgb": colors, "spectra": colors, "wavelengths": np.array([400.0, 500.0, 600.0]),
        "jacobian": np.array([1], np.uint8), "description": np.frombuffer(b"waves", np.uint8),
    }  # fmt: skip


def merl_directions():
    """The directions in the middle of each cell of a MERL file, wi and wo (3, 90 * 90 * 180)."""
    k, d, p = (a.ravel() + 0.5 for a in np.meshgrid(*(np.arange(n) for n in SHAPE), indexing="ij"))
    return directions_of_angles(np.square(k / 90.0) * 0.5 * np.pi, np.radians(d), np.radians(p))


def write_merl(path, f):
    """Write a MERL file of the BRDF values `f`, (3, 90 * 90 * 180), in sr^-1."""
    path.write_bytes(np.array(SHAPE, "<i4").tobytes() + np.ascontiguousarray(f / SCALES[:, None], "<f8").tobytes())
    return path
