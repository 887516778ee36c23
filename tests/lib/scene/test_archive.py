# SPDX-License-Identifier: GPL-3.0-or-later
"""What is saved comes back bit for bit; what is damaged, foreign or missing is one line."""

import json
import pickle
import zipfile
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.scene import expressions as ex
from etalon.lib.scene.archive import fingerprint, load, save
from etalon.lib.scene.materials import Diffuse, Material, WeightedClosure
from etalon.lib.scene.motion import Motion


def same(a, b):
    """Whether two values agree in type, and in every bit of every array."""
    if type(a) is not type(b):
        return False
    if is_dataclass(a):
        return all(same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if isinstance(a, tuple):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[k], b[k]) for k in a)
    return a == b


@pytest.fixture
def path(tmp_path):
    return tmp_path / "scene.npz"


def test_a_round_trip_changes_nothing(scene, path):
    save(scene, path)
    assert same(load(path), scene)
    assert [p.name for p in path.parent.iterdir()] == ["scene.npz"]


def test_motion_comes_back(scene, path):
    """Keys of objects by number, beside the shutter's curve."""
    keys = np.array([scene.mesh.objects[0].world_from_object] * 2, float)
    keys[1, 0, 3] += 1.0
    moving = replace(scene, motion=Motion(objects={0: keys}, shutter=np.array([0.0, 1.0])))
    save(moving, path)
    assert same(load(path), moving)
    assert fingerprint(moving) != fingerprint(scene)
    damaged = replace(moving, motion=Motion(objects={9: keys}))
    save(damaged, path)
    with pytest.raises(EtalonError, match="moves object 9, which is not there"):
        load(path)


def test_what_is_shared_stays_shared(scene, path):
    """Fifty doublings: a tree with 2^50 paths, a file with fifty nodes."""
    node = ex.Coordinates("NORMAL")
    for _ in range(50):
        node = ex.Mix(ex.ONE, node, node)
    save(replace(scene, materials=(Material("deep", (WeightedClosure(Diffuse(node)),)), scene.materials[1])), path)
    color = load(path).materials[0].lobes[0].closure.color
    assert color.a is color.b


def test_saving_again_replaces_and_a_failure_does_not(scene, path, monkeypatch):
    save(scene, path)
    save(replace(scene, name="again"), path)
    assert load(path).name == "again"

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(EtalonError, match=r"cannot be written \(No space left on device\)"):
        save(scene, path)
    assert load(path).name == "again"
    assert [p.name for p in path.parent.iterdir()] == ["scene.npz"]


def test_a_missing_file_is_named_and_a_missing_folder_is_made(scene, tmp_path):
    with pytest.raises(EtalonError, match=r"nowhere\.npz: cannot be read \(No such file"):
        load(tmp_path / "nowhere.npz")
    save(scene, tmp_path / "nowhere" / "scene.npz")
    assert load(tmp_path / "nowhere" / "scene.npz").name == scene.name


def document(path):
    with np.load(path, allow_pickle=False) as file:
        return json.loads(file["scene"].tobytes()), {name: file[name] for name in file.files}


def rewrite(path, text, arrays):
    arrays["scene"] = np.frombuffer(json.dumps(text).encode(), np.uint8)
    np.savez(path, **arrays)


@pytest.mark.parametrize("part", np.linspace(0.0, 0.98, 12))
def test_a_file_cut_short_is_damaged(scene, path, part):
    save(scene, path)
    data = path.read_bytes()
    path.write_bytes(data[: int(part * len(data))])
    with pytest.raises(EtalonError, match="is damaged or no scene"):
        load(path)


@pytest.mark.parametrize("turn", range(25))
def test_a_flipped_byte_is_found_or_harmless(scene, path, rng, turn):
    save(scene, path)
    data = bytearray(path.read_bytes())
    data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))
    path.write_bytes(data)
    message = ""
    try:
        harmless = same(load(path), scene)
    except EtalonError as error:
        harmless, message = False, str(error)
    assert harmless or (str(path) in message and "\n" not in message)


def test_another_version_says_so(scene, path):
    save(scene, path)
    text, arrays = document(path)
    text["version"] = 99
    rewrite(path, text, arrays)
    with pytest.raises(EtalonError, match="is of version 99, not 4; export the scene again"):
        load(path)


HOSTILE = {
    "a class that is none of ours": lambda text: text["nodes"][0].update({"class": "Path"}),
    "a field too many": lambda text: text["nodes"][0]["fields"].update({"extra": 1}),
    "a node that refers ahead": lambda text: text["nodes"][0].update({"fields": {"vector": {"node": 10**6}}}),
    "an array that is not there": lambda text: text.update({"root": {"array": 77}}),
    "a root that is no scene": lambda text: text.update({"root": {"node": 0}}),
    "a number for the raster": lambda text: text["nodes"][-1]["fields"].update({"camera": 3.0}),
    "an array of objects": lambda text: text.update({"root": {"values": [0], "dtype": "|O", "shape": [10**12]}}),
    "no nodes": lambda text: text.pop("nodes"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_file_made_to_harm_is_damaged(scene, path, name):
    save(scene, path)
    text, arrays = document(path)
    HOSTILE[name](text)
    rewrite(path, text, arrays)
    with pytest.raises(EtalonError, match="is damaged or no scene"):
        load(path)


def test_pickles_are_never_opened(scene, path):
    class Boom:
        def __reduce__(self):
            return (pytest.fail, ("a pickle ran",))

    save(scene, path)
    text, arrays = document(path)
    arrays["array_0"] = np.array([Boom()], dtype=object)
    rewrite(path, text, arrays)
    with pytest.raises(EtalonError, match="is damaged or no scene"):
        load(path)
    path.write_bytes(pickle.dumps(Boom()))
    with pytest.raises(EtalonError, match="is damaged or no scene"):
        load(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("scene.npy", pickle.dumps(Boom()))
    with pytest.raises(EtalonError, match="is damaged or no scene"):
        load(path)


def test_a_scene_that_breaks_its_rules_is_not_loaded(scene, path):
    save(replace(scene, camera=replace(scene.camera, width=0)), path)
    with pytest.raises(EtalonError, match="its image has no pixels"):
        load(path)
