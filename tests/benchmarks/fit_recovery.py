# SPDX-License-Identifier: GPL-3.0-or-later
"""How often `etalon fit` is right.

Planted materials have 1 % noise; measured are the coverage of its intervals, and the model that it names.

    python tests/benchmarks/fit_recovery.py [--tries 100]

For each planted material it prints in how many tries the truth lies in the 95 % interval of each parameter, how often
the planted model is named or among those that the data cannot tell apart, how often Beckmann and GGX are told apart,
and how often "none of these" is said.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from etalon.lib.fit.candidates import Candidate
from etalon.lib.fit.identify import identify
from etalon.tests.lib.fit.planted import planted
from scipy.stats import binomtest

CASES = {
    "GGX, F0, alpha 0.3": (Candidate("ggx", "correlated", "schlick", False), {"alpha": 0.3}),
    "Beckmann, F0, alpha 0.3": (Candidate("beckmann", "correlated", "schlick", False), {"alpha": 0.3}),
    "Student-t, g 3, F0, alpha 0.3": (
        Candidate("student-t", "correlated", "schlick", False),
        {"alpha": 0.3, "inverse": 1.0 / 3.0},
    ),
    "GGX, metal, alpha 0.2": (Candidate("ggx", "correlated", "exact", False), {"alpha": 0.2}),
    "GGX, anisotropic, separable": (
        Candidate("ggx", "separable", "none", True),
        {"alpha": 0.3, "anisotropy": 2.0},
    ),
}
NAMES = {"alpha": "alpha", "anisotropy": "anisotropy", "inverse": "1/g"}


def study(name: str, tries: int) -> str:
    """A row of the table, with 95 % intervals (Clopper and Pearson) of what each count stands for."""
    candidate, truth = CASES[name]
    inside = dict.fromkeys(truth, 0)
    right = among = family = none = 0
    begin = time.process_time()
    for number in range(tries):
        found = identify(planted(np.random.default_rng((list(CASES).index(name), number)), candidate, **truth))
        chosen = found.best.candidate
        right += chosen == candidate
        among += any(one.candidate == candidate for one in found.equivalent)
        rival = {"ggx": "beckmann", "beckmann": "ggx"}.get(candidate.distribution)
        family += rival is not None and all(one.candidate.distribution != rival for one in found.equivalent)
        none += not found.fits
        for key, value in truth.items():
            low, high = found.intervals.get(NAMES[key], (np.nan, np.nan))
            inside[key] += low <= value <= high
    seconds = (time.process_time() - begin) / tries
    covered = ", ".join(f"{NAMES[key]} {_share(count, tries)}" for key, count in inside.items())
    counts = " | ".join(_share(count, tries) for count in (right, among, family, none))
    return f"| {name} | {covered} | {counts} | {seconds:.1f} |"


def _share(count: int, tries: int) -> str:
    interval = binomtest(count, tries).proportion_ci()
    return f"{count} ({interval.low:.0%} to {interval.high:.0%})"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tries", type=int, default=100)
    parser.add_argument("--case", type=int, help="one row only, counted from 0")
    arguments = parser.parse_args()
    print("| planted | truth inside | named | named or alike | rival excluded | none of these | s each |")
    print("|---|---|---|---|---|---|---|")
    for number, name in enumerate(CASES):
        if arguments.case is None or arguments.case == number:
            print(study(name, arguments.tries), flush=True)


if __name__ == "__main__":
    main()
