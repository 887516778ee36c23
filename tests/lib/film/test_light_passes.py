# SPDX-License-Identifier: GPL-3.0-or-later
"""The names of light passes, and the option that asks for them."""

import pytest
from etalon.lib.film.light_passes import Family, LightPass, direct, indirect, is_asked


def test_every_family_has_a_direct_and_an_indirect_pass():
    named = {name(family) for family in Family for name in (direct, indirect)}
    assert named | {LightPass.EMISSION, LightPass.ENVIRONMENT} == set(LightPass)


@pytest.mark.parametrize(
    ("asked", "expected"),
    [
        ("none", set()),
        ("all", set(LightPass)),
        ("glossy", {LightPass.GLOSSY_DIRECT, LightPass.GLOSSY_INDIRECT}),
        ("emission", {LightPass.EMISSION}),
    ],
)
def test_the_option_asks_for_all_or_for_those_of_one_name(asked, expected):
    assert {name for name in LightPass if is_asked(name, asked)} == expected
