# SPDX-License-Identifier: GPL-3.0-or-later
"""Fetch the corpus of real .blend files.

Run `python tests/corpus/fetch.py FOLDER`, then `etalon plan FOLDER`. `files.csv` has the repository, commit, path and
SHA-256 of each file: .blend files, and the textures and libraries that they name. The files are other people's work and
no part of this project. A file whose hash differs is not kept; one that exists is left alone.
"""

from __future__ import annotations

import argparse
import csv
import hashlib
import urllib.error
import urllib.parse
import urllib.request
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

LISTED = Path(__file__).with_name("files.csv")
RAW = "https://raw.githubusercontent.com"
# No listed file is larger; a longer answer is not the file.
MOST_BYTES = 32_000_000
PATIENCE = 60.0


@dataclass(frozen=True)
class Listed:
    """One row of files.csv: a file at a commit of a public repository."""

    repository: str
    commit: str
    path: str
    sha256: str

    @property
    def url(self) -> str:
        """Where GitHub serves the file."""
        return f"{RAW}/{self.repository}/{self.commit}/{urllib.parse.quote(self.path)}"

    @property
    def place(self) -> PurePosixPath:
        """Where the file lies below the folder.

        It lies as in its repository, so that a scene finds its textures.
        """
        return PurePosixPath(self.repository.replace("/", "+")) / self.path


def read_list(listed: Path = LISTED) -> list[Listed]:
    """All rows of files.csv, in order."""
    with listed.open(encoding="utf-8", newline="") as text:
        return [Listed(**row) for row in csv.DictReader(text)]


def fetch(file: Listed, folder: Path) -> str | None:
    """Place `file` below `folder` if it has the listed hash; otherwise return what is wrong."""
    place = folder / file.place
    if place.is_file():
        return None
    try:
        with urllib.request.urlopen(file.url, timeout=PATIENCE) as answer:
            data = answer.read(MOST_BYTES + 1)
    except (urllib.error.URLError, TimeoutError) as error:
        return str(error)
    if hashlib.sha256(data).hexdigest() != file.sha256:
        return "other content than listed; not kept"
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_bytes(data)
    return None


def main() -> int:
    """Fetch every listed file; 1 if any could not be fetched."""
    parser = argparse.ArgumentParser(description="Fetch the corpus of real .blend files.")
    parser.add_argument("folder", type=Path, help="where to place them; not in the repository")
    folder, files = parser.parse_args().folder, read_list()
    wrong = 0
    for file in files:
        error = fetch(file, folder)
        if error is not None:
            wrong += 1
            print(f"{file.url}: {error}")
    print(f"{len(files) - wrong} of {len(files)} files are in {folder}")
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
