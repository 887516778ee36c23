# SPDX-License-Identifier: GPL-3.0-or-later
"""One key for all that the result of a comparison depends on.

That is the command line, Étalon, Blender and its build, the file and all that it refers to.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path

from ..version import VERSION
from .journal import Journal
from .plan import Unit


class Hashes:
    """Contents of files as hashes.

    The journal keeps them for as long as a file's time and size stay the same.
    """

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._scenes: dict[str, str] = {}

    def of_file(self, path: Path) -> str:
        """The hash of a file's content; 'missing' where it cannot be read."""
        try:
            status = path.stat()
            stamp = f"{status.st_mtime_ns} {status.st_size}"
            known = self._journal.read_digest(str(path), stamp)
            if known is None:
                with path.open("rb") as file:
                    known = hashlib.file_digest(file, "sha256").hexdigest()
                self._journal.write_digest(str(path), stamp, known)
        except OSError:
            return "missing"
        return known

    def of_scene(self, target: str) -> str | None:
        """The hash of a .blend and of the files that it refers to.

        None where these are not known yet, '' for a reference scene.
        """
        if not target.endswith(".blend"):
            return ""
        if target not in self._scenes:
            own = self.of_file(Path(target))
            files = self._journal.read_files(own)
            if files is None:
                return None
            parts = [own, *(f"{path} {self.of_file(Path(path))}" for path in files)]
            self._scenes[target] = hashlib.sha256("\n".join(parts).encode()).hexdigest()
        return self._scenes[target]

    def of_files(self, target: str) -> dict[str, str]:
        """A .blend and the files that it refers to, with their hashes.

        Files that are missing are left out. Empty for a reference scene.
        """
        if not target.endswith(".blend"):
            return {}
        paths = [target, *(self._journal.read_files(self.of_file(Path(target))) or ())]
        found = {path: self.of_file(Path(path)) for path in paths}
        return {path: digest for path, digest in found.items() if digest != "missing"}

    def learn(self, target: str, files: Sequence[str]) -> None:
        """Keep which files a scene refers to, by the content of its .blend."""
        if target.endswith(".blend"):
            self._journal.write_files(self.of_file(Path(target)), files)


def make_key(unit: Unit, options: Sequence[str], blender: str, scene: str) -> str:
    """Make the key of a unit.

    `blender` names the release and the build that it runs in, `scene` is the hash of its files.
    """
    what = [VERSION, blender, scene, *unit.arguments(), *options]
    return hashlib.sha256(json.dumps(what).encode()).hexdigest()[:16]
