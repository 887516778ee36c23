# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that a comparison leaves: its figures under their schema, its page safe from what a file's author called things."""

import base64
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from etalon.lib import report as package
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.departures.catalogue import Departure
from etalon.lib.departures.effects import Alternatives
from etalon.lib.effects.plan import Decision, Plan
from etalon.lib.errors import EtalonError
from etalon.lib.film.exr import read_exr
from etalon.lib.pages.formats import format_duration, format_percent
from etalon.lib.progress import Progress
from etalon.lib.report import write_report
from etalon.lib.report.document import CHANGES, VERSION, document
from etalon.lib.report.flip import flip
from etalon.lib.report.read import read_verdict
from etalon.lib.report.words import sentences
from etalon.lib.report.write import averaged
from etalon.lib.verdict.causes import State
from etalon.lib.verdict.outcome import Outcome
from etalon.tests.lib.renderers import Painter, blank, grey
from jsonschema import Draft202012Validator

SCHEMA = json.loads((Path(package.__file__).parent / "verdict.schema.json").read_text(encoding="utf-8"))
FILES = {
    "verdict.json",
    "report.html",
    "reference.exr",
    "cycles.exr",
    "difference.exr",
    "reference.png",
    "cycles.png",
    "difference.png",
}
HOSTILE = "</script><img src=x onerror=alert(1)>&\"'{{ 7*7 }}\u2028\u202e../../etc"
PLAN = Plan((Decision("GGX", True, f"material {HOSTILE}"), Decision("Beckmann", False, "no material has it")))
HALF = np.pad(np.ones((20, 12)), ((0, 0), (0, 12)))
BRIGHTER = grey() * (1 + 0.05 * HALF[..., None])


def bad_pixel(replicate, image):
    image[2, 5] = np.nan
    return image


CASES = {
    "equivalent": {},
    "different": {"other": BRIGHTER},
    "explained": {"other": BRIGHTER, "effects": {"known": 0.05}},
    "likely": {"other": BRIGHTER, "effects": {"known": 0.05}, "replicates": 8, "sigma": 0.18},
    "partial": {"other": BRIGHTER, "effects": {"known": 0.02, "other": 0.0}},
    "no reason": {"other": BRIGHTER, "effects": {"known": 0.0, "other": 0.0}},
    "none applies": {"other": BRIGHTER, "effects": {}},
    "cancelled": {"other": BRIGHTER, "effects": {"known": 0.05}, "stop": True},
    "undecided": {"sigma": 3.0},
    "one replicate": {"replicates": 1},
    "black": {"truth": grey(0.0)},
    "light on black": {"truth": grey(0.0), "other": grey(1e-3)},
    "non-finite": {"change": bad_pixel},
    "nothing finite": {"change": lambda replicate, image: image * np.inf},
    "one pixel": {"truth": grey(1.0, 1, 1), "coverage": {}},
}


def made(
    name="Test",
    truth=None,
    other=None,
    sigma=0.05,
    replicates=40,
    change=None,
    coverage=None,
    settings=None,
    effects=None,
    stop=False,
):
    """A comparison of two known images; `effects` are what departures, by name, add to the left half of the reference."""
    truth = grey() if truth is None else truth
    height, width, _ = truth.shape
    reference = Painter("the reference", truth, sigma)
    candidate = Painter("Cycles", truth if other is None else other, sigma, settings, change=change)
    coverage = {"material": [(name, HALF)]} if coverage is None else coverage
    options = CompareOptions(time=None, samples=16, replicates=replicates)
    stopped = []

    def departed(names):
        def note(replicate, image):
            stopped.append(stop)
            return image

        added = sum(effects[one] for one in names) * HALF[..., None]
        return Painter("the reference", truth * (1 + added), sigma, change=note)

    among = effects
    if effects is not None:
        among = Alternatives(tuple(Departure(one, f"{one} it is.", "a.h") for one in effects), departed)
    return compare(
        blank(width, height, name),
        reference,
        candidate,
        coverage,
        options,
        Progress(is_cancelled=lambda: any(stopped)),
        among,
    )


