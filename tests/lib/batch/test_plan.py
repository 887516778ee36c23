# SPDX-License-Identifier: GPL-3.0-or-later
"""Plans: what is wrong in one is told before anything is rendered."""

import pytest
from etalon.lib.batch.plan import read_plan
from etalon.lib.errors import EtalonError

VARY = 'scenes = ["a"]\n[[vary]]\npath = "x"\n'
WRONG = [
    ("", "'scenes' must be"),
    ("scenes = [", "is not TOML"),
    ("a shopping list", "is not TOML"),
    ("scenes = []", "'scenes' must be"),
    ('scenes = "a"', "'scenes' must be"),
    ("scenes = [1]", "'scenes' must be"),
    ('scenes = [""]', "'scenes' must be"),
    ('scenes = [["a"]]', "'scenes' must be"),
    ('scenes = ["--help"]', "is not the name of a scene"),
    ('scenes = ["a\\u0000"]', "is not the name of a scene"),
    ('scenes = ["a", "a"]', 'the scene "a" is listed twice'),
    ('scenes = ["a"]\ncolour = 1', "unknown entry 'colour'"),
    ('scenes = ["a"]\nout = 3', "'out' is a text"),
    ('scenes = ["a"]\nout = ""', "'out' is the folder of the plan"),
    ('scenes = ["a"]\nout = "."', "'out' is the folder of the plan"),
    ('scenes = ["a"]\noptions = 3', "'options' a table"),
    ('scenes = ["a"]\n[vary]\npath = "x"', "'vary' a list"),
    ('scenes = ["a"]\nvary = [1]', "each [[vary]] needs"),
    (VARY, "each [[vary]] needs"),
    (VARY + "values = []", "is empty"),
    (VARY + "values = 3", "each [[vary]] needs"),
    (VARY + "values = [1979-05-27]", "1979-05-27 is no number"),
    (VARY + "values = [nan]", "nan is no number"),
    (VARY + "values = [{a = 1}]", "is no number"),
    (VARY + "values = [[1, [2]]]", "is no number"),
    (VARY + "values = [1, 1]", "the value of x 1 is listed twice"),
    (VARY + 'values = [1]\nnmae = "y"', "did you mean 'name'?"),
    (VARY + "values = [1]\nname = 3", "a text 'name'"),
    (VARY + 'values = [1]\n[[vary]]\npath = "x"\nvalues = [2]', 'in [[vary]] "x" is listed twice'),
    ('scenes = ["a"]\n[options]\nout = "x"', "[options] cannot set 'out'"),
    ('scenes = ["a"]\n[options]\nnoise = 1', "unknown option 'noise'"),
    ('scenes = ["a"]\n[options]\ntolerance = true', "tolerance: True is not a number"),
    ('scenes = ["a"]\n[options]\ntime = "soon"', "time: 'soon' is not a time"),
    ('scenes = ["a"]\n[options]\nsamples = [1, 2]', "samples: '(1, 2)' is not a whole number"),
    ('scenes = ["a"]\n[options]\nset = [1]', "set: [1] is not a list of texts"),
    ('scenes = ["a"]\n[options]\npartial = "yes"', "neither true nor false"),
]


@pytest.mark.parametrize(("text", "complaint"), WRONG)
def test_a_wrong_plan_is_one_line_that_names_the_entry(tmp_path, text, complaint):
    path = tmp_path / "plan.toml"
    path.write_text(text)
    with pytest.raises(EtalonError) as caught:
        read_plan(path)
    assert complaint in str(caught.value)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == [path]


def test_what_is_no_text_is_one_line(tmp_path):
    (tmp_path / "plan.toml").write_bytes(b"\xff\xfe\x00scenes")
    for path, complaint in (("plan.toml", "is not TOML"), ("nowhere.toml", "cannot be read"), (".", "cannot be read")):
        with pytest.raises(EtalonError, match=complaint):
            read_plan(tmp_path / path)


def test_a_plan_that_nests_too_deep_is_one_line(tmp_path):
    (tmp_path / "plan.toml").write_text("scenes = " + 100_000 * "[")
    with pytest.raises(EtalonError, match="is not TOML"):
        read_plan(tmp_path / "plan.toml")


def test_scenes_that_are_not_there_are_told_before_the_first_comparison(tmp_path):
    (tmp_path / "here.blend").touch()
    path = tmp_path / "plan.toml"
    path.write_text('scenes = ["here.blend", "furnace"]')
    read_plan(path).require_scenes(["furnace"])
    for wrong, complaint in (("gone.blend", "gone.blend: no such file"), ("furnase", "did you mean 'furnace'?")):
        path.write_text(f'scenes = ["here.blend", "{wrong}"]')
        with pytest.raises(EtalonError, match=complaint):
            read_plan(path).require_scenes(["furnace"])


def test_a_list_of_assignments_reaches_the_command_line(tmp_path):
    from etalon.addon.command.cli import parser

    path = tmp_path / "plan.toml"
    path.write_text('scenes = ["a"]\n[options]\nset = ["x=1", "y=[1, 2]"]\n[[vary]]\npath = "z"\nvalues = [3]')
    plan = read_plan(path)
    (unit,) = plan.units()
    read = parser().parse_args(["compare", *unit.arguments(), *plan.options])
    assert read.assignments == ["z=3", "x=1", "y=[1, 2]"]
