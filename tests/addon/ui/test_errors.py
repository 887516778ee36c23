# SPDX-License-Identifier: GPL-3.0-or-later
"""Every message that a user of the panel can meet is recognised.

It has French with the same values.
"""

import re
import string
from functools import cache

import bpy  # noqa: F401  (makes blf importable)
import pytest
from etalon.addon.ui import errors
from etalon.addon.ui.french import FRENCH
from etalon.addon.ui.french_errors import ERRORS
from etalon.addon.ui.french_refusals import REMEDIES, WHATS
from etalon.addon.ui.panel_words import IN_PANEL, in_panel
from etalon.lib.errors import Refusal, unknown
from etalon.tests.addon.ui.messages import find_messages

TABLES = {"errors": (ERRORS, errors._ERRORS), "whats": (WHATS, errors._WHATS), "remedies": (REMEDIES, errors._REMEDIES)}
# What the scan finds and the panel never shows.
NOT_SHOWN = {
    # Options that the panel does not have.
    "--bounces {}..{}: the scene ends paths after {}; give {}..{}, or raise Max Bounces in Blender",
    "--verify tests the forecast for one error; name that error with --target",
    "departure '{}' exists in Blender {}, and this scene comes from Blender {}; leave it out",
    "pairs is {}; give at least 2, for an interval",
    "samples: an audit renders all settings with the same samples per pixel; give one number",
    "without a time limit nothing ends the comparison; give samples and replicates, or a time",
    "{}: there are {} replicates, and number {} is asked for; give fewer replicates of more samples",
    "{} is a folder; name a file",
    "worker {} has Blender {}; install Blender {} there, as here",
    "the comparison has ended",
    # The first words of `unknown`, which is recognised as a whole.
    *("option", "strategy", "--{}"),
    # Commands that the panel ends at once when they are cancelled.
    "{}: cancelled before anything was measured; nothing was written",
    "{}: cancelled before the first round was done; there is nothing to tell",
    # Python without the Blender program.
    "this is Python with Blender as a module; run the panel's comparison in Blender itself",
    "this is Python with Blender as a module; use the command line",
    # Calls that only a script can get wrong.
    "an image is {} pixels, the other {} x {}; render both at the same size",
    "no effect is called '{}'; see lib/effects/names.py",
    "unknown microfacet distribution {}; choose one of {}",
    "{}: its coverage has negative or non-finite weights",
    "{}: its coverage is {} pixels, the image {} x {}",
    "{}: was evaluated for the viewport; export it from with_render_depsgraph",
    # Parts of messages, which are recognised with the rest.
    "{} x {} pixels: about {} GB to compare at full size",
    "{}: cannot be written (it does not read back as written); {}",
    "beside the volume of '{}', which scatters",
    *("cannot be read", "is not there"),
}
# Templates of what is put together where the scan cannot follow.
MADE = {
    *("etalon {}: the second Blender ended early", "{}: {}; please report it with the console's text"),
    *("unknown {} '{}'; choose from {}", "unknown {} '{}'; did you mean '{}'?"),
    *("this machine has {} GB; {}", "{}: cannot be read ({}); write it again"),
    "{} x {} pixels: about {} GB to compare at full size; this machine has {} GB; {}",
    "{}: cannot be written (it does not read back as written); make room or name another folder",
    "lower the resolution, or give a time and let a smaller image be compared",
    "give more than 1.5 and at most {}; Beckmann's is the limit of large g",
    *("choose another {}, or use Blender {}", "set it back to {}"),
    *("Simplify", "stereoscopy", "shadow caustics", "property '{}' ({})", "Cycles' setting '{}' ({})"),
    *("light linking beside the volume of '{}', which scatters,", ", property '{}',", ", type {},"),
    *("ray visibility beside the volume of '{}', which scatters,", ", in a world,"),
    *("its subsurface scattering", "the height of a bump", "a panoramic view", "an orthographic view of oblong pixels"),
    *("a scene with subsurface scattering", "a scene with volumes that scatter"),
    *("its emission", "what lets light straight through", "a world that depends on the direction"),
    *("the subsurface scattering of '{}'", "the volume of '{}', which scatters"),
    *(" in a volume", " on a surface", " on a world"),
}
# Values: {}, numbers, and names, whose words begin with a capital; any other word belongs to a template.
_VALUE = re.compile(r"(?:\{\}|[^a-z]|[A-Z][\w-]*)+")


@cache
def found():
    """What the sources say, by table.

    The tests ask for it, not the import: every worker imports this file, and one runs it.
    """
    return dict(zip(TABLES, find_messages(), strict=True))


