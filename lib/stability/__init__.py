# SPDX-License-Identifier: GPL-3.0-or-later
"""The stability atlas: each equation of the reference against 50 digits over its whole domain, and what float32 makes of it.

measure.py says what an error is; domain.py where it is looked for; exact.py holds the truth (mpmath), single.py the same equations in
float32 as the documents print them and as Cycles writes them; closed_forms.py, inversions.py and identities.py are the
catalogue; atlas.py runs it and writes what it found.
"""
