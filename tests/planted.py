# SPDX-License-Identifier: GPL-3.0-or-later
"""An error to plant in the reference.

Tests use it to see how a difference that nothing explains is handled.
"""

from etalon.lib.bsdfs.oren_nayar import OrenNayar

FACTOR = 1.05


def plant_bright_rough_diffuse(set_attribute=setattr):
    """Have rough diffuse surfaces of the reference reflect 5 % more than they should.

    `set_attribute` may be that of a test's monkeypatch, which takes the error out again.
    """
    right = OrenNayar.evaluate

    def evaluate(self, wi):
        value, pdf = right(self, wi)
        return FACTOR * value, pdf

    set_attribute(OrenNayar, "evaluate", evaluate)
