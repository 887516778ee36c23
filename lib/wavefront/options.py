# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user chooses about the reference: models, sampling strategies, seeds, threads."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import EtalonError

STRATEGIES = ("visible", "bounded", "d_cos", "cosine", "uniform")
DIRECT = ("mis", "lights", "bsdf")
MASKING = ("correlated", "separable", "torrance_sparrow")
SAMPLERS = ("sobol", "random")


@dataclass(frozen=True)
class Options:
    """Options of the reference integrator.

    strategy: how a glossy lobe is sampled: 'visible' normals (Heitz 2014), 'bounded' ones (Eto and Tokuyoshi 2023; GGX), the
        documents' 'd_cos' (pdf(m) = D cos), or the hemisphere by 'cosine' or 'uniform' density.
    direct: 'mis' combines light and BSDF sampling by the power heuristic with a cutoff; 'lights' and 'bsdf' take one of them alone (light
        that one of them cannot sample is then still taken by the other: deltas, constant worlds).
    masking: 'correlated' (Ross, Heitz; what Cycles uses), 'separable' (the documents' G1 G1) or 'torrance_sparrow'.
    sampler: 'sobol' (Owen-scrambled, padded) or 'random'.
    departures: names from lib/departures/catalogue.py, by which the reference errs as Cycles does.
    russian_roulette: stop paths after the third scattering with a probability that leaves the mean as it is.
    """

    strategy: str = "visible"
    direct: str = "mis"
    masking: str = "correlated"
    sampler: str = "sobol"
    departures: frozenset[str] = frozenset()
    russian_roulette: bool = True
    seed: int = 0
    threads: int = 2
    tile_paths: int = 131072

    def __post_init__(self) -> None:
        for name, allowed in (
            ("strategy", STRATEGIES),
            ("direct", DIRECT),
            ("masking", MASKING),
            ("sampler", SAMPLERS),
        ):
            if getattr(self, name) not in allowed:
                raise EtalonError(f"{name} '{getattr(self, name)}' is unknown; choose one of {', '.join(allowed)}")
        if self.departures:
            # Here, since the catalogue brings SciPy and all kernels with it, and help texts need neither.
            from ..departures.catalogue import SWITCHES

            for name in self.departures - SWITCHES:
                raise EtalonError(f"departure '{name}' is unknown; choose from {', '.join(sorted(SWITCHES))}")
        if self.threads < 1:
            raise EtalonError(f"threads is {self.threads}; give at least 1")
