# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of a comparison: those of the verdict, and all that a user chooses."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from ..errors import EtalonError
from ..film.light_passes import Family, LightPass
from .common import LOCAL, Seeded
from .declaration import Panel, option
from .reference import Options
from .units import Choice, FilePath, Flag, Seconds, Share, Unit, Whole, WholeOrPair, WholeRange

SIZES = ("auto", "full")
AUTO = "auto"
PASSES = (AUTO, "none", "all", *(str(family) for family in Family), str(LightPass.EMISSION), str(LightPass.ENVIRONMENT))


@dataclass(frozen=True)
class CompareOptions(Seeded):
    """What the user asks of a verdict.

    tolerance: the relative difference that counts as none. confidence: the probability that no claim on any region is false.
    time: seconds for everything, None for no limit. samples: per pixel and replicate, for both sides or (reference,
    candidate); None: chosen by a pilot. replicates: the most on each side, None for no limit. seed: of the whole.
    Sampling ends when all is decided or at the first limit. Raises EtalonError for values out of range.
    """

    TITLE: ClassVar[str] = "the verdict"

    tolerance: float = option(
        0.01,
        Share(),
        "largest relative difference that counts as agreement",
        panel=Panel("Tolerance", low=0.0001, high=0.5),
    )
    confidence: float = option(
        0.99,
        Share(low=0.5),
        "confidence of the whole verdict, all regions together",
        advanced=True,
        panel=Panel("Confidence", low=0.5, high=0.9999),
    )
    time: float | None = option(
        120.0,
        Seconds(),
        "time budget; a comparison ends sooner if every region is decided sooner",
        nullable=True,
        panel=Panel("Time", low=5.0, soft_high=3600.0),
    )
    samples: int | tuple[int, int] | None = option(
        None,
        WholeOrPair("N", 1),
        "samples per pixel in each replicate",
        absent="chosen by a pilot render",
        advanced=True,
    )
    replicates: int | None = option(
        None, Whole("R", 1), "most replicates on each side", absent="as many as the time allows", advanced=True
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.time is None and (self.samples is None or self.replicates is None):
            raise EtalonError(
                "without a time limit nothing ends the comparison; give samples and replicates, or a time"
            )


@dataclass(frozen=True, kw_only=True)
class ComparisonSettings(CompareOptions, Options):
    """All settings of a comparison, wherever it runs: those that a batch and a comparison of versions take.

    They are described in Settings.
    """

    size: str = option(
        SIZES[0],
        Choice("SIZE", "size", SIZES),
        "auto: compare a smaller image of the same view where the whole one gives no useful answer in time; full: never",
        advanced=True,
        panel=Panel("Image size"),
    )
    passes: str = option(
        PASSES[0],
        Choice("PASSES", "light passes", PASSES),
        "light passes to compare beside the image, which say in which light it differs; auto: all, where they cost "
        f"Cycles less than 10 % of its time: {', '.join(PASSES)}",
        panel=Panel("Light passes", group="passes"),
    )
    bounces: tuple[int, int] | None = option(
        None,
        WholeRange(),
        "limits of bounces under which the images are compared too, which says at which bounce they part; "
        "Cycles renders once for each",
        absent="only the scene's own",
    )
    lights: bool = option(
        False,
        Flag(),
        "compare the light of each lamp, each emitting object and the world, which says whose light differs",
        panel=Panel("Lights", group="passes"),
    )
    partial: bool = option(
        False,
        Flag(),
        "compare what can be compared: leave out pixels that show unsupported materials, and leave room for their light in the others",
        panel=Panel("Partial"),
    )
    motion_blur: bool = option(
        False,
        Flag(),
        "compare with the scene's motion blur: objects, the camera and meshes that deform; otherwise it is off on both sides",
        panel=Panel("Motion blur"),
    )
    out: Path | None = option(
        None,
        FilePath("FOLDER"),
        "folder for the report, verdict.json and images",
        absent="etalon-out/SCENE",
        panel=Panel("Output", default="//etalon-out", help="// is the folder of this file"),
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.partial and self.motion_blur:
            raise EtalonError("--partial does not know motion blur; leave --partial or --motion-blur out")


@dataclass(frozen=True, kw_only=True)
class Settings(ComparisonSettings):
    """All settings of a comparison.

    They are the verdict's options, the reference's, where the results go, and where replicates are rendered.

    tolerance, confidence, time, samples, replicates: as in CompareOptions.
    strategy, direct, masking, sampler, departures, russian_roulette, seed, threads: as in Options.
    passes: the light passes that are compared beside the image: 'auto', 'none', 'all', or those of one name.
    bounces: limits of bounces, from the first to the last, under which images are compared too.
    lights: compare the light of each emitter.
    size: whether a smaller image may be compared, 'auto', or not, 'full'.
    partial: compare what can be compared where materials are not supported. motion_blur: compare with the scene's motion blur.
    out: folder for the results.
    scheduler: 'local', or the address of a Dask scheduler whose workers render the replicates, such as 'tcp://host:8786'.
    Raises EtalonError for a value out of range.

    >>> Settings(tolerance=0.02, time=60).tolerance
    0.02
    >>> Settings(strategy="visable")
    Traceback (most recent call last):
    ...
    etalon.lib.errors.EtalonError: unknown strategy 'visable'; did you mean 'visible'?
    """

    scheduler: str = option(
        LOCAL, Unit("ADDRESS"), "render replicates on the workers of a Dask scheduler, such as tcp://host:8786"
    )
