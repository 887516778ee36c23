# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon microsurface`: a table for each question, and the same figures as JSON.

What it does not take is one line.
"""

import json

import numpy as np
import pytest
from etalon.addon.command import cli
from etalon.lib.microsurface import measure
from etalon.lib.microsurface.height_field import gaussian_field


def test_tables_and_json_have_the_same_figures(monkeypatch, capsys):
    for name, value in (("CELLS", 48), ("PLACES", 4000), ("RAYS", 1000)):
        monkeypatch.setattr(measure, name, value)
    words = ["microsurface", "--alpha=0.5", "--angle=70", "--fields=2", "--correlation=4"]
    assert cli.main(words) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines() if line.strip().startswith("70°")]
    assert cli.main([*words, "--json"]) == 0
    (figures,) = json.loads(capsys.readouterr().out)["angles"]
    for row, name in zip(rows, ("visible", "mirror", "reflected_once"), strict=True):
        traced, *formulas = figures[name].values()
        shown = [float(word) for word in row[1:] if word != "±"]
        assert shown == pytest.approx([traced["mean"], traced["error"], *formulas], abs=6e-5)


@pytest.mark.parametrize(
    ("word", "told"), [("--angle=89", "give 0 to 88 degrees"), ("--correlation=40", "give 4 to 32 cells")]
)
def test_what_is_out_of_range_is_one_line(word, told, capsys):
    assert cli.main(["microsurface", word]) == 2
    assert told in capsys.readouterr().err


def test_the_mesh_in_the_file_is_the_field_that_is_traced_first(tmp_path, monkeypatch, capsys):
    """The file has a head, float32 vertices, and triangles of three corners.

    Heights are those of the first seed.
    """
    monkeypatch.setattr("etalon.addon.command.microsurface.measure_microsurface", lambda *_: [])
    path = tmp_path / "field.ply"
    assert cli.main(["microsurface", "--angle=30", "--fields=2", "--correlation=4", "--mesh", str(path)]) == 0
    assert f"mesh: {path}" in capsys.readouterr().out
    head, body = path.read_bytes().split(b"end_header\n")
    assert head.startswith(b"ply\nformat binary_little_endian 1.0\n")
    assert b"element vertex 263169\n" in head
    assert b"element face 524288\n" in head
    x, y, z = np.frombuffer(body, "<f4", 3 * 263169).reshape(-1, 3).T
    faces = np.frombuffer(body, [("count", "u1"), ("corners", "<i4", 3)], offset=12 * 263169)
    assert len(faces) == 524288
    assert set(faces["count"]) == {3}
    assert faces["corners"].max() == 263168
    (first,) = np.random.SeedSequence(0).spawn(1)
    heights = gaussian_field(np.random.default_rng(first), 256, 4, 0.6)
    np.testing.assert_allclose(z, heights[x.astype(int) % 256, y.astype(int) % 256], rtol=1e-6, atol=1e-6)


def test_a_mesh_that_is_no_ply_is_one_line(capsys):
    assert cli.main(["microsurface", "--mesh=field.obj"]) == 2
    assert "name a file that ends in .ply" in capsys.readouterr().err
