# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that an audit writes.

Its figures follow their schema, and its page is safe from the names that a file's author chose.
"""

import base64
import functools
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest
from etalon.lib import audit as package
from etalon.lib.audit.document import table
from etalon.lib.audit.measure import audit
from etalon.lib.audit.setting import FACTORY, Setting
from etalon.lib.audit.summary import summarize
from etalon.lib.audit.write import write_audit
from etalon.lib.comparison.compare import CompareOptions
from etalon.lib.film.rendering import Rendering
from jsonschema import Draft202012Validator
from markupsafe import escape

SCHEMA = json.loads((Path(package.__file__).parent / "audit.schema.json").read_text(encoding="utf-8"))
HOSTILE = "</script><img src=x onerror=alert(1)>&\"'{{ 7*7 }}\u2028\u202e../../etc"


class Painter:
    """One image, with noise from the replicate's number."""

    name = "Painter"

    def __init__(self, image, settings=None, noise=0.01):
        self.image, self.settings, self.noise = image, settings or {}, noise

    def render(self, replicate, samples, progress, windows=None):
        rng = np.random.default_rng(replicate)
        image = self.image * (1.0 + self.noise * rng.standard_normal((*self.image.shape[:2], 1)))
        return Rendering(image, np.zeros(image.shape[:2], int), 0.01)


def image(value=1.0, part=1.0):
    out = np.full((20, 24, 3), value)
    out[:, :12] *= part
    return out


@functools.cache  # each takes the time that it is given; tests read it, and none changes it
def made(name="Test", level=1.0, broken=False, candidates=True, noise=0.01):
    biased = image(level, 0.9)
    if broken:
        biased[1, 2] = np.inf
    settings = [
        (Setting("clamp", name, name, name, name), Painter(image(level), noise=noise)),
        (Setting("filter-factory", name, name, name, name, FACTORY), Painter(biased, noise=noise)),
        (Setting("all", name, name, name, name, together=True), Painter(image(2.0 * level), noise=noise)),
    ]
    same, missing = (Setting("same", name, name, name, name),), (Setting("gone", name, name, name, name, missing=name),)
    neutral = Painter(image(level), {name: name}, noise)
    options = CompareOptions(time=0.4, samples=2)
    return audit(name, neutral, settings if candidates else [], options, 64, same, missing)


CASES = {
    "plain": {},
    "black": {"level": 0.0},
    "non-finite": {"broken": True},
    "nothing": {"candidates": False},
    "no noise": {"noise": 0.0},
}


@pytest.fixture(params=CASES)
def found(request):
    with np.errstate(invalid="ignore"):
        return made(**CASES[request.param])


class Page(HTMLParser):
    """The elements of a page, and what it shows."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.shown = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs

    def handle_data(self, data):
        self.shown.append(data)


def test_figures_are_what_the_schema_says(found, tmp_path):
    Draft202012Validator.check_schema(SCHEMA)
    figures = write_audit(found, tmp_path, "etalon audit")
    written = json.loads((tmp_path / "audit.json").read_text(encoding="utf-8"))
    assert written == figures
    assert [
        f"{list(e.absolute_path)}: {e.message[:200]}" for e in Draft202012Validator(SCHEMA).iter_errors(written)
    ] == []
    assert not Draft202012Validator(SCHEMA).is_valid(written | {"surplus": 1})
    maps = {entry["map"] for entry in figures["settings"]}
    assert {p.name for p in tmp_path.iterdir()} == {"audit.json", "audit.html"} | maps | (
        {"neutral.png"} if maps else set()
    )


def test_the_page_opens_with_the_setting_that_costs_most(tmp_path):
    figures = write_audit(made(), tmp_path)
    worst = next(entry for entry in figures["settings"] if not entry["together"])
    assert worst["outcome"] == "DIFFERENT"
    said = summarize(figures)
    assert said.startswith(f"The setting that costs most is {worst['label']}, {worst['value']} (")
    assert f"<h1>{escape(said)}</h1>" in (tmp_path / "audit.html").read_text(encoding="utf-8")


def test_an_audit_that_finds_no_bias_says_so(tmp_path):
    figures = write_audit(made(), tmp_path)
    for entry in figures["settings"]:
        entry["outcome"] = "EQUIVALENT"
    assert summarize(figures) == "No setting costs accuracy: none is off by more than 1 % anywhere."
    assert summarize(figures | {"settings": [], "missing": []}) == "Every setting is at its neutral value."


def test_the_table_says_it_in_order(tmp_path):
    lines = table(write_audit(made(), tmp_path)).splitlines()
    assert lines[0].split()[:3] == ["setting", "value", "verdict"]
    assert lines[1].split()[:4] == ["Test", "Test,", "factory", "biased"]
    assert lines[2].split()[:4] == ["Test", "Test", "no", "bias"]
    assert "-5 % (-5 to -5)" in lines[1]
    assert "x 0-15, y " in lines[1]
    assert lines[2].count(" 0 ") == 2
    assert "+100 %" in lines[3]
    assert lines[4] == "Test Test: not measured, Test"
    assert lines[5] == "as neutral: Test"


def test_hostile_names_stay_text(tmp_path):
    write_audit(made(), tmp_path, "Test")
    plain = Page((tmp_path / "audit.html").read_text(encoding="utf-8"))
    write_audit(made(HOSTILE), tmp_path, HOSTILE)
    text = (tmp_path / "audit.html").read_text(encoding="utf-8")
    page = Page(text)
    assert page.tags == plain.tags
    assert "script" not in page.tags
    assert not any(name.startswith("on") for name, _ in page.attributes)
    assert any(HOSTILE in shown for shown in page.shown)
    assert not re.search(r'(src|href)="(?!data:)', text)


def test_the_page_carries_no_more_pixels_than_it_shows(tmp_path, monkeypatch):
    monkeypatch.setattr("etalon.lib.audit.write.SHOWN", 100)
    write_audit(made(), tmp_path)
    text = (tmp_path / "audit.html").read_text(encoding="utf-8")
    for code, name in zip(
        re.findall(r'base64,([^"]+)"', text), ("neutral.png", "map-filter-factory.png"), strict=False
    ):
        (tmp_path / "small.png").write_bytes(base64.b64decode(code))
        small, whole = (OpenImageIO.ImageInput.open(str(tmp_path / n)) for n in ("small.png", name))
        assert (small.spec().width, small.spec().height) == (8, 7)
        assert (whole.spec().width, whole.spec().height) == (24, 20)
        means = [np.asarray(file.read_image("uint8")).astype(float).mean() for file in (small, whole)]
        assert means[0] == pytest.approx(means[1], rel=0.05)
    assert not list(tmp_path.glob(".*"))


def test_maps_are_signed(tmp_path):
    write_audit(made(), tmp_path)

    def mean(name):
        return (
            np.asarray(OpenImageIO.ImageInput.open(str(tmp_path / name)).read_image("uint8"))
            .astype(float)
            .mean(axis=(0, 1))
        )

    assert mean("map-all.png")[0] > 1.5 * mean("map-all.png")[2]
    assert mean("map-filter-factory.png")[0] < mean("map-filter-factory.png")[2]
    np.testing.assert_array_equal(mean("map-clamp.png"), 247.0)
