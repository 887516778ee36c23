# SPDX-License-Identifier: GPL-3.0-or-later
"""Options declared once: defaults, checks in one place, JSON, command lines."""

import json
import shlex
from dataclasses import dataclass
from pathlib import Path

import pytest
from etalon.addon.command import cli
from etalon.addon.command.arguments import read_arguments
from etalon.addon.command.table import COMMANDS
from etalon.lib.errors import EtalonError
from etalon.lib.settings.common import PageTerminal, Target
from etalon.lib.settings.comparison import CompareOptions, Settings
from etalon.lib.settings.declaration import Declared, option
from etalon.lib.settings.reference import Options
from etalon.lib.settings.units import Share
from etalon.lib.settings.words import read_table, repeating_command

FULL = Settings(
    tolerance="2.5%",
    confidence=0.95,
    time="3m",
    samples=16,
    replicates=12,
    strategy="bounded",
    direct="bsdf",
    masking="separable",
    model="student-t:g=2.5",
    fresnel="exact:ior=1.5",
    sampler="random",
    departures=["Oren-Nayar colour", "narrow spread"],
    russian_roulette=False,
    seed=7,
    threads=3,
    size="full",
    passes="glossy",
    bounces="0..4",
    lights=True,
    partial=True,
    out="a folder/out",
    scheduler="tcp://host:8786",
)
TARGET = Target(
    "my room.blend", 3, "Cam 2", assignments=('objects["A b"].x=1', "scene.render.resolution_percentage=50")
)


def read(line):
    """The settings that a command line gives."""
    words = shlex.split(line)
    assert words[0] == "etalon"
    command = next(c for c in COMMANDS if c.name == words[1])
    return read_arguments(command, cli.parser().parse_args(words[1:]))


def test_every_option_of_the_example_differs_from_its_default():
    # Motion blur excludes partial comparisons.
    assert FULL.changed().keys() | {"motion_blur"} == {declared.name for declared in Settings.options()}
    assert Settings(motion_blur=True).changed() == {"motion_blur": True}


def test_texts_and_numbers_give_the_same_settings():
    assert FULL.tolerance == 0.025
    assert FULL.time == 180.0
    assert FULL.out == Path("a folder/out")


def test_the_repeating_command_gives_the_same_settings_again():
    assert read(repeating_command("compare", TARGET, FULL)) == (TARGET, FULL, PageTerminal())
    assert repeating_command("compare", Target("a.blend"), Settings()) == "etalon compare a.blend"


@pytest.mark.parametrize(
    "line", ["etalon compare", "etalon compare --no-russian-roulette --time 1h --depart 'narrow spread'"]
)
def test_a_command_line_repeats_itself(line):
    settings = read(line)
    assert read(repeating_command("compare", *settings)) == settings


def test_json_gives_the_same_settings_again():
    for settings in (FULL, Settings(samples=(4, 32)), Settings()):
        assert Settings.from_json(json.loads(json.dumps(settings.to_json()))) == settings


def test_parts_keep_their_values_and_share_one_seed():
    assert FULL.part(Options).departures == {"Oren-Nayar colour", "narrow spread"}
    assert FULL.part(CompareOptions).tolerance == 0.025
    assert FULL.part(Options).seed == FULL.part(CompareOptions).seed == 7
    assert [declared.flag for declared in Settings.options()].count("seed") == 1


def test_a_table_of_options_is_the_same_as_their_words():
    table = {
        "tolerance": "1%",
        "time": 60,
        "partial": True,
        "russian-roulette": False,
        "depart": ["narrow spread"],
        "set": "a.b=1",
        "camera": "Cam 2",
    }
    words = read_table((Target, Settings), table)
    assert words == (
        *("--tolerance=0.01", "--time=60", "--partial", "--no-russian-roulette"),
        *("--depart=narrow spread", "--set=a.b=1", "--camera=Cam 2"),
    )
    target, settings, _ = read(shlex.join(["etalon", "compare", "x.blend", *words]))
    assert (target.camera, target.assignments) == ("Cam 2", ("a.b=1",))
    assert (settings.tolerance, settings.time, settings.partial, settings.russian_roulette) == (0.01, 60.0, True, False)
    assert read_table((Settings,), {"partial": False}) == ()


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"tolerence": 0.01}, "unknown option 'tolerence'; did you mean 'tolerance'?"),
        ({"scene": "x"}, "unknown option 'scene'"),
        ({"tolerance": 2}, "tolerance: 2 is out of range"),
        ({"time": "soon"}, "time: 'soon' is not a time"),
        ({"partial": "yes"}, "partial: 'yes' is neither true nor false"),
        ({"strategy": "visable"}, "unknown strategy 'visable'; did you mean 'visible'?"),
        ({"depart": ["narow spread"]}, "unknown departure 'narow spread'; did you mean 'narrow spread'?"),
    ],
)
def test_wrong_entries_of_a_table_are_one_line_that_names_them(table, message):
    with pytest.raises(EtalonError) as error:
        read_table((Target, Settings), table)
    assert str(error.value).startswith(message)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("wrong", [{"strategy": "mss"}, {"threads": 0}, {"seed": 0.5}, {"out": 3}, {"partial": 1}])
def test_settings_of_another_kind_are_refused(wrong):
    with pytest.raises(EtalonError, match=r"strategy|threads|seed|out|partial"):
        Settings(**wrong)


def test_none_is_a_value_only_where_it_is_declared():
    assert Settings(time=None, samples=1, replicates=1).time is None
    with pytest.raises(EtalonError, match="tolerance: None"):
        Settings(tolerance=None)


def test_a_new_option_is_in_json_words_and_checks_by_its_declaration_alone():
    @dataclass(frozen=True, kw_only=True)
    class More(Declared):
        overlap: float = option(0.5, Share(), "overlap of blocks")

    assert repeating_command("compare", More(overlap="25%")) == "etalon compare --overlap=0.25"
    assert More.from_json(More(overlap=0.25).to_json()) == More(overlap=0.25)
    with pytest.raises(EtalonError, match="overlap: 3 is out of range"):
        More(overlap=3)
