"""Scripts of jobs run in forks of one process that has imported the libraries, which takes longer than many jobs work.

A script asks for it by `hand_over`. Where no server is, or it cannot serve, as on a cluster, the script goes on itself.
Needs Linux: elsewhere none is started.
"""

from __future__ import annotations

import atexit
import contextlib
import importlib
import json
import os
import runpy
import secrets
import selectors
import signal
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NoReturn

from threedfs.store.workers import FORKED, ONE_THREAD, die_with_parent

ADDRESS = "THREEDFS_FORK_SERVER"
"""The variable of the environment that tells scripts where the server listens; set but empty, none is started."""

_LIBRARIES = (
    "scipy.ndimage",
    "scipy.optimize",
    "scipy.sparse.linalg",
    "scipy.spatial",
    "zarr",
    "cv2",
    "pycolmap",
    "trimesh",
    "trimesh.ray.ray_pyembree",
    "skimage.measure",
    "sklearn.mixture",
    "maxflow",
    "av",
    "yaml",
    "snakemake.iocontainers",
    "snakemake.logging",
)
_REFUSED = "refused\n"
_PATIENCE = 5.0
"""Seconds for a script to say what it wants; it is a process of the same user on the same machine."""


@dataclass(frozen=True)
class Order:
    """A script to be run.

    Attributes
    ----------
    argv : list of str
        The script and its arguments.
    folder : str
    environment : dict of str to str
    python : str
        The interpreter that it was started with.
    """

    argv: list[str]
    folder: str
    environment: dict[str, str]
    python: str


def start_server() -> None:
    """Start the server as a child of this process, which it does not outlive; jobs find it by their environment."""
    if sys.platform != "linux" or ADDRESS in os.environ:
        return
    address = f"threedfs-{secrets.token_hex(16)}"
    subprocess.Popen(
        [sys.executable, "-m", "threedfs.store.fork_server", address, str(os.getpid())],
        stdin=subprocess.DEVNULL,
        env=os.environ | ONE_THREAD,
    )
    os.environ[ADDRESS] = address


def hand_over() -> None:
    """Have the server run this process's script, and exit as that does; return if there is no server, or it refuses.

    The script dies with this process, and this process waits for it.
    """
    address = os.environ.pop(ADDRESS, "")
    if not address:
        return
    with socket.socket(socket.AF_UNIX) as server:
        try:
            server.connect(f"\0{address}")
        except OSError:  # it is not ready yet, or gone
            return
        if not _is_own(server):
            return
        interrupted = signal.signal(signal.SIGINT, signal.SIG_DFL)  # nothing is left to tidy up here
        answers = _ask(server, Order(sys.argv, os.getcwd(), dict(os.environ), sys.executable))
        if next(answers, "") == _REFUSED:
            signal.signal(signal.SIGINT, interrupted)
            return
        status = next(answers, "")
    if not status:  # the fork, if there was one, has died with the server
        sys.exit("threedfs: the process that jobs are forked from has ended; run again.")
    code = int(status)
    sys.exit(code if code >= 0 else 128 - code)


def _ask(server: socket.socket, order: Order) -> Iterator[str]:
    """Yield the lines that the server answers, up to its end."""
    with contextlib.suppress(OSError):  # it may refuse before it has heard all
        socket.send_fds(server, [b"\n"], [1, 2])
        server.sendall(json.dumps(vars(order)).encode() + b"\n")
    with contextlib.suppress(OSError):
        yield from server.makefile()


@dataclass(eq=False)
class _Fork:
    """A script at work: its process, the descriptor that can be read when that has ended, and who asked for it."""

    process: int
    ending: int
    asking: socket.socket
    ended: bool = False


def serve(address: str) -> Order:
    """Fork for every script that is handed over, and tell each how its fork has ended.

    Returns
    -------
    Order
        In a fork: what to run. The server itself ends with its parent, and does not return.
    """
    with socket.socket(socket.AF_UNIX) as door, selectors.DefaultSelector() as waiting:
        door.bind(f"\0{address}")
        door.listen()
        waiting.register(door, selectors.EVENT_READ)
        while True:
            for key, _ in waiting.select():
                if key.fileobj is door:
                    order = _admit(door.accept()[0], waiting)
                    if order is not None:
                        return order
                elif not key.data.ended:  # its other event may have come first
                    _attend(key.data, key.fd, waiting)


