# SPDX-License-Identifier: GPL-3.0-or-later
"""Uses of random numbers share no replicate and no key.

No code numbers replicates on its own.
"""

import ast
import re
from itertools import combinations, product
from pathlib import Path

import pytest
from etalon.lib import sampling
from etalon.lib.errors import EtalonError
from etalon.lib.sampling import streams
from etalon.lib.sampling.sobol import stream_key

ROOT = Path(sampling.__file__).parents[2]


def numbers(stream):
    return range(stream.first, stream.first + stream.count)


def overlaps(streams_):
    return [
        (a.use, b.use)
        for a, b in combinations(streams_, 2)
        if max(a.first, b.first) < min(a.first + a.count, b.first + b.count)
    ]


def test_no_two_streams_share_a_replicate():
    assert not overlaps(streams.STREAMS)
    assert all(stream.count > 0 for stream in streams.STREAMS)


def test_an_overlap_is_seen():
    planted = streams.Stream("another", streams.REACH.first, 2)
    assert overlaps((*streams.STREAMS, planted)) == [
        (streams.REACH.use, "another"),
        (streams.FIRST_CALLS.use, "another"),
    ]


def test_every_stream_of_the_registry_is_listed():
    named = [value for value in vars(streams).values() if isinstance(value, streams.Stream)]
    assert set(named) == set(streams.STREAMS)
    assert len(named) == len(streams.STREAMS)


def test_a_number_beyond_the_range_is_refused():
    assert streams.TRUTH.number(0) == streams.TRUTH.first
    assert streams.TRUTH.number(streams.TRUTH.count - 1) in numbers(streams.TRUTH)
    for k in (-1, streams.TRUTH.count):
        with pytest.raises(EtalonError, match="give fewer replicates"):
            streams.TRUTH.number(k)


def test_what_cycles_renders_has_seeds_of_its_own():
    """A chunk of an image's samples adds CYCLES_REPLICATES to the seed.

    So every replicate must stay below it.
    """
    on_both_sides = set(streams.STREAMS) - {
        streams.COVERAGE,
        streams.REACH,
        streams.DEPARTURES,
        streams.SCOUTING,
        streams.STAND_INS,
    }
    assert all(stream.first >= 0 for stream in on_both_sides)
    assert all(stream.first + stream.count <= streams.CYCLES_REPLICATES for stream in on_both_sides)


def test_dimensions_of_a_path_are_distinct():
    decisions = (streams.BSDF, streams.LIGHT, streams.CHOICES, streams.FATE)
    dimensions = [streams.PIXEL, streams.LENS, streams.PIXEL_KEYS, streams.RANDOM_NUMBERS]
    dimensions += [streams.step_dimension(step, decision) for step, decision in product(range(200), decisions)]
    dimensions += [streams.WAVELENGTH, streams.EMITTER, streams.PLACE, streams.HEADING]
    of_lights = (streams.ADJOINT_CHOICES, streams.ADJOINT_BSDF, streams.ADJOINT_LENS, streams.ADJOINT_FATE)
    dimensions += [streams.light_step_dimension(step, decision) for step, decision in product(range(200), of_lights)]
    assert len(set(dimensions)) == len(dimensions)
    assert set(decisions) == set(range(streams.DIMENSIONS_PER_STEP))


def test_keys_at_both_ends_of_every_stream_differ():
    """64-bit keys of every dimension, of seeds beside each other.

    A collision by chance has a probability of 1e-12.
    """
    ends = sorted({k for stream in streams.STREAMS for k in (numbers(stream)[0], numbers(stream)[-1])})
    keys = [int(stream_key(*parts)) for parts in product((-1, 0, 1, 2**32), ends, range(-2, 40))]
    assert len(set(keys)) == len(keys)


def replicates_of_their_own(source):
    """Lines of calls .render(...) and Sampler(...) with a replicate of their own.

    It is written out as a number or summed up from numbers.
    """
    found = []
    if not re.search(
        r"\b(render|render_counted|SobolSampler|RandomSampler)\(", source
    ):  # looking is quicker than reading
        return found
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.Call):
            continue
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if name in ("render", "render_counted", "SobolSampler", "RandomSampler"):
            parts = [part for argument in node.args[:2] for part in ast.walk(argument)]
            inside = [
                part for part in parts if isinstance(part, ast.Call) and getattr(part.func, "attr", "") == "number"
            ]
            literal = any(isinstance(part, ast.Constant) and isinstance(part.value, int) for part in parts)
            if literal and not inside:
                found.append(node.lineno)
    return found


def test_nobody_numbers_replicates_on_their_own():
    assert replicates_of_their_own("renderer.render((1 << 20) + k, samples)") == [1]
    assert not replicates_of_their_own("renderer.render(FIRST_CALLS.number(1), samples)")
    files = [path for room in ("lib", "addon") for path in sorted((ROOT / room).rglob("*.py"))]
    assert len(files) > 100
    found = {str(path.relative_to(ROOT)): replicates_of_their_own(path.read_text()) for path in files}
    assert not {name: lines for name, lines in found.items() if lines}
