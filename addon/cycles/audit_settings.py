# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue of settings that an audit measures.

Each is a setting of Cycles that may bias an image, with its place and its neutral value. What is noted as measured was
measured on Cycles itself; the neutral values are those of `neutral`, except for bounces, which are as many as Cycles
takes, and the light threshold, which `neutral` leaves alone because it only adds noise.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import bpy

from .neutral import SEQUENCE
from .settings import Assignment, noise_threshold

MOST_BOUNCES = 1024
ADAPTIVE, DENOISER = "adaptive", "denoiser"

_OWNERS: dict[str, Callable[[bpy.types.Scene], Iterable[Any]]] = {
    "cycles": lambda scene: [scene.cycles],
    "render": lambda scene: [scene.render],
    "object": lambda scene: (o for o in bpy.data.objects if hasattr(o.data, "materials")),
    "object.cycles": lambda scene: (o.cycles for o in bpy.data.objects),
    "material": lambda scene: bpy.data.materials,
    "material.cycles": lambda scene: (m.cycles for m in bpy.data.materials),
    "modifier": lambda scene: (m for o in bpy.data.objects for m in o.modifiers),
    "light": lambda scene: (light for light in bpy.data.lights if getattr(light, "shadow_soft_size", 0.0) > 0.0),
    "light.cycles": lambda scene: (light.cycles for light in bpy.data.lights),
    "world.cycles": lambda scene: (world.cycles for world in bpy.data.worlds),
}

# What says which image is wanted, and `neutral` would change on both sides alike: it stays as the user has it.
_KEPT = {
    "cycles": ("feature_set", "shading_system"),
    "render": ("use_motion_blur", "film_transparent"),
    "object.cycles": ("use_adaptive_subdivision", "is_caustics_caster"),
    "modifier": ("use_adaptive_subdivision",),
    "light.cycles": ("is_caustics_light",),
    "world.cycles": ("is_caustics_light",),
}


@dataclass(frozen=True)
class Entry:
    """One setting: its properties, each by owner and name, and their neutral values.

    The first property says whether the setting is in force. `rides` are properties that go with it and need no neutral
    value.
    """

    key: str
    label: str
    neutral: dict[str, Any]
    statement: str
    rides: tuple[str, ...] = ()

    def of_file(self, scene: bpy.types.Scene) -> list[Assignment]:
        """The user's own values, as far as this Blender and this file have any.

        Read them before `neutral` holds the scene.
        """
        return [(owner, name, getattr(owner, name)) for owner, name in self._places(scene)]

    def of_factory(self, scene: bpy.types.Scene) -> list[Assignment]:
        """The values that Blender starts with, for the same properties."""
        return [(owner, name, owner.bl_rna.properties[name].default) for owner, name in self._places(scene)]

    def departs(self, values: list[Assignment]) -> bool:
        """Whether the first property has another value than its neutral one anywhere."""
        return any(value != self._first[1] for _, name, value in values if name == self._first[0])

    def shown(self, values: list[Assignment]) -> str:
        """Values for a table.

        Shown is the property that counts; where it is in force, that of the first of `rides` too.
        """
        words: dict[str, set[str]] = {}
        for _, name, value in values:
            words.setdefault(name, set()).add(_word(value))
        rides = [path.rpartition(".")[2] for path in self.rides[:1]] if self.departs(values) else []
        told = [sorted(words[name]) for name in (self._first[0], *rides)]
        return ", ".join(" and ".join(found[:3]) + (" and more" if len(found) > 3 else "") for found in told)

    @property
    def neutral_shown(self) -> str:
        """The neutral value of the property that counts."""
        return _word(self._first[1])

    def needs(self, values: list[Assignment]) -> int:
        """The least samples a pixel at which it can be measured."""
        if self.key != ADAPTIVE:
            return 1
        found = {name: value for _, name, value in values}
        threshold = noise_threshold(found["adaptive_threshold"])
        # Cycles' own choice where the least number is 0, and its looks at every 16th sample; it stops one sample after the first look.
        least = found["adaptive_min_samples"] or math.ceil(16.0 / threshold**0.3)
        first = ((max(least, 4) + 1) | 15) + 2
        # Fewer would need a threshold above 1 to make up for rendering a part of the sequence.
        return max(first, math.ceil(SEQUENCE * threshold**2))

    @property
    def _first(self) -> tuple[str, Any]:
        path, value = next(iter(self.neutral.items()))
        return path.rpartition(".")[2], value

    def _places(self, scene: bpy.types.Scene) -> Iterator[tuple[Any, str]]:
        for path in (*self.neutral, *self.rides):
            kind, _, name = path.rpartition(".")
            for owner in _OWNERS[kind](scene):
                if hasattr(owner, name):
                    yield owner, name


def _word(value: Any) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _bounces(name: str, label: str, statement: str) -> Entry:
    return Entry(name.replace("_", "-"), label, {f"cycles.{name}": MOST_BOUNCES}, statement)


