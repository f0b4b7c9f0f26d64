"""Exact: a script that is handed over ends as it would have by itself; nothing outlives who asked for it."""

import os
import selectors
import signal
import socket
import subprocess
import sys
import time

import pytest

from threedfs.store import fork_server

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="no fork server is started elsewhere")

HEAD = """
import os, time
from threedfs.store.fork_server import ADDRESS, start_server
start_server()
print(os.environ[ADDRESS], flush=True)
time.sleep(600)
"""
START = "from threedfs.store.fork_server import hand_over\nimport os\nhand_over()\n"


def is_served(address):
    with socket.socket(socket.AF_UNIX) as client:
        return client.connect_ex(f"\0{address}") == 0


def wait_until(holds, seconds=60):
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.05)


def children(process):
    with open(f"/proc/{process}/task/{process}/children", encoding="ascii") as file:
        return [int(child) for child in file.read().split()]


def is_alive(process):
    try:
        with open(f"/proc/{process}/stat", encoding="ascii") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):  # the latter if it goes while its file is open
        return False


@pytest.fixture
def head():
    process = subprocess.Popen([sys.executable, "-c", HEAD], stdout=subprocess.PIPE, text=True)
    address = process.stdout.readline().strip()
    wait_until(lambda: is_served(address))
    yield process, address
    process.kill()
    process.wait()


