# SPDX-License-Identifier: GPL-3.0-or-later
"""Which steps of the loop run for a scene: flags of its stages, set by the plan."""

from __future__ import annotations

from dataclasses import dataclass

from ..departures.light_below import LIGHT_BELOW
from ..effects.names import Effect
from .kernel import Kernel


@dataclass(frozen=True)
class Flow:
    """The loop of one kernel.

    has_lens: camera rays start on a lens. hides: some objects hide from camera rays. several_materials: hits are sorted by material.
    transparent: light passes faces straight, or volumes. second_hits, last_hits: what rays meet after the first face, and at their end,
    matters.
    emission: faces shine. samples_lobes: paths go on from a hit; last_rays: so they do after the last scattering.
    has_choices: there is a lobe or a light to pick. asks_visibility: sampled lights may be hidden. most_bounces: scatterings after
    the first one. disperses: an index depends on the wavelength. counts: shaders ask how often paths have scattered.
    occludes: shaders ask for ambient occlusion. bevels: they average normals.
    pixel_widths: they ask how wide a pixel is.
    subsurface: light scatters inside objects. roulette: weak paths end at random.
    volumes_scatter: paths scatter between faces, too.
    """

    has_lens: bool
    hides: bool
    several_materials: bool
    transparent: bool
    second_hits: bool
    last_hits: bool
    emission: bool
    samples_lobes: bool
    last_rays: bool
    has_choices: bool
    asks_visibility: bool
    most_bounces: int
    disperses: bool
    counts: bool
    occludes: bool
    bevels: bool
    pixel_widths: bool
    subsurface: bool
    roulette: bool
    volumes_scatter: bool

    @staticmethod
    def of(kernel: Kernel) -> Flow:
        """What the kernel's plan and options call for."""
        needs, options = kernel.plan.needs, kernel.options
        return Flow(
            has_lens=needs(Effect.DEPTH_OF_FIELD),
            hides=needs(Effect.HIDDEN_OBJECTS) and kernel.sight.class_of is None,
            several_materials=needs(Effect.SEVERAL_MATERIALS),
            transparent=needs(Effect.TRANSPARENT_SURFACES) or kernel.media is not None,
            second_hits=needs(Effect.SECOND_HITS) or kernel.coplanar is not None,
            last_hits=needs(Effect.LAST_HITS),
            emission=needs(Effect.EMISSION),
            samples_lobes=needs(Effect.SCATTERED_RAYS),
            last_rays=needs(Effect.LAST_RAYS),
            has_choices=kernel.selects or needs(Effect.SEVERAL_LOBES),
            asks_visibility=needs(Effect.SHADOW_RAYS)
            or LIGHT_BELOW in options.departures
            or kernel.coplanar is not None,
            most_bounces=kernel.scene.transport.max_bounces if needs(Effect.INDIRECT_LIGHT) else 0,
            disperses=needs(Effect.DISPERSION),
            counts=needs(Effect.RAY_COUNTS),
            occludes=needs(Effect.AMBIENT_OCCLUSION),
            bevels=needs(Effect.BEVELS),
            pixel_widths=needs(Effect.PIXEL_WIDTHS),
            subsurface=needs(Effect.SUBSURFACE),
            roulette=options.russian_roulette and needs(Effect.RUSSIAN_ROULETTE),
            volumes_scatter=needs(Effect.VOLUME_SCATTERING),
        )