CATALOGUE = (
    Entry(
        "clamp-direct",
        "Clamp Direct",
        {"cycles.sample_clamp_direct": 0.0},
        "Cuts direct light of any sample at this value: energy is lost, and noise with it.",
    ),
    Entry(
        "clamp-indirect",
        "Clamp Indirect",
        {"cycles.sample_clamp_indirect": 0.0},
        "Cuts indirect light of any sample at this value: energy is lost, and fireflies with it.",
    ),
    Entry(
        "filter-glossy",
        "Filter Glossy",
        {"cycles.blur_glossy": 0.0},
        "Widens glossy lobes after a blurry bounce: caustics and their noise are smeared.",
    ),
    Entry(
        "light-threshold",
        "Light Threshold",
        {"cycles.light_sampling_threshold": 0.0},
        "Ends light samples below it at random: unbiased, fewer shadow rays for more noise. Nothing where the light tree is on.",
    ),
    Entry(
        ADAPTIVE,
        "Noise Threshold",
        {"cycles.use_adaptive_sampling": False},
        "Stops pixels that happen to look converged, which the darker of the noisy ones do more often.",
        ("cycles.adaptive_threshold", "cycles.adaptive_min_samples"),
    ),
    Entry(
        DENOISER,
        "Denoise",
        {"cycles.use_denoising": False},
        "Replaces each pixel by a guess from its neighbours: noise becomes error that stays.",
    ),
    _bounces("max_bounces", "Max Bounces", "Ends every path after this many bounces: what light does later is lost."),
    _bounces("diffuse_bounces", "Diffuse Bounces", "Ends paths after this many diffuse bounces."),
    _bounces("glossy_bounces", "Glossy Bounces", "Ends paths after this many glossy bounces."),
    _bounces(
        "transmission_bounces",
        "Transmission Bounces",
        "Ends paths after this many transmissions: deep glass goes black.",
    ),
    _bounces("volume_bounces", "Volume Bounces", "Ends paths after this many scatterings in a volume."),
    _bounces("transparent_max_bounces", "Transparent Bounces", "Ends paths after this many transparent surfaces."),
    Entry(
        "light-bounces",
        "Light Bounces",
        {"light.cycles.max_bounces": MOST_BOUNCES},
        "Lets a light reach only paths of at most this many bounces.",
    ),
    Entry(
        "world-bounces",
        "World Bounces",
        {"world.cycles.max_bounces": MOST_BOUNCES},
        "Lets the world reach only paths of at most this many bounces.",
    ),
    Entry(
        "caustics-reflective",
        "Reflective Caustics",
        {"cycles.caustics_reflective": True},
        "Off: light that a glossy surface sends to a diffuse one is lost.",
    ),
    Entry(
        "caustics-refractive",
        "Refractive Caustics",
        {"cycles.caustics_refractive": True},
        "Off: light that glass sends to a diffuse surface is lost.",
    ),
    Entry(
        "pixel-filter",
        "Pixel Filter",
        {"cycles.pixel_filter_type": "BOX"},
        "Spreads what a pixel sees over its neighbours: another image by choice, held here against box pixels. "
        "Its table is off by up to 1/1023 pixel.",
        ("cycles.filter_width",),
    ),
    Entry(
        "fast-gi",
        "Fast GI",
        {"cycles.use_fast_gi": False},
        "Replaces late bounces by a guess from ambient occlusion.",
        ("cycles.fast_gi_method", "cycles.ao_bounces_render"),
    ),
    Entry(
        "guiding",
        "Path Guiding",
        {"cycles.use_guiding": False},
        "Learns where light comes from: another noise for more time.",
    ),
    Entry(
        "scrambling",
        "Scrambling Distance",
        {"cycles.scrambling_distance": 1.0},
        "Below 1 neighbouring pixels share random numbers: error that looks like structure instead of noise.",
    ),
    Entry(
        "auto-scrambling",
        "Automatic Scrambling",
        {"cycles.auto_scrambling_distance": False},
        "Lets neighbouring pixels share random numbers: error that looks like structure instead of noise.",
    ),
    Entry(
        "simplify",
        "Simplify",
        {
            "render.use_simplify": False,
            "cycles.texture_limit_render": "OFF",
            "cycles.texture_resolution_render": 1.0,
            "cycles.use_camera_cull": False,
            "cycles.use_distance_cull": False,
        },
        "Smaller textures, fewer subdivisions and child particles, and nothing that is culled.",
        ("render.simplify_subdivision_render", "render.simplify_child_particles_render"),
    ),
    Entry(
        "terminator-geometry",
        "Shadow Terminator Geometry",
        {"object.shadow_terminator_geometry_offset": 0.0},
        "Moves the origins of shadow rays off smooth meshes: light leaks to hide facets.",
    ),
    Entry(
        "terminator-shading",
        "Shadow Terminator Shading",
        {"object.shadow_terminator_shading_offset": 0.0},
        "Moves the shadow's edge on smooth meshes.",
    ),
    Entry(
        "bump-correction",
        "Bump Map Correction",
        {"material.cycles.use_bump_map_correction": False},
        "Turns the normal of glossy surfaces until nothing is reflected below the face.",
    ),
    Entry(
        "transparent-shadows",
        "Transparent Shadows",
        {"material.use_transparent_shadow": True},
        "Off: transparent surfaces cast opaque shadows.",
    ),
    Entry(
        "soft-falloff",
        "Soft Falloff",
        {"light.use_soft_falloff": False},
        "Makes a sphere light a disk turned to what it lights.",
    ),
)


def neutral_assignments(entry: Entry, scene: bpy.types.Scene) -> list[Assignment]:
    """What sets the properties of `entry` that are not neutral to their neutral values."""
    values = {path.rpartition(".")[2]: value for path, value in entry.neutral.items()}
    there = [(owner, name, values[name]) for owner, name, _ in entry.of_file(scene) if name in values]
    return [(owner, name, value) for owner, name, value in there if getattr(owner, name) != value]


def kept(scene: bpy.types.Scene) -> list[Assignment]:
    """What stays as the user has it on both sides."""
    return [
        (owner, name, getattr(owner, name))
        for kind, names in _KEPT.items()
        for owner in _OWNERS[kind](scene)
        for name in names
        if hasattr(owner, name)
    ]
