# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the reference, and those of `etalon render`.

They are models, sampling strategies, random numbers and threads.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from ..errors import EtalonError
from .common import LOCAL, Run
from .declaration import Panel, again, option, required
from .models import EMPIRICAL_MODELS, FRESNELS, MODELS, ModelName, describe_models, split_model
from .units import Choice, FilePath, Flag, Names, Unit, Whole

STRATEGIES = ("visible", "bounded", "d_cos", "cosine", "uniform")
LIGHT_TRACING, PHOTON_MAPPING, METROPOLIS = "light-tracing", "photon-mapping", "metropolis"
OTHER_ESTIMATORS = (LIGHT_TRACING, PHOTON_MAPPING, METROPOLIS)
DIRECT = ("mis", "lights", "bsdf")
MASKING = ("correlated", "separable", "torrance_sparrow")
SAMPLERS = ("sobol", "random")


def _switches() -> Collection[str]:
    """The departures that have a switch.

    They are looked up late: the catalogue imports SciPy and all kernels, and help texts need neither.
    """
    from ..departures.catalogue import SWITCHES

    return SWITCHES


@dataclass(frozen=True, kw_only=True)
class Options(Run):
    """Options of the reference integrator.

    strategy: how a glossy lobe is sampled: 'visible' normals (Heitz 2014), 'bounded' ones (Eto and Tokuyoshi 2023; GGX), the
        documents' 'd_cos' (pdf(m) = D cos), or the hemisphere by 'cosine' or 'uniform' density.
    direct: 'mis' combines light and BSDF sampling by the power heuristic with a cutoff; 'lights' and 'bsdf' take one of them alone (light
        that one of them cannot sample is then still taken by the other: deltas, constant worlds).
    masking: 'correlated' (Ross, Heitz; what Cycles uses), 'separable' (the documents' G1 G1) or 'torrance_sparrow'.
    sampler: 'sobol' (Owen-scrambled, padded) or 'random'.
    model: what takes the place of the lobes of Glossy nodes (Blender's Glossy BSDF, and nothing else): a distribution of microfacets or an
        empirical model with the node's roughness, anisotropy and colour; None leaves them as they are. lib/settings/models.py has the names.
    fresnel: a Fresnel term for the same lobes, which have none in Blender: 'exact' of an index, times the node's colour; 'schlick' and
        'cook-torrance' from the node's colour as the reflectance at normal incidence.
    departures: names from lib/departures/catalogue.py, by which the reference errs as Cycles does.
    russian_roulette: stop paths after the third scattering with a probability that leaves the mean as it is.
    tile_paths: the most paths that one thread traces at once; no figure depends on it.
    """

    TITLE: ClassVar[str] = "the reference"

    strategy: str = option(
        STRATEGIES[0],
        Choice("NAME", "strategy", STRATEGIES),
        f"sampling of glossy lobes: {', '.join(STRATEGIES)}",
        advanced=True,
        panel=Panel("Strategy", group="model"),
    )
    direct: str = option(
        DIRECT[0],
        Choice("NAME", "direct", DIRECT),
        f"sampling of direct light: {', '.join(DIRECT)}",
        advanced=True,
        panel=Panel("Direct light", group="model"),
    )
    masking: str = option(
        MASKING[0],
        Choice("NAME", "masking", MASKING),
        f"masking-shadowing: {', '.join(MASKING)}",
        advanced=True,
        panel=Panel("Masking", group="model"),
    )
    model: str | None = option(
        None,
        ModelName(known=MODELS),
        f"model in place of the lobes of Glossy nodes: {describe_models(MODELS)}",
        absent="each node's own",
        advanced=True,
        panel=Panel("Lobes", default="", help="empty: each node's own", group="model"),
    )
    fresnel: str = option(
        "none",
        ModelName("FRESNEL", "Fresnel term", FRESNELS),
        f"Fresnel term of the lobes of Glossy nodes: {describe_models(FRESNELS)}",
        advanced=True,
        panel=Panel("Fresnel", group="model"),
    )
    sampler: str = option(
        SAMPLERS[0],
        Choice("NAME", "sampler", SAMPLERS),
        f"random numbers: {', '.join(SAMPLERS)}",
        advanced=True,
        panel=Panel("Random numbers", group="model"),
    )
    departures: frozenset[str] = option(
        frozenset(),
        Names(what="departure", known=_switches),
        "make the reference reproduce a known departure of Cycles (reports give the names); may be repeated",
        flag="depart",
        advanced=True,
    )
    russian_roulette: bool = option(True, Flag(), "end faint paths early; the mean does not change", advanced=True)
    tile_paths: int = 131072

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.model is None or split_model(self.model, MODELS, "model")[0] not in EMPIRICAL_MODELS:
            return
        for flag, value, default in (("strategy", self.strategy, STRATEGIES[0]), ("masking", self.masking, MASKING[0])):
            if value not in (default, *OTHER_ESTIMATORS):
                raise EtalonError(
                    f"--{flag} {value} is for distributions of microfacets, and '{self.model}' has none; leave one of them out"
                )


@dataclass(frozen=True, kw_only=True)
class RenderOptions(Options):
    """Options of `etalon render` and `etalon.render`.

    They are those of the reference, and how much of it is rendered.

    samples: samples per pixel in each replicate. replicates: number of independent scramblings.
    strategy: as in Options, or another estimator of the image: 'light-tracing' starts paths at the lights, `samples`
        for every pixel; 'photon-mapping' makes a map of photons for each sample, and the film's `remarks` state its
        bias; 'metropolis' mutates the random numbers of paths and refuses a `sampler` that is not the default.
    scheduler: 'local', or the address of a Dask scheduler whose workers render the replicates, such as 'tcp://host:8786'.
    """

    strategy: str = again(
        Options,
        "strategy",
        unit=Choice("NAME", "strategy", (*STRATEGIES, *OTHER_ESTIMATORS)),
        help=f"sampling of glossy lobes: {', '.join(STRATEGIES)}; or {LIGHT_TRACING}: paths from the lights; "
        f"{PHOTON_MAPPING}: photons, with a stated bias; {METROPOLIS}: Markov chains",
    )

    samples: int = option(64, Whole("N", 1), "samples per pixel in each replicate")
    replicates: int = option(8, Whole("R", 1), "number of independent replicates")
    scheduler: str = option(
        LOCAL, Unit("ADDRESS"), "render replicates on the workers of a Dask scheduler, such as tcp://host:8786"
    )


@dataclass(frozen=True, kw_only=True)
class RenderOutput(RenderOptions):
    """Options of the command `etalon render`, which writes a file."""

    out: Path = required(FilePath("FILE.exr"), "image to write")
