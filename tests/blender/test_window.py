# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's button, pressed with a mouse in a window of the real program."""

import json

import numpy as np
import pytest
from OpenImageIO import ImageBuf
from scipy import ndimage

pytestmark = pytest.mark.blender

START, RUN, STOP = 60, 240, 30  # bounds on waiting, in seconds; the comparison itself is given 30


def press_button(window, box, picture):
    """Find the panel's large button on the screen by its colour, and click on its middle."""
    window.screenshot(picture)
    left, top, width, height = box
    pixels = ImageBuf(str(picture)).get_pixels()[top : top + height, left : left + width, :3]
    blobs, count = ndimage.label((pixels > [0.97, -1, 0.97]).all(axis=2) & (pixels[..., 1] < 0.03))
    assert count, f"no button on {picture}"
    largest = 1 + np.argmax(ndimage.sum_labels(np.ones_like(blobs), blobs, range(1, count + 1)))
    y, x = ndimage.center_of_mass(blobs == largest)
    window.hand("mousemove", left + round(x), top + round(y), "click", "1")


def test_the_button_compares_and_leaves_everything_as_it_was(window, debian, tmp_path):
    before = window.wait_for("ready", seconds=START)
    press_button(window, before["box"], tmp_path / "panel.png")
    window.wait_for("started", seconds=START)
    assert window.wait_for("halfway", "ended", seconds=RUN)["event"] == "halfway"
    window.screenshot(tmp_path / "running.png")
    ended = window.wait_for("ended", seconds=RUN)
    window.wait_for("shown", seconds=STOP)
    window.screenshot(tmp_path / "ended.png")
    assert ended["errors"] == []
    assert ended["outcome"] in {"EQUIVALENT", "UNDECIDED"}
    assert ended["state"] == before["state"]
    assert ended["fractions"] > 10, "the window was not alive while the comparison ran"
    folder = debian.root / ended["folder"].lstrip("/")
    assert json.loads((folder / "verdict.json").read_text())["verdict"] == ended["outcome"]


def test_esc_cancels_and_the_button_works_again(window, debian, tmp_path):
    before = window.wait_for("ready", seconds=START)
    press_button(window, before["box"], tmp_path / "panel.png")
    assert window.wait_for("halfway", "ended", seconds=RUN)["event"] == "halfway"
    window.hand("key", "Escape")
    ended = window.wait_for("ended", seconds=STOP)
    assert ended["errors"] == []
    assert ended["stopped"] in {None, "cancelled"}
    folders = {path.name for path in debian.outside.glob("etalon-*") if path.is_dir()}
    assert folders <= {"etalon-out"}, "temporary files were left behind"
    assert ended["state"] == before["state"]
    window.wait_for("shown", seconds=STOP)
    window.screenshot(tmp_path / "cancelled.png")
    assert "cycles/worker.py" not in debian.run("sh", "-c", "cat /proc/[0-9]*/cmdline | tr '\\0' ' '").stdout
    press_button(window, before["box"], tmp_path / "panel.png")
    window.wait_for("started", seconds=START)
