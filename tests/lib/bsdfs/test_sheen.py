# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheen: its table against random walks among fibers.

Also its sampling against its density, and what it leaves for layers below.
"""

import numpy as np
import pytest
from etalon.lib.bsdfs.sheen import Sheen, beneath_sheen, sheen_coefficients
from etalon.tests.chi2 import Sphere, chi_square, integrals, sidak

COUNT, WALKS = 100_000, 40_000
LEVEL = 1e-3
LOBES = [(0.15, 0.1), (0.3, 0.5), (0.5, 0.05), (0.5, 0.9), (0.8, 1.0), (1.0, 0.4), (1.0, 0.02)]  # roughness, cosine
NODES = [(31, 3), (31, 24), (20, 8), (16, 2), (12, 6)]  # rows and columns of the table


def viewer(cos_o, count, phi=0.9):
    sine = np.sqrt(1.0 - cos_o**2)
    return np.repeat(np.array([[sine * np.cos(phi)], [sine * np.sin(phi)], [cos_o]]), count, axis=1)


def walk(cos_o, roughness, count, rng):
    """Directions of light that leaves a layer of fibers upwards, (3, k).

    `count` walks enter the layer from `cos_o` in the plane y = 0. The model behind the table (Zeltner et al. 2022):
    SGGX fibers along z of cross-section sigma = roughness^2, density and thickness 1, each of which reflects like a
    mirror. The normals that w sees of an ellipsoid with half axes (1, 1, 1 / sigma) are those of points uniform on
    its shadow, and a linear map takes it to a sphere.
    """
    stretch = np.array([[1.0], [1.0], [roughness**2]])  # a normal of the sphere, times this, is one of the ellipsoid
    direction = -viewer(cos_o, count, 0.0)
    height, left = np.zeros(count), []
    while direction.shape[1]:
        extinction = np.sqrt(((stretch * direction) ** 2).sum(axis=0))
        height = height + direction[2] * rng.exponential(size=height.size) / extinction
        left.append(direction[:, height > 0.0])
        inside = (height <= 0.0) & (height >= -1.0)
        seen, height = -direction[:, inside], height[inside]
        axis = stretch * seen
        axis /= np.sqrt((axis**2).sum(axis=0))
        radius, turn = np.sqrt(rng.random(height.size)), 2.0 * np.pi * rng.random(height.size)
        across = np.cross(axis, np.array([[0.0], [1.0], [0.0]]), axis=0)
        across /= np.sqrt((across**2).sum(axis=0))
        point = radius * (np.cos(turn) * across + np.sin(turn) * np.cross(axis, across, axis=0))
        normal = stretch * (point + np.sqrt(1.0 - radius**2) * axis)
        normal /= np.sqrt((normal**2).sum(axis=0))
        direction = 2.0 * (seen * normal).sum(axis=0) * normal - seen
    return np.concatenate(left, axis=1)


@pytest.mark.parametrize(("row", "column"), NODES)
def test_the_table_holds_what_random_walks_among_fibers_reflect(row, column, rng):
    """The albedo to five standard errors of the walks.

    The fit of a cosine leaves up to 0.028 of their mean direction.
    """
    roughness, cosine = row / 31.0, column / 31.0
    found = walk(cosine, roughness, WALKS, rng)
    albedo = found.shape[1] / WALKS
    wi, weight, _ = Sheen(viewer(cosine, COUNT, 0.0), np.float64(roughness)).sample(*rng.random((2, COUNT)))
    assert abs(weight[0, 0] - albedo) < 5.0 * np.sqrt(albedo * (1.0 - albedo) / WALKS) + 5e-6
    np.testing.assert_allclose(wi.mean(axis=1), found.mean(axis=1), atol=0.04)


@pytest.mark.parametrize(("roughness", "cosine"), LOBES)
def test_sheen_follows_its_density_and_reflects_its_albedo(roughness, cosine, rng):
    lobe = Sheen(viewer(cosine, COUNT), np.float64(roughness))
    wi, weight, pdf = lobe.sample(*rng.random((2, COUNT)))

    def density(directions):
        return Sheen(viewer(cosine, directions.shape[1]), np.float64(roughness)).evaluate(directions)[1]

    assert chi_square(wi, density, Sphere(), tolerance=1e-5).p_value > sidak(LEVEL, len(LOBES))
    assert integrals(density, Sphere(), (8, 8), tolerance=1e-6).sum() == pytest.approx(1.0, abs=1e-4)
    value, density_there = lobe.evaluate(wi)
    np.testing.assert_allclose(pdf, density_there, rtol=1e-9)
    np.testing.assert_allclose(weight * pdf, value, rtol=1e-9)
    np.testing.assert_array_equal(weight[0], sheen_coefficients(np.full(COUNT, cosine), np.float64(roughness))[2])


def test_another_side_of_the_viewers_plane_fails(rng):
    """The chi-square test sees a B of the wrong sign, which leans away from the viewer."""
    wi, _, _ = Sheen(viewer(0.1, COUNT), np.float64(0.5)).sample(*rng.random((2, COUNT)))

    def turned(directions):
        return Sheen(viewer(0.1, directions.shape[1], 0.9 + np.pi), np.float64(0.5)).evaluate(directions)[1]

    assert chi_square(wi, turned, Sphere(), tolerance=1e-5).p_value < 1e-9


def test_sheen_is_not_reciprocal(rng):
    """How far f(wi, wo) and f(wo, wi) differ at roughness 0.5.

    Beyond 10 degrees from grazing they differ by up to a half of their mean.
    """
    directions = rng.normal(size=(2, 3, 5000))
    wo, wi = directions / np.sqrt((directions**2).sum(axis=1, keepdims=True))
    wo[2], wi[2] = np.abs(wo[2]), np.abs(wi[2])
    there = Sheen(wo, np.float64(0.5)).evaluate(wi)[0][0] / wi[2]
    back = Sheen(wi, np.float64(0.5)).evaluate(wo)[0][0] / wo[2]
    clear = np.minimum(wo[2], wi[2]) > np.sin(np.radians(10.0))
    apart = 2.0 * np.abs(there - back)[clear] / (there + back)[clear]
    assert 0.3 < apart.max() < 1.0, apart.max()


def test_where_the_table_has_no_lobe_nothing_is_reflected():
    value, pdf = Sheen(viewer(0.8, 4), np.float64(0.0)).evaluate(viewer(0.5, 4))
    assert not value.any()
    assert (pdf > 0.0).all()


def test_layers_below_get_what_sheen_does_not_reflect():
    """Of white light they get one less the largest colour of the lobe's quadrature.

    They never get less than nothing.
    """
    tint, weight = np.array([[0.3], [0.9], [-0.5]]), np.float64(0.7)

    def value(directions):
        return 0.7 * 0.9 * Sheen(viewer(0.2, directions.shape[1]), np.float64(0.4)).evaluate(directions)[0][1]

    left = beneath_sheen(tint, np.float64(0.4), weight, np.full(3, 0.2))
    np.testing.assert_allclose(left, 1.0 - integrals(value, Sphere(), (8, 8), tolerance=1e-6).sum(), atol=1e-4)
    assert not beneath_sheen(tint, np.float64(0.4), np.float64(9.0), np.full(3, 0.2)).any()
