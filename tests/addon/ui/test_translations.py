# SPDX-License-Identifier: GPL-3.0-or-later
"""Every text that the panels show has a French translation, with the same values in it."""

import ast
import re
import string
from pathlib import Path

import bpy
import etalon
import pytest
from etalon.addon import ui
from etalon.addon.cycles.audit_settings import CATALOGUE
from etalon.addon.ui import errors, image_writing, images, regions, registration, watching
from etalon.addon.ui.french import FRENCH
from etalon.addon.ui.translations import contexts
from etalon.lib.audit.document import WORDS
from etalon.lib.film.light_passes import LightPass
from etalon.lib.report.headline import TEMPLATES
from etalon.lib.report.summary import describe_box
from etalon.lib.settings.presets import PRESETS

# Words that are the same in both languages, or names.
SAME = {"Étalon", "", "Sobol"}


def in_calls():
    """The texts that the sources give to `translate`.

    Those that they give to a label or property by name are included.
    """
    for path in Path(ui.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call):
                continue
            name = node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
            texts = node.args[:1] if name == "translate" else []
            texts += [keyword.value for keyword in node.keywords if keyword.arg == "text"]
            for part in (part for text in texts for part in ast.walk(text)):
                if isinstance(part, ast.Constant) and isinstance(part.value, str):
                    yield part.value


def of_classes():
    """Labels and tooltips of everything that is registered.

    Names and descriptions of its properties are included.
    """
    for cls in registration._CLASSES:
        yield getattr(cls, "bl_label", "")
        if issubclass(cls, bpy.types.Operator | bpy.types.Menu):
            yield cls.__doc__
        for deferred in vars(cls).get("__annotations__", {}).values():
            keywords = getattr(deferred, "keywords", {})
            if "HIDDEN" in keywords.get("options", ()):
                continue
            yield from (keywords.get("name", ""), keywords.get("description", ""))
            yield from (text for item in keywords.get("items", ()) for text in item[1:3])


def of_tables():
    """Texts that stand in tables and are translated when they are shown."""
    yield from TEMPLATES
    yield from watching.STAGES
    yield from regions.KINDS.values()
    yield from regions.CHANNELS.values()
    yield from image_writing.LABELS.values()
    yield from images.DESCRIPTIONS.values()
    yield from WORDS.values()
    yield from (*errors.TEMPLATES, *errors.VALUES, *errors.KINDS)
    yield from PRESETS
    yield from (str(light).capitalize() for light in LightPass)
    yield from (describe_box((x, y, x, y), (3, 3)) for x in range(3) for y in range(3))


def shown():
    return sorted({*in_calls(), *of_classes(), *of_tables()} - SAME)


def placeholders(text):
    return {name for _, name, _, _ in string.Formatter().parse(text) if name}


@pytest.mark.parametrize("text", shown())
def test_it_is_translated_with_the_same_values(text):
    assert text in FRENCH
    assert placeholders(FRENCH[text]) == placeholders(text)


def in_sources():
    """Texts of other rooms that the panel shows as they are: reasons of a plan, summaries, a Blender that is too new."""
    root = Path(etalon.__file__).parent / "lib"
    places = (*root.glob("effects/*.py"), root / "cost" / "summary.py", root / "blender_versions.py")
    for node in (node for path in places for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
    yield from (text for entry in CATALOGUE for text in (entry.label, entry.neutral_shown))


def test_no_text_of_the_panel_names_an_option_of_the_command_line():
    assert [text for text in (*shown(), *FRENCH.values(), *in_sources()) if re.search(r"(?<!\S)--", text)] == []


def test_no_translation_is_for_a_text_that_is_not_shown():
    assert set(FRENCH) - set(shown()) == set()


def test_both_contexts_of_blender_find_a_text():
    found = contexts({"Plan": "Plan"})
    assert {context for context, _ in found["fr_FR"]} == {"*", "Operator"}
    assert found["fr"] == found["fr_FR"]