@pytest.fixture
def ask(tmp_path):
    def ask(address, body, **more):
        script = tmp_path / "script.py"
        script.write_text(START + body)
        environment = os.environ | {fork_server.ADDRESS: address} | more
        return subprocess.Popen(
            [sys.executable, str(script)],
            cwd=tmp_path,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    return ask


WHERE = """
import sys
print(os.getppid(), "numba" in sys.modules, os.getcwd(), os.environ["OWN"], __name__)
"""


def test_a_script_runs_in_a_fork_with_its_own_folder_environment_and_streams(head, ask, tmp_path):
    process, address = head
    server = children(process.pid)[0]
    for own in "ab":
        out, err = ask(address, WHERE, OWN=own).communicate(timeout=60)
        assert out.split() == [str(server), "True", str(tmp_path), own, "__main__"]
        assert err == ""


@pytest.mark.parametrize(
    ("body", "status", "told"),
    [
        ("", 0, ""),
        ("raise SystemExit(3)", 3, ""),
        ("import sys; sys.exit('expected more')", 1, "expected more"),
        ("1 / 0", 1, "ZeroDivisionError"),
        ("os.kill(os.getpid(), 9)", 137, ""),
    ],
)
def test_it_ends_as_the_fork_ends(head, ask, body, status, told):
    asking = ask(head[1], body)
    _, err = asking.communicate(timeout=60)
    assert asking.returncode == status
    assert told in err
    assert bool(told) == bool(err)


def test_a_fork_does_what_is_left_for_its_end_but_does_not_take_modules_apart(head, ask):
    body = """
import atexit, builtins
class Late:
    def __del__(self, write=os.write):
        write(1, b"apart")
builtins.late = Late()
atexit.register(print, "kept")
"""
    assert ask(head[1], body).communicate(timeout=60)[0] == "kept\n"


def test_scripts_run_side_by_side(head, ask, tmp_path):
    first = ask(head[1], "import time\nwhile not os.path.exists('go'): time.sleep(0.01)")
    second = ask(head[1], "open('go', 'w').close()")
    assert second.wait(60) == first.wait(60) == 0


def test_the_server_forks_from_one_thread(head):
    server = children(head[0].pid)[0]
    assert len(os.listdir(f"/proc/{server}/task")) == 1


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_fork_dies_with_the_script_that_asked(head, ask, number):
    server = children(head[0].pid)[0]
    asking = ask(head[1], "import time\ntime.sleep(600)")
    wait_until(lambda: children(server))
    (fork,) = children(server)
    asking.send_signal(number)
    _, err = asking.communicate(timeout=60)
    assert asking.returncode == -number
    assert err == ""
    wait_until(lambda: not is_alive(fork), 5)
    again = ask(head[1], "raise SystemExit(5)")
    assert again.wait(60) == 5


def test_all_die_with_the_head(head, ask):
    process, address = head
    server = children(process.pid)[0]
    asking = ask(address, "import time\ntime.sleep(600)")
    wait_until(lambda: children(server))
    (fork,) = children(server)
    process.kill()
    _, err = asking.communicate(timeout=60)
    assert asking.returncode == 1
    assert err == "threedfs: the process that jobs are forked from has ended; run again.\n"
    wait_until(lambda: not is_alive(server) and not is_alive(fork), 5)


@pytest.fixture
def silent():
    """A server that takes orders and answers none."""
    address = f"threedfs-silent-{os.getpid()}"
    with socket.socket(socket.AF_UNIX) as door:
        door.bind(f"\0{address}")
        door.listen()
        yield door, address


def test_a_server_that_ends_before_it_answers_may_have_forked_and_ends_the_script(silent, ask):
    """Exact: at that moment a fork may be at work, which dies with the server; the script must not go on itself."""
    door, address = silent
    asking = ask(address, "print('went on')")
    door.accept()[0].close()
    out, err = asking.communicate(timeout=60)
    assert (asking.returncode, out) == (1, "")
    assert err == "threedfs: the process that jobs are forked from has ended; run again.\n"


def test_an_interrupt_before_the_answer_ends_the_script_in_silence(silent, ask):
    door, address = silent
    asking = ask(address, "print('went on')")
    with door.accept()[0] as asked:
        assert asked.makefile().readline() == "\n"
        asking.send_signal(signal.SIGINT)
        out, err = asking.communicate(timeout=60)
    assert (asking.returncode, out, err) == (-signal.SIGINT, "", "")


def test_who_is_refused_is_interrupted_as_before(silent, ask):
    door, address = silent
    asking = ask(address, "import signal\nprint(signal.getsignal(signal.SIGINT) is signal.default_int_handler)")
    with door.accept()[0] as asked:
        asked.sendall(fork_server._REFUSED.encode())
    assert asking.communicate(timeout=60)[0] == "True\n"


def test_without_a_server_the_script_goes_on_itself(ask):
    asking = ask("threedfs-nobody-listens", "print(os.getppid())")
    assert asking.communicate(timeout=60)[0] == f"{os.getpid()}\n"


def test_another_interpreter_is_not_served(head, ask):
    body = "import sys\nprint('numba' in sys.modules)"
    asking = ask(head[1], body)
    assert asking.communicate(timeout=60)[0] == "True\n"
    changed = START.replace("hand_over()\n", "import sys\nsys.executable = '/other/python'\nhand_over()\n", 1)
    script = f"{changed}{body}"
    done = subprocess.run(
        [sys.executable, "-c", script],
        env=os.environ | {fork_server.ADDRESS: head[1]},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "False\n"


def test_other_users_are_refused(monkeypatch):
    here, there = socket.socketpair()
    assert fork_server._is_own(here)
    monkeypatch.setattr(os, "geteuid", lambda: 12345)
    assert not fork_server._is_own(here)
    assert fork_server._receive(there) is None
    here.close()
    there.close()


def test_streams_of_an_order_that_cannot_be_read_are_closed():
    here, there = socket.socketpair()
    before = len(os.listdir("/proc/self/fd"))
    socket.send_fds(there, [b"\n"], [1, 2])
    there.sendall(b"not json\n")
    assert fork_server._receive(here) is None
    assert len(os.listdir("/proc/self/fd")) == before
    here.close()
    there.close()


@pytest.mark.parametrize("sent", [b"", b"not json\n", b"{}\n", b'{"argv": 1}\n'])
def test_junk_does_no_harm(head, ask, sent):
    with socket.socket(socket.AF_UNIX) as client:
        client.connect(f"\0{head[1]}")
        client.sendall(sent)
        client.shutdown(socket.SHUT_WR)
        assert client.makefile().read() == fork_server._REFUSED
    assert ask(head[1], "raise SystemExit(4)").wait(60) == 4


def test_a_fork_follows_the_settings_of_its_job(head, ask, tmp_path):
    body = """
from pathlib import Path
from threedfs.store.perform import load_stages
import numba
load_stages({}, Path("store"), 3)
print(numba.config.NUMBA_NUM_THREADS, numba.config.CACHE_DIR)
"""
    threads, folder = ask(head[1], body).communicate(timeout=60)[0].split()
    assert threads == "3"
    assert folder.startswith(str(tmp_path / "store/kernels"))


@pytest.mark.parametrize("first", [0, 1])
def test_an_end_and_a_loss_at_once_are_one_end(first):
    """Exact: whichever of a fork's two events comes first, it is reaped once, and nothing else is killed."""
    here, there = socket.socketpair()
    process = os.fork()
    if process == 0:
        os._exit(7)
    ending = os.pidfd_open(process)
    with selectors.DefaultSelector() as waiting:
        fork = fork_server._Fork(process, ending, here)
        for file in (ending, here):
            waiting.register(file, selectors.EVENT_READ, fork)
        there.close()
        wait_until(lambda: len(waiting.select(0)) == 2)
        both = sorted((key for key, _ in waiting.select(0)), key=lambda key: (key.fd == ending) == bool(first))
        for key in both:
            if not key.data.ended:
                fork_server._attend(key.data, key.fd, waiting)
        assert fork.ended
        assert not waiting.get_map()
    with pytest.raises(ChildProcessError):
        os.waitpid(process, 0)
