# SPDX-License-Identifier: GPL-3.0-or-later
"""A pixel taken apart: parts that are known, and their errors."""

from copy import copy

import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.film.light_passes import LightPass
from etalon.lib.film.parts import WORLD, BounceLimit, EmitterLight
from etalon.lib.probe import measure
from etalon.lib.probe.measure import probe
from etalon.lib.probe.words import probe_lines
from etalon.lib.progress import Progress
from etalon.tests.lib.renderers import Painter, grey

SHARES = {
    LightPass.DIFFUSE_DIRECT: 0.6,
    LightPass.GLOSSY_INDIRECT: 0.4,
    BounceLimit(1): 0.9,
    BounceLimit(0): 0.6,
    EmitterLight("Key"): 0.75,
    WORLD: 0.25,
}
SHAPE = (20, 24)
LEFT = np.pad(np.ones(SHAPE)[:, :12], ((0, 0), (0, 12)))[..., None]


class Parted(Painter):
    """A painter whose parts are those that are asked for."""

    def with_passes(self, passes):
        more = copy(self)
        more.passes = {part: self.passes[part] for part in passes}
        return more


def painters(sigma=0.05, change=None):
    """The light is 1 on the left and 3 on the right; Cycles has 10 % less light of Key."""
    truth = grey() * (3.0 - 2.0 * LEFT)
    parts = {part: truth * share for part, share in SHARES.items()}
    theirs = parts | {EmitterLight("Key"): 0.9 * parts[EmitterLight("Key")]}
    sides = (("the reference", parts), ("Cycles", theirs))
    return tuple(Parted(name, truth, sigma, passes=light, change=change) for name, light in sides)


def read(box, seconds=0.2, **how):
    return probe(painters(**how), SHAPE, box, tuple(SHARES), seconds, Progress())


def test_every_part_is_read_in_the_pixels_that_are_asked_for():
    found = read((20, 3, 21, 4))
    names = [(one.kind, one.name) for one in found.readings]
    assert names == [
        ("image", "all of it"),
        ("light pass", "diffuse direct"),
        ("light pass", "glossy indirect"),
        ("bounce", "up to 0 bounces"),
        ("bounce", "bounce 1"),
        ("bounce", "beyond bounce 1"),
        ("light", "light of 'Key'"),
        ("light", "light of the world"),
    ]
    expected = 3.0 * np.array([1.0, 0.6, 0.4, 0.6, 0.3, 0.1, 0.75, 0.25])
    theirs = expected.copy()
    theirs[6] *= 0.9
    for side, truth in (("reference", expected), ("cycles", theirs)):
        means = np.array([getattr(one, side) for one in found.readings])
        errors = np.array([getattr(one, f"{side}_error") for one in found.readings])
        assert (errors > 0.0).all()
        assert (np.abs(means - truth[:, None]) < 6.0 * errors + 1e-12).all()


def test_errors_are_those_of_the_means(rng):
    """Noise of one sample of 5 %.

    The error of the image is that over the root of all samples and pixels.
    """
    found = read((0, 0, 1, 1))
    expected = 0.05 / np.sqrt(4 * found.samples * found.replicates)
    assert found.readings[0].reference_error[0] == pytest.approx(expected, rel=0.6)


def test_light_without_noise_is_the_same_on_both_sides():
    lines = probe_lines("Test", read((0, 0, 0, 0), sigma=0.0))
    assert "pixel x 0, y 0" in lines[0]
    assert any(
        line.split() == ["diffuse", "direct", "0.6", "±", "0", "0.6", "±", "0", "+0.00", "%", "±", "0.00", "%"]
        for line in lines
    )
    assert any("-10.00 %" in line and "Key" in line for line in lines)


def test_cancelled_before_there_is_anything_to_read():
    with pytest.raises(EtalonError, match="cancelled before there were two replicates"):
        probe(painters(), SHAPE, (0, 0, 0, 0), tuple(SHARES), 1.0, Progress(is_cancelled=lambda: True))


def test_equal_sums_leave_no_light_beyond_the_last_bounce():
    means = np.array([[1.0 + 2e-16] * 3, [0.1] * 3, [1.0] * 3])
    found = measure._increments(means, (BounceLimit(0), BounceLimit(1)))
    assert (found[-1] == 0.0).all()
