# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a folded scene departures can change."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..scene.expressions import EnvironmentTexture, Expression, ImageTexture, SurfaceNormal
from ..scene.light_overlaps import find_light_overlaps
from ..scene.lights import AreaLight
from ..scene.materials import Closure, Diffuse, Emission, Glass, Microfacets, Refraction
from ..scene.scene import Scene
from ..textures.fold import is_constant, walk
from .scene import NARROW


def closures_of(scene: Scene) -> Iterator[Closure]:
    """The closures of all materials."""
    for material in scene.materials:
        for lobe in material.lobes:
            yield lobe.closure


def nodes_of(scene: Scene) -> Iterator[Expression]:
    """Every node of every socket of a folded scene."""
    sockets = [scene.world.radiance]
    for material in scene.materials:
        for lobe in material.lobes:
            sockets += [lobe.weight, *(v for v in vars(lobe.closure).values() if isinstance(v, Expression))]
    for socket in sockets:
        yield from walk(socket)


def _is_rough(closure: Microfacets | Diffuse) -> bool:
    socket = closure.roughness
    return not (is_constant(socket) and socket.number == 0.0)


def reflects_by(*distributions: str) -> Callable[[Scene], bool]:
    """Whether a rough lobe, of reflection or refraction, has one of these distributions."""
    return lambda scene: any(
        isinstance(c, Microfacets) and c.distribution in distributions and _is_rough(c) for c in closures_of(scene)
    )


def samples_rough_glass(scene: Scene) -> bool:
    """Whether light is sampled through rough glass; that of a constant world is not."""
    sampled = (
        scene.lights
        or not is_constant(scene.world.radiance)
        or any(isinstance(c, Emission) for c in closures_of(scene))
    )
    return bool(sampled) and any(isinstance(c, Glass | Refraction) and _is_rough(c) for c in closures_of(scene))


def has_rough_diffuse(scene: Scene) -> bool:
    """Whether a diffuse lobe is rough."""
    return any(isinstance(c, Diffuse) and _is_rough(c) for c in closures_of(scene))


def disperses(glass: Glass) -> bool:
    """Whether an index depends on the wavelength."""
    return not (is_constant(glass.dispersion) and glass.dispersion.number == 0.0)


def has_rough_facets(scene: Scene) -> bool:
    """Whether a rough lobe is of Beckmann or GGX."""
    return reflects_by("BECKMANN", "GGX", "MULTI_GGX")(scene)


def has_leaning_normals(scene: Scene) -> bool:
    """Whether faces are shaded smooth, or bumped by a displacement."""
    smooth = bool(scene.mesh.corner_normals.shape[2] and scene.mesh.smooth.any())
    return smooth or any(isinstance(node, SurfaceNormal) for node in nodes_of(scene))


def interpolates_codes(scene: Scene) -> bool:
    """Whether an sRGB image is interpolated."""
    read = {
        n.image
        for n in nodes_of(scene)
        if isinstance(n, ImageTexture | EnvironmentTexture) and n.interpolation != "CLOSEST"
    }
    return any(scene.images[k].encoding == "SRGB" for k in read)


def multiplies_alpha(scene: Scene) -> bool:
    """Whether an image is read whose alpha is multiplied in."""
    read = (n for n in nodes_of(scene) if isinstance(n, ImageTexture | EnvironmentTexture))
    return any(n.association != "SEPARATE" for n in read)


def has_faces_in_one_plane(scene: Scene) -> bool:
    """Whether faces overlap."""
    return scene.mesh.overlaps.count > 0


def has_tilted_faces_in_one_plane(scene: Scene) -> bool:
    """Whether faces overlap in a plane that is not along two axes, in single precision."""
    mesh = scene.mesh
    corners = mesh.vertices.astype(np.float32)[:, mesh.triangles[:, mesh.overlaps.pairs]].reshape(3, 6, -1)
    return bool((np.ptp(corners, axis=1) > 0.0).all(axis=0).any())


def has_materials_in_one_plane(scene: Scene) -> bool:
    """Whether faces of two materials overlap."""
    mesh = scene.mesh
    return bool(np.not_equal(*mesh.material_index[mesh.overlaps.pairs]).any())


def has_lights_in_one_plane(scene: Scene) -> bool:
    """Whether area lights overlap."""
    return bool(find_light_overlaps(scene.lights))


def has_motion(scene: Scene) -> bool:
    """Whether anything moves while the shutter is open."""
    return scene.motion is not None


def has_narrow_spread(scene: Scene) -> bool:
    """Whether an area light has a spread for which Cycles takes a series."""
    return any(isinstance(light, AreaLight) and 0.0 < light.spread <= NARROW for light in scene.lights)