@pytest.fixture(params=CASES)
def comparison(request):
    with np.errstate(invalid="ignore"):
        return made(**CASES[request.param])


def test_the_schema_is_one():
    Draft202012Validator.check_schema(SCHEMA)


def test_figures_are_what_the_schema_says(comparison):
    figures = json.loads(json.dumps(document(comparison, PLAN, "etalon compare"), allow_nan=False))
    errors = [f"{list(e.absolute_path)}: {e.message[:200]}" for e in Draft202012Validator(SCHEMA).iter_errors(figures)]
    assert errors == []
    assert figures["exit_code"] == comparison.verdict.outcome.exit_code


def test_the_schema_notices_what_is_amiss():
    figures = json.loads(json.dumps(document(made(), PLAN, "")))
    valid = Draft202012Validator(SCHEMA).is_valid
    assert valid(figures)
    for broken in ({"version": 2}, {"verdict": "FINE"}, {"tolerance": 0}, {"surplus": 1}, {"regions": [{}]}):
        assert not valid(figures | broken)
    assert not valid({key: value for key, value in figures.items() if key != "looks"})


def test_all_files_are_there_and_nothing_else(comparison, tmp_path):
    write_report(comparison, PLAN, tmp_path / "deep" / "out", "etalon compare scene.blend")
    assert {path.name for path in (tmp_path / "deep" / "out").iterdir()} == FILES
    assert all(path.stat().st_size for path in (tmp_path / "deep" / "out").iterdir())


def test_images_on_disk_are_the_films(tmp_path):
    found = made(**CASES["non-finite"])
    write_report(found, PLAN, tmp_path)
    pixels = np.stack([read_exr(tmp_path / "cycles.exr")[c] for c in "RGB"], axis=2)
    np.testing.assert_allclose(pixels, found.candidate.film.moments.mean, rtol=1e-6)
    assert np.isnan(pixels[2, 5]).all()
    difference = read_exr(tmp_path / "difference.exr")["G"]
    e, c = (side.film.moments.mean[..., 1] for side in (found.reference, found.candidate))
    np.testing.assert_allclose(difference, (c - e) / e, rtol=1e-5, atol=1e-7)


