# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves while the shutter is open, read from the depsgraph at the frames of the keys.

Cycles' rules: 2^steps + 1 keys of each object and of the camera, equally spaced over the shutter, whose middle is the
frame. Deforming meshes have as many keys of their vertices. Materials, lights and the world are those of the frame.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, replace

import bpy
import numpy as np

from ...lib.errors import EtalonError, Refusal
from ...lib.scene.camera import Camera
from ...lib.scene.matrices import affine
from ...lib.scene.mesh import Mesh
from ...lib.scene.motion import Motion
from ...lib.scene.normals import normal_matrices
from ...lib.scene.placements import have_area
from ...lib.scene.scene import Scene
from ...lib.textures.requirements import reads_tangents
from .camera import read_camera
from .mesh import faces_of, is_smooth, read_corners, read_normals
from .refusals import is_invisible, raise_any

_LEAVE_OUT = "leave --motion-blur out"
_MOST_KEYS = 129

# From this release on Cycles has custom normals at each key. Before, it mixes those of the frame with plain ones of the others.
_BLURS_OWN_NORMALS = (5, 2, 0)

_Keys = dict[int, np.ndarray]

Key = tuple[str, str, tuple[int, ...]]
"""An object or an instance: its name, its instancer's, and the instance's numbers."""


@dataclass(frozen=True)
class _Thing:
    """An object with faces at one time: its map, its mesh's address, and how many keys it has."""

    name: str
    matrix: np.ndarray
    pointer: int
    keys: int
    deforms: bool


@dataclass(frozen=True)
class _Shape:
    """A mesh at one time.

    It has vertices (3, v), the vertices of its faces' corners, and the first corner of each face. `triangles` (t, 3)
    are the corners of the middle's triangles, and `normals` (3 corners, 3, t) theirs, None where no face is smooth.
    """

    positions: np.ndarray
    corners: np.ndarray
    starts: np.ndarray
    has_velocity: bool
    has_own_normals: bool
    triangles: np.ndarray
    normals: np.ndarray | None


@dataclass(frozen=True)
class _State:
    """Everything that may move, at one time."""

    things: Mapping[Key, _Thing]
    shapes: Mapping[int, _Shape]
    lights: Mapping[Key, np.ndarray]
    camera_name: str
    camera: Camera | None


def check_blur(depsgraph: bpy.types.Depsgraph, refusals: list[Refusal]) -> bool:
    """Whether the scene and its view layer have motion blur on.

    What of the shutter's settings is not simulated is appended to `refusals`.
    """
    scene = depsgraph.scene_eval
    owner, render = f"scene '{scene.name}'", scene.render
    if not (render.use_motion_blur and depsgraph.view_layer_eval.use_motion_blur):
        return False
    if scene.cycles.rolling_shutter_type != "NONE":
        path = "scene.cycles.rolling_shutter_type=NONE"
        refusals.append(Refusal(owner, "a rolling shutter", "set Rolling Shutter to None", path))
    if render.motion_blur_position != "CENTER":
        path = "scene.render.motion_blur_position=CENTER"
        refusals.append(
            Refusal(owner, "a shutter that does not open about the frame", "set Position to Center on Frame", path)
        )
    heights = {point.location[1] for point in render.motion_blur_shutter_curve.curves[0].points}
    if len(heights) > 1 or min(heights) <= 0.0:
        refusals.append(Refusal(owner, "a Shutter Curve that is not flat", "make its points equally high, above 0"))
    return True


