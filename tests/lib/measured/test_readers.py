# SPDX-License-Identifier: GPL-3.0-or-later
"""MERL and RGL files against closed forms, quadrature and Mitsuba's `measured`.

Files that cannot be used are tested too.
"""

import struct

import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.measured.merl import SCALES, SHAPE, half_difference_angles, read_merl
from etalon.lib.measured.read import read_measured
from etalon.lib.measured.warp import SquareWarp
from etalon.tests.lib.measured.files import merl_directions, wavy_fields, write_merl, write_tensors

QUARTER = np.linspace(-np.pi, -np.pi / 2, 4)
THETAS = [0.0, 0.4, 0.9, 1.4]

# Mitsuba 3.9.1, scalar_spectral, plugin `measured`, at 400, 500 and 600 nm, of the file `wavy_fields(QUARTER, THETAS)`:
# theta and phi of the viewer (its wi), then of the light.
MITSUBA = [
    ((0.3, 0.5, 0.4, 0.2), (0.3923955261707306, 0.4791460633277893, 0.22164221107959747)),
    ((-0.6, 0.9, 0.1, 1.2), (0.9862647652626038, 0.5385053753852844, 0.1797001212835312)),
    ((1.1, -0.4, 1.3, 2.9), (0.5010526776313782, 0.2043144553899765, 0.7262162566184998)),
    ((0.9, 2.5, 0.2, -2.2), (0.8370746374130249, 0.29559043049812317, 0.3775354027748108)),
    ((1.3, 0.3, 0.8, -1.0), (0.5699421763420105, 0.7547534704208374, 0.66427081823349)),
]


def direction(theta, phi):
    """A unit vector, (3, 1)."""
    return np.array([[np.sin(theta) * np.cos(phi)], [np.sin(theta) * np.sin(phi)], [np.cos(theta)]])


def test_an_rgl_file_has_the_values_that_mitsuba_reads(tmp_path):
    brdf = read_measured(write_tensors(tmp_path / "waves.bsdf", wavy_fields(QUARTER, THETAS)))
    assert (brdf.isotropic, brdf.reduction) == (False, 4)
    for (theta_o, phi_o, theta_i, phi_i), expected in MITSUBA:
        value = brdf.evaluate(direction(theta_i, phi_i), direction(theta_o, phi_o))
        assert value[:, 0] == pytest.approx(expected, rel=5e-6)


def test_an_isotropic_rgl_file_depends_on_the_difference_of_azimuths_alone(tmp_path, rng):
    brdf = read_measured(write_tensors(tmp_path / "waves.bsdf", wavy_fields([0.0], THETAS)))
    turn = rng.uniform(-3.0, 3.0, 20)
    one = brdf.evaluate(direction(0.7, 0.4), direction(0.5, -1.1))
    for angle in turn:
        assert brdf.evaluate(direction(0.7, 0.4 + angle), direction(0.5, angle - 1.1)) == pytest.approx(one, rel=1e-12)
    assert not brdf.evaluate(direction(1.6, 0.0), direction(0.5, 0.0)).any()


def test_an_rgl_file_of_white_spectra_is_grey_and_keeps_its_value(tmp_path):
    fields = wavy_fields([0.0], THETAS)
    grey = read_measured(write_tensors(tmp_path / "rgb.bsdf", {**fields, "rgb": np.full((1, 4, 3, 6, 6), 0.4)}))
    white = {name: a for name, a in fields.items() if name != "rgb"}
    white |= {"wavelengths": np.arange(380.0, 781.0, 20.0), "spectra": np.full((1, 4, 21, 6, 6), 0.4)}
    spectral = read_measured(write_tensors(tmp_path / "spectra.bsdf", white))
    at = direction(0.7, 0.4), direction(0.5, -1.1)
    assert spectral.evaluate(*at) == pytest.approx(grey.evaluate(*at), rel=1e-9)


def test_the_warp_to_uniforms_is_the_integral_of_its_density(rng):
    table, knots = rng.uniform(0.1, 2.0, (3, 5, 4)), np.array([0.0, 1.0, 3.0])
    warp = SquareWarp(table, (knots,))
    for x, y, parameter in rng.uniform(0.0, 1.0, (4, 3)) * [1.0, 1.0, 3.0]:
        s, t = warp.to_uniform(np.array([x]), np.array([y]), (np.array([parameter]),))
        fine, coarse = (np.arange(4000) + 0.5) / 4000, (np.arange(200) + 0.5) / 200

        def density(a, b, at=parameter):
            return warp.evaluate(a, b, (np.full(a.shape, at),))

        row = density(fine, np.full(4000, y))
        assert s[0] == pytest.approx(row[fine < x].sum() / row.sum(), abs=4e-4)
        grid = density(*(a.ravel() for a in np.meshgrid(coarse, coarse, indexing="ij"))).reshape(200, 200)
        assert grid.mean() == pytest.approx(1.0, abs=1e-3)
        assert t[0] == pytest.approx(grid.mean(axis=0)[coarse < y].sum() / grid.mean(axis=0).sum(), abs=6e-3)


