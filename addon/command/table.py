# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands, one row each.

The function `run` of the file of that name takes the settings and returns the exit code.
"""

from __future__ import annotations

from dataclasses import dataclass

from ...lib.exit_codes import ExitCode
from ...lib.settings.audit import AuditOptions
from ...lib.settings.commands import (
    BatchOptions,
    CompletionOptions,
    IllustrateOptions,
    MicrosurfaceOptions,
    PlanOutput,
    ScenesOptions,
    StabilityOptions,
)
from ...lib.settings.common import PageTerminal, Target, Terminal
from ...lib.settings.comparison import Settings
from ...lib.settings.cost import CostOptions
from ...lib.settings.declaration import Declared
from ...lib.settings.fit import FitOptions
from ...lib.settings.probe import ProbeOptions
from ...lib.settings.reference import RenderOutput
from ...lib.settings.versions import VersionsSettings, VersionsTarget

# Help is broken into lines of so many characters at most.
HELP_WIDTH = 100


def _codes(*codes: tuple[ExitCode, str]) -> str:
    return "exit code: " + ", ".join(f"{code.value} {meaning}" for code, meaning in codes)


FAILED = (ExitCode.BAD_INPUT, "bad input, or a scene that is not supported")
VERDICTS = _codes(
    *((ExitCode[name], name) for name in ("EQUIVALENT", "DIFFERENT", "UNDECIDED", "EXPLAINED")),
    FAILED,
)
DONE = _codes((ExitCode.DONE, "done"), FAILED)

_BATCH = """\
Compare every scene at every combination of values. `etalon batch --example` prints a plan with all that it may say: scenes by
name or pattern; frames, cameras, view layers and Blenders; any option of `etalon compare`, of which a list is an axis; and any
property by its data path from bpy.data, or from the open scene if it begins with `scene.`.

The whole plan is checked before the first comparison. Each comparison runs in another process. If one crashes, it is run
once more, recorded as failed, and the rest continue. All results are kept in OUT/journal.sqlite, so the same command runs only
what is missing after Ctrl-C or a crash, or what depends on a file that has changed. OUT has a folder for each comparison,
batch.html, batch.csv, batch.json and junit.xml."""

_COMPLETION = """\
Print a completion script. For bash:

  etalon completion bash > ~/.local/share/bash-completion/completions/etalon

For zsh, in a folder of $fpath:

  etalon completion zsh > ~/.zsh/completions/_etalon

