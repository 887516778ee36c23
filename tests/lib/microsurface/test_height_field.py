# SPDX-License-Identifier: GPL-3.0-or-later
"""Height fields have the statistics that Beckmann's distribution assumes.

Rays on them keep areas and energy.
"""

import numpy as np
import pytest
from etalon.lib.microsurface.height_field import gaussian_field, power_mean, tiled_mesh
from etalon.lib.microsurface.models import FORMULAS, _masking, reflected_once, shared_by_mirror
from etalon.lib.microsurface.traced import TracedField
from etalon.lib.vectors import dot
from numpy.polynomial.hermite import hermgauss

ALPHA, ANGLES = 0.6, np.radians([60.0, 80.0])


def at(angle):
    return np.array([np.sin(angle), 0.0, np.cos(angle)])


def test_slopes_are_gaussian_with_the_variance_of_beckmann(rng):
    """Along each axis alpha^2 / 2, and a kurtosis of 3.

    40 fields of some 200 independent patches each.
    """
    slopes = []
    for _ in range(40):
        field = gaussian_field(rng, 96, 6.0, ALPHA)
        slopes.append([np.roll(field, -1, axis) - field for axis in (0, 1)])
    slopes = np.array(slopes)
    second = (slopes**2).mean(axis=(2, 3))
    assert second.mean() == pytest.approx(0.5 * ALPHA**2, abs=4.5 * second.std(ddof=1) / np.sqrt(second.size))
    fourth = (slopes**4).mean(axis=(2, 3))
    assert fourth.mean() == pytest.approx(
        3.0 * (0.5 * ALPHA**2) ** 2, abs=4.5 * fourth.std(ddof=1) / np.sqrt(fourth.size)
    )


@pytest.mark.parametrize("cells", [8, 9])
def test_half_a_spectrum_has_the_mean_of_the_whole(rng, cells):
    frequency = np.abs(np.fft.fftfreq(cells))
    whole = np.exp(-np.add.outer(frequency**2, frequency**2))
    assert power_mean(whole[:, : cells // 2 + 1], cells) == pytest.approx(whole.mean(), rel=1e-12)


def test_the_mesh_repeats_the_field_and_has_no_gaps(rng):
    heights = rng.normal(size=(5, 5))
    mesh = tiled_mesh(heights, 3)
    corner = mesh.vertices[:, mesh.triangles]
    one, other = corner[:2, 1] - corner[:2, 0], corner[:2, 2] - corner[:2, 0]
    area = 0.5 * (one[0] * other[1] - one[1] * other[0])
    np.testing.assert_allclose(area, 0.5)  # all upwards, and half a cell
    assert area.sum() == pytest.approx(11.0**2)
    x, y, z = mesh.vertices
    np.testing.assert_array_equal(z, heights[x.astype(int) % 5, y.astype(int) % 5])


@pytest.mark.grid(2)
@pytest.mark.parametrize("angle", ANGLES)
def test_what_a_direction_sees_of_the_facets_projects_as_the_mean_plane_does(rng, angle):
    """The sum of visible facets times (o.m) is the plane's area times (o.n).

    See Heitz 2014, eq. 14. Of all that face o it is more.
    """
    o, seen, facing = at(angle), [], []
    for _ in range(8):
        normal, area, (visible,) = TracedField(rng, 96, 6.0, ALPHA).seen([o], 30_000)
        projected = area * np.maximum(dot(o[:, None], normal), 0.0) / o[2]
        seen.append((projected * visible).mean())
        facing.append(projected.mean())
    error = 4.5 * np.std(seen, ddof=1) / np.sqrt(8)
    assert np.mean(seen) == pytest.approx(1.0, abs=error)
    assert error < 0.03
    assert np.mean(facing) > 1.0 + error


@pytest.mark.parametrize("angle", ANGLES)
def test_white_mirrors_let_all_light_go(rng, angle):
    once, total = TracedField(rng, 96, 6.0, ALPHA).reflected(at(angle), 20_000)
    assert total > 0.9998
    assert 0.7 < once < total


def test_a_field_that_is_nearly_flat_hides_nothing(rng):
    field = TracedField(rng, 64, 6.0, 1e-3)
    _, _, seen = field.seen([at(ANGLES[1]), at(-ANGLES[1])], 2_000)
    assert seen.all()
    assert field.reflected(at(ANGLES[1]), 2_000) == (1.0, 1.0)


def test_formulas_at_82_degrees():
    """1 / (1 + L)^2, 1 / (1 + 2 L) with L = 0.7698, and cavities.

    The latter hide nothing from a mirror's two sides.
    """
    shared = shared_by_mirror(at(np.radians(82.0)), ALPHA)
    assert [shared[name] for name in FORMULAS] == pytest.approx([0.31926, 0.39376, 1.0], abs=1e-5)


@pytest.mark.parametrize("name", FORMULAS)
def test_what_is_reflected_once_is_the_integral_over_slopes(name):
    """Over slopes x, y of the facets.

    Their density is exp(-(x^2 + y^2) / alpha^2) / (pi alpha^2).
    """
    node, weight = hermgauss(180)
    x, y = (one.ravel() for one in np.meshgrid(ALPHA * node, ALPHA * node))
    weight = np.multiply.outer(weight, weight).ravel() / np.pi
    m = np.stack([-x, -y, np.ones_like(x)])
    facing = dot(at(ANGLES[0])[:, None], m)  # (o.m) / (n.m) of the unit normal
    keep = facing > 0.0
    m, weight = m[:, keep] / np.linalg.norm(m[:, keep], axis=0), weight[keep] * facing[keep] / np.cos(ANGLES[0])
    wo = np.repeat(at(ANGLES[0])[:, None], weight.size, axis=1)
    wi = 2.0 * dot(wo, m) * m - wo
    total = (_masking(wi, wo, m, ALPHA)[name] * (wi[2] > 0.0)) @ weight
    assert reflected_once(at(ANGLES[0]), ALPHA)[name] == pytest.approx(total, abs=2e-3)
