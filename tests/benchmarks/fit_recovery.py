# SPDX-License-Identifier: GPL-3.0-or-later
"""How often `etalon fit` is right.

Planted materials have 1 % noise; measured are the coverage of its intervals, and the model that it names.

    python tests/benchmarks/fit_recovery.py [--tries 100] [--first 0]
    python tests/benchmarks/fit_recovery.py --known [--tries 100] # fits the planted model alone, and chooses none

For each planted material it prints in how many tries the truth lies in the 95 % interval of each parameter, how often
the planted model is named or among those that the data cannot tell apart, how often Beckmann and GGX are told apart,
and how often "none of these" is said. With `--known` it prints how far chi^2 rises to the true alpha, which has the
chi^2 distribution of one degree of freedom where intervals are right. `--first` chooses other tries.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from etalon.lib.fit.candidates import Candidate
from etalon.lib.fit.identify import identify
from etalon.lib.fit.intervals import CONFIDENCE
from etalon.lib.fit.solve import solve_from
from etalon.tests.lib.fit.planted import planted, planted_vector
from scipy.stats import binomtest, chi2, kstest

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


def study(name: str, tries: range) -> str:
    """A row of the table, with 95 % intervals (Clopper and Pearson) of what each count stands for."""
    candidate, truth = CASES[name]
    inside = dict.fromkeys(truth, 0)
    right = among = family = none = 0
    begin = time.process_time()
    for number in tries:
        found = identify(planted(_generator(name, number), candidate, **truth))
        chosen = found.best.candidate
        right += chosen == candidate
        among += any(one.candidate == candidate for one in found.equivalent)
        rival = {"ggx": "beckmann", "beckmann": "ggx"}.get(candidate.distribution)
        family += rival is not None and all(one.candidate.distribution != rival for one in found.equivalent)
        none += not found.fits
        for key, value in truth.items():
            low, high = found.intervals.get(NAMES[key], (np.nan, np.nan))
            inside[key] += low <= value <= high
    seconds = (time.process_time() - begin) / len(tries)
    covered = ", ".join(f"{NAMES[key]} {_share(count, tries)}" for key, count in inside.items())
    counts = " | ".join(_share(count, tries) for count in (right, among, family, none))
    return f"| {name} | {covered} | {counts} | {seconds:.1f} |"


def known(name: str, tries: range) -> str:
    """A row of the table for the planted model alone."""
    candidate, truth = CASES[name]
    vector, rises = planted_vector(candidate, **truth), []
    for number in tries:
        seen = planted(_generator(name, number), candidate, **truth)
        seen = seen.at_level(solve_from(candidate, seen, [vector]).predicted)
        best = solve_from(candidate, seen, [vector])
        rises.append(solve_from(candidate, seen, [best.vector], {0: float(vector[0])}).chi2 - best.chi2)
    inside = int(np.sum(np.array(rises) <= chi2.ppf(CONFIDENCE, 1)))
    return f"| {name} | {_share(inside, tries)} | {np.mean(rises):.2f} | {kstest(rises, chi2(1).cdf).pvalue:.2g} |"


def _generator(name: str, number: int) -> np.random.Generator:
    return np.random.default_rng((list(CASES).index(name), number))


def _share(count: int, tries: range) -> str:
    interval = binomtest(count, len(tries)).proportion_ci()
    return f"{count} ({interval.low:.0%} to {interval.high:.0%})"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tries", type=int, default=100)
    parser.add_argument("--case", type=int, help="one row only, counted from 0")
    parser.add_argument("--first", type=int, default=0, help="number of the first try")
    parser.add_argument("--known", action="store_true", help="fit the planted model alone")
    arguments = parser.parse_args()
    tries = range(arguments.first, arguments.first + arguments.tries)
    columns = ["planted", "truth inside", "named", "named or alike", "rival excluded", "none of these", "s each"]
    if arguments.known:
        columns = ["planted", "true alpha inside", "mean rise", "p of its distribution (Kolmogorov and Smirnov)"]
    print("| " + " | ".join(columns) + " |")
    print("|---" * len(columns) + "|")
    for number, name in enumerate(CASES):
        if arguments.case is None or arguments.case == number:
            print((known if arguments.known else study)(name, tries), flush=True)


if __name__ == "__main__":
    main()
