"""Child processes that run a script and are interrupted as by Ctrl-C."""

import contextlib
import signal
import subprocess
import sys
import textwrap
import threading
from collections.abc import Iterator

HANG = 300.0
"""Seconds after which a child counts as hung and is killed; no child needs a tenth of them."""

# The parent may ignore SIGINT (as in `make test &`), and a child inherits that. The wake-up pipe is written as soon as
# the signal arrives, also while compiled code runs: the thread that reads it notes the processor time used so far.
_PREAMBLE = """
import os, signal, threading, time
signal.signal(signal.SIGINT, signal.default_int_handler)
_receiver, _sender = os.pipe()
os.set_blocking(_sender, False)
signal.set_wakeup_fd(_sender)
_arrival = []
def _note_arrival():
    os.read(_receiver, 1)
    _arrival.append(time.process_time())
_watcher = threading.Thread(target=_note_arrival, daemon=True)
_watcher.start()
def seconds_since_signal():
    _watcher.join()
    return time.process_time() - _arrival[0]
"""


@contextlib.contextmanager
def script(text: str, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """Run a Python script that may call `seconds_since_signal()`: processor seconds since SIGINT arrived.

    The child is killed when the block ends, whatever happened in it, and after `HANG` seconds.
    """
    command = [sys.executable, "-c", _PREAMBLE + textwrap.dedent(text), *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    timer = threading.Timer(HANG, process.kill)
    timer.start()
    try:
        yield process
    finally:
        timer.cancel()
        process.kill()
        process.communicate()


def read_line(process: subprocess.Popen[str]) -> str:
    """Return the next line that the child prints; an empty one if it has ended."""
    assert process.stdout is not None
    return process.stdout.readline().strip()


def interrupt(process: subprocess.Popen[str]) -> None:
    """Send SIGINT to the child."""
    process.send_signal(signal.SIGINT)
