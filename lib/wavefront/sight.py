# SPDX-License-Identifier: GPL-3.0-or-later
"""Visibility by kind of ray: which rays meet which objects, lights and worlds.

Each of these has a mask of the rays that see it.
Kinds of rays that see the same things make one class; class 0 is the camera's rays. Where no kind of ray differs from
another, there are no classes. Light samples are tested by shadow rays, directions that lobes choose by the ray itself.
Where the two would meet different faces, or where a light does not shine as far as rays reach, only light sampling
finds direct light: such a light is `alone`, as one without size is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..effects.masks import reads_flags, shades_transparently
from ..effects.names import Effect
from ..effects.plan import Plan
from ..scene.lights import Switches
from ..scene.links import EVERY_SET, has_set
from ..scene.rays import (
    CAMERA,
    FLAGS,
    FLAGS_BY_KIND,
    LIGHT_BITS,
    OBJECT_BITS,
    SHADOW,
    Kind,
    has_bits,
    tells_shadows_apart,
)
from ..scene.scene import Scene
from .casters import Casters, PartCaster
from .paths import Paths
from .raycaster import Hits, Raycaster


class Sight:
    """The masks of one scene, as far as the plan calls for them; read-only once made.

    `camera`, `shadow`: the casters of camera rays and shadow rays. `class_of` (kinds,): the class of each kind of ray, or None where all
    scattered rays see everything. `sees` (classes, lights) bool: which lights each class sees; `sees_world` (classes,) bool.
    `shows` (lights,) bool: which lights camera rays see. `alone` (lights,) bool: which ones light sampling alone finds. `reads_flags`:
    shaders ask of what kind rays are. `casts_shadow` (lights,) bool and `max_bounces` (lights,) int are None where no light has such a
    switch. `receiver_of` (triangles,) is the set of linked objects to which each belongs, or None where all lights reach all objects;
    `lights` (sets + 1, lights) and `faces_light` (sets + 1, objects) bool say what is lit by which light, and by which object's faces. Their
    last row is for camera rays, whose set is -1. `shadow_of` (lights,) numbers the `shadow_casters`, or is None where all lights have the
    same; `hidden_apart` (lights,) bool: which lights have linked blockers.
    """

    def __init__(
        self, scene: Scene, plan: Plan, casters: Casters, lights: Sequence[tuple[Switches, bool]], delta: np.ndarray
    ) -> None:
        """Make the masks of the scene's lights, objects and world.

        `lights`: the switches of each sampler, and whether it is made of faces. `delta` (lights,) bool: which lights
        have no size.
        """
        hides, told = plan.needs(Effect.HIDDEN_OBJECTS), plan.needs(Effect.RAY_KINDS)
        self.camera = casters.for_bits(CAMERA) if hides else casters.whole
        self.shadow = casters.for_bits(SHADOW) if hides else casters.whole
        switches = [light for light, _ in lights]
        self.shows = np.array([has_bits(light.rays, CAMERA) or faces for light, faces in lights], bool)
        self.casts_shadow = self.max_bounces = self.class_of = self.receiver_of = self.shadow_of = None
        self.alone = delta.copy()
        if plan.needs(Effect.SHADOWS_APART):
            apart = any(tells_shadows_apart(thing.rays) for thing in scene.mesh.objects)
            self.alone |= apart or any(map(shades_transparently, scene.materials))
        if plan.needs(Effect.LIGHTS_WITHOUT_SHADOWS):
            self.casts_shadow = np.array([light.casts_shadow for light in switches], bool)
            self.alone |= ~self.casts_shadow
        if plan.needs(Effect.LIGHT_BOUNCES):
            self.max_bounces = np.array([light.max_bounces for light in switches], np.intp)
            self.alone |= self.max_bounces < scene.transport.max_bounces
        if plan.needs(Effect.LINKED_SHADOWS):
            self._link_shadows(casters, switches)
        if plan.needs(Effect.LINKED_LIGHTS):
            self._link_lights(scene, switches)
        asked = told and plan.needs(Effect.RAY_FLAGS)
        self.reads_flags = asked and any(map(reads_flags, (scene.world, *scene.materials)))
        if told:
            self._tell_apart(scene, casters, lights)

    def _link_lights(self, scene: Scene, switches: list[Switches]) -> None:
        """Say which sets of objects each light and each object's faces light."""
        mesh = scene.mesh
        self.receiver_of = np.array([thing.receiver for thing in mesh.objects] or [0])[mesh.object_index]
        self._object_index = mesh.object_index
        sets = range(max((thing.receiver for thing in mesh.objects), default=0) + 1)
        rows = [[[has_set(one.links.receivers, k) for one in each] for k in sets] for each in (switches, mesh.objects)]
        self.lights, self.faces_light = (np.array([*row, [True] * len(row[0])], bool) for row in rows)

    def _link_shadows(self, casters: Casters, switches: list[Switches]) -> None:
        """Give each light the caster of what hides it; scattered rays would meet other faces."""
        linked = np.array([light.links.blockers != EVERY_SET for light in switches], bool)
        self.alone |= linked
        self.hidden_apart = linked
        of_lights = [casters.for_blockers(light.links.blockers) for light in switches]
        self.shadow_casters: list[Raycaster | PartCaster] = list(dict.fromkeys(of_lights))
        self.shadow_of = np.array([self.shadow_casters.index(one) for one in of_lights], np.intp)

    def faces_lit(self, receiver: np.ndarray, triangle: np.ndarray) -> np.ndarray:
        """Whether the faces `triangle` light the sets of objects `receiver`, (n,) each; (n,) bool."""
        return self.faces_light[receiver, np.take(self._object_index, triangle)]

    def _tell_apart(self, scene: Scene, casters: Casters, lights: Sequence[tuple[Switches, bool]]) -> None:
        """Sort the kinds of rays into classes that meet the same objects and see the same lights."""
        seen = {}
        for kind in Kind:
            bits = [OBJECT_BITS[kind] if faces else LIGHT_BITS[kind] for _, faces in lights]
            row = tuple(has_bits(light.rays, b) for (light, _), b in zip(lights, bits, strict=True))
            sees_world = has_bits(scene.world.rays, LIGHT_BITS[kind])
            # Where shaders ask for the kind, each kind is a class of its own, with its number.
            seen[kind] = casters.for_bits(OBJECT_BITS[kind]), row, sees_world, kind if self.reads_flags else None
        scattered = list(dict.fromkeys(seen[kind] for kind in Kind if kind != Kind.CAMERA))
        self.class_of = np.array([0, *(1 + scattered.index(seen[kind]) for kind in Kind if kind != Kind.CAMERA)])
        classes = [seen[Kind.CAMERA], *scattered]
        self._casters = [caster for caster, _, _, _ in classes]
        self.sees = np.array([row for _, row, _, _ in classes], bool).reshape(len(classes), len(lights))
        self.sees_world = np.array([world for _, _, world, _ in classes], bool)

    @property
    def splits(self) -> bool:
        """Whether scattered rays are of several classes, which cannot stand in for each other."""
        return self.class_of is not None and self.class_of.max() > 1

    def flags_of(self, paths: Paths, index: np.ndarray | None = None) -> np.ndarray | int:
        """The flags of rays, (n,) int, or 0 where no shader asks for them.

        With `index`, those of some of the rays.
        """
        if not self.reads_flags or paths.ray_class is None:
            return 0
        kind, pdf = (x if index is None else x[index] for x in (paths.ray_class, paths.pdf))
        singular = np.isinf(pdf) & (kind != Kind.CAMERA)
        return np.array(FLAGS_BY_KIND)[kind] | FLAGS["SINGULAR"] * singular

    def closest(self, ray_class: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> Hits:
        """First triangle along rays (3, n) of the classes `ray_class` (n,)."""
        groups = self._groups(ray_class)
        if len(groups) == 1:
            return groups[0][0].closest(origin, direction)
        size = ray_class.size
        whole = Hits(np.empty(size, np.int32), np.empty(size), np.empty(size, np.float32), np.empty(size, np.float32))
        for caster, index in groups:
            hits = caster.closest(np.take(origin, index, axis=1), np.take(direction, index, axis=1))
            for array, part in zip(vars(whole).values(), vars(hits).values(), strict=True):
                array[index] = part
        return whole

    def occluded(self, ray_class: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Whether rays meet any triangle, (n,) bool; the rest as `closest`."""
        hidden = np.zeros(ray_class.size, bool)
        for caster, index in self._groups(ray_class):
            far = np.full(index.size, np.inf)
            hidden[index] = caster.occluded(np.take(origin, index, axis=1), np.take(direction, index, axis=1), far)
        return hidden

    def _groups(self, ray_class: np.ndarray) -> list[tuple[Raycaster | PartCaster, np.ndarray]]:
        """Each caster that is asked, with the indices of its rays."""
        present = np.unique(ray_class)
        casters = list(dict.fromkeys(self._casters[k] for k in present))
        if len(casters) == 1:
            return [(casters[0], np.arange(ray_class.size))]
        of_class = np.array([casters.index(c) if c in casters else -1 for c in self._casters])
        return [(caster, np.flatnonzero(of_class[ray_class] == k)) for k, caster in enumerate(casters)]
