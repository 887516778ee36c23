# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a measurement.

Its files are complete and agree with each other, names are escaped, and gaps are reported.
"""

import csv
import json
import zlib
from copy import deepcopy

import numpy as np
import pytest
from etalon.lib.cost.document import Extras, document
from etalon.lib.cost.estimates import Estimate
from etalon.lib.cost.estimators import estimator_ways
from etalon.lib.cost.measure import measure
from etalon.lib.cost.models import Form, measure_forms
from etalon.lib.cost.spans import took
from etalon.lib.cost.summary import summarize
from etalon.lib.cost.verify import cheapest, verify
from etalon.lib.cost.ways import Bias, Way, reference_ways
from etalon.lib.cost.write import digits, interval, table, write_cost
from etalon.lib.errors import EtalonError
from etalon.lib.film.light_passes import LightPass
from etalon.lib.sampling.streams import VERIFICATION
from etalon.lib.scene.lights import SphereLight
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.lib.cost.synthetic import RELATIVE, Synthetic, way
from etalon.tests.scenes import floor, glossy, orthographic, scene
from markupsafe import escape

LIGHT = SphereLight("light", (1.0, 0.5, 2.0), 0.5, (10.0, 9.0, 8.0))
NAME = "<script>alert(1)</script> & $x_"


@pytest.fixture(scope="module")
def measured():
    seed = zlib.crc32(b"measured")
    ways = [
        way("mis", seed=seed),
        way("torrance-sparrow", Bias.FLOOR, seed=seed + 1, bias=0.2),
        way("cycles", Bias.FLOOR, seed=seed + 2, seconds=2e-3),
        way("cycles-denoised", Bias.UNKNOWN, seed=seed + 3, variance=0.01, bias=0.2),
    ]
    return measure(NAME, ways, "mis", 30.0, most_samples=16)


@pytest.fixture
def measurement(measured):
    return deepcopy(measured)


@pytest.fixture(scope="module")
def written(measured, tmp_path_factory):
    """The folder of a measurement, and its figures."""
    folder = tmp_path_factory.mktemp("cost")
    forms = (Form("Fresnel", "Schlick", "exact", 0.1, 0.2, 1.0, 30.0),)
    return folder, write_cost(measured, Extras(forms, command="etalon cost <x>"), folder)


def test_the_folder(written):
    """The folder has JSON without NaN, CSV with its points, and pictures.

    The scene's name is text on the page.
    """
    folder, figures = written
    assert {p.name for p in folder.iterdir()} == {"cost.html", "cost.json", "cost.csv", "cost.png", "cost.svg"}
    text = (folder / "cost.json").read_text(encoding="utf-8")
    assert json.loads(text, parse_constant=pytest.fail) == json.loads(json.dumps(figures))
    with (folder / "cost.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == sum(len(w["points"]) for w in figures["ways"]) == 12
    first = figures["ways"][0]["points"][0]
    assert float(rows[0]["error"]) == first["error"]["value"] == pytest.approx(np.sqrt(RELATIVE), rel=0.1)
    page = (folder / "cost.html").read_text(encoding="utf-8")
    assert "<script" not in page
    assert "&lt;script&gt;" in page
    assert "etalon cost &lt;x&gt;" in page
    assert page.count("<svg") == 1
    assert (folder / "cost.png").read_bytes().startswith(b"\x89PNG")


def test_stages_are_drawn_where_there_are_clocks(measurement, tmp_path):
    for m in measurement.ways[:1]:
        m.stages = {"intersect": 1.0, "shade": 2.0, "lights": 0.5, "film": 0.5}
    write_cost(measurement, Extras(), tmp_path)
    assert (tmp_path / "stages.svg").exists()
    assert "Where the time goes" in (tmp_path / "cost.html").read_text(encoding="utf-8")


def test_gaps_are_told(measurement, tmp_path):
    """A way without a point says why, in the table and on the page.

    Without Cycles there is no ratio to it.
    """
    late = measurement["cycles"]
    late.points, late.missing = [], "no time left to begin with it"
    figures = write_cost(measurement, Extras(targets=(0.1,)), tmp_path)
    assert figures["ways"][0]["ratio_to_cycles"] is None
    assert "cycles: no time left" in table(figures)
    assert "no time left" in (tmp_path / "cost.html").read_text(encoding="utf-8")


def test_the_table_has_the_cheapest_first(measurement):
    lines = table(document(measurement, Extras(targets=(0.1,)))).splitlines()
    assert lines[0].split() == ["to", "10", "%"]
    assert lines[1].startswith("mis")
    assert lines[2].startswith("cycles ")
    # Both are biased by 20 %.
    assert all("not reached" in line for line in lines[3:])
    assert len(lines) == 5


def test_the_page_opens_with_the_cheapest_unbiased_way(written):
    folder, figures = written
    (k,) = [k for k, target in enumerate(figures["targets"]) if target == 0.01]
    unbiased = [way for way in figures["ways"] if way["points"] and way["bias_kind"] == "none"]
    best = min(unbiased, key=lambda way: way["to_error"][k]["seconds"]["median"] or np.inf)
    said = summarize(figures)
    assert said.startswith(f"The cheapest unbiased way to 1 % is {best['label']}: ")
    assert f"<h1>{escape(said)}</h1>" in (folder / "cost.html").read_text(encoding="utf-8")


def test_an_error_that_no_unbiased_way_reaches_is_said(measurement):
    figures = document(measurement, Extras())
    for one in figures["ways"]:
        for told in one.get("to_error", ()):
            told["reached"] = False
    assert summarize(figures).startswith("No unbiased way that was measured is likely to reach 1 %")


def test_words():
    assert took({"median": None, "low": None, "high": None}) == "not reached"
    assert took({"median": None, "low": 5.0, "high": None}) == "not reached (at best 5 s)"
    assert took({"median": 60.0, "low": 30.0, "high": None}) == "60 s (30 s to never)"
    estimate = Estimate(0.5, 0.25, 1.0).__dict__
    assert (digits(estimate, 100), interval(estimate, 100)) == ("50", "25 to 100")
    assert (digits({"value": None, "low": None, "high": None}), interval({"value": 1, "low": None, "high": 1})) == (
        "—",
        "",
    )


def test_verification(measurement, seed):
    """The cheapest way that is no other model is run as forecast, and its error found anew."""
    key, told = cheapest(measurement, 0.1)
    assert key == "mis"
    seen = []

    class Watched(Synthetic):
        def render(self, replicate, samples, progress=None, windows=None):
            seen.append((replicate, samples))
            return super().render(replicate, samples)

    fresh = measurement["mis"]
    fresh.way = Way("mis", "mis", "sampling", lambda: Watched(seed + 9), Bias.NONE)
    came = verify(measurement, 0.1)
    assert seen[-2:] == [(VERIFICATION.number(1), came.samples), (VERIFICATION.number(1) + 1, came.samples)]
    assert came.samples == told.samples.median
    assert came.error == pytest.approx(np.sqrt(RELATIVE / came.samples), rel=0.1)
    # 1 / N = 0.1^2 takes 100 ms.
    assert came.to_target == pytest.approx(0.1 * RELATIVE, rel=0.2)


def test_nothing_reaches_it(measurement):
    measurement.ways[:] = [measurement["cycles-denoised"]]
    assert cheapest(measurement, 1e-4) is None
    assert verify(measurement, 1e-4) is None


def test_forms_of_the_model():
    """The forms have known errors.

    Walter's fit of Lambda is 0.3 % off in G1, Cook-Torrance is exact for glass, float32 has seven digits.
    """
    found = {(f.equation, f.form): f for f in measure_forms()}
    assert found["G1 of Beckmann", "rational Lambda"].largest_error == pytest.approx(3.1e-3, rel=0.1)
    assert found["Fresnel, glass", "Cook-Torrance"].largest_error < 1e-13
    assert 1e-3 < found["Fresnel, gold", "Schlick"].mean_error < 0.02
    for name in ("D of GGX", "G1 of GGX", "D of Beckmann", "G1 of Beckmann"):
        assert 1e-9 < found[name, "float32"].mean_error < 1e-5
    assert all(f.nanoseconds > 0.0 for f in found.values())


SCENE = scene([floor(4.0)], [glossy(0.9, 0.8, 0.6, 0.4)], orthographic(8, 8, 1.0, (0.0, 0.0, 2.0)), [LIGHT], 0.2, 1)


def test_reference_ways_are_the_integrator_s_strategies():
    """Keys of their own, one acceleration structure, and one image but for the models."""
    ways = reference_ways(SCENE, 0, 1, 5.0)
    assert len({w.key for w in ways}) == len(ways)
    assert all(w.opening > 5.0 for w in ways)
    assert {w.key for w in ways if w.bias is Bias.FLOOR} == {"separable", "torrance-sparrow"}
    assert [w.key for w in ways if w.rate] == ["random-mis"]
    renderers = {w.key: w.make() for w in ways}
    assert len({id(r.kernel.caster) for r in renderers.values()}) == 1
    means = {k: np.array([r.render(i, 64).radiance.mean() for i in range(8)]) for k, r in renderers.items()}
    for w in ways:
        if w.bias is Bias.NONE:
            error = np.hypot(means[w.key].std(), means["mis"].std()) / np.sqrt(7)
            assert abs(means[w.key].mean() - means["mis"].mean()) < 7.0 * error, w.key
    assert means["torrance-sparrow"].mean() > 1.02 * means["mis"].mean()


@pytest.mark.slow
def test_other_estimators_are_ways_with_the_image_of_path_tracing():
    ways = {w.key: w for w in estimator_ways(SCENE, 0, 1, 5.0)}
    assert set(ways) == {"light-tracing", "photon-mapping", "metropolis"}
    assert {w.group for w in ways.values()} == {"estimators"}
    mean = ReferenceRenderer(SCENE, Options(seed=1, threads=1)).render(0, 256).radiance.mean()
    for w in ways.values():
        renderer = w.make()
        found = np.array([renderer.render(k, 4).radiance.mean() for k in range(8)])
        room = 0.02 * mean if w.bias is Bias.UNKNOWN else 0.0  # photon mapping has a bias
        assert abs(found.mean() - mean) < 7.0 * found.std() / np.sqrt(7) + room, w.key


def test_other_estimators_refuse_light_passes_in_one_line():
    way = estimator_ways(SCENE, 0, 1, 0.0)[0]
    with pytest.raises(EtalonError, match="light-tracing has no light passes"):
        way.make().with_passes((LightPass.EMISSION,))