def test_a_merl_file_gives_back_a_phong_lobe_and_is_reciprocal(tmp_path, rng):
    wi, wo = merl_directions()
    half = wi + wo
    cosine = half[2] / np.sqrt((half**2).sum(axis=0))
    brdf = read_measured(write_merl(tmp_path / "phong.binary", np.outer([0.5, 0.3, 0.1], cosine**20)))
    z, phi = rng.uniform(0.3, 1.0, (2, 2000)), rng.uniform(-np.pi, np.pi, (2, 2000))
    s = np.sqrt(1.0 - z * z)
    a, b = (np.stack([s[k] * np.cos(phi[k]), s[k] * np.sin(phi[k]), z[k]]) for k in (0, 1))
    m = (a + b) / np.sqrt(((a + b) ** 2).sum(axis=0))
    red, green, _ = brdf.evaluate(a, b) / a[2]
    assert green == pytest.approx(0.6 * red)
    # A cell holds the value of its middle, which lies between those of its edges.
    cell = np.floor(90.0 * np.sqrt(np.arccos(m[2]) * 2.0 / np.pi))
    low, high = (np.cos(((cell + k) / 90.0) ** 2 * np.pi / 2.0) ** 20 for k in (1, 0))
    assert ((red >= 0.5 * low) & (red <= 0.5 * high)).all()
    assert brdf.evaluate(a, b) / a[2] == pytest.approx(brdf.evaluate(b, a) / b[2], rel=1e-9)


def test_half_and_difference_angles_are_found_again():
    wi, wo = merl_directions()
    half, difference, azimuth = (a.reshape(SHAPE) for a in half_difference_angles(wi, wo))
    assert half[:, 40, 70] == pytest.approx((np.arange(90) + 0.5) ** 2 / 8100 * np.pi / 2, rel=1e-9)
    assert difference[10, :, 70] == pytest.approx(np.radians(np.arange(90) + 0.5), rel=1e-9)
    assert azimuth[10, 40] == pytest.approx(np.radians(np.arange(180) + 0.5), rel=1e-9)


def broken_tensor_files():
    """Names, fields and what the error says."""
    good = wavy_fields([0.0], THETAS)
    return [
        ("without", {n: a for n, a in good.items() if n != "vndf"}, "'vndf' is missing"),
        ("nan", {**good, "ndf": np.full((5, 8), np.nan)}, "not finite"),
        ("negative", {**good, "rgb": -good["rgb"]}, "negative; a BRDF has none"),
        ("slices", {**good, "theta_i": np.array([0.0, 1.0])}, "slices"),
        ("order", {**good, "theta_i": np.array([0.0, 1.0, 0.5, 1.2])}, "does not increase"),
        ("zero", {**good, "vndf": np.zeros((1, 4, 9, 7))}, "zero everywhere"),
        ("colourless", {n: a for n, a in good.items() if n not in ("rgb", "spectra")}, "neither 'rgb' nor 'spectra'"),
    ]


@pytest.mark.parametrize(("name", "fields", "message"), broken_tensor_files())
def test_a_broken_rgl_file_is_refused_in_one_line(tmp_path, name, fields, message):
    path = write_tensors(tmp_path / f"{name}.bsdf", fields)
    with pytest.raises(EtalonError, match=message) as refused:
        read_measured(path)
    assert "\n" not in str(refused.value)
    assert f"{name}.bsdf" in str(refused.value)


def test_a_truncated_rgl_file_is_refused_wherever_it_ends(tmp_path):
    whole = write_tensors(tmp_path / "waves.bsdf", wavy_fields([0.0], THETAS)).read_bytes()
    for end in [*range(0, 600, 7), len(whole) - 1]:
        path = tmp_path / "short.bsdf"
        path.write_bytes(whole[:end])
        with pytest.raises(EtalonError, match=r"short\.bsdf"):
            read_measured(path)


def test_a_merl_file_that_cannot_be_used_is_refused_in_one_line(tmp_path):
    good = np.ones((3, int(np.prod(SHAPE)))) * SCALES[:, None]
    path = write_merl(tmp_path / "m.binary", good)
    whole = path.read_bytes()
    grazing = good.copy()
    grazing.reshape(3, *SHAPE)[:, 89] = -1.0  # nothing is measured under grazing half vectors: real files mark it so
    values = read_merl(write_merl(path, grazing)).values
    assert np.isnan(values[:, 89]).all()
    assert np.isfinite(values[:, :89]).all()
    cases = {
        "ends before": whole[:-1],
        "not a MERL file": struct.pack("<3i", 90, 90, 90) + whole[12:],
        "more data": whole + b"1",
        "negative; a BRDF has none": whole[:12] + struct.pack("<d", -1.0) + whole[20:],
        "not finite": whole[:12] + struct.pack("<d", np.nan) + whole[20:],
    }
    for message, data in cases.items():
        path.write_bytes(data)
        with pytest.raises(EtalonError, match=message):
            read_measured(path)
    (tmp_path / "photo.jpg").write_bytes(b"\xff\xd8 no BRDF")
    with pytest.raises(EtalonError, match="holds no measured BRDF"):
        read_measured(tmp_path / "photo.jpg")
