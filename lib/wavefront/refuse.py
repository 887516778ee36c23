# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene can hold and the path integrator does not simulate, by name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from ..effects.facts import Facts
from ..effects.masks import flags_in, linked_lights, ray_kinds
from ..errors import Refusal, Refused
from ..scene.camera import PANORAMAS
from ..scene.expressions import Bevel, Bump, Expression, PixelWidth
from ..scene.links import EVERY_SET
from ..scene.materials import Subsurface, WeightedClosure
from ..scene.occlusion import find_misuse, name_unasked
from ..scene.rays import COUNTS, EVERY
from ..scene.scene import Scene
from ..textures.fold import walk


def refuse_combinations(scene: Scene) -> None:
    """Raise Refused for things that are simulated each by itself, and not together."""
    facts = Facts(scene)
    refuse_linked_faces(facts)
    refuse_volumes(facts)
    refuse_counts(facts)
    refuse_shader_rays(facts)
    refuse_pixel_widths(facts)


def refuse_linked_faces(facts: Facts) -> None:
    """Raise Refused where mirrors or smooth glass may show linked emitting faces wrongly.

    The faces would be behind objects that do not hide them.
    """
    if not facts.smooth:
        return
    linked = [thing.name for thing in facts.shining if thing.links.blockers != EVERY_SET]
    what = f"shadow linking of its faces beside the smooth material '{facts.smooth[0]}'"
    if linked:
        raise Refused([Refusal(f"object '{name}'", what, "use a light, or remove its blockers") for name in linked])


def refuse_counts(facts: Facts) -> None:
    """Raise Refused where shaders ask for the depth or length of scattered rays.

    These are rays that scatter below or between faces.
    """
    asking = [m.name for m in facts.materials if flags_in(m) & {*COUNTS}]
    below = [m.name for m in facts.materials if any(isinstance(lobe.closure, Subsurface) for lobe in m.lobes)]
    inside = [f"the subsurface scattering of '{name}'" for name in below[:1]]
    inside += [f"the volume of '{name}', which scatters" for name in facts.turbid[:1]]
    what = f"the depth or length of rays beside {' and '.join(inside)}"
    if asking and inside:
        raise Refused([Refusal(f"material '{name}'", what, "unlink the Light Path node") for name in asking])


def refuse_shader_rays(facts: Facts) -> None:
    """Raise Refused where Cycles does not trace the rays of shaders for all the light that it samples."""
    refusals = [
        Refusal(f"material '{material.name}'", what, remedy)
        for material in facts.materials
        for what, remedy in dict.fromkeys(misused_rays(material.lobes))
    ]
    if refusals:
        raise Refused(refusals)


def refuse_pixel_widths(facts: Facts) -> None:
    """Raise Refused where shaders ask for the width of pixels that Cycles does not follow, or not as measured."""
    camera = facts.scene.camera
    asking = [m.name for m in facts.materials if any(isinstance(n, PixelWidth) for x in m.lobes for n in _nodes(x))]
    below = any(isinstance(lobe.closure, Subsurface) for m in facts.materials for lobe in m.lobes)
    places = {
        "a panoramic view": camera.kind in PANORAMAS,
        "an orthographic view of oblong pixels": camera.kind == "ORTHOGRAPHIC"
        and not np.isclose(*np.abs(np.diagonal(camera.plane_from_raster))),
        "a scene with subsurface scattering": below,
        "a scene with volumes that scatter": bool(facts.turbid),
    }
    found = [f"Pixel Size of a Wireframe node in {place}" for place, holds in places.items() if holds]
    if asking and found:
        raise Refused([Refusal(f"material '{n}'", what, "switch Pixel Size off") for n in asking for what in found])


def misused_rays(lobes: Iterable[WeightedClosure]) -> Iterator[tuple[str, str]]:
    """Yield what folded lobes make of ambient occlusion and bevels that is not simulated, each with the remedy."""
    for lobe in lobes:
        where = find_misuse(lobe)
        if where is not None:
            yield f"ambient occlusion in {where}", "link it to a factor of a diffuse colour, or unlink it"
        for part in _misplaced(lobe, Bevel):
            yield f"a Bevel node in {part}", "link it to the Normal of a BSDF, or unlink it"
        for part in _misplaced(lobe, PixelWidth):
            yield f"Pixel Size of a Wireframe node in {part}", "switch Pixel Size off"


def refuse_strategy(scene: Scene, strategy: str) -> None:
    """Raise Refused where what a Bevel node does after a reflection depends on the reference's strategy.

    Cycles samples visible normals, and bevels where their density is high (wavefront/bevels.py).
    """
    asking = [m.name for m in Facts(scene).materials if any(isinstance(n, Bevel) for x in m.lobes for n in _nodes(x))]
    if asking and strategy != "visible":
        what, remedy = f"a Bevel node with the strategy {strategy}", "choose the strategy visible"
        raise Refused([Refusal(f"material '{name}'", what, remedy) for name in asking])


