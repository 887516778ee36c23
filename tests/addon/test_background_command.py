# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel keeps of a command's words."""

from etalon.addon.background_command import BackgroundCommand
from etalon.lib.errors import Refusal, Refused
from etalon.lib.refusals import describe_refusals


def test_reasons_are_kept_and_options_that_would_compare_the_rest_are_not():
    skin = Refusal("material 'Skin'", "node 'Hair' (Hair BSDF)", "replace it by a supported shader")
    command = BackgroundCommand.__new__(BackgroundCommand)
    command._read("", describe_refusals(Refused([skin])))
    assert command.errors == (str(skin),)
