# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of an image: that they cover what they must, and cost no more than the whole."""

import numpy as np
import pytest
from etalon.lib.film.windows import Windows, windows_around


def blocks(shape, *corners):
    inside = np.zeros(shape, bool)
    for x, y in corners:
        inside[y : y + 16, x : x + 16] = True
    return inside


def test_the_mask_is_what_the_boxes_hold_both_ends_included():
    windows = Windows((4, 5), ((1, 0, 2, 1), (4, 3, 4, 3)))
    assert windows.mask.astype(int).tolist() == [[0, 1, 1, 0, 0], [0, 1, 1, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 1]]
    assert windows.pixels == 5


def test_neighbours_are_one_window_and_far_ones_are_two():
    inside = blocks((300, 600), (0, 0), (16, 16), (560, 270))
    assert windows_around(inside, 8).boxes == ((0, 0, 31, 31), (560, 270, 575, 285))


@pytest.mark.parametrize("count", [1, 30, 300])
def test_everything_is_covered_by_few_windows(rng, count):
    inside = blocks((480, 640), *(16 * rng.integers(0, (40, 30), (count, 2))))
    windows = windows_around(inside, 8)
    assert (windows.mask | ~inside).all()
    assert 1 <= len(windows.boxes) <= 32
    assert windows.mask.sum() <= inside.size


def test_windows_of_a_frame_leave_out_its_middle():
    inside = np.zeros((300, 400), bool)
    inside[20:280, 40:360] = True
    inside[40:260, 60:340] = False
    windows = windows_around(inside, 16)
    assert (windows.mask | ~inside).all()
    assert windows.pixels < 1.2 * inside.sum()
    assert windows_around(inside, 0).boxes == ((40, 20, 359, 279),)


def test_noise_all_over_a_large_image_is_one_window(rng):
    inside = rng.random((2160, 3840)) < 1e-3
    assert windows_around(inside, 8).share > 0.99