For fish:

  etalon completion fish > ~/.config/fish/completions/etalon.fish"""

_BATCH_CODES = (
    "exit code: that of the worst comparison: 0 all EQUIVALENT, 4 some EXPLAINED, 3 some UNDECIDED, 1 some DIFFERENT, "
    "2 some refused or failed; with --fail-on: 1 if the rule is broken, 0 if not, 2 some refused or failed"
)


@dataclass(frozen=True)
class Command:
    """One command: its name, what it takes, and its help.

    `blender` says that its file imports bpy.
    """

    name: str
    settings: tuple[type[Declared], ...]
    help: str
    description: str = ""
    epilog: str = DONE
    blender: bool = False


COMMANDS = (
    Command(
        "compare",
        (Target, Settings, PageTerminal),
        "render with the reference and with Cycles, and compare the images",
        epilog=VERDICTS,
        blender=True,
    ),
    Command(
        "render",
        (Target, RenderOutput, Terminal),
        "render the reference alone",
        "Channels of the EXR: radiance (R, G, B), its standard error (error.R ...) and the sample count\n(samples). "
        "SCENE may also be a scene saved as .npz, which needs no Blender.",
    ),
    Command("scenes", (ScenesOptions, Terminal), "list the reference scenes, or save one as a .blend", blender=True),
    Command(
        "plan",
        (Target, PlanOutput, Terminal),
        "list the effects that a scene needs, and why, without rendering",
        "SCENE may also be a scene saved as .npz, which needs no Blender, or a folder: then each .blend file in it is read, in a "
        "process of its own, and a table says which can be compared and what stops the others.",
    ),
    Command(
        "cost",
        (Target, CostOptions, PageTerminal),
        "measure the time that accuracy takes, or forecast it",
        "Error against time for every sampling strategy, for Cycles, and for Cycles' denoiser.",
    ),
    Command(
        "probe",
        (Target, ProbeOptions, Terminal),
        "take the light of one pixel apart, in the reference and in Cycles",
        "The light of a pixel by light pass, by bounce and by light, with standard errors on both sides; and every lamp in watts,\n"
        "W/sr, W/m2, candela and lumens.",
        blender=True,
    ),
    Command(
        "fit",
        (FitOptions, Terminal),
        "find the model and the parameters behind a measured material, or a sphere that Cycles renders",
        "FILE is a MERL .binary, an RGL .bsdf, or a .blend file in which one sphere stands under one sun of angle 0 and a black world.\n"
        "Fitted are Beckmann, GGX and Student-t distributions with three maskings and three Fresnel terms, with 95 % intervals.\n"
        "The answer may be that none of them explains the data, or that the data cannot tell some of them apart.",
    ),
    Command(
        "audit",
        (Target, AuditOptions, PageTerminal),
        "measure what each Cycles setting of a file costs: bias, noise, seconds",
        "Cycles against Cycles: the file's own settings, one at a time, against the least biased state.",
        blender=True,
    ),
    Command(
        "batch",
        (BatchOptions, PageTerminal),
        "compare scenes over property values; can be interrupted",
        _BATCH,
        _BATCH_CODES,
    ),
    Command(
        "versions",
        (VersionsTarget, VersionsSettings, PageTerminal),
        "compare the same scenes under several versions of Blender",
        "Does a render change from one Blender to another, where, by how much, and which version is nearer to the reference?\n"
        "A release that is not installed is installed as a Python module, in an environment in the user's cache folder.",
        _codes(
            (ExitCode.EQUIVALENT, "nothing changed by more than the tolerance"),
            (ExitCode.DIFFERENT, "something changed"),
            (ExitCode.UNDECIDED, "undecided"),
            (ExitCode.EXPLAINED, "what changed is explained by known departures"),
            (ExitCode.BAD_INPUT, "bad input, or a version that cannot render a scene"),
        ),
    ),
    Command(
        "stability",
        (StabilityOptions, PageTerminal),
        "measure the rounding errors of the reference, and those of the same equations in float32",
        "Every equation against 50 digits over its whole domain, identities, and scenes at the edge; one line each.",
        _codes((ExitCode.HELD, "every bound held"), (ExitCode.BROKEN, "the reference broke one"), FAILED),
    ),
    Command(
        "microsurface",
        (MicrosurfaceOptions, Terminal),
        "trace rough surfaces facet by facet, beside what masking formulas say of them",
        "Height fields with Gaussian slopes: which facets one direction or two see, and what white mirrors reflect once, beside\n"
        "separable and height-correlated masking and V-cavities. Needs no Blender.",
    ),
    Command(
        "illustrate",
        (IllustrateOptions, PageTerminal),
        "make one page, in English and French, of what the lecture's slides show",
        "Distributions, facets, four strategies, inversions, the five slips, spheres by both renderers, radiosity and caches, and masking:\n"
        "each figure with its numbers, the command that remakes it and the test that holds it. One file that loads nothing. Without\n"
        "Blender the page says what is missing for the spheres. In Blender, the file that is open is replaced.",
    ),
    Command(
        "doctor",
        (Terminal,),
        "check Blender, libraries, processors and memory, and say what is missing",
        epilog=_codes((ExitCode.DONE, "all is there"), (ExitCode.BAD_INPUT, "something is missing")),
    ),
    Command(
        "completion",
        (CompletionOptions, Terminal),
        "print a script that lets a shell complete the words of etalon",
        _COMPLETION,
    ),
)
