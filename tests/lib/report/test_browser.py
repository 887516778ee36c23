# SPDX-License-Identifier: GPL-3.0-or-later
"""The page in a browser.

Tested are what it opens with, what a click does, and that it stays within its window.
"""

import re

import numpy as np
import pytest
from etalon.lib.film.light_passes import LightPass
from etalon.lib.verdict.outcome import Outcome
from etalon.tests.lib.renderers import grey
from etalon.tests.lib.report.browser import PROGRAM, Browser
from etalon.tests.lib.report.comparisons import HOSTILE, comparison_of, made, written_page

pytestmark = pytest.mark.skipif(PROGRAM is None, reason="no Chromium or Chrome is on the path")

ROWS = "[...document.querySelectorAll('#table tbody tr')]"


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    found = Browser(tmp_path_factory.mktemp("browser"))
    yield found
    found.close()


@pytest.fixture(scope="module")
def comparison():
    """Two blocks of 64 x 48 pixels, called a ball, are 5 % brighter."""
    ball = np.zeros((48, 64))
    ball[16:32, 16:48] = 1.0
    coverage = {"material": [("Wall", 1.0 - ball)], "object": [(HOSTILE, ball)]}
    return made(truth=grey(1.0, 64, 48), other=grey(1.0, 64, 48) * (1 + 0.05 * ball[..., None]), coverage=coverage)


