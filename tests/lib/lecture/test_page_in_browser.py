# SPDX-License-Identifier: GPL-3.0-or-later
"""The lecture's page in a browser.

The inversions follow the mouse and the keys, and show what the reference computes.
"""

import numpy as np
import pytest
from etalon.lib.lecture import inversions, page
from etalon.tests.lib.report.browser import PROGRAM, Browser

pytestmark = pytest.mark.skipif(PROGRAM is None, reason="no Chromium or Chrome is on the path")

SHOWN = "document.querySelector('[data-shows={}]').textContent"


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    found = Browser(tmp_path_factory.mktemp("browser"))
    yield found
    found.close()


@pytest.fixture
def opened(browser, tmp_path):
    path = tmp_path / "lecture.html"
    page.illustrate(path, ("inversions",), 0)
    browser.problems.clear()
    browser.open(path)
    yield browser
    assert browser.problems == []


def shown(browser, name):
    return browser.evaluate(SHOWN.format(name))


def expect_numbers(browser):
    """The numbers shown are those of the reference for the cell about the point."""
    xi1, xi2 = (float(browser.evaluate(f"state_of('{name}')")) for name in ("xi1", "xi2"))
    widened, _ = inversions.stretch(inversions.CELLS * xi2 - 0.5, inversions.CELLS * xi1 - 0.5)
    m = inversions.normals(np.array([xi1]), np.array([xi2]))
    four = 4.0 * abs(float(inversions.observer() @ m[:, 0]))
    assert float(shown(browser, "widened")) == pytest.approx(widened, abs=2e-3)
    assert float(shown(browser, "four")) == pytest.approx(four, abs=1e-3)
    assert shown(browser, "m").startswith(f"θ = {np.degrees(np.arccos(m[2, 0])):.1f}°")


def test_inversions_follow_mouse_and_keys_with_the_numbers_of_the_reference(opened):
    opened.evaluate("window.state_of = (name) => document.querySelector(`input[name=${name}]`).value")
    expect_numbers(opened)
    opened.evaluate("document.querySelector('input[name=xi2]').focus()")
    before = opened.evaluate("state_of('xi2')")
    opened.press("ArrowRight")
    assert float(opened.evaluate("state_of('xi2')")) == pytest.approx(float(before) + 0.005)
    expect_numbers(opened)
    # A point of the disc of normals, dragged: the slope 0.3 at an azimuth of 90 degrees is xi1 = 1/4, xi2 = 1 - 1/e.
    box = "(({x, y, width}) => [x, y, width])(document.querySelectorAll('.disc')[1].getBoundingClientRect())"
    opened.place(".discs figure:nth-child(2) svg")
    x, y, width = opened.evaluate(box)
    middle, radius = np.array([x + 0.5 * width, y + 0.5 * width]), width / 2.1
    opened.drag(tuple(middle), tuple(middle - [0.0, radius * 0.3 / np.hypot(1.0, 0.3)]))
    assert float(shown(opened, "xi1")) == pytest.approx(0.25, abs=0.01)
    assert float(shown(opened, "xi2")) == pytest.approx(1.0 - np.exp(-1.0), abs=0.02)


@pytest.mark.parametrize("width", [390, 1400])
def test_page_stays_within_its_window_and_needs_no_script(browser, tmp_path, width):
    path = tmp_path / "lecture.html"
    page.illustrate(path, ("inversions", "slips"), 0)
    browser.open(path, width, scripts=False)
    assert browser.evaluate("document.documentElement.scrollWidth") <= width
    assert browser.evaluate("document.querySelector('#inversions-play').hidden")
    assert browser.evaluate("document.querySelectorAll('.disc polygon').length") > 400
