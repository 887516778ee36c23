# SPDX-License-Identifier: GPL-3.0-or-later
"""The page: safe from what a file's author called things, self-contained, and complete."""

import base64
import json
import re
from dataclasses import replace

import numpy as np
from etalon.tests.lib.renderers import grey
from etalon.tests.lib.report.comparisons import CASES, FILES, HOSTILE, Page, made, written_page


def test_hostile_names_stay_text(tmp_path):
    harmless = made("Plain")
    plain = Page(written_page(harmless, tmp_path, "Plain"))
    # The seconds differ, and with them the marks on the axis of the curve.
    hostile = replace(made(HOSTILE, settings={HOSTILE: HOSTILE}), history=harmless.history)
    page = Page(written_page(hostile, tmp_path, HOSTILE))
    assert "img" not in page.tags
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
        assert name not in ("src", "href") or value.startswith("data:")
    policy = dict(page.attributes)["content"]
    assert "default-src 'none'" in text
    assert policy
    outside = re.sub(r'<script type="text/plain".*?</script>', "", text, flags=re.S)
    for word in ("http://", "https://", "//cdn", "@import", "url(", "fetch(", "XMLHttpRequest", "sendBeacon"):
        assert word not in outside


def test_the_page_holds_the_floats(tmp_path):
    found = made(truth=grey() * np.linspace(0.1, 2, 24)[:, None])
    page = Page(written_page(found, tmp_path, ""))
    held = np.frombuffer(base64.b64decode(page.scripts["floats-1"].strip()), "<f4").reshape(20, 24, 3)
    np.testing.assert_allclose(held, found.candidate.film.moments.mean, rtol=1e-6)


def test_the_plan_is_in_both(tmp_path):
    page = Page(written_page(made(), tmp_path, ""))
    plan = json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))["plan"]
    assert plan[0] == {"effect": "GGX", "needed": True, "fact": f"material {HOSTILE}"}
    assert [decision["needed"] for decision in plan] == [True, False]
    assert f"material {HOSTILE}" in page.shown
    assert "no material has it" in page.shown
    assert "Simulated: 1 effect" in page.shown


def test_the_page_holds_flip_and_says_what_it_is_for(tmp_path):
    found = made(**CASES["non-finite"])
    page = Page(written_page(found, tmp_path, ""))
    held = np.frombuffer(base64.b64decode(page.scripts["flip"].strip()), np.uint8).reshape(20, 24)
    assert np.argwhere(held == 255).tolist() == [[2, 5]]
    assert any("the verdict does not rest on it" in text for text in page.shown)