def read_motion(depsgraph: bpy.types.Depsgraph, set_frame: Callable[[float], None], exported: Scene) -> Motion | None:
    """Read what moves in the scene that was `exported` at the depsgraph's frame; None where nothing does.

    `set_frame` evaluates the depsgraph at a time in frames. The caller sets it back. Raises Refused with all that is
    not simulated.
    """
    scene = depsgraph.scene_eval
    now, shutter = scene.frame_current + scene.frame_subframe, scene.render.motion_blur_shutter
    middle = _read_state(depsgraph)
    camera_keys = _count_keys(scene.camera, scene.camera)
    most = max(camera_keys, *(thing.keys for thing in middle.things.values()), 1)
    states = {most // 2: middle}
    for k in range(most):
        if k != most // 2:
            set_frame(now + (k / (most - 1) - 0.5) * shutter)
            states[k] = _read_state(depsgraph, middle)
    ordered = [states[k] for k in range(most)]
    refusals = list(_find_refused(ordered, middle))
    raise_any(refusals)
    if len(middle.things) != len(exported.mesh.objects):
        raise EtalonError(
            f"{scene.name}: objects with faces cannot be told apart for motion blur; rename the namesakes"
        )
    objects, positions, normals = _read_objects(ordered, middle, exported)
    camera = _keys([state.camera.world_from_camera for state in ordered], camera_keys)
    return Motion(objects, positions, normals, camera) if objects or positions or camera is not None else None


def _count_keys(thing: bpy.types.Object, parent: bpy.types.Object) -> int:
    """The keys of an object with this instancer, or of itself; 1 where its motion blur is off."""
    both = (thing.cycles, parent.cycles)
    if not all(one.use_motion_blur for one in both):
        return 1
    return min(2 ** max(1, *(one.motion_steps for one in both)) + 1, _MOST_KEYS)


def _read_state(depsgraph: bpy.types.Depsgraph, middle: _State | None = None) -> _State:
    """Read the state at the time for which the depsgraph is evaluated.

    What is the same as in the `middle` is shared with it.
    """
    things: dict[Key, _Thing] = {}
    shapes: dict[int, _Shape] = {}
    lights: dict[Key, np.ndarray] = {}
    for instance in depsgraph.object_instances:
        thing, parent = instance.object, instance.parent or instance.object
        key = thing.name_full, parent.name_full, tuple(instance.persistent_id) if instance.is_instance else ()
        if not instance.show_self:
            continue
        if thing.type == "LIGHT":
            lights[key] = affine(instance.matrix_world)
        elif isinstance(thing.data, bpy.types.Mesh) and not is_invisible(instance):
            faces = faces_of(thing)
            if not len(faces.loop_triangles):
                continue
            pointer = thing.data.as_pointer()
            if pointer not in shapes:
                known = middle is not None and key in middle.things
                shapes[pointer] = _read_shape(faces, middle.shapes[middle.things[key].pointer] if known else None)
            deforms = thing.cycles.use_deform_motion and parent.cycles.use_deform_motion
            keys = _count_keys(thing, parent)
            things[key] = _Thing(thing.name, affine(instance.matrix_world), pointer, keys, deforms and keys > 1)
    scene = depsgraph.scene_eval
    return _State(things, shapes, lights, scene.camera.name, read_camera(scene.camera, scene.render, []))


def _read_shape(mesh: bpy.types.Mesh, middle: _Shape | None) -> _Shape:
    """The mesh's shape, or its shape in the `middle` where it is the same, so that an equal shape is kept once."""
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    corners, starts = np.empty(len(mesh.loops), np.int32), np.empty(len(mesh.polygons), np.int32)
    mesh.vertices.foreach_get("co", positions)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("loop_start", starts)
    velocity = mesh.attributes.get("velocity")
    has_velocity = velocity is not None and velocity.domain == "POINT" and velocity.data_type == "FLOAT_VECTOR"
    triangles = read_corners(mesh) if middle is None else middle.triangles
    own = mesh.has_custom_normals
    shape = _Shape(positions.reshape(-1, 3).T.astype(np.float64), corners, starts, has_velocity, own, triangles, None)
    if middle is not None and _has_faces_of(shape, middle) and np.array_equal(shape.positions, middle.positions):
        return middle
    wanted = is_smooth(mesh) if middle is None else middle.normals is not None and _has_faces_of(shape, middle)
    if not wanted:
        return shape
    return replace(shape, normals=read_normals(mesh, triangles, corners[triangles].T))


def _has_faces_of(shape: _Shape, other: _Shape) -> bool:
    """Whether two shapes have as many vertices, and the same faces."""
    same = shape.positions.shape == other.positions.shape
    return same and np.array_equal(shape.corners, other.corners) and np.array_equal(shape.starts, other.starts)


def _find_refused(states: list[_State], middle: _State) -> Iterator[Refusal]:
    """What moves in a way that is not simulated."""
    for state in states:
        yield from _of_camera(state, middle)
        for key, matrix in middle.lights.items():
            if key not in state.lights or not np.array_equal(state.lights[key], matrix):
                yield Refusal(f"light '{key[0]}'", "motion blur of a moving light", _LEAVE_OUT)
        for key in state.lights.keys() - middle.lights.keys():
            yield Refusal(f"light '{key[0]}'", "motion blur of a light that appears", _LEAVE_OUT)
        for key in state.things.keys() ^ middle.things.keys():
            what = "motion blur of an object that appears or vanishes while the shutter is open"
            yield Refusal(f"object '{key[0]}'", what, _LEAVE_OUT)
        for key in state.things.keys() & middle.things.keys():
            yield from _of_thing(key, state, middle)
    settings: dict[int, set[tuple[int, bool]]] = defaultdict(set)
    for thing in middle.things.values():
        settings[thing.pointer].add((thing.keys, thing.deforms))
    for key, thing in middle.things.items():
        if len(settings[thing.pointer]) > 1 and _deforms(key, states, middle):
            what = "motion blur of a deforming mesh whose objects have other Steps or Deformation"
            yield Refusal(f"object '{thing.name}'", what, "give them the same")


def _of_camera(state: _State, middle: _State) -> Iterator[Refusal]:
    owner = f"camera '{middle.camera_name}'"
    if state.camera_name != middle.camera_name:
        yield Refusal(owner, "motion blur over a cut to another camera", "move the marker out of the shutter's time")
        return
    if state.camera is None:
        yield Refusal(owner, "a lens or a scale that is refused while the shutter is open", _LEAVE_OUT)
        return
    for field in fields(Camera):
        left, right = getattr(state.camera, field.name), getattr(middle.camera, field.name)
        if field.name != "world_from_camera" and not np.array_equal(left, right):
            what = "motion blur of lens, shift, clipping or focus that change while the shutter is open"
            yield Refusal(owner, what, "keep them constant, or leave --motion-blur out")
            return


def _of_thing(key: Key, state: _State, middle: _State) -> Iterator[Refusal]:
    thing, other = middle.things[key], state.things[key]
    owner = f"object '{thing.name}'"
    if thing.keys == 1:
        return
    if not np.array_equal(thing.matrix, other.matrix):
        before, after = (np.linalg.det(one.matrix[:, :3]) for one in (thing, other))
        if not before * after > 0.0:
            yield Refusal(owner, "motion blur of a scale of 0, or of one that changes its sign", _LEAVE_OUT)
    if not thing.deforms:
        return
    one, two = middle.shapes[thing.pointer], state.shapes[other.pointer]
    if one.has_velocity:
        what = "motion blur by the attribute 'velocity'"
        yield Refusal(owner, what, "remove the attribute, or switch Deformation off in its motion blur settings")
    if not _has_faces_of(one, two):
        what = "motion blur of a mesh whose faces change while the shutter is open"
        yield Refusal(owner, what, "switch Deformation off in its motion blur settings")


def _deforms(key: Key, states: list[_State], middle: _State) -> bool:
    """Whether the vertices of an object's mesh move in its own space."""
    shape = middle.shapes[middle.things[key].pointer].positions
    return any(
        not np.array_equal(shape, state.shapes[state.things[key].pointer].positions)
        for state in states
        if key in state.things
    )


def _read_objects(states: list[_State], middle: _State, exported: Scene) -> tuple[_Keys, _Keys, _Keys]:
    """Return the keys of transforms, of vertices and of normals; raises Refused.

    They are by the number of the object in `exported`. Normals of a mesh with several users are mixed in object space, as
    are those of what moves: such an object has keys of its transform, though they may be the same.
    """
    objects: _Keys = {}
    positions: _Keys = {}
    normals: _Keys = {}
    refusals: list[Refusal] = []
    mesh = exported.mesh
    first = _first_vertices(middle)
    users = Counter(thing.pointer for thing in middle.things.values())
    for index, (key, thing) in enumerate(middle.things.items()):
        if thing.keys == 1:
            continue
        transforms = _keys([state.things[key].matrix for state in states], thing.keys)
        if transforms is not None:
            objects[index] = transforms
        if not thing.deforms:
            continue
        shapes = _keys([state.shapes[state.things[key].pointer].positions for state in states], thing.keys)
        if shapes is None:
            continue
        faces = mesh.object_index == index
        positions[index] = shapes[:, :, np.unique(mesh.triangles[:, faces]) - first[index]]
        shape = middle.shapes[thing.pointer]
        refusals += _of_shading(thing, shape, faces, exported)
        if not mesh.smooth[faces].any():
            continue
        if users[thing.pointer] > 1:
            objects.setdefault(index, np.array([thing.matrix, thing.matrix]))
        local = _spaced([state.shapes[state.things[key].pointer].normals for state in states], thing.keys)
        placed = _placed(local, shape, thing.matrix, first[index], mesh)
        normals[index] = _unit(placed if index in objects else _turned(placed, thing.matrix))
    raise_any(refusals)
    return objects, positions, normals


def _of_shading(thing: _Thing, shape: _Shape, faces: np.ndarray, exported: Scene) -> Iterator[Refusal]:
    """What of a deforming mesh's normals, tangents and displacement is not simulated."""
    owner = f"object '{thing.name}'"
    if shape.has_own_normals and exported.mesh.smooth[faces].any() and bpy.app.version < _BLURS_OWN_NORMALS:
        what = "motion blur of a deforming mesh with custom normals, before Blender 5.2"
        remedy = "clear its custom normals, or switch Deformation off in its motion blur settings"
        yield Refusal(owner, what, remedy)
    materials = [exported.materials[k] for k in np.unique(exported.mesh.material_index[faces])]
    if any(material.displacement is not None for material in materials):
        what = "motion blur of a deforming mesh that a material displaces"
        yield Refusal(owner, what, "switch Deformation off in its motion blur settings")
    if any(reads_tangents(material) for material in materials):
        what = "motion blur of a deforming mesh whose material has a normal map or UV tangents"
        yield Refusal(owner, what, "switch Deformation off in its motion blur settings")


def _placed(normals: np.ndarray, shape: _Shape, matrix: np.ndarray, first: int, mesh: Mesh) -> np.ndarray:
    """Keys of the normals (k, 3 corners, 3, t) of an object's faces in `mesh`, from its `first` vertex on.

    Faces without area are left out there, and a mirrored object has its corners turned round.
    """
    order = [0, 2, 1] if np.linalg.det(matrix[:, :3]) < 0.0 else [0, 1, 2]
    triangles = first + shape.corners[shape.triangles].T[order]
    return normals[:, order][..., have_area(mesh.vertices, triangles)]


def _turned(normals: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Keys of normals in world space, of those in an object's space."""
    return np.einsum("ij,kcjt->kcit", normal_matrices(matrix[None, :, :3])[0], normals)


def _unit(normals: np.ndarray) -> np.ndarray:
    """Keys of normals with unit length; one without length stays so."""
    length = np.linalg.norm(normals, axis=2, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)


def _keys(values: list[np.ndarray], count: int) -> np.ndarray | None:
    """Return `count` of the values, as `_spaced` does; None where they do not change."""
    if count == 1:
        return None
    found = _spaced(values, count)
    return None if (found == found[:1]).all() else found


def _spaced(values: list[np.ndarray], count: int) -> np.ndarray:
    """Return `count` of the values, at least 2, equally spaced from the first to the last."""
    return np.array(values[:: (len(values) - 1) // (count - 1)])


def _first_vertices(state: _State) -> list[int]:
    """Return the number of each object's first vertex in the joined mesh.

    The joined mesh has all users of a mesh one after another.
    """
    groups: dict[int, list[int]] = {}
    for index, thing in enumerate(state.things.values()):
        groups.setdefault(thing.pointer, []).append(index)
    first, reached = [0] * len(state.things), 0
    for pointer, users in groups.items():
        for index in users:
            first[index] = reached
            reached += state.shapes[pointer].positions.shape[1]
    return first
