"""All suites at length: ``python -m fuzz [--inputs N] [--seed S] [--workers W] [SUITE ...]`` in ``tests``."""

import argparse
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

from fuzz.campaign import run
from fuzz.suites import SUITES


def main() -> int:
    """Run the suites, print a table and the faults, and return 1 if there are any."""
    parser = argparse.ArgumentParser(prog="python -m fuzz", description="Mutated files of every kind that fedic reads.")
    parser.add_argument("suites", nargs="*", choices=[[], *SUITES], default=[], metavar="SUITE")
    parser.add_argument("--inputs", type=int, default=10_000, help="inputs of each suite")
    parser.add_argument("--seed", default="0")
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    total: Counter[str] = Counter()
    for suite in options.suites or SUITES:
        shares = [
            [f"{options.seed}:{suite}:{number}" for number in range(first, options.inputs, options.workers)]
            for first in range(options.workers)
        ]
        with ThreadPoolExecutor(options.workers) as pool:
            tallies = list(pool.map(run, [suite] * options.workers, shares))
        counts = sum((tally.counts for tally in tallies), Counter())
        total += counts
        print(f"{suite:16}", ", ".join(f"{kind} {count}" for kind, count in sorted(counts.items())), flush=True)
        for fault in (fault for tally in tallies for fault in tally.faults):
            print(f"  {fault}", flush=True)
    print(f"{'together':16}", ", ".join(f"{kind} {count}" for kind, count in sorted(total.items())))
    return 0 if set(total) <= {"read", "refused"} else 1


if __name__ == "__main__":
    sys.exit(main())