@pytest.fixture(scope="module")
def page(comparison, tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    written_page(comparison, folder, "etalon compare " + "long" * 60)
    return folder / "report.html"


@pytest.fixture
def opened(browser, page):
    browser.problems.clear()
    browser.open(page)
    yield browser
    assert browser.problems == []


def texts(browser, column):
    return browser.evaluate(f"{ROWS}.map((row) => row.cells[{column}].textContent)")


def pixels(browser, pane=0):
    """The colours of a pane, (height, width, 4)."""
    canvas = f"document.querySelectorAll('#panes canvas')[{pane}]"
    found = browser.evaluate(
        "((canvas, { width, height }) => {"
        "  const copy = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });"
        "  copy.drawImage(canvas, 0, 0);"
        "  return [width, height, [...copy.getImageData(0, 0, width, height).data]];"
        f"}})({canvas}, {canvas})"
    )
    return np.array(found[2]).reshape(found[1], found[0], 4)


def is_outline(colors):
    return (colors[..., :3] == (255, 216, 74)).all(axis=2)


def choose(browser, name, value):
    browser.evaluate(
        f"((one) => {{ one.value = '{value}'; one.dispatchEvent(new Event('input')); }})(document.getElementById('{name}'))"
    )
    browser.settle()


def test_the_table_opens_with_what_is_not_equivalent(opened, comparison):
    count = comparison.verdict.count(Outcome.DIFFERENT)
    assert set(texts(opened, 2)) == {"DIFFERENT"}
    assert texts(opened, 1)[0] == HOSTILE
    assert len(texts(opened, 2)) == count
    assert is_outline(pixels(opened)).any()


def test_the_filters_say_how_many_regions_pass_them(opened, comparison):
    verdict = comparison.verdict
    options = opened.evaluate("[...document.getElementById('outcome').options].map((one) => one.textContent)")
    same, differ = verdict.count(Outcome.EQUIVALENT), verdict.count(Outcome.DIFFERENT)
    assert options == [
        f"all ({same + differ})",
        f"not equivalent ({differ})",
        f"DIFFERENT ({differ})",
        "UNDECIDED (0)",
        "EXPLAINED (0)",
        f"EQUIVALENT ({same})",
    ]
    choose(opened, "outcome", "EQUIVALENT")
    assert texts(opened, 2) == ["EQUIVALENT"] * same
    choose(opened, "kind", "named")
    named = [
        kind for kind, out in zip(comparison.regions.kinds, verdict.outcomes, strict=True) if out is Outcome.EQUIVALENT
    ]
    expected = sum(kind not in ("block", "cell") for kind in named)
    assert opened.evaluate("document.getElementById('shown').textContent") == f"{expected} of {same + differ} regions"


def test_an_undecided_report_opens_with_what_is_undecided(browser, tmp_path):
    found = comparison_of("undecided")
    written_page(found, tmp_path, "")
    browser.problems.clear()
    browser.open(tmp_path / "report.html")
    assert texts(browser, 2) == ["UNDECIDED"] * found.verdict.count(Outcome.UNDECIDED)
    assert browser.problems == []


def test_a_click_on_a_row_zooms_to_the_region_and_outlines_its_pixels(opened):
    fitted = is_outline(pixels(opened))
    opened.click("#table tbody tr a")
    row, column = np.nonzero(is_outline(pixels(opened)))
    height, width = fitted.shape
    # The 32 pixels of 64 fill 6 tenths of the pane's width, in the middle of it.
    assert np.ptp(column) == pytest.approx(0.6 * width, abs=4)
    assert np.ptp(column) / np.ptp(row) == pytest.approx(32 / 16, abs=0.05)
    assert (row.min() + row.max()) / 2 == pytest.approx(height / 2, abs=3)
    assert (column.min() + column.max()) / 2 == pytest.approx(width / 2, abs=3)
    assert opened.evaluate("location.hash").startswith("#region-")
    assert HOSTILE in opened.evaluate("document.getElementById('chosen').textContent")
    assert opened.evaluate("document.querySelectorAll('#table tr[aria-current]').length") == 1


def test_a_count_shows_its_regions_in_table_and_picture(opened, comparison):
    opened.click(".counts a.EQUIVALENT")
    assert texts(opened, 2) == ["EQUIVALENT"] * comparison.verdict.count(Outcome.EQUIVALENT)
    assert is_outline(pixels(opened)).sum() > 1000


def test_the_divider_is_dragged_in_the_picture_and_moved_by_keys(opened):
    opened.click("[data-mode=split]")
    x, y = opened.place("#divider")
    opened.drag((x, y), (x - 200, y))
    width = opened.evaluate("document.querySelector('#panes canvas').clientWidth")
    share = float(opened.evaluate("document.getElementById('divider').getAttribute('aria-valuenow')"))
    assert share == pytest.approx(50 - 100 * 200 / width, abs=0.6)
    opened.evaluate("document.getElementById('divider').focus()")
    opened.press("Home")
    assert opened.evaluate("document.getElementById('divider').getAttribute('aria-valuenow')") == "0"


@pytest.mark.slow
def test_keys_choose_views_and_regions_and_move_the_picture(opened):
    opened.press("3", "3")
    assert opened.evaluate("document.querySelector('[data-mode=difference]').getAttribute('aria-pressed')") == "true"
    opened.press("n", "n")
    opened.press("n", "n")
    assert opened.evaluate(f"{ROWS}.findIndex((row) => row.hasAttribute('aria-current'))") == 2
    opened.evaluate("document.querySelector('#panes canvas').focus()")
    before = np.nonzero(is_outline(pixels(opened)))[1].mean()
    opened.press("ArrowLeft")
    after = np.nonzero(is_outline(pixels(opened)))[1].mean()
    assert after - before == pytest.approx(0.1 * pixels(opened).shape[1], abs=1.5)
    assert opened.evaluate("document.getElementById('reading').textContent").startswith("x ")


@pytest.mark.slow
def test_every_view_channel_and_colour_is_painted(opened):
    seen = set()
    for mode in ("beside", "split", "difference", "map", "eye"):
        opened.click(f"[data-mode={mode}]")
        seen.add(pixels(opened).tobytes())
    opened.click("[data-mode=beside]")
    for name, values in (("display", ("false", "standard")), ("channel", ("r", "g", "b", "luminance", "rgb"))):
        for value in values:
            choose(opened, name, value)
            assert pixels(opened)[..., 3].max() == 255
    assert len(seen) >= 4


@pytest.mark.parametrize("dark", [False, True])
def test_nothing_scrolls_sideways_at_390_pixels(browser, page, dark):
    browser.problems.clear()
    browser.open(page, 390, 800, dark)
    for mode in ("beside", "split", "difference", "map", "eye"):
        browser.click(f"[data-mode={mode}]")
        assert browser.evaluate("document.documentElement.scrollWidth") == 390
    browser.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    assert browser.evaluate("document.documentElement.scrollWidth") == 390
    assert browser.problems == []


PASSES = {LightPass.GLOSSY_INDIRECT: (0.1, 0.09), LightPass.DIFFUSE_DIRECT: (0.9, 0.9)}
PASS_ROWS = "[...document.querySelectorAll('#pass-table tbody tr')].filter((row) => !row.hidden)"


@pytest.fixture(scope="module")
def compared_by_pass():
    return made(passes=PASSES)


@pytest.fixture(scope="module")
def page_with_passes(compared_by_pass, tmp_path_factory):
    folder = tmp_path_factory.mktemp("passes")
    written_page(compared_by_pass, folder, "")
    return folder / "report.html"


@pytest.mark.slow
def test_a_pass_is_shown_in_place_of_the_image(browser, page_with_passes):
    """Its pictures, its significance and its rows.

    Verdicts of blocks and FLIP stay with the whole image.
    """
    browser.problems.clear()
    browser.open(page_with_passes)
    browser.click("[data-mode=difference]")
    image = pixels(browser), pixels(browser, 1)
    choose(browser, "pass", "0")
    assert all((pixels(browser, k) != image[k]).any() for k in range(2))
    # 10 % less light than the reference: as blue as the scale goes to.
    inside = pixels(browser)[..., :3][pixels(browser)[..., 3] == 255]
    assert inside[:, 2].mean() > inside[:, 0].mean() + 100
    rows = browser.evaluate(f"{PASS_ROWS}.map((row) => [row.cells[0].textContent, row.cells[1].textContent])")
    assert rows == [["glossy indirect", "whole image"], ["glossy indirect", "material Test"]]
    assert browser.evaluate("document.querySelector('[data-mode=eye]').disabled")
    browser.press("5", "5")
    assert browser.evaluate("document.querySelector('[data-mode=difference]').getAttribute('aria-pressed')") == "true"
    choose(browser, "pass", "-1")
    assert (pixels(browser) == image[0]).all()
    assert browser.evaluate(f"{PASS_ROWS}.length") == 3
    assert browser.problems == []


def numbers(cell):
    """The numbers of a cell, one for each channel or, with errors, two."""
    return [float(word) for word in cell.replace("±", " ").replace("%", " ").replace("\u2212", "-").split()]


def test_a_pixel_is_read_with_its_parts_on_both_sides_and_their_errors(browser, page_with_passes, compared_by_pass):
    """It is read by the keyboard and by the pointer.

    The standard errors are those of the films, to the digit that is shown.
    """
    browser.problems.clear()
    browser.open(page_with_passes)
    rows = "[...document.querySelectorAll('#decomposition tbody tr')].map((row) => [...row.cells].map((one) => one.textContent))"
    browser.evaluate("document.querySelector('#panes canvas').focus()")
    found = browser.evaluate(rows)
    assert [row[0] for row in found] == ["all of it", *map(str, PASSES)]
    x, y = browser.place("#panes canvas")
    browser.drag((x, y), (x + 1, y))
    column, row = map(
        int, re.match(r"x (\d+), y (\d+)", browser.evaluate("document.getElementById('reading').textContent")).groups()
    )
    sides = compared_by_pass.reference, compared_by_pass.candidate
    for light, cells in zip(PASSES, browser.evaluate(rows)[1:], strict=True):
        for side, cell in zip(sides, cells[1:3], strict=True):
            moments = side.pass_films[light]
            error = np.sqrt(moments.variance / moments.count)[row, column]
            np.testing.assert_allclose(numbers(cell)[::2], moments.mean[row, column], rtol=1e-3)
            np.testing.assert_allclose(numbers(cell)[1::2], error, rtol=0.4)
        assert len(numbers(cells[3])) == len(numbers(cells[4])) == 3
    assert browser.problems == []


def test_a_link_of_the_table_shows_its_pass(browser, page_with_passes):
    browser.problems.clear()
    browser.open(page_with_passes)
    browser.click("#pass-table a[href='#pass-1']")
    assert browser.evaluate("document.getElementById('pass').value") == "1"
    assert browser.problems == []


def test_passes_stay_within_390_pixels(browser, page_with_passes):
    browser.problems.clear()
    browser.open(page_with_passes, 390, 800)
    choose(browser, "pass", "0")
    assert browser.evaluate("document.documentElement.scrollWidth") == 390
    assert browser.problems == []


def test_passes_can_be_read_without_javascript(browser, page_with_passes):
    browser.open(page_with_passes, 390, 800, scripts=False)
    assert browser.evaluate("[...document.images].map((one) => one.naturalWidth)") == [24] * 9
    assert browser.evaluate(f"{PASS_ROWS}.length") == 3
    browser.evaluate("document.querySelector('#pass-0').open = true")
    assert browser.evaluate("document.querySelector('#pass-0 img').getBoundingClientRect().width") > 100
    assert browser.evaluate("document.documentElement.scrollWidth") == 390


def test_images_and_rows_are_there_without_javascript(browser, page, comparison):
    browser.problems.clear()
    browser.open(page, scripts=False)
    shown = browser.evaluate("[...document.images].map((one) => one.naturalWidth)")
    assert shown == [64, 64, 64]
    assert texts(browser, 1)[0] == HOSTILE
    assert not browser.evaluate(
        "[...document.querySelectorAll('[data-script]')].some((one) => one.offsetParent !== null)"
    )
