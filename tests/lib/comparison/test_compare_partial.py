# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparisons of a part.

Pixels that light from unknown materials reaches are left out, and the rest is judged as usual.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.effects.plan import Plan
from etalon.lib.errors import EtalonError
from etalon.lib.film.exr import read_exr
from etalon.lib.report import write_report
from etalon.lib.report.read import read_verdict
from etalon.lib.report.summary import summarize
from etalon.lib.report.words import sentences
from etalon.lib.scene.materials import Material
from etalon.lib.settings.reference import Options
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.wavefront.coverage import coverage
from etalon.lib.wavefront.reach import reached
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import diffuse, emission, floor, perspective, quad, scene

OPTIONS = CompareOptions(tolerance=0.05, time=None, samples=16, replicates=20)
UNKNOWN = Material("glow", (), "node 'Hair BSDF'")


def desk(lamp, floor_color=0.5):
    """A floor under a sky, a lamp, and a wall.

    The lamp hovers over the floor's right end, and the wall keeps its light from the left.
    """
    parts = [
        floor(6.0),
        quad((3.0, -1.0, 1.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), 1),
        quad((1.0, -40.0, -1.0), (0.0, 80.0, 0.0), (0.0, 0.0, 8.0), 2),
    ]
    view = perspective(48, 32, 0.5, (1.0, 0.0, 9.0))
    return scene(parts, [diffuse(floor_color), lamp, diffuse(0.0)], view, world=1.0)


def compared(known, unknown=UNKNOWN, seed=0):
    """The comparison of a reference that does not know the lamp with one that knows all."""
    partial = replace(known, materials=(known.materials[0], unknown, known.materials[2]))
    reference = ReferenceRenderer(partial, Options(seed=seed, threads=1))
    candidate = ReferenceRenderer(known, Options(seed=seed + 1, threads=1))
    return judged(partial, reference, candidate)


def judged(partial, reference, candidate):
    return compare(partial, reference, candidate, coverage(reference.kernel), OPTIONS, left_out=reached(reference))


def test_what_the_unknown_does_not_reach_is_equivalent(seed, tmp_path):
    found = compared(desk(emission(50.0)), seed=seed)
    assert found.verdict.outcome is Outcome.EQUIVALENT
    assert 0.1 < found.left_out.mean() < 0.9
    assert found.unknown == {"glow": "node 'Hair BSDF'"}
    assert not found.excluded.any()
    assert "glow" not in found.regions.names
    far = found.candidate.film.moments.mean > 2.0 * found.reference.film.moments.mean
    assert far.any()  # what was left out would have differed
    assert not far[~found.left_out].any()
    said = " ".join([*summarize(found), *sentences(found)])
    assert f"{found.left_out.sum()} of 1,536 pixels" in said
    assert "'glow' (node 'Hair BSDF')" in said
    write_report(found, Plan(()), tmp_path)
    figures = read_verdict(tmp_path / "verdict.json")
    assert figures["left_out"]["pixels"] == found.left_out.sum()
    assert figures["left_out"]["materials"] == [{"name": "glow", "what": "node 'Hair BSDF'"}]
    assert np.array_equal(np.isnan(read_exr(tmp_path / "difference.exr")["R"]), found.left_out)


def test_what_is_left_is_judged(seed):
    """The same scene, but for a floor that is a fifth brighter for one of them."""
    partial = replace(desk(UNKNOWN), materials=(diffuse(0.5), UNKNOWN, diffuse(0.0)))
    reference = ReferenceRenderer(partial, Options(seed=seed, threads=1))
    candidate = ReferenceRenderer(desk(emission(50.0), 0.6), Options(seed=seed + 1, threads=1))
    found = judged(partial, reference, candidate)
    assert found.verdict.outcome is Outcome.DIFFERENT


def test_nothing_left_is_an_error(seed):
    known = desk(emission(1.0))
    everywhere = replace(known, materials=(UNKNOWN, UNKNOWN, UNKNOWN))
    reference = ReferenceRenderer(everywhere, Options(seed=seed, threads=1))
    with pytest.raises(EtalonError, match="test: light from materials that are not simulated reaches every pixel"):
        judged(everywhere, reference, ReferenceRenderer(known))
