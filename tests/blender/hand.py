# SPDX-License-Identifier: GPL-3.0-or-later
"""Eye and hand of the tests.

They find a colour on the screen, click there, and wait for the result.
"""

import numpy as np
from OpenImageIO import ImageBuf
from scipy import ndimage

START, RUN, STOP = 180, 240, 60  # bounds on waiting, in seconds; the comparison itself is given 12
LIST_ROW = 21  # pixels from one row of a list to the next


def find(window, box, picture, colour):
    """The middle, on the screen, of the largest patch of that colour in a box of it."""
    window.screenshot(picture)
    left, top, width, height = box
    pixels = ImageBuf(str(picture)).get_pixels()[top : top + height, left : left + width, :3]
    blobs, count = ndimage.label((np.abs(pixels - colour) < 0.03).all(axis=2))
    assert count, f"nothing of that colour on {picture}"
    largest = 1 + np.argmax(ndimage.sum_labels(np.ones_like(blobs), blobs, range(1, count + 1)))
    y, x = ndimage.center_of_mass(blobs == largest)
    return left + round(x), top + round(y)


def click(window, x, y):
    """Move the mouse there, let Blender see that, and click."""
    window.hand("mousemove", x, y)
    window.ask("None")
    window.hand("click", "1")


def press_button(window, box, picture):
    """Find the panel's large button on the screen by its colour, and click on its middle."""
    click(window, *find(window, box, picture, (1.0, 0.0, 1.0)))


def wait_until(window, condition, questions=100):
    """Ask until the condition holds; every question waits for Blender's timer."""
    for _ in range(questions):
        if window.ask(condition):
            return
    raise AssertionError(f"never true: {condition}")


def settle(window, questions=12):
    """Let Blender draw for a second: its panels glide to their places."""
    for _ in range(questions):
        window.ask("None")