def without_names(template):
    return re.sub(r"\{\w*\}", "{}", template)


def has_words(template):
    """Whether it says anything besides its values."""
    return bool(re.search("[a-z]{2}", template.replace("{}", ""))) and not template.startswith("{}node")


def is_recognised(template, patterns):
    found = (pattern.fullmatch(template) for pattern in patterns.values())
    return any(one and all(_VALUE.fullmatch(value) for value in one.groups()) for one in found)


@pytest.mark.parametrize("name", TABLES)
def test_every_message_of_the_sources_is_recognised(name):
    _, patterns = TABLES[name]
    advice = found()["remedies"] if name == "whats" else set()  # a function that returns both
    new = [one for one in found()[name] - advice - NOT_SHOWN if has_words(one) and not is_recognised(one, patterns)]
    assert sorted(new) == []


@pytest.mark.parametrize("name", TABLES)
def test_every_template_is_in_the_sources_and_keeps_its_values_in_french(name):
    texts, _ = TABLES[name]
    unused = {without_names(one) for one in texts} - found()[name] - MADE
    assert {one for one in unused if not any(has_part(one, text) for text in found()[name])} == set()
    for text, french in texts.items():
        assert values_of(text) == values_of(french)


def values_of(text):
    return {name for _, name, _, _ in string.Formatter().parse(text) if name}


def has_part(template, text):
    """Whether `text` of the sources is one that the more general template is for."""
    return (
        bool(errors.pattern_of(re.sub(r"\{\}", "{x}", template, count=1)).fullmatch(text))
        if "{}" in template
        else False
    )


@pytest.fixture
def french(monkeypatch):
    texts = in_panel(FRENCH | ERRORS | WHATS | REMEDIES)
    monkeypatch.setattr(errors, "translate", lambda text, **values: texts[text].format(**values))
    return errors.translate_error


def test_a_refusal_is_french_from_its_owner_to_its_remedy(french):
    node = "group 'Rust', node 'A (b)' (Noise Texture), socket 'Scale' (linked),"
    said = "l'entrée « Scale » (liée) du groupe « Rust » ; retirez le lien de Scale"
    assert french(str(Refusal("material 'A (b); c'", node, "unlink Scale"))) == (
        f"matériau « A (b); c » : Étalon ne simule pas le nœud « A (b) » (Noise Texture), {said}"
    )
    image = "node 'Image' (Image Texture), image 'a.png' (tiled, packed),"
    assert french(str(Refusal("world 'W'", image, "unpack it"))).endswith(
        "l'image « a.png » (en tuiles, empaquetée) ; dépaquetez-la"
    )
    assert french(str(Refusal("the scene", "negative power", "switch it off"))).startswith(
        "la scène : Étalon ne simule pas une puissance"
    )


def test_an_error_keeps_its_values_and_what_is_not_known_stays(french):
    full = "/a {b} cannot be written (No space left on device); make room or name another folder"
    assert french(full).startswith("Impossible d'écrire /a {b} (No space left on device) ;")
    assert french(unknown("model", "ggxx", ("ggx",))) == "« ggxx » est inconnu (model) ; vouliez-vous dire « ggx » ?"
    assert french("something else") == "something else"


@pytest.mark.parametrize("text", sorted(ERRORS | WHATS | REMEDIES))
def test_no_error_in_the_panel_names_an_option_of_the_command_line(text):
    values = {name: name for name in values_of(text)}
    assert "--" not in errors.translate_error(text.format(**values))
    assert "--" not in (ERRORS | WHATS | REMEDIES)[text]


def test_what_the_panel_says_instead_has_the_same_values():
    assert all(values_of(text) == values_of(said) for text, said in IN_PANEL.items())
    assert set(IN_PANEL) <= set(ERRORS | WHATS | REMEDIES)


def test_options_in_an_error_that_is_not_known_are_named_as_the_panel_names_them():
    said = errors.translate_error("'a--b' needs time; give --motion-blur, --partial and --samples 4")
    assert said == "'a--b' needs time; give Motion blur, Partial and samples 4"
    said = errors.translate_error("object 'O': dust is not simulated; leave --lights out")
    assert said == "object 'O': dust is not simulated; leave Lights out"


def test_a_remedy_is_translated_from_what_the_panel_says(french):
    blur = Refusal("object 'O'", "motion blur of a moving light", "leave --motion-blur out")
    assert french(str(blur)).endswith("; désactivez Flou de mouvement")
