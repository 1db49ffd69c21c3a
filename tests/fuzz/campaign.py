"""Workers fed with inputs and watched: those that die or do not answer are replaced."""

import contextlib
import os
import queue
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

__all__ = ["Tally", "run"]

_SECONDS = 20.0
"""Time after which an input counts as one that hangs."""
_START = 300.0


@dataclass
class Tally:
    """Outcomes of a suite.

    Attributes
    ----------
    counts : Counter
        Number of inputs ``read``, ``refused``, and with each kind of fault: ``untyped``, ``crash``, ``hang``.
    faults : list of str
        Input, seed file and outcome of each fault.
    """

    counts: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)

    def add(self, line: str) -> None:
        """Count the answer of a worker."""
        outcome = line.split(" ", 2)[2]
        kind = outcome.split(" ", 1)[0]
        self.counts[kind] += 1
        if kind not in ("read", "refused"):
            self.faults.append(line)


class _Worker:
    def __init__(self, suite: str) -> None:
        tests = str(Path(__file__).parents[1])
        path = os.pathsep.join(filter(None, (tests, os.environ.get("PYTHONPATH"))))
        self.process = subprocess.Popen(
            [sys.executable, "-m", "fuzz.worker", suite],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env={**os.environ, "PYTHONPATH": path},
        )
        self.lines: queue.Queue[str] = queue.Queue()
        self.collector = threading.Thread(target=self._collect, daemon=True)
        self.collector.start()
        if self._answer(_START) != "ready":
            self.stop()
            raise RuntimeError(f"the worker of {suite} does not start")

    def _collect(self) -> None:
        for line in self.process.stdout or ():
            self.lines.put(line.rstrip("\n"))
        self.lines.put("")

    def _answer(self, seconds: float) -> str:
        try:
            return self.lines.get(timeout=seconds)
        except queue.Empty:
            return "hang"

    def ask(self, number: str) -> str:
        """Return the answer for an input, ``crash`` or ``hang``."""
        try:
            print(number, file=self.process.stdin, flush=True)
        except BrokenPipeError:
            return f"{number} - crash"
        answer = self._answer(_SECONDS)
        return answer if answer not in ("", "hang") else f"{number} - {answer or 'crash'}"

    def stop(self) -> None:
        self.process.kill()
        self.process.wait()
        self.collector.join()
        for pipe in (self.process.stdin, self.process.stdout):
            with contextlib.suppress(BrokenPipeError):
                pipe.close()  # type: ignore[union-attr]


def run(suite: str, numbers: Iterable[str]) -> Tally:
    """Use one input after the other in a worker.

    Parameters
    ----------
    suite : str
        Name of the suite.
    numbers : iterable of str
        The inputs, ``seed:number``: the same always makes the same file.

    Returns
    -------
    Tally
        What became of them.
    """
    tally, worker = Tally(), _Worker(suite)
    try:
        for number in numbers:
            answer = worker.ask(number)
            tally.add(answer)
            if answer.endswith((" - crash", " - hang")):
                worker.stop()
                worker = _Worker(suite)
    finally:
        worker.stop()
    return tally
