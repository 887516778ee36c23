# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw files of the corpus for comparisons: writes a plan for `etalon batch`.

Run `python tests/corpus/draw.py FOLDER 30`, then `etalon batch FOLDER/drawn.toml`, where FOLDER is what `fetch.py` filled.
The draw goes by the CRC-32 of repository and path, so it is the same for everybody, and nobody chose it.
"""

from __future__ import annotations

import argparse
import json
import zlib
from pathlib import Path

from fetch import read_list

WIDTH, HEIGHT = 480, 270
SECONDS = 60


def draw(count: int) -> list[str]:
    """The places of `count` scenes below the folder of the corpus."""
    scenes = {str(file.place) for file in read_list() if file.place.suffix == ".blend"}
    return sorted(scenes, key=lambda place: (zlib.crc32(place.encode()), place))[:count]


def write_plan(scenes: list[str], place: Path) -> None:
    """Write the plan of the comparisons of `scenes` into the file `place`."""
    lines = ['out = "drawn"', f"scenes = {json.dumps(scenes, indent=4)}", "", "[options]", f'time = "{SECONDS}s"']
    sizes = {"resolution_x": WIDTH, "resolution_y": HEIGHT, "resolution_percentage": 100}
    for name, value in sizes.items():
        lines += ["", "[[vary]]", f"path = 'scene.render.{name}'", f"values = [{value}]"]
    place.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    """Write FOLDER/drawn.toml."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="the folder of the corpus")
    parser.add_argument("count", type=int, nargs="?", default=30, help="how many files")
    arguments = parser.parse_args()
    write_plan(draw(arguments.count), arguments.folder / "drawn.toml")


if __name__ == "__main__":
    main()
