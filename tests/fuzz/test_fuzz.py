"""A short part of the mutated files; ``python -m fuzz`` in the folder ``tests`` uses as many as wanted."""

import random
import sys

import pytest

from fuzz.campaign import Tally, run
from fuzz.mutations import mutated
from fuzz.suites import SUITES

INPUTS = 100


@pytest.mark.skipif(sys.platform == "win32", reason="pipes of processes differ")
@pytest.mark.parametrize("suite", SUITES)
def test_every_mutated_file_is_read_or_refused(suite: str) -> None:
    tally = run(suite, [f"short:{suite}:{number}" for number in range(INPUTS)])
    assert tally.faults == []
    assert tally.counts.total() == INPUTS
    assert tally.counts["refused"] > INPUTS // 10
    assert tally.counts["read"] > 0


def test_the_same_number_makes_the_same_mutation() -> None:
    data = b"*NODE\n1, 0.0, 1.0\n2, 3.0, 4.0\n"
    versions = {mutated(data, random.Random("7")) for _ in range(3)}
    assert len(versions) == 1
    assert len({mutated(data, random.Random(str(number))) for number in range(100)}) > 60


def test_faults_are_counted_and_listed() -> None:
    tally = Tally()
    for line in ("1 a.tif read", "2 a.tif refused", "3 - crash", "4 - hang", "5 a.tif untyped KeyError: 'x'"):
        tally.add(line)
    assert tally.counts == {"read": 1, "refused": 1, "crash": 1, "hang": 1, "untyped": 1}
    assert len(tally.faults) == 3
