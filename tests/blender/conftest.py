# SPDX-License-Identifier: GPL-3.0-or-later
"""The real Blender program in a Debian 13 folder.

The extension, built from this tree, is installed.
"""

import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DEFAULT = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "etalon-debian13"
MARK = "ETALON "


class Debian:
    """Commands in the folder at `root`.

    `home` is a fresh place for settings and files, as seen from inside.
    """

    def __init__(self, root, home):
        self.root = root
        self.home = home
        self.outside = root / home.relative_to("/")
        self.environment = {
            "PATH": "/usr/bin:/bin:/usr/sbin:/sbin",
            "HOME": str(home),
            "TMPDIR": str(home),
            "BLENDER_USER_RESOURCES": str(home / "blender"),
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "LANG": "C.UTF-8",
        }

    def command(self, *words, **environment):
        """The command line that runs `words` inside."""
        variables = [f"{k}={v}" for k, v in {**self.environment, **environment}.items()]
        return ["chroot", str(self.root), "env", "-i", f"--chdir={self.home}", *variables, *map(str, words)]

    def run(self, *words, timeout=300, **environment):
        """Run a command inside to its end; output and errors come as one text."""
        return subprocess.run(
            self.command(*words, **environment),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=timeout,
            stdin=subprocess.DEVNULL,
        )


@pytest.fixture(scope="session")
def debian():
    """The folder, with a home of its own that goes when the tests end."""
    root = Path(os.environ.get("ETALON_DEBIAN", DEFAULT))
    if not (root / "usr/bin/blender").exists():
        pytest.fail(f"{root}: no Blender there; `.ci/debian {root}` makes it (root, network, two minutes)")
    home = Path("/", Path(tempfile.mkdtemp(prefix="etalon-", dir=root / "tmp")).relative_to(root))
    inside = Debian(root, home)
    yield inside
    subprocess.run(["rm", "-rf", str(inside.outside)], check=True)


@pytest.fixture(scope="session")
def built(tmp_path_factory, worker_id):
    """The extension's archive, which the first worker builds while the others wait: they share the folder for it."""
    import fcntl  # not on Windows, which collects this file too

    folder = tmp_path_factory.getbasetemp()
    if worker_id != "master":
        folder = folder.parent
    with (folder / "extension.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # until the file is closed
        out = folder / "extension"
        if not out.is_dir():
            words = ["build_extension.py", "--platform=linux-x64", "--python=3.13", f"--out={out}"]
            subprocess.run([sys.executable, *words], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    (archive,) = out.glob("etalon-*.zip")
    return archive


@pytest.fixture(scope="session")
def extension(debian, built):
    """The extension, built, validated and installed; its module's name in that Blender."""
    shutil.copy(built, debian.outside)
    archive = debian.home / built.name
    for words in (("validate", archive), ("install-file", "--repo=user_default", "--enable", archive)):
        done = debian.run("blender", "--command", "extension", *words)
        assert done.returncode == 0, done.stdout
    return "bl_ext.user_default.etalon"


@pytest.fixture
def pictures(request, tmp_path):
    """The folder for a test's pictures of the screen.

    It is the test's own in the folder that ETALON_PICTURES names, where pictures are kept to look at.
    """
    kept = os.environ.get("ETALON_PICTURES")
    folder = Path(kept).resolve() / request.node.name if kept else tmp_path
    folder.mkdir(parents=True, exist_ok=True)
    return folder


class Window:
    """Blender in a window on an X server of its own.

    window.py drives it from inside and xdotool from outside.
    """

    def __init__(self, debian, display, blend):
        self.debian = debian
        self.display = display
        driver = debian.outside / "window.py"
        driver.write_text((Path(__file__).parent / "window.py").read_text())
        words = ["blender", "--window-geometry", "0", "0", "1280", "900", blend, "--python", debian.home / driver.name]
        self.process = subprocess.Popen(
            debian.command(*words, DISPLAY=display),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        self._text = b""
        self._seen = []

    def wait_for(self, *events, seconds):
        """The next report of one of those kinds from window.py.

        It fails with what Blender printed if none comes.
        """
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0:
            line, separator, rest = self._text.partition(b"\n")
            if separator:
                self._text = rest
                self._seen.append(line.decode(errors="replace"))
                last = self._seen[-1]
                if last.startswith(MARK) and (report := json.loads(last[len(MARK) :]))["event"] in events:
                    return report
            elif select.select([self.process.stdout], [], [], left)[0]:
                more = os.read(self.process.stdout.fileno(), 65536)
                if not more:
                    break
                self._text += more
        state = "still runs" if self.process.poll() is None else f"ended with code {self.process.returncode}"
        raise AssertionError(
            f"none of {events} within {seconds} s; Blender {state} and said:\n" + "\n".join(self._seen[-40:])
        )

    def ask(self, text, seconds=30):
        """Run statements inside; the value of the last one, if it is an expression."""
        place = self.debian.outside / "question"
        place.write_text(text)
        place.replace(place.with_suffix(".py"))
        answer = self.wait_for("answer", seconds=seconds)
        assert "error" not in answer, f"{answer['error']} of {text}"
        return answer["value"]

    def hand(self, *words):
        """Mouse and keyboard, in xdotool's words."""
        done = self.debian.run("xdotool", *words, DISPLAY=self.display)
        assert done.returncode == 0, done.stdout

    def screenshot(self, path):
        """Save what the screen shows."""
        inside = self.debian.home / path.name
        done = self.debian.run("import", "-window", "root", inside, DISPLAY=self.display)
        assert done.returncode == 0, done.stdout
        path.write_bytes((self.debian.outside / path.name).read_bytes())

    def close(self):
        """End Blender; fails where it has printed an error of Python."""
        self.process.kill()
        self.process.wait()
        self._seen += self.process.stdout.read().decode(errors="replace").split("\n")
        self.process.stdout.close()
        assert not [line for line in self._seen if "Traceback" in line], "\n".join(self._seen)


@pytest.fixture
def display(debian):
    """An X server without a screen; its name."""
    read, write = os.pipe()
    words = ["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x900x24", "-nolisten", "tcp"]
    server = subprocess.Popen(debian.command(*words), pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        assert select.select([read], [], [], 60)[0], "Xvfb did not start"
        yield f":{os.read(read, 64).decode().strip()}"
    finally:
        os.close(read)
        server.terminate()
        server.wait()


@pytest.fixture
def window(debian, extension, display):
    """Blender with a reference scene and the panel open; closed when the test ends."""
    blend = debian.home / "window.blend"
    done = debian.run("blender", "--background", "--command", "etalon", "scenes", "--save", "lambert_analytic", blend)
    assert done.returncode == 0, done.stdout
    opened = Window(debian, display, blend)
    yield opened
    opened.close()
