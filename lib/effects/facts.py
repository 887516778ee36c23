# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene holds, as far as the catalogue asks; each fact is computed once.

The facts are what is seen, what emits light, and what the geometry allows.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from ..lights.build import light_sampler
from ..scene.expressions import ONE, Constant, Expression
from ..scene.lights import Light
from ..scene.materials import (
    Anisotropic,
    Closure,
    Emission,
    Glass,
    Material,
    Refraction,
    Subsurface,
    Translucent,
    Transparent,
    WeightedClosure,
)
from ..scene.mesh import Object
from ..scene.scene import Scene
from ..scene.volumes import Volume
from ..textures.fold import fold_scene
from .geometry import Answer, meets_again


def is_zero(expression: Expression) -> bool:
    """Whether a folded expression is the constant zero."""
    return isinstance(expression, Constant) and not np.any(expression.value)


def adds_nothing(lobe: WeightedClosure) -> bool:
    """Whether weight, colour or strength of a folded lobe is the constant zero."""
    sockets = [lobe.weight, getattr(lobe.closure, "color", ONE)]
    if isinstance(lobe.closure, Emission):
        sockets.append(lobe.closure.strength)
    return any(is_zero(socket) for socket in sockets)


def adding_lobes(material: Material) -> tuple[WeightedClosure, ...]:
    """The lobes of a folded material that add something."""
    return tuple(lobe for lobe in material.lobes if not adds_nothing(lobe))


def scatters(closure: Closure) -> bool:
    """Whether a closure sends light on in a sampled direction."""
    return not isinstance(closure, Emission | Transparent)


def is_smooth(closure: Closure) -> bool:
    """Return whether a folded closure scatters into one direction or two.

    No light sample ever finds these directions.
    """
    if isinstance(closure, Glass | Refraction):
        return is_zero(closure.roughness)
    return (
        isinstance(closure, Anisotropic) and closure.distribution != "ASHIKHMIN_SHIRLEY" and is_zero(closure.roughness)
    )


class Facts:
    """The facts of one scene, whose constants are folded here."""

    def __init__(self, scene: Scene) -> None:
        self.scene = fold_scene(scene)

    @cached_property
    def materials(self) -> tuple[Material, ...]:
        """The materials that faces have, with the lobes that add something."""
        count = np.bincount(self.scene.mesh.material_index, minlength=len(self.scene.materials))
        used = (self.scene.materials[k] for k in np.flatnonzero(count))
        return tuple(replace(material, lobes=adding_lobes(material)) for material in used)

    @property
    def world(self) -> Expression:
        """The world's radiance, folded."""
        return self.scene.world.radiance

    @cached_property
    def world_varies(self) -> bool:
        """Whether the world's radiance depends on the direction."""
        return not isinstance(self.world, Constant)

    @cached_property
    def world_shines(self) -> bool:
        """Whether the world is anything but black."""
        return not is_zero(self.world)

    @cached_property
    def _lights(self) -> tuple[tuple[Light, bool], ...]:
        samplers = ((light, light_sampler(light, 1.0)) for light in self.scene.lights)
        return tuple((light, sampler.delta) for light, sampler in samplers if sampler.power > 0.0)

    @property
    def lights(self) -> tuple[Light, ...]:
        """The light objects that send out anything."""
        return tuple(light for light, _ in self._lights)

    @property
    def broad_lights(self) -> tuple[Light, ...]:
        """Those of them that rays can meet."""
        return tuple(light for light, delta in self._lights if not delta)

    @cached_property
    def shining(self) -> tuple[Object, ...]:
        """The objects with faces that emit light."""
        mesh = self.scene.mesh
        emits = [any(isinstance(x.closure, Emission) for x in adding_lobes(m)) for m in self.scene.materials]
        return tuple(mesh.objects[k] for k in np.unique(mesh.object_index[np.take(emits, mesh.material_index)]))

    def named(self, kind: type | tuple[type, ...]) -> list[str]:
        """Names of the materials with a closure of that kind."""
        return [m.name for m in self.materials if any(isinstance(lobe.closure, kind) for lobe in m.lobes)]

    @property
    def unknown(self) -> list[str]:
        """Names of the materials that are not known: they may shine, and let light pass."""
        return [m.name for m in self.materials if m.unknown]

    @property
    def transparent(self) -> list[str]:
        """Names of the materials that light passes straight, or may pass."""
        bounds = [material.name for material in self.materials if material.only_bounds]
        return self.named(Transparent) + self.unknown + bounds

    @cached_property
    def volumes(self) -> list[str]:
        """Names of the materials whose volumes do something to light, and 'world' for the world's."""
        return [name for name, _ in self._volumes]

    @cached_property
    def _volumes(self) -> list[tuple[str, Volume]]:
        owners = [(material.name, material.volume) for material in self.materials]
        owners.append(("world", self.scene.world.volume))
        return [(name, volume) for name, volume in owners if volume is not None and not volume.is_empty]

    @property
    def turbid(self) -> list[str]:
        """Names of those of them whose volumes scatter light."""
        return [name for name, volume in self._volumes if any(volume.scattering)]

    @property
    def glowing(self) -> list[str]:
        """Names of those of them whose volumes emit light."""
        return [name for name, volume in self._volumes if any(volume.emission)]

    @cached_property
    def rough(self) -> list[str]:
        """Return the names of materials that scatter into more than one or two directions.

        They do so by a lobe or in their volume.
        """
        rough = [
            m.name for m in self.materials if any(scatters(x.closure) and not is_smooth(x.closure) for x in m.lobes)
        ]
        return rough + self.turbid

    @cached_property
    def smooth(self) -> list[str]:
        """Names of the materials with a lobe that scatters into one or two directions."""
        return [m.name for m in self.materials if any(scatters(x.closure) and is_smooth(x.closure) for x in m.lobes)]

    @cached_property
    def scattering(self) -> list[str]:
        """Names of the materials that scatter, by a lobe or in their volume."""
        return [m.name for m in self.materials if any(scatters(lobe.closure) for lobe in m.lobes)] + self.turbid

    @cached_property
    def meets_again(self) -> Answer:
        """Whether what leaves a face can meet another, and the fact that says so."""
        if self.volumes:
            return True, f"rays are followed through the volume of '{self.volumes[0]}'"
        behind = self.named((Glass, Refraction, Translucent, Subsurface))
        return meets_again(self.scene.mesh, self.scene.camera, behind + self.transparent)
