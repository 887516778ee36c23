# SPDX-License-Identifier: GPL-3.0-or-later
"""The stability atlas: each equation of the reference against 50 digits.

It covers the whole domain of each, and float32 forms too. measure.py defines the error, case.py one line of the atlas,
and domain.py the places where errors are looked for. The truth, in mpmath, is in exact.py, exact_lobes.py,
exact_lights.py and exact_inversions.py; the same equations in float32 in single.py, as the documents print them, and in
cycles_single.py and cycles_inversions.py, as Cycles writes them. closed_forms.py, lobes.py, lights.py, inversions.py,
identities.py and watertight.py are the catalogue; atlas.py runs it and writes what it found. outside.py names the
equations that the catalogue leaves out, and says why.
"""
