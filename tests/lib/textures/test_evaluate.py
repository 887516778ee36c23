# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluation as a whole: shapes, laziness, sharing, conversions, numbers that overflow."""

import numpy as np
import pytest
from etalon.lib.scene import expressions as ex
from etalon.lib.scene.images import Image
from etalon.lib.textures.evaluate import Evaluator, evaluate
from etalon.lib.textures.images import ImageSet

UV = ex.Coordinates("UV", "map")


class Points:
    """Points that count what they are asked."""

    def __init__(self, rng, size=64):
        self.size, self.asked = size, []
        self._uv = np.concatenate([rng.random((2, size)), np.zeros((1, size))])
        self._uv.flags.writeable = False

    def coordinates(self, kind, uv_map):
        self.asked.append((kind, uv_map))
        return self._uv

    @property
    def cos_wo(self):
        self.asked.append("cos_wo")
        return np.full(self.size, 0.5)

    @property
    def backfacing(self):
        self.asked.append("backfacing")
        return np.zeros(self.size, bool)


NO_IMAGES = ImageSet(())


def test_constants_stay_small_and_ask_nothing(rng):
    points = Points(rng)
    value = ex.Math("MULTIPLY", ex.Constant(2.0), ex.Constant(3.0), ex.ZERO)
    color = ex.Mix(ex.Constant(0.5), ex.WHITE, ex.ValueToColor(value))
    assert evaluate(value, points, NO_IMAGES).shape == ()
    np.testing.assert_array_equal(evaluate(color, points, NO_IMAGES), [[3.5]] * 3)
    assert points.asked == []


def test_only_what_is_needed_is_asked_for_and_once(rng):
    points = Points(rng)
    value = ex.VectorToValue(UV)
    both = ex.Mix(value, ex.ValueToColor(value), UV)
    evaluator = Evaluator(points, NO_IMAGES)
    assert evaluator(both).shape == (3, 64)
    assert evaluator(ex.ColorToValue(UV)).shape == (64,)
    assert points.asked == [("UV", "map")]


@pytest.mark.parametrize(
    ("expression", "shape"),
    [
        (UV, (3, 64)),
        (ex.Mapping(UV, ex.BLACK, ex.BLACK, ex.WHITE), (3, 64)),
        (ex.ImageTexture(UV, 0), (3, 64)),
        (ex.ImageTexture(UV, 0, output="ALPHA"), (64,)),
        (ex.EnvironmentTexture(UV, 0), (3, 64)),
        (ex.Checker(UV, ex.WHITE, ex.BLACK, ex.Constant(5.0)), (3, 64)),
        (ex.Checker(UV, ex.WHITE, ex.BLACK, ex.Constant(5.0), output="FACTOR"), (64,)),
        (ex.Math("SINE", ex.VectorToValue(UV), ex.ZERO, ex.ZERO), (64,)),
        (ex.Mix(ex.ColorToValue(UV), ex.ZERO, ex.ONE), (64,)),
        (ex.Mix(UV, ex.BLACK, ex.WHITE), (3, 64)),
        (ex.ColorRamp(ex.VectorToValue(UV), (0.0, 1.0), ((0, 0, 0, 1), (1, 1, 1, 1))), (3, 64)),
        (ex.ColorRamp(ex.VectorToValue(UV), (0.0, 1.0), ((0, 0, 0, 1), (1, 1, 1, 1)), output="ALPHA"), (64,)),
        (ex.FresnelFactor(ex.Constant(1.5)), (64,)),
        (ex.LayerWeight(ex.Constant(0.5)), (64,)),
        (ex.LayerWeight(ex.Constant(0.5), output="FACING"), (64,)),
        (ex.Backfacing(), (64,)),
        (ex.ValueToColor(ex.VectorToValue(UV)), (3, 64)),
    ],
)
@pytest.mark.parametrize("size", [64, 0])
def test_every_node_has_its_shape(expression, shape, size, rng):
    """Light tracing may ask for no points, where none of them is in sight."""
    images = ImageSet([Image("", rng.random((3, 4, 4)).astype(np.float32), "SRGB")])
    got = evaluate(expression, Points(rng, size), images)
    assert got.shape == (*shape[:-1], size)
    assert got.dtype == np.float64
    assert np.isfinite(got).all()


def test_conversions():
    red = ex.Constant((1.0, 0.0, 0.0))
    assert evaluate(ex.ColorToValue(red), None, NO_IMAGES) == pytest.approx(0.2126, abs=5e-5)
    assert evaluate(ex.VectorToValue(red), None, NO_IMAGES) == pytest.approx(1 / 3)


@pytest.mark.parametrize(("place", "first"), [((0.5, 0.5, 0.5), False), ((1.5, 0.5, 0.5), True), ((-0.5, 0.5, 0.5), True),
                                              ((1.0, 1.0, 1.0), False), ((-1.0, 1.0, 0.0), True)])  # fmt: skip
def test_checker_cells(place, first):
    """Odd sums show the first colour.

    A whole coordinate belongs to the cell on the side of the origin, 0 to the one above.
    """
    node = ex.Checker(ex.Constant(place), ex.WHITE, ex.BLACK, ex.ONE, output="FACTOR")
    assert bool(evaluate(node, None, NO_IMAGES)[0]) is first


def test_overflow_is_handed_on_without_a_warning():
    huge = ex.Math("EXPONENT", ex.Constant(1e6), ex.ZERO, ex.ZERO)
    assert evaluate(huge, None, NO_IMAGES) == np.inf


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_fresnel_and_layer_weight_take_the_angle_to_their_normal(rng, side):
    points = Points(rng)
    points.wo = np.tile([[0.0], [0.0], [1.0]], 64)
    angle = 1.1
    turned = ex.Constant((side * np.sin(angle), 0.0, side * np.cos(angle)))
    # Snell and Fresnel, from air into glass.
    inside = np.arcsin(np.sin(angle) / 1.5)
    s = np.sin(inside - angle) / np.sin(inside + angle)
    p = np.tan(inside - angle) / np.tan(inside + angle)
    fresnel = evaluate(ex.FresnelFactor(ex.Constant(1.5), turned), points, NO_IMAGES)
    np.testing.assert_allclose(fresnel, 0.5 * (s**2 + p**2), rtol=1e-12)
    layer = evaluate(ex.LayerWeight(ex.Constant(1.0 / 3.0), normal=turned), points, NO_IMAGES)  # 1 / (1 - 1/3) = 1.5
    np.testing.assert_allclose(layer, fresnel, rtol=1e-12)
    facing = evaluate(ex.LayerWeight(ex.Constant(0.5), "FACING", turned), points, NO_IMAGES)
    np.testing.assert_allclose(facing, 1.0 - np.cos(angle), rtol=1e-12)
    assert "cos_wo" not in points.asked
