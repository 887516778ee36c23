# SPDX-License-Identifier: GPL-3.0-or-later
"""Every public function and class of the equations has a row in the atlas.

Otherwise it stands in the list that says why not. The rooms that hold equations are covered.
"""

import ast
import sys
from pathlib import Path

import numpy as np
from etalon import lib
from etalon.lib.microfacets import densities
from etalon.lib.microfacets.beckmann import Beckmann
from etalon.lib.microfacets.ggx import GGX
from etalon.lib.stability.closed_forms import closed_forms
from etalon.lib.stability.inversions import inversions
from etalon.lib.stability.lights import lights_and_factors
from etalon.lib.stability.lobes import lobes
from etalon.lib.stability.outside import OUTSIDE

ROOMS = ("microfacets", "bsdfs", "lights", "sampling")
ROOT = Path(lib.__file__).resolve().parent
# Rows of identities.py call this one, at places of their own.
BY_IDENTITIES = {"microfacets.densities.pdf_d_cos": densities.pdf_d_cos}


def public_names():
    """Name -> the (file, first line) of its code: of a class, that of all its methods.

    Those of a distribution are equations, one by one.
    """
    found = {}
    for room in ROOMS:
        for path in sorted((ROOT / room).glob("*.py")):
            for node in ast.parse(path.read_text(encoding="utf-8")).body:
                for name, code in equations(node):
                    inside = [part for part in ast.walk(code) if isinstance(part, ast.FunctionDef)]
                    lines = {min([part.lineno, *(d.lineno for d in part.decorator_list)]) for part in inside}
                    found[f"{room}.{path.stem}.{name}"] = {(str(path), line) for line in lines}
    return found


def equations(node):
    """The public name and code of a statement that defines a function or a class.

    Of a distribution those of its public methods.
    """
    if not isinstance(node, ast.FunctionDef | ast.ClassDef) or node.name.startswith("_"):
        return
    bases = {base.id for base in node.bases} if isinstance(node, ast.ClassDef) else set()
    if bases & {"Distribution", "BoundedDistribution"} and node.name != "BoundedDistribution":
        parts = (part for part in node.body if isinstance(part, ast.FunctionDef))
        yield from ((f"{node.name}.{part.name}", part) for part in parts if not part.name.startswith("_"))
    else:
        yield node.name, node


def called(action):
    """The (file, first line) of every Python function that runs while `action` does."""
    seen = set()

    def note(frame, event, argument):
        if event == "call":
            seen.add((frame.f_code.co_filename, frame.f_code.co_firstlineno))

    sys.setprofile(note)
    try:
        action()
    finally:
        sys.setprofile(None)
    return {(str(Path(name).resolve()), line) for name, line in seen}


def measured():
    """What the rows of the atlas call."""
    ran = set()
    for function in (*closed_forms(), *lobes(), *lights_and_factors(), *inversions()):
        arguments = function.draw(np.random.default_rng(1), 40)
        ran |= called(lambda f=function, a=arguments: f.kernel(a))
    return ran


def test_every_equation_is_measured_or_the_list_says_why_not():
    names, ran = public_names(), measured()
    assert len(names) > 90
    inside = {name for name, code in names.items() if code & ran} | set(BY_IDENTITIES)
    assert not set(OUTSIDE) - set(names), "names that are gone"
    assert not set(names) - inside - set(OUTSIDE), "give them a row, or a reason in lib/stability/outside.py"
    assert not set(OUTSIDE) & inside, "these have a row by now"
    assert all(reason.strip() for reason in OUTSIDE.values())


def test_what_runs_is_seen():
    m = np.array([[0.0], [0.0], [1.0]])
    ran = called(lambda: GGX().density(m, 0.5, 0.5))
    names = public_names()
    assert names["microfacets.ggx.GGX.density"] & ran
    assert not names["microfacets.beckmann.Beckmann.density"] & ran
    assert called(lambda: Beckmann().density(m, 0.5, 0.5)) & names["microfacets.beckmann.Beckmann.density"]