def _admit(asking: socket.socket, waiting: selectors.BaseSelector) -> Order | None:
    """Fork for a script, if it can be served; return what to run in the fork, and None in the server."""
    received = _receive(asking)
    if received is None:
        _tell(asking, _REFUSED)
        asking.close()
        return None
    order, streams = received
    process = os.fork()
    if process == 0:
        for other in {key.data for key in waiting.get_map().values() if key.data is not None}:
            other.asking.close()
            os.close(other.ending)
        asking.close()
        _take_over(order, streams)
        return order
    for stream in streams:
        os.close(stream)
    fork = _Fork(process, os.pidfd_open(process), asking)
    waiting.register(fork.ending, selectors.EVENT_READ, fork)
    waiting.register(asking, selectors.EVENT_READ, fork)
    _tell(asking, "forked\n")
    return None


def _attend(fork: _Fork, descriptor: int, waiting: selectors.BaseSelector) -> None:
    """Kill a fork that nobody waits for any more; tell of one that has ended."""
    if descriptor != fork.ending:
        waiting.unregister(fork.asking)
        signal.pidfd_send_signal(fork.ending, signal.SIGKILL)
        return
    fork.ended = True
    _tell(fork.asking, f"{os.waitstatus_to_exitcode(os.waitpid(fork.process, 0)[1])}\n")
    with contextlib.suppress(KeyError):  # who asked was gone before
        waiting.unregister(fork.asking)
    waiting.unregister(fork.ending)
    fork.asking.close()
    os.close(fork.ending)


def _receive(asking: socket.socket) -> tuple[Order, list[int]] | None:
    """Return what a script asks for and the streams that it writes to, or None if it cannot be served."""
    if not _is_own(asking):
        return None
    asking.settimeout(_PATIENCE)
    streams: list[int] = []
    try:
        streams = socket.recv_fds(asking, 1, 2)[1]
        order = Order(**json.loads(asking.makefile().readline()))
        if len(streams) == 2 and order.python == sys.executable:
            return order, streams
    except (OSError, ValueError, TypeError):
        pass
    for stream in streams:
        os.close(stream)
    return None


def _take_over(order: Order, streams: list[int]) -> None:
    """Make this fork what the script's own process was."""
    os.setsid()  # Ctrl-C reaches the process that asked, with which this one dies
    die_with_parent()
    for number, stream in zip((1, 2), streams, strict=True):
        os.dup2(stream, number)
        os.close(stream)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
    os.chdir(order.folder)
    os.environ.clear()
    os.environ.update(order.environment | {FORKED: "1"})
    sys.argv[:] = order.argv


def _is_own(other: socket.socket) -> bool:
    """Say whether the process at the other end is this user's."""
    size = struct.calcsize("3i")
    _, user, _ = struct.unpack("3i", other.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, size))
    return user == os.geteuid()


def _tell(asking: socket.socket, line: str) -> None:
    with contextlib.suppress(OSError):  # it may be gone
        asking.sendall(line.encode())


def _import_libraries() -> None:
    for name in _LIBRARIES:
        with contextlib.suppress(ImportError):  # jobs that need it will say so
            importlib.import_module(name)
    from numba.core.registry import cpu_target

    cpu_target.typing_context.refresh()  # takes longer than the import, and is done when a kernel is loaded
    cpu_target.target_context.refresh()


def main(address: str, parent: str) -> None:
    """Serve until the parent ends; in a fork, run the script."""
    die_with_parent()
    if os.getppid() != int(parent):
        return
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # the parent decides
    _import_libraries()
    order = serve(address)
    _run(order.argv[0])


def _run(script: str) -> NoReturn:
    """Run a script and end as it does, but leave the libraries: to take them apart takes longer than many jobs work."""
    sys.path[0] = os.path.dirname(script)
    status = 0
    try:
        runpy.run_path(script, run_name="__main__")
    except SystemExit as end:
        if not isinstance(end.code, int | None):  # a sentence
            raise
        status = end.code or 0
    atexit._run_exitfuncs()  # what the script's modules have asked for, as that a folder is removed
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


if __name__ == "__main__":
    main(*sys.argv[1:])
