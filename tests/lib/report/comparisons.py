# SPDX-License-Identifier: GPL-3.0-or-later
"""Comparisons of images that are known, and the pages written of them."""

import functools
from html.parser import HTMLParser

import numpy as np
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.comparison.departures import Alternatives
from etalon.lib.departures.catalogue import Departure
from etalon.lib.effects.plan import Decision, Plan
from etalon.lib.film.light_passes import LightPass
from etalon.lib.film.parts import BounceLimit, EmitterLight
from etalon.lib.progress import Progress
from etalon.lib.report import write_report
from etalon.tests.lib.renderers import Painter, blank, grey

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


def left_half(height=20, width=24):
    """1 in the left half of an image, 0 elsewhere."""
    return np.pad(np.ones((height, width // 2)), ((0, 0), (0, width - width // 2)))


BRIGHTER = grey() * (1 + 0.05 * left_half()[..., None])


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
    "passes": {"passes": {LightPass.GLOSSY_INDIRECT: (0.1, 0.095), LightPass.DIFFUSE_DIRECT: (0.9, 0.9)}},
    "parts": {"passes": {BounceLimit(0): (0.5, 0.5), EmitterLight(HOSTILE): (0.9, 0.95)}},
    "noisy passes": {"passes": {LightPass.EMISSION: (1.0, 1.0)}, "replicates": 1},
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
    by_rounding=False,
    finding="",
    passes=None,
    show=None,
):
    """A comparison of two known images.

    `effects` are what departures, by name, add to the left half of the reference. `by_rounding`: rounding decides how
    much of them acts. `finding` is the check of the scene check that they come from. `passes` are parts of the image,
    by light pass: the reference's and Cycles'. `show` is called at each look.
    """
    passes = passes or {}
    truth = grey() if truth is None else truth
    height, width, _ = truth.shape
    half = left_half(height, width)
    parts = [{light: truth * share[k] for light, share in passes.items()} for k in range(2)]
    reference = Painter("the reference", truth, sigma, passes=parts[0])
    candidate = Painter("Cycles", truth if other is None else other, sigma, settings, change=change, passes=parts[1])
    coverage = {"material": [(name, half)]} if coverage is None else coverage
    options = CompareOptions(time=None, samples=16, replicates=replicates)
    stopped = []

    def departed(names):
        def note(replicate, image):
            stopped.append(stop)
            return image

        added = sum(effects[one] for one in names) * half[..., None]
        return Painter("the reference", truth * (1 + added), sigma, change=note)

    among = effects
    if effects is not None:
        known = (Departure(one, f"{one} it is.", "a.h", by_rounding=by_rounding, finding=finding) for one in effects)
        among = Alternatives(tuple(known), departed)
    return compare(
        blank(width, height, name),
        reference,
        candidate,
        coverage,
        options,
        Progress(is_cancelled=lambda: any(stopped), **({} if show is None else {"show": show})),
        among,
        passes=tuple(passes),
    )


@functools.cache
def comparison_of(case):
    """One of CASES, made once: tests read it, and none changes it."""
    with np.errstate(invalid="ignore"):
        return made(**CASES[case])


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
        is_pass = isinstance(self._id, str) and self._id.startswith(("pass-", "errors-"))
        if (
            isinstance(self._id, int)
            or is_pass
            or self._id in ("view", "floats-0", "floats-1", "flip", "significance", "labels")
        ):
            self.scripts[self._id] = self.scripts.get(self._id, "") + data
        else:
            self.shown.append(data)


def written_page(comparison, folder, command):
    write_report(comparison, PLAN, folder, command)
    return (folder / "report.html").read_text(encoding="utf-8")
