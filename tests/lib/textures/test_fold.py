# SPDX-License-Identifier: GPL-3.0-or-later
"""Folding keeps every value and leaves nothing constant uncomputed."""

import numpy as np
from etalon.lib.scene import expressions as ex
from etalon.lib.textures.evaluate import evaluate
from etalon.lib.textures.fold import Folder, fold, is_constant, walk
from etalon.lib.textures.images import ImageSet

UV = ex.Coordinates("UV")
U = ex.VectorToValue(UV)


class Points:
    size = 8
    uv = np.linspace(0, 1, 24).reshape(3, 8)

    def coordinates(self, kind, uv_map):
        return self.uv


def product(a, b):
    return ex.Math("MULTIPLY", a, b, ex.ZERO)


def test_constant_trees_become_constants():
    value = ex.Math("ADD", ex.Constant(0.25), ex.ColorToValue(ex.WHITE), ex.ZERO, clamp=True)
    assert fold(value) == ex.ONE
    assert fold(ex.ValueToColor(value)) == ex.WHITE
    assert fold(ex.Checker(ex.Constant((1.5, 0.5, 0.5)), ex.WHITE, ex.BLACK, ex.ONE, output="FACTOR")) == ex.ONE
    assert is_constant(fold(ex.Mapping(ex.WHITE, ex.BLACK, ex.WHITE, ex.WHITE)))


def test_neutral_nodes_vanish():
    assert fold(product(ex.ONE, U)) == U
    assert fold(product(U, ex.Math("COSINE", ex.ZERO, ex.ZERO, ex.ZERO))) == U
    assert fold(product(U, ex.ZERO)) == ex.ZERO
    assert fold(ex.Math("ADD", ex.ZERO, U, ex.ZERO)) == U
    assert fold(ex.Mix(ex.ONE, ex.BLACK, UV)) == UV
    assert fold(ex.Mix(ex.ZERO, UV, ex.BLACK)) == UV
    assert fold(ex.Mix(ex.ONE, UV, ex.WHITE, blend="MULTIPLY")) == UV


def test_clamped_nodes_stay():
    clamped = ex.Math("ADD", U, ex.ZERO, ex.ZERO, clamp=True)
    assert fold(clamped) is clamped
    mixed = ex.Mix(ex.ONE, ex.BLACK, UV, clamp_result=True)
    assert fold(mixed) is mixed


def test_values_do_not_change():
    tree = ex.Mix(
        product(U, product(ex.Constant(2.0), ex.Constant(0.25))),
        UV,
        ex.ValueToColor(product(ex.ONE, U)),
        blend="SCREEN",
    )
    images = ImageSet(())
    np.testing.assert_array_equal(evaluate(tree, Points(), images), evaluate(fold(tree), Points(), images))
    assert len(list(walk(fold(tree)))) < len(list(walk(tree)))


def test_what_is_shared_stays_shared():
    folder = Folder()
    shared = product(U, product(ex.Constant(2.0), ex.Constant(3.0)))
    first, second = folder(ex.Math("SINE", shared, ex.ZERO, ex.ZERO)), folder(ex.ValueToColor(shared))
    assert first.a is second.value


def test_points_are_never_folded():
    for node in (ex.FresnelFactor(ex.ONE), ex.LayerWeight(ex.ONE), ex.Backfacing(), UV, ex.ImageTexture(ex.BLACK, 0)):
        assert not is_constant(fold(node))
