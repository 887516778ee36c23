# SPDX-License-Identifier: GPL-3.0-or-later
"""The page: safe from what a file's author called things, self-contained, and complete."""

import base64
import json
import re
import zlib
from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.film.regions import image_regions
from etalon.lib.film.view_transform import ViewTransform
from etalon.lib.report import write_report
from etalon.lib.report.page import label_maps, order_regions, significances
from etalon.lib.report.pixels import MANTISSA, SIGNIFICANCE_ONE
from etalon.tests.lib.renderers import grey
from etalon.tests.lib.report.comparisons import FILES, HOSTILE, PLAN, Page, comparison_of, made, written_page


def unpacked(page, name):
    """The bytes that a script element of the page holds."""
    return np.frombuffer(zlib.decompress(base64.b64decode(page.scripts[name].strip())), np.uint8)


def test_hostile_names_stay_text(tmp_path):
    harmless = made("Plain")
    plain = Page(written_page(harmless, tmp_path, "Plain"))
    # The seconds differ, and with them the marks on the axis of the curve.
    hostile = replace(made(HOSTILE, settings={HOSTILE: HOSTILE}), history=harmless.history)
    page = Page(written_page(hostile, tmp_path, HOSTILE))
    assert page.tags.count("img") == 3
    assert page.tags == plain.tags
    assert not any(name.startswith("on") for name, _ in page.attributes)
    assert any(HOSTILE in text for text in page.shown)
    view = json.loads(page.scripts["view"])
    assert view["regions"][1]["name"] == HOSTILE
    assert json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))["scene"] == HOSTILE
    assert {path.name for path in tmp_path.iterdir()} == FILES


def test_the_page_asks_nothing_of_a_network(comparison, tmp_path):
    text = written_page(comparison, tmp_path, "")
    page = Page(text)
    for name, value in page.attributes:
        assert name not in ("src", "href") or value.startswith(("data:", "#"))
    policy = dict(page.attributes)["content"]
    assert "default-src 'none'" in text
    assert policy
    outside = re.sub(r'<script type="text/plain".*?</script>', "", text, flags=re.S)
    for word in ("http://", "https://", "//cdn", "@import", "url(", "fetch(", "XMLHttpRequest", "sendBeacon"):
        assert word not in outside


def test_the_page_holds_the_floats(tmp_path):
    found = made(truth=grey() * np.linspace(0.1, 2, 24)[:, None])
    page = Page(written_page(found, tmp_path, ""))
    planes = unpacked(page, "floats-1").reshape(4, -1)
    held = np.ascontiguousarray(planes.T).view("<f4").reshape(20, 24, 3)
    np.testing.assert_allclose(held, found.candidate.film.moments.mean, rtol=2.0**-MANTISSA)
    assert not np.array_equal(held, found.candidate.film.moments.mean.astype(np.float32))


def test_the_plan_is_in_both(tmp_path):
    page = Page(written_page(comparison_of("equivalent"), tmp_path, ""))
    plan = json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))["plan"]
    assert plan[0] == {"effect": "GGX", "needed": True, "fact": f"material {HOSTILE}"}
    assert [decision["needed"] for decision in plan] == [True, False]
    assert f"material {HOSTILE}" in page.shown
    assert "no material has it" in page.shown
    assert "Simulated: 1 effect" in page.shown


def test_the_page_holds_flip_and_says_what_it_is_for(tmp_path):
    found = comparison_of("non-finite")
    page = Page(written_page(found, tmp_path, ""))
    held = unpacked(page, "flip").reshape(20, 24)
    assert np.argwhere(held == 255).tolist() == [[2, 5]]
    assert any("the verdict does not rest on it" in text for text in page.shown)


def test_significances_of_equal_images_are_standard_normal():
    """At 40 replicates the t distribution's variance is 1.03.

    1440 values have it with a standard error of 4 %.
    """
    found = significances(comparison_of("equivalent"))
    assert found.shape == (20, 24, 3)
    assert abs(found.mean()) < 0.15
    assert 0.85 < found.std() < 1.2


