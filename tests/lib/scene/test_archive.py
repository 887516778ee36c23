# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene comes back from its .npz as it went in."""

from dataclasses import fields, is_dataclass

import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.scene import archive
from etalon.lib.scene.camera import Aperture, Camera
from etalon.lib.scene.expressions import Constant, Coordinates, ImageTexture, Math
from etalon.lib.scene.images import Image
from etalon.lib.scene.lights import Cone, SpotLight
from etalon.lib.scene.materials import Glossy, Lobe, Material
from etalon.lib.scene.mesh import Mesh, Object
from etalon.lib.scene.scene import Scene, Transport
from etalon.lib.scene.world import World


@pytest.fixture
def scene(rng):
    """One triangle with a texture, a spot, a lens: every kind of value that a scene can hold."""
    corners = np.eye(3)
    mesh = Mesh(
        vertices=corners,
        triangles=np.array([[0], [1], [2]], np.int32),
        material_index=np.zeros(1, np.int32),
        object_index=np.zeros(1, np.int32),
        smooth=np.zeros(1, bool),
        corner_normals=np.zeros((3, 3, 0), np.float32),
        objects=(Object("Étalon <1>", np.eye(3, 4)),),
        uvs={"UVMap": rng.random((3, 2, 1)).astype(np.float32)},
    )
    texture = ImageTexture(Coordinates("UV", "UVMap"), 0)
    roughness = Math("MULTIPLY", Constant(0.1), Constant(1 / 3), Constant(0.0))
    return Scene(
        name="one triangle",
        mesh=mesh,
        materials=(Material("Gloss", (Lobe(Glossy("BECKMANN", texture, roughness)),)),),
        lights=(
            SpotLight("Spot", (0.0, 0.0, 2.0), 0.0, (1.0, 2.0, 3.0), Cone((0, 0, -1), (1, 0, 0), (0, 1, 0), 0.7, 0.15)),
        ),
        world=World(Constant((0.1, 0.2, 0.3))),
        camera=Camera(
            "PERSPECTIVE", 4, 3, rng.random((2, 3)), np.eye(3, 4), 0.1, float("inf"), Aperture(0.01, 5, 0.2, 1.0, 3.0)
        ),
        transport=Transport(4, 8),
        images=(Image("wood", rng.random((2, 2, 4)).astype(np.float32), "LINEAR"),),
    )


def same(a, b):
    """Equal in type and to the last bit, all the way down."""
    if type(a) is not type(b):
        return False
    if is_dataclass(a):
        return all(same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and np.array_equal(a, b)
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[k], b[k]) for k in a)
    if isinstance(a, tuple):
        return len(a) == len(b) and all(map(same, a, b))
    return a == b


def test_a_scene_comes_back_to_the_last_bit(scene, tmp_path):
    archive.save(scene, tmp_path / "scene.npz")
    assert same(archive.load(tmp_path / "scene.npz"), scene)
    assert [p.name for p in tmp_path.iterdir()] == ["scene.npz"]


def test_foreign_files_are_told_by_name(tmp_path):
    (tmp_path / "text.npz").write_text("not a zip file")
    np.savez(tmp_path / "arrays.npz", a=np.zeros(3))
    np.savez(tmp_path / "old.npz", text=np.array('{"format": "etalon-scene", "version": 0}'))
    np.savez(tmp_path / "class.npz", text=np.array('{"format": "etalon-scene", "version": 1, "scene": ["Popen", {}]}'))
    for name in ("text", "arrays", "old", "class", "missing"):
        with pytest.raises(EtalonError, match=rf"{name}\.npz: .+; .+"):
            archive.load(tmp_path / f"{name}.npz")


def test_an_unwritable_path_is_told(scene, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(EtalonError, match="cannot be written"):
        archive.save(scene, tmp_path / "file" / "scene.npz")
