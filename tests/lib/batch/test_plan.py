# SPDX-License-Identifier: GPL-3.0-or-later
"""Plans: what is wrong in one is told before anything is rendered."""

import pytest
from etalon.addon.command.batch_example import EXAMPLE
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
    ('scenes = ["a"]\n[options]\nsamples = [1, 1]', "the value of 'samples' 1 is listed twice"),
    ('scenes = ["a"]\n[options]\nsamples = []', "the list of 'samples' is empty"),
    ('scenes = ["a"]\n[options]\nsamples = [1, 0]', "samples: 0 is out of range"),
    ('scenes = ["*.blend"]', "no .blend file fits '*.blend'"),
    ('scenes = ["/tmp/*.blend"]', "is not relative"),
    ('scenes = ["a"]\nframes = []', "'frames' must be a list that is not empty"),
    ('scenes = ["a"]\nframes = 3', "'frames' must be a list"),
    ('scenes = ["a"]\nframes = ["3-1"]', "'3-1' has no frame"),
    ('scenes = ["a"]\nframes = ["1-9:0"]', "'1-9:0' has no frame"),
    ('scenes = ["a"]\nframes = [true]', "True is no frame"),
    ('scenes = ["a"]\nframes = [9999999]', "9999999 is out of range"),
    ('scenes = ["a"]\nframes = [3, "1-5"]', "the value of 'frames' 3 is listed twice"),
    ('scenes = ["a"]\ncameras = []', "'cameras' must be a list of texts that is not empty"),
    ('scenes = ["a"]\nblenders = [4.5]', "'blenders' must be a list of texts"),
    ('scenes = ["a"]\n[limits]\ntime = "soon"', "[limits]: time: 'soon' is not a time"),
    ('scenes = ["a"]\n[limits]\nmemory = "much"', "'much' is not a size; write it as '8 GB'"),
    ('scenes = ["a"]\n[limits]\ncores = 1', "unknown entry of [limits] 'cores'"),
    ('scenes = ["a"]\nper_process = 0', "'per_process': 0 is no number of comparisons"),
    ('scenes = ["a"]\nper_process = true', "'per_process': True is no number of comparisons"),
    (VARY.replace('"x"', '"--time"') + "values = [1]", "'--time' is not a data path"),
    ('scenes = ["a"]\nframes = [1]\n[options]\nframe = [2]', 'name in [[vary]] "frame" is listed twice'),
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


def test_patterns_find_each_file_once_and_follow_no_circle(tmp_path):
    for name in ("b.blend", "a.blend", "shots/c.blend", "shots/notes.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    (tmp_path / "shots" / "around").symlink_to(tmp_path, target_is_directory=True)
    (tmp_path / "copy.blend").symlink_to(tmp_path / "b.blend")
    path = tmp_path / "plan.toml"
    path.write_text('scenes = ["furnace", "a*.blend", "*.blend", "**/*.blend"]')
    assert read_plan(path).scenes == ("furnace", "a.blend", "b.blend", "shots/c.blend")


def test_every_axis_is_combined_with_every_other(tmp_path):
    from etalon.addon.command.cli import parser

    path = tmp_path / "plan.toml"
    path.write_text(
        'scenes = ["a"]\nframes = [1, "10-30:10"]\ncameras = ["Front"]\nview_layers = ["Wide"]\nblenders = ["4.5", "5.2"]\n'
        '[options]\ntime = 5\ntolerance = ["1%", 0.02]\ndepart = [[], ["light below the face"]]'
    )
    plan = read_plan(path)
    units = list(plan.units())
    assert len(units) == 4 * 2 * 2 * 2
    assert [v.name for v in plan.variations] == ["frame", "camera", "view-layer", "blender", "tolerance", "depart"]
    last = units[-1]
    assert (last.blender, units[0].blender) == ("5.2", "4.5")
    read = parser().parse_args(["compare", *last.arguments(), *plan.options])
    assert (read.frame, read.camera, read.view_layer, read.tolerance) == (30, "Front", "Wide", 0.02)
    assert read.departures == ["light below the face"]


def test_the_example_is_a_plan(tmp_path):
    path = tmp_path / "plan.toml"
    path.write_text(EXAMPLE)
    plan = read_plan(path)
    assert len(list(plan.units())) == 4
    assert (plan.time_limit, plan.memory_limit) == (600.0, 8_000_000_000)
    uncommented = EXAMPLE.replace("# frames", "frames").replace("# cameras", "cameras").replace("# view_", "view_")
    path.write_text(uncommented.replace("# blenders", "blenders").replace("# per_", "per_"))
    assert len(list(read_plan(path).units())) == 4 * 11 * 2 * 1 * 3
    assert (plan.per_process, read_plan(path).per_process) == (1, 20)
