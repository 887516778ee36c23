# SPDX-License-Identifier: GPL-3.0-or-later
"""The images that Image editors show."""

import bpy
import numpy as np
import pytest
from etalon.addon.ui import images, regions, registration
from etalon.addon.ui.session import Result, Setup, session
from etalon.lib.film.exr import read_exr
from etalon.lib.film.light_passes import LightPass
from etalon.lib.report.ranking import rank_regions
from etalon.lib.report.views import View
from etalon.tests.lib.report.comparisons import comparison_of


@pytest.fixture
def result(tmp_path):
    """The result of a comparison by pass in the open scene.

    The panel's classes are registered meanwhile.
    """
    registration.register()
    scene = bpy.context.scene
    session.results[scene.session_uid] = Result(
        comparison_of("passes"), tmp_path / "out", Setup.of(scene), (0.0, 0.0, 1.0, 1.0), False
    )
    yield session.results[scene.session_uid]
    session.results.pop(scene.session_uid)
    images.forget_images()
    registration.unregister()


def test_the_light_that_is_chosen_is_written_even_while_others_are(result):
    """Chosen twice in a row, the second is written once the first is.

    Then the image is written again.
    """
    uid = bpy.context.scene.session_uid
    films = result.comparison.reference.pass_films
    for asked in ("glossy indirect", "diffuse direct", ""):
        assert bpy.ops.etalon.show_light(part=asked) == {"FINISHED"}
    writer = images._writers[uid]
    for asked, mean in (
        ("diffuse direct", films[LightPass.DIFFUSE_DIRECT].mean),
        ("", result.comparison.reference.film.moments.mean),
    ):
        bpy.ops.etalon.show_light(part=asked)
        for _ in range(2):  # what is under way, and what was chosen meanwhile
            writer._thread.join()
            images._look()
        writer._thread.join()
        assert images.light_of(uid) == (asked or None)
        np.testing.assert_allclose(read_exr(writer.folder / View.REFERENCE.value)["R"], mean[..., 0], rtol=1e-6)


def rows():
    (table,) = bpy.data.window_managers[0].etalon_regions
    return [row.name for row in table.rows]


def test_the_list_shows_the_regions_of_the_light_that_is_chosen(result):
    uid = bpy.context.scene.session_uid
    for asked in (LightPass.GLOSSY_INDIRECT, LightPass.DIFFUSE_DIRECT, None):
        bpy.ops.etalon.show_light(part=asked or "")
        expected = rank_regions(result.comparison, asked)
        assert images.regions_shown(uid) == expected
        assert rows() == [regions.label_text(region) for region in expected]
        if asked:
            images._writers[uid]._thread.join()
    assert bpy.ops.etalon.show_region(number=len(rows()) - 1) == {"FINISHED"}


def test_a_new_result_without_the_light_that_was_chosen_shows_its_own_regions(result):
    scene = bpy.context.scene
    bpy.ops.etalon.show_light(part=LightPass.GLOSSY_INDIRECT)
    images._writers[scene.session_uid]._thread.join()
    new = Result(comparison_of("equivalent"), result.folder, Setup.of(scene), result.border, False)
    session.results[scene.session_uid] = new
    assert images.regions_shown(scene.session_uid) == new.regions