def _nodes(lobe: WeightedClosure) -> list[Expression]:
    sockets = [v for v in (lobe.weight, *vars(lobe.closure).values()) if isinstance(v, Expression)]
    return [node for socket in sockets for node in walk(socket)]


def _misplaced(lobe: WeightedClosure, kind: type[Expression]) -> Iterator[str]:
    """What of a lobe reads a node of a `kind` where Cycles evaluates it for no path, or beside the point."""
    nodes = _nodes(lobe)
    where = name_unasked(lobe.closure)
    if where is not None and any(isinstance(node, kind) for node in nodes):
        yield where
    heights = [node.height for node in nodes if isinstance(node, Bump)]
    if any(isinstance(node, kind) for height in heights for node in walk(height)):
        yield "the height of a bump"


def refuse_volumes(facts: Facts) -> None:
    """Raise Refused where faces do not say what is in their volume.

    Also where some rays would not know that they enter it.
    """
    scene = facts.scene
    if not facts.volumes:
        return
    refusals = list(_of_bounds(scene))
    emitters = (*scene.lights, *scene.mesh.objects)
    linked = [one.name for one in emitters if one.links.blockers != EVERY_SET]
    remedy = "remove the blockers, or the volume"
    refusals += [Refusal(f"'{name}'", "shadow linking beside a volume", remedy) for name in linked]
    refusals += _of_bodies(scene)
    if facts.turbid:
        asked = {"ray visibility": ray_kinds(facts)[0], "light linking": linked_lights(facts)[0]}
        what = f"beside the volume of '{facts.turbid[0]}', which scatters"
        refusals += [
            Refusal("the scene", f"{name} {what},", "remove one of the two") for name, on in asked.items() if on
        ]
    refusals += _of_world(scene)
    if refusals:
        raise Refused(refusals)


def _of_world(scene: Scene) -> Iterator[Refusal]:
    """A world that glows brighter and brighter with the distance."""
    volume = scene.world.volume
    if volume is not None and any(
        e > 0.0 and not s > 0.0 for e, s in zip(volume.emission, volume.extinction, strict=True)
    ):
        yield Refusal("world", "a volume that emits light and absorbs none", "have it absorb, or emit nothing")


def _of_bounds(scene: Scene) -> Iterator[Refusal]:
    """What is wrong with the faces that bound volumes."""
    mesh, count = scene.mesh, len(scene.materials)
    key = mesh.object_index.astype(np.int64) * count + mesh.material_index
    for thing, material in (divmod(k, count) for k in np.unique(key).tolist()):
        volume = scene.materials[material].volume
        if volume is None or volume.is_empty:
            continue
        owner, name = f"object '{mesh.objects[thing].name}'", scene.materials[material].name
        defect = mesh.find_defect(thing, material)
        if defect:
            remedy = "close the mesh, with all faces of this material and turned outwards"
            yield Refusal(owner, f"the volume of material '{name}', because {defect},", remedy)
        if mesh.objects[thing].rays != EVERY:
            what = f"the volume of material '{name}' in an object that some rays do not meet"
            yield Refusal(owner, what, "switch its ray visibility on")


def _of_bodies(scene: Scene) -> Iterator[Refusal]:
    """Objects below whose faces light may get from one volume into another.

    Walks do not say which volumes they pass.
    """
    mesh = scene.mesh
    filled = [m.volume is not None and not m.volume.is_empty for m in scene.materials]
    enters = [any(isinstance(x.closure, Subsurface) for x in m.lobes) for m in scene.materials]
    volumes, bodies = (np.unique(mesh.object_index[np.take(has, mesh.material_index)]) for has in (filled, enters))
    for body in bodies.tolist():
        for volume in volumes.tolist():
            if body != volume and _touch(_box(scene, body), _box(scene, volume)):
                what = (
                    f"subsurface scattering where the object may reach into the volume of '{mesh.objects[volume].name}'"
                )
                yield Refusal(f"object '{mesh.objects[body].name}'", what, "move them apart")


def _box(scene: Scene, number: int) -> tuple[np.ndarray, np.ndarray]:
    """The lowest and the highest coordinates (3,) of an object."""
    mesh = scene.mesh
    places = mesh.vertices[:, mesh.triangles[:, mesh.object_index == number].ravel()]
    return places.min(axis=1), places.max(axis=1)


def _touch(first: tuple[np.ndarray, np.ndarray], second: tuple[np.ndarray, np.ndarray]) -> bool:
    return bool((first[0] <= second[1]).all() and (second[0] <= first[1]).all())
