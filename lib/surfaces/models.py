# SPDX-License-Identifier: GPL-3.0-or-later
"""Other models in place of the lobes of Glossy nodes.

This file has the change of the scene, and the forms of the lobes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..bsdfs.fresnels import AveragedFresnel, Conductor, CookTorrance, Schlick
from ..empirical.models import EMPIRICAL, LobeForm
from ..microfacets.distribution import Distribution
from ..microfacets.distributions import DISTRIBUTIONS, distribution_by_name
from ..microfacets.scale_mixture import ExponentialPower, ShiftedGamma
from ..microfacets.student_t import StudentT
from ..scene.materials import Glossy, Material, WeightedClosure
from ..scene.scene import Scene
from ..settings.models import FRESNELS, MODELS, split_model
from ..settings.reference import Options

_OF_BLENDER = {"ggx": "GGX", "beckmann": "BECKMANN", "ashikhmin-shirley": "ASHIKHMIN_SHIRLEY"}
"""Models that a Glossy node has itself: departures of Cycles act on them as on the node's."""
_SHAPED: dict[str, Callable[..., Distribution]] = {
    "student-t": StudentT,
    "shifted-gamma": ShiftedGamma,
    "exponential-power": ExponentialPower,
}


def with_other_model(scene: Scene, options: Options) -> Scene:
    """Return `scene` with the model and the Fresnel term of `options` in its Glossy closures.

    It is the scene itself where they change nothing.
    """
    if options.model is None and options.fresnel == "none":
        return scene
    return replace(scene, materials=tuple(_with_model(material, options) for material in scene.materials))


def _with_model(material: Material, options: Options) -> Material:
    return replace(material, lobes=tuple(_with_closure(lobe, options) for lobe in material.lobes))


def _with_closure(lobe: WeightedClosure, options: Options) -> WeightedClosure:
    closure = lobe.closure
    if not isinstance(closure, Glossy):
        return lobe
    name = closure.distribution if options.model is None else _OF_BLENDER.get(options.model, options.model)
    return replace(lobe, closure=replace(closure, distribution=name, fresnel=options.fresnel))


def empirical_form(name: str) -> LobeForm | None:
    """Return the form of the lobe that a closure calls `name`.

    None where that is a distribution of microfacets.
    """
    model = name.partition(":")[0]
    return EMPIRICAL[model](**split_model(name, MODELS, "model")[1]) if model in EMPIRICAL else None


def distribution_of(name: str) -> Distribution:
    """Return the distribution of microfacets that a closure calls `name`.

    It is Blender's, or a model with its parameters.
    """
    if name in DISTRIBUTIONS:
        return distribution_by_name(name)
    model, values = split_model(name, MODELS, "model")
    return _SHAPED[model](**values)


def fresnel_curve(name: str, color: np.ndarray) -> tuple[AveragedFresnel | None, np.ndarray]:
    """Return the reflectance that a Glossy closure calls `name`, and the colour left outside.

    The closure's `color` is (3, 1) or (3, n). The reflectance is None for the term 'none'.
    """
    model, values = split_model(name, FRESNELS, "Fresnel term")
    if model == "none":
        return None, color
    if model == "exact":
        return Conductor(np.asarray(values["ior"], float), np.asarray(values["k"], float)), color
    curve = Schlick if model == "schlick" else CookTorrance
    return curve(np.clip(color, 0.0, 1.0)), np.ones((3, 1))
