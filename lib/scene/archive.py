# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene in one .npz file: its frozen dataclasses as JSON, with large arrays beside it.

Nothing in the file is ever executed.
"""

from __future__ import annotations

import hashlib
import json
import struct
import zipfile
import zlib
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import EtalonError
from ..files.atomic import replace_file
from . import (
    camera,
    converters,
    expressions,
    findings,
    images,
    layers,
    lights,
    links,
    materials,
    mesh,
    motion,
    procedural,
    scene,
    sky,
    volumes,
    world,
)
from .checks import validate
from .scene import Scene

_VERSION = 4
_SMALL = 64
_CLASSES = {
    kind.__name__: kind
    for module in (
        camera,
        converters,
        expressions,
        findings,
        images,
        layers,
        lights,
        links,
        materials,
        mesh,
        motion,
        procedural,
        scene,
        sky,
        volumes,
        world,
    )
    for kind in vars(module).values()
    if isinstance(kind, type) and is_dataclass(kind)
}
_DAMAGE = (ValueError, TypeError, KeyError, IndexError, AttributeError, EOFError, RecursionError, MemoryError)
_DAMAGE += (zipfile.BadZipFile, zlib.error, struct.error, NotImplementedError, OverflowError)


def save(scene: Scene, path: Path | str) -> None:
    """Write `scene` to `path`, beside it first, so that a failure leaves what was there.

    Raises EtalonError when the folder cannot be written.
    """
    path = Path(path)
    encoder = _Encoder()
    root = encoder.encode(scene)
    text = json.dumps({"version": _VERSION, "root": root, "nodes": encoder.nodes})
    arrays = {f"array_{i}": array for i, array in enumerate(encoder.arrays)}
    arrays["scene"] = np.frombuffer(text.encode(), np.uint8)
    with replace_file(path) as beside, beside.open("wb") as file:
        np.savez(file, **arrays)  # pyright: ignore[reportArgumentType]: the stub takes every name for allow_pickle


def load(path: Path | str) -> Scene:
    """Read and validate what `save` wrote.

    Raises EtalonError when the file is missing, damaged or of another version.
    """
    path = Path(path)
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            document = json.loads(file["scene"].tobytes())
            if document["version"] != _VERSION:
                raise EtalonError(
                    f"{path}: is of version {document['version']}, not {_VERSION}; export the scene again"
                )
            result = _Decoder(document["nodes"], file).decode(document["root"])
        if not isinstance(result, Scene):
            raise TypeError(type(result).__name__)
        validate(result)
    except OSError as error:
        raise EtalonError(f"{path}: cannot be read ({error.strerror or error}); check the path") from error
    except _DAMAGE as error:
        raise EtalonError(f"{path}: is damaged or no scene of Étalon's ({error}); export the scene again") from error
    return result


def fingerprint(scene: Scene) -> str:
    """A hash of all that an image of `scene` depends on.

    Its name, its findings and the release that exported it do not count.
    """
    encoder = _Encoder()
    root = encoder.encode(replace(scene, name="", blender=None, findings=()))
    digest = hashlib.sha256(json.dumps([root, encoder.nodes]).encode())
    for array in encoder.arrays:
        digest.update(f"{array.dtype.str}{array.shape}".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


class _Encoder:
    """Turns values into JSON.

    Each dataclass instance becomes one node, however often the scene refers to it.
    """

    def __init__(self) -> None:
        self.nodes: list[dict[str, Any]] = []
        self.arrays: list[np.ndarray] = []
        self._index: dict[int, int] = {}

    def encode(self, value: Any) -> Any:
        if is_dataclass(value):
            if id(value) not in self._index:
                node = {f.name: self.encode(getattr(value, f.name)) for f in fields(value)}
                self._index[id(value)] = len(self.nodes)
                self.nodes.append({"class": type(value).__name__, "fields": node})
            return {"node": self._index[id(value)]}
        if isinstance(value, np.ndarray):
            if value.size <= _SMALL:
                return {"values": value.ravel().tolist(), "dtype": value.dtype.str, "shape": value.shape}
            self.arrays.append(value)
            return {"array": len(self.arrays) - 1}
        if isinstance(value, tuple):
            return {"tuple": [self.encode(one) for one in value]}
        if isinstance(value, dict) and any(isinstance(key, int) for key in value):
            return {"numbered": [[key, self.encode(one)] for key, one in value.items()]}
        if isinstance(value, dict):
            return {"dict": {name: self.encode(one) for name, one in value.items()}}
        return value.item() if isinstance(value, np.generic) else value


class _Decoder:
    """Turns JSON back into values.

    Nodes refer only to earlier nodes, so there are no cycles to follow.
    """

    def __init__(self, nodes: list[dict[str, Any]], file: np.lib.npyio.NpzFile) -> None:
        self._file = file
        self._nodes: list[Any] = []
        for node in nodes:
            values = {name: self.decode(value) for name, value in node["fields"].items()}
            self._nodes.append(_CLASSES[node["class"]](**values))

    def decode(self, value: Any) -> Any:
        if not isinstance(value, dict):
            return value
        if "node" in value:
            return self._nodes[value["node"]]
        if "array" in value:
            return self._file[f"array_{value['array']}"]
        if "values" in value:
            return np.array(value["values"], np.dtype(value["dtype"])).reshape(value["shape"])
        if "tuple" in value:
            return tuple(self.decode(one) for one in value["tuple"])
        if "numbered" in value:
            return {int(key): self.decode(one) for key, one in value["numbered"]}
        return {name: self.decode(one) for name, one in value["dict"].items()}
