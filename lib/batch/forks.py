# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that are forked from one that has loaded Étalon and SciPy, but not Blender.

A request is one message on a socket: the variables of the new process as JSON, with three descriptors. Two are its standard input and its
standard error. On the third, the server (addon/host/fork_server.py) tells the number of the process, and later its exit code.
"""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from .process import FORKS, LEASH, find_blender, start

# A message with a number has fewer bytes.
_NUMBER = 32


def can_fork() -> bool:
    """Whether this system and this Python can run a fork server.

    Linux can, from kernel 5.3 on. The Blender program cannot: its Python begins with Blender loaded.
    """
    if sys.platform != "linux" or find_blender() is not None:
        return False
    try:
        os.close(os.pidfd_open(os.getpid()))
    except OSError:
        return False
    return True


class ForkedProcess:
    """A process that a server has forked, with what a batch uses of a subprocess.Popen.

    It leads a process group of its own. One thread at a time may ask about its end.
    """

    def __init__(self, stdin: int, stderr: int, status: socket.socket) -> None:
        """`stdin` and `stderr` are this side's descriptors, `status` is where the server tells of the process.

        Raises ConnectionError where the server is gone.
        """
        self.stdin = os.fdopen(stdin, "w", encoding="utf-8")
        self.stderr = os.fdopen(stderr, encoding="utf-8", errors="replace")
        self.returncode: int | None = None
        self._status = status
        number = status.recv(_NUMBER)
        if not number:
            for file in (self.stdin, self.stderr, status):
                file.close()
            raise ConnectionError("the fork server has ended")
        self.pid = int(number)

    def poll(self) -> int | None:
        """The exit code, or None while it runs."""
        try:
            return self.wait(0.0)
        except subprocess.TimeoutExpired:
            return None

    def wait(self, timeout: float | None = None) -> int:
        """Wait for its end; returns the exit code, or minus the number of the signal that ended it.

        Where the server is gone, nobody knows the code, and it is that of SIGKILL. Raises subprocess.TimeoutExpired.
        """
        if self.returncode is None:
            self._status.settimeout(timeout)
            try:
                code = self._status.recv(_NUMBER)
            except (TimeoutError, BlockingIOError):
                raise subprocess.TimeoutExpired("fork", timeout or 0.0) from None
            self.returncode = int(code or -signal.SIGKILL)
            self._status.close()
        return self.returncode

    def kill(self) -> None:
        """End it at once."""
        os.kill(self.pid, signal.SIGKILL)


class ForkServer:
    """A process that has loaded Étalon, and forks others that compare.

    It ends when it is closed, and with this process.
    """

    def __init__(self, command: list[str]) -> None:
        """Start `command`, an `etalon compare`; it loads while this process goes on. Raises OSError."""
        self._requests, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        nowhere: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        with theirs:
            self._process = start(command, variables={LEASH: FORKS}, stdin=theirs, **nowhere)

    def fork(self, variables: Mapping[str, str]) -> ForkedProcess:
        """A new process with these variables in its environment.

        Raises ConnectionError where the server is gone.
        """
        status, their_status = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        (their_stdin, stdin), (stderr, their_stderr) = os.pipe(), os.pipe()
        message = json.dumps(dict(variables)).encode()
        # That the server is gone is seen as it tells no number.
        with suppress(OSError):
            socket.send_fds(self._requests, [message], [their_stdin, their_stderr, their_status.fileno()])
        for descriptor in (their_stdin, their_stderr, their_status.detach()):
            os.close(descriptor)
        return ForkedProcess(stdin, stderr, status)

    def close(self) -> None:
        """End it. The processes that it has forked go on."""
        self._requests.close()
        self._process.wait()
