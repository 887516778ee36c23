# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Multiscatter GGX in a coloured furnace: what Cycles shows is the model with its own coarse table of albedos."""

import bpy
import numpy as np
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.addon.job import export
from etalon.lib.microfacets import albedo
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.reference_scenes import building
from etalon.tests.chi2 import sidak
from scipy.stats import t

COLOR = (0.9, 0.5, 0.1)
ROUGHNESS = (0.2, 0.62, 0.95)
TILTS = np.radians([-87.0, -63.0, -20.0, 5.0, 35.0, 75.0])
TILE, REPLICATES, SAMPLES = 8, 16, 128
LEVEL = 1e-3


def vault():
    """The furnace of reference_scenes with other materials: a convex body in a white world, one tile for each angle and roughness."""
    columns, rows = len(TILTS), len(ROUGHNESS)
    building.start("multi", TILE * columns, TILE * rows, 0)
    building.world((1.0, 1.0, 1.0))
    heights = np.concatenate([[0.0], np.cumsum(-np.tan(TILTS))])
    x, y = np.arange(columns + 1) - columns / 2, rows / 2 - np.arange(rows + 1)
    vertices = np.stack([np.tile(x, len(y)), np.repeat(y, len(x)), np.tile(heights - heights.max(), len(y))], axis=1)
    corner = np.add.outer(np.arange(rows) * len(x), np.arange(columns)).ravel()
    faces = np.stack([corner, corner + len(x), corner + len(x) + 1, corner + 1], axis=1)
    materials = [building.glossy(f"{r}", "MULTI_GGX", r * r, COLOR) for r in ROUGHNESS]
    building.mesh("Vault", vertices, faces, materials, material_index=np.repeat(np.arange(rows), columns))
    building.camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), ortho_scale=columns)


def tiles(renderer):
    """Means of the tiles without their rims, (replicates, rows, columns, 3)."""
    shown = []
    for replicate in range(REPLICATES):
        pixels = renderer.render(replicate, SAMPLES).radiance
        cells = pixels.reshape(len(ROUGHNESS), TILE, len(TILTS), TILE, 3)[:, 1:-1, :, 1:-1]
        shown.append(cells.mean(axis=(1, 3)))
    return np.array(shown)


def expected(directional, average):
    """Colour x E x compensation, with the compensation's own albedos from the given tables."""
    mu, alpha = (grid.ravel() for grid in np.meshgrid(np.cos(TILTS), np.square(ROUGHNESS)))
    color = np.array(COLOR)[:, None]
    lost, mean = 1.0 / directional(mu, alpha) - 1.0, average(alpha)
    factor = 1.0 + color * mean / (1.0 - color * (1.0 - mean)) * lost
    return (color * albedo.directional_albedo(mu, alpha) * factor).T.reshape(len(ROUGHNESS), len(TILTS), 3)


def test_cycles_and_the_reference_each_show_their_model():
    vault()
    by_the_book = expected(albedo.directional_albedo, albedo.average_albedo)
    by_cycles = expected(albedo.directional_albedo_cycles, albedo.average_albedo_cycles)
    scene = export(bpy.context.scene)
    reference = tiles(ReferenceRenderer(scene, Options()))
    cycles = tiles(CyclesRenderer(bpy.context.scene, threads=2))
    quantile = t.ppf(1.0 - 0.5 * sidak(LEVEL, 2 * by_cycles.size), REPLICATES - 1)
    for shown, model in ((reference, by_the_book), (cycles, by_cycles)):
        error = shown.std(axis=0, ddof=1) / np.sqrt(REPLICATES)
        assert (error < 1.2e-3 * model).all()
        assert (np.abs(shown.mean(axis=0) - model) <= quantile * error + 2e-4 * model).all()
    # The named departure is visible: at grazing incidence the two tables differ by more than all noise.
    apart = np.abs(cycles.mean(axis=0) / reference.mean(axis=0) - 1.0)
    assert 5e-3 < apart.max() < 1e-2