class Page(HTMLParser):
    """The elements of a page, and what its scripts hold."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.scripts, self.shown = [], [], {}, []
        self._id = None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs
        self._id = dict(attrs).get("id", len(self.tags)) if tag == "script" else tag

    def handle_data(self, data):
        if isinstance(self._id, int) or self._id in ("view", "floats-0", "floats-1", "flip"):
            self.scripts[self._id] = self.scripts.get(self._id, "") + data
        else:
            self.shown.append(data)


def test_hostile_names_stay_text(tmp_path):
    plain = Page(_written(made("Plain"), tmp_path, "Plain"))
    hostile = made(HOSTILE, settings={HOSTILE: HOSTILE})
    page = Page(_written(hostile, tmp_path, HOSTILE))
    assert "img" not in page.tags
    assert page.tags == plain.tags
    assert not any(name.startswith("on") for name, _ in page.attributes)
    assert any(HOSTILE in text for text in page.shown)
    view = json.loads(page.scripts["view"])
    assert view["regions"][1][1] == HOSTILE
    assert json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))["scene"] == HOSTILE
    assert {path.name for path in tmp_path.iterdir()} == FILES


def _written(comparison, folder, command):
    write_report(comparison, PLAN, folder, command)
    return (folder / "report.html").read_text(encoding="utf-8")


def test_the_page_asks_nothing_of_a_network(comparison, tmp_path):
    text = _written(comparison, tmp_path, "")
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
    page = Page(_written(found, tmp_path, ""))
    held = np.frombuffer(base64.b64decode(page.scripts["floats-1"].strip()), "<f4").reshape(20, 24, 3)
    np.testing.assert_allclose(held, found.candidate.film.moments.mean, rtol=1e-6)


def test_the_plan_is_in_both(tmp_path):
    page = Page(_written(made(), tmp_path, ""))
    plan = json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))["plan"]
    assert plan[0] == {"effect": "GGX", "needed": True, "fact": f"material {HOSTILE}"}
    assert [decision["needed"] for decision in plan] == [True, False]
    assert f"material {HOSTILE}" in page.shown
    assert "no material has it" in page.shown
    assert "Simulated: 1 effects" in page.shown


def _hunt(linear):
    """L*, a*, b* of a linear Rec. 709 colour (D65) with the Hunt effect, as FLIP compares them (section 3 of the paper)."""
    to_xyz = np.array([[0.412391, 0.357584, 0.180481], [0.212639, 0.715169, 0.072192], [0.019331, 0.119195, 0.950532]])
    xyz = to_xyz @ np.asarray(linear, float) / to_xyz.sum(axis=1)
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    lightness = 116 * f[1] - 16
    return np.array([lightness, 0.01 * lightness * 500 * (f[0] - f[1]), 0.01 * lightness * 200 * (f[1] - f[2])])


def _flip_of_uniform(one, other):
    """FLIP of two images without any feature: HyAB to the power 0.7, its lower 0.4 spread over 0.95 (Andersson et al. 2020, section 3.3)."""

    def hyab(a, b):
        d = _hunt(a) - _hunt(b)
        return (abs(d[0]) + np.hypot(d[1], d[2])) ** 0.7

    most = hyab((0, 1, 0), (0, 0, 1))
    low = 0.4 * most
    error = hyab(one, other)
    return 0.95 * error / low if error < low else 0.95 + 0.05 * (error - low) / (most - low)


@pytest.mark.parametrize("color", [(1.0, 1.0, 1.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
def test_flip_of_uniform_images_is_its_closed_form(color):
    black = np.zeros((64, 64, 3))
    expected = _flip_of_uniform((0.0, 0.0, 0.0), color)
    np.testing.assert_allclose(flip(black, black + np.array(color), 0.0), expected, atol=2e-3)


def test_flip_sees_what_is_shown():
    """Equal images are 0; what is brighter than white is white, and one stop less it is not; a pixel that is not finite has no value."""
    white = np.ones((64, 64, 3))
    assert flip(white, white, 1.0).max() == 0.0
    assert flip(white, 1.5 * white, 0.0).max() == 0.0
    assert flip(white, 1.5 * white, -1.0).min() > 0.01
    broken = white.copy()
    broken[3, 4, 0] = np.nan
    assert np.argwhere(np.isnan(flip(white, broken, 0.0))).tolist() == [[3, 4]]


def test_the_page_holds_flip_and_says_what_it_is_for(tmp_path):
    found = made(**CASES["non-finite"])
    page = Page(_written(found, tmp_path, ""))
    held = np.frombuffer(base64.b64decode(page.scripts["flip"].strip()), np.uint8).reshape(20, 24)
    assert np.argwhere(held == 255).tolist() == [[2, 5]]
    assert any("the verdict does not rest on it" in text for text in page.shown)


def test_a_verdict_is_read_back_and_an_older_one_told_apart(tmp_path):
    path = tmp_path / "verdict.json"
    write_report(made(), PLAN, tmp_path)
    figures = read_verdict(path)
    assert figures["verdict"] == "EQUIVALENT"
    assert [entry["version"] for entry in figures["changes"]] == list(CHANGES) == list(range(2, VERSION + 1))
    for broken, told in (
        ({"version": 1}, "is of version 1, .*compare again. Version 2: .*departures.* Version 3: .*plan"),
        ({"version": 2}, "is of version 2, .*compare again. Version 3: "),
        ({"version": VERSION + 1}, f"only version {VERSION} is known here; update etalon"),
        ({"version": None}, "is of version None"),
        ({"format": "shopping"}, "is no verdict of etalon's"),
    ):
        path.write_text(json.dumps(figures | broken))
        with pytest.raises(EtalonError, match=told):
            read_verdict(path)
    for text, told in (("{", "is not JSON"), ("[]", "is no verdict")):
        path.write_text(text)
        with pytest.raises(EtalonError, match=told):
            read_verdict(path)
    with pytest.raises(EtalonError, match="cannot be read"):
        read_verdict(tmp_path / "nowhere.json")


def test_a_failed_write_leaves_what_was_there(tmp_path, monkeypatch):
    write_report(made(), PLAN, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def full(*args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("etalon.lib.report.write.write_png", full)
    with pytest.raises(EtalonError, match=r"cannot be written \(No space left on device\); make room"):
        write_report(made(**CASES["different"]), PLAN, tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_folder_that_is_a_file_is_named(tmp_path):
    (tmp_path / "out").write_text("a file")
    with pytest.raises(EtalonError, match=r"out is a file, not a folder"):
        write_report(made(), PLAN, tmp_path / "out")


def test_large_images_are_averaged_block_by_block(rng):
    image = rng.random((7, 5, 3))
    small = averaged(image, 3)
    assert small.shape == (3, 2, 3)
    np.testing.assert_allclose(small[2, 1], image[6:, 3:].mean(axis=(0, 1)), rtol=1e-12)
    np.testing.assert_allclose(averaged(image, 1), image, rtol=1e-12)


def test_the_verdict_in_words():
    said = {name: sentences(made(**CASES[name])) for name in ("equivalent", "different", "undecided", "one replicate")}
    assert said["equivalent"][0] == "Cycles agrees with the reference to within 1 % in all 6 regions."
    assert said["different"][0].startswith("Cycles differs from the reference by more than 1 % in ")
    assert "Furthest off: material Test +5" in said["different"][2]
    assert said["undecided"][0] == "Whether Cycles agrees with the reference to within 1 % is not decided."
    assert said["undecided"][-1].startswith("Deciding the 6 open regions takes ")
    assert any("Fewer than two replicates" in sentence for sentence in said["one replicate"])


def test_a_smaller_image_is_recommended_where_a_large_one_takes_long(monkeypatch):
    found = made(**CASES["undecided"])
    advice = "--set scene.render.resolution_percentage=25"
    assert advice not in sentences(found)[-1]
    monkeypatch.setattr("etalon.lib.report.words.LARGE", 400)
    slow = replace(found, round_seconds=1e3)
    assert advice in sentences(slow)[-1]
    assert advice not in sentences(replace(found, round_seconds=1e-6))[-1]


def test_a_blender_newer_than_the_newest_checked_is_reported_in_words_and_figures(tmp_path):
    settings = {"version": "99.1.0", "build": "abc123, 2099-01-01"}
    known = made(settings=settings)
    newer = replace(known, blender=(99, 1))
    (said,) = (s for s in sentences(newer) if "99.1" in s)
    assert said.startswith("Blender 99.1 is newer than")
    assert not any("newer" in s for s in sentences(known))
    figures = document(newer, PLAN, "")["blender"]
    assert figures["is_newer_than_checked"]
    assert not document(known, PLAN, "")["blender"]["is_newer_than_checked"]
    assert (figures["version"], figures["build"]) == ("99.1.0", "abc123, 2099-01-01")
    page = _written(newer, tmp_path, "")
    assert "Blender 99.1.0 (build abc123, 2099-01-01)" in page
    assert said in page


def test_numbers_in_words():
    assert [format_percent(v) for v in (0.01234, -0.5, float("inf"))] == ["+1.23 %", "-50 %", "unbounded"]
    assert [format_duration(v) for v in (0.5, 42, 600, 7200, 3e5, 1e9)] == [
        "0.5 s",
        "42 s",
        "10 min",
        "2 h",
        "3 days",
        "years",
    ]


SAID = {
    "explained": (
        State.CAUSE,
        r"Cause: known. It is sufficient to explain every region that differs: with it, the reference agrees with Cycles to within 1 %, "
        r"and accounts for [\d.]+ % of the difference in material Test \([\d.]+ % to [\d.]+ %\).",
    ),
    "likely": (
        State.LIKELY,
        r"Likely cause, not proved yet: known. It accounts for [\d.]+ % of the difference in material Test \([\d.]+ % to [\d.]+ %, "
        r"99 % confidence for this share alone\). A proof should take about .* in all, [\d.]+ times the replicates.",
    ),
    "partial": (
        State.PARTIAL,
        r"Partial cause: known. It accounts for [\d.]+ % of the difference in material Test \([\d.]+ % to [\d.]+ %\); "
        r"\+[\d.]+ % is left over there, in [RGB].",
    ),
    "no reason": (
        State.NO_REASON,
        r"Unexplained: \d regions differ for no known reason. Tried: known and other; each is shown to account for less than 20 % of the "
        r"difference.",
    ),
    "none applies": (
        State.NO_DEPARTURE,
        r"Unexplained: \d regions differ, and no known departure of Cycles applies to this scene.",
    ),
    "cancelled": (
        State.NO_TIME,
        r"Unexplained: \d regions differ. The departures that apply \(known\) were not measured: the comparison was cancelled.",
    ),
}


@pytest.mark.parametrize("case", SAID)
def test_what_is_known_of_causes_is_said_in_words_and_figures(case, tmp_path):
    state, words = SAID[case]
    found = made(**CASES[case])
    assert found.explanation.state is state
    said = [sentence for sentence in sentences(found) if re.fullmatch(words, sentence)]
    assert len(said) == 1, sentences(found)
    figures = document(found, PLAN, "")
    assert figures["attribution"]["state"] == state.value
    assert said[0] in figures["attribution"]["sentences"]
    assert figures["unexplained"] == (0 if state is State.CAUSE else found.verdict.count(Outcome.DIFFERENT))
    assert said[0] in Page(_written(found, tmp_path, "")).shown


def test_a_difference_whose_causes_were_not_sought_is_said_to_be_unexplained():
    found = made(**CASES["different"])
    count = found.verdict.count(Outcome.DIFFERENT)
    assert f"Unexplained: {count} regions differ. Departures were not searched." in sentences(found)
    assert document(found, PLAN, "")["attribution"]["state"] == "not searched"


def test_where_nothing_differs_no_cause_is_spoken_of():
    found = made(**CASES["equivalent"])
    figures = document(found, PLAN, "")
    assert (figures["attribution"], figures["unexplained"]) == (None, 0)


def test_one_region_differs_in_the_singular():
    other = grey()
    other[16:, 16:] *= 1.1
    found = made(other=other, coverage={}, effects={})
    assert found.verdict.count(Outcome.DIFFERENT) == 1
    assert "Unexplained: 1 region differs, and no known departure of Cycles applies to this scene." in sentences(found)


def test_departures_that_do_the_same_are_rivals():
    found = made(other=BRIGHTER, effects={"known": 0.05, "twin": 0.05})
    assert found.verdict.outcome is Outcome.EXPLAINED
    assert any(
        re.fullmatch(r"(known or twin|twin or known): the data do not tell them apart.", sentence)
        for sentence in sentences(found)
    )
    assert len(document(found, PLAN, "")["attribution"]["rivals"]) == 1


def test_what_explains_some_regions_is_named_beside_those_that_differ_for_no_known_reason():
    """The left half has the departure, a corner of the right one is brighter for a reason of its own."""
    other = BRIGHTER.copy()
    other[16:, 16:] *= 1.1
    found = made(other=other, coverage={}, effects={"known": 0.05}, sigma=0.01)
    said = sentences(found)
    assert any(
        re.search(r"^Partial cause: known\..* It explains \d of the \d regions that differ\.", s) for s in said
    ), said
    assert any(re.search(r"^Unexplained: \d regions? differs? ", s) for s in said), said
