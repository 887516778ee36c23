# SPDX-License-Identifier: GPL-3.0-or-later
"""The process that a batch forks its comparisons from.

It has loaded Étalon and SciPy, which each comparison would load again otherwise. It has not loaded Blender: that starts threads, which a
fork leaves behind, so that its child waits for them for ever. The other side is lib/batch/forks.py.
"""

from __future__ import annotations

import importlib
import json
import os
import pkgutil
import selectors
import socket
from contextlib import suppress
from pathlib import Path

from .own_process import leave

# A request is shorter.
_REQUEST = 4096
_ROOT = __package__.removesuffix(".addon.host")
# Packages of `lib` that comparisons use, and that import the others.
_PACKAGES = (
    "batch",
    "cluster",
    "comparison",
    "effects",
    "rendering",
    "report",
    "scene",
    "scene_check",
    "settings",
    "surfaces",
    "textures",
    "wavefront",
)
# Comparisons import these only where they need them, which most do.
_OF_SCIPY = ("scipy.ndimage", "scipy.optimize")


def fork_as_asked() -> None:
    """Fork a process for each request on standard input. Returns in each of these; this process ends with the last request."""
    load()
    requests = socket.socket(fileno=os.dup(0))
    with selectors.DefaultSelector() as selector:
        selector.register(requests, selectors.EVENT_READ)
        while True:
            for key, _ in selector.select():
                if key.data is not None:
                    selector.unregister(key.fd)
                    _report_end(key.fd, *key.data)
                elif not _fork(requests, selector):
                    return


def _fork(requests: socket.socket, selector: selectors.BaseSelector) -> bool:
    """Fork a process for the next request. Returns False in it; this one ends where there is no other request."""
    message, descriptors, *_ = socket.recv_fds(requests, _REQUEST, 3)
    if not message:
        leave(0)
    stdin, stderr, status = descriptors
    number = os.fork()
    if number == 0:
        # Here too: whatever this process starts is in its group, however late the server comes to it.
        os.setpgid(0, 0)
        requests.close()
        for key in selector.get_map().values():
            if key.data is not None:
                os.close(key.fd)
                key.data[1].close()
        _become(json.loads(message), stdin, stderr, status)
        return False
    # Before the number is told, so that the group can be ended as soon as it is known.
    with suppress(OSError):
        os.setpgid(number, number)
    told = socket.socket(fileno=status)
    _tell(told, number)
    selector.register(os.pidfd_open(number), selectors.EVENT_READ, (number, told))
    os.close(stdin)
    os.close(stderr)
    return True


def _become(variables: dict[str, str], stdin: int, stderr: int, status: int) -> None:
    """Have this process, which was forked, be the one that was asked for."""
    for descriptor, number in ((stdin, 0), (stderr, 2)):
        os.dup2(descriptor, number)
        os.close(descriptor)
    os.close(status)
    os.environ |= variables


def _report_end(descriptor: int, number: int, status: socket.socket) -> None:
    """Tell the exit code of a process that has ended, and forget the process."""
    os.close(descriptor)
    _, code = os.waitpid(number, 0)
    _tell(status, os.waitstatus_to_exitcode(code))
    status.close()


def _tell(status: socket.socket, number: int) -> None:
    # Whoever asked may be gone.
    with suppress(OSError):
        status.send(str(number).encode())


def load() -> None:
    """Load what comparisons need, except for Blender and what imports it."""
    from ...lib.pages.page import compile_templates
    from ...lib.report import page

    for name in _OF_SCIPY:
        importlib.import_module(name)
    for name in _PACKAGES:
        package = importlib.import_module(f"{_ROOT}.lib.{name}")
        for found in pkgutil.iter_modules(package.__path__, f"{package.__name__}."):
            importlib.import_module(found.name)
    compile_templates(Path(page.__file__).parent)