def test_the_significance_of_a_known_difference_grows_as_the_root_of_the_pixels_averaged():
    found = made(other=grey() * 1.05)
    one, four = significances(found), significances(found, 2)
    assert four.mean() / one.mean() == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize(("factor", "low", "high"), [(1.0 + 2.0**-22, 0.0, 0.1), (1.01, 100.0, np.inf)])
def test_the_last_digit_of_single_precision_is_no_significant_difference(factor, low, high):
    """Of light without noise, such as a plain sky; a difference of 1 % is significant there."""
    found = significances(made(other=grey() * factor, sigma=0.0))
    assert ((found > low) & (found < high)).all()


def test_there_is_no_significance_without_a_second_replicate(tmp_path):
    found = comparison_of("one replicate")
    assert np.isnan(significances(found)).all()
    page = Page(written_page(found, tmp_path, ""))
    assert (unpacked(page, "significance").view(np.int8) == -128).all()


def test_significances_travel_in_eighths(tmp_path):
    found = comparison_of("different")
    page = Page(written_page(found, tmp_path, ""))
    held = unpacked(page, "significance").view(np.int8).reshape(20, 24, 3) / SIGNIFICANCE_ONE
    np.testing.assert_allclose(held, np.clip(significances(found), -127 / 8, 127 / 8), atol=1 / 16)


def test_a_pixel_belongs_to_the_material_that_covers_most_of_it():
    left = np.zeros((4, 6))
    left[:, :3], left[:, 3] = 1.0, 0.4
    coverage = {"material": [("Left", left), ("Right", 1.0 - left)], "object": [("Ball", left)]}
    regions = image_regions(4, 6, coverage)
    kinds, labels = label_maps(replace(comparison_of("equivalent"), regions=regions), 1)
    assert kinds == ["material", "object"]
    numbers = {name: regions.names.index(name) + 1 for name in ("Left", "Right", "Ball")}
    assert labels[0, 0].tolist() == [numbers["Left"]] * 3 + [numbers["Right"]] * 3
    assert labels[1, 0].tolist() == [numbers["Ball"]] * 4 + [0] * 2


def test_the_page_opens_with_what_is_not_equivalent():
    def region(kind, outcome, difference, bound=0.01, excluded=0):
        sizes = {"pixels": 9, "excluded_pixels": excluded}
        return {"kind": kind, "outcome": outcome, "difference": [difference, 0.0, None], "bound": bound, **sizes}

    regions = [
        region("image", "EQUIVALENT", 0.0),
        region("block", "UNDECIDED", 0.9, None, excluded=9),
        region("block", "UNDECIDED", 0.9, 0.2),
        region("block", "UNDECIDED", 0.1, 0.3),  # the larger bound, not the larger difference
        region("block", "UNDECIDED", 0.1, None),
        region("material", "UNDECIDED", 0.1),
        region("block", "DIFFERENT", 0.02),
        region("block", "DIFFERENT", -0.5),
    ]
    assert order_regions(regions) == [7, 6, 5, 4, 3, 2, 1, 0]


def test_rows_are_readable_without_a_script(tmp_path):
    page = Page(written_page(made(HOSTILE, other=grey() * 1.05), tmp_path, ""))
    assert page.shown.count(HOSTILE) >= 1
    assert ("href", "#regions-DIFFERENT") in page.attributes
    assert ("href", "#region-1") in page.attributes


def test_a_view_transform_that_cannot_be_applied_is_named_and_srgb_takes_its_place(tmp_path):
    write_report(comparison_of("equivalent"), PLAN, tmp_path, "", ViewTransform(tmp_path / "nowhere.ocio", "AgX"))
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "view transform &#39;AgX&#39; cannot be applied" in text
    assert json.loads(Page(text).scripts["view"])["transform"] is None
