"""Measure all cases with the installed fedic and store the results, or compare them with those stored.

python tests/golden/make_fedic_results.py --check    prints each case that differs, bit by bit
python tests/golden/make_fedic_results.py            overwrites the stored results
"""

import sys

import numpy as np
from cases import CASES, FEDIC_RESULTS, measure


def main() -> None:
    """Store or compare."""
    found = {f"{name}:{key}": value for name, case in CASES.items() for key, value in measure(case).items()}
    if sys.argv[1:] != ["--check"]:
        np.savez_compressed(FEDIC_RESULTS, **found)  # type: ignore[arg-type]
        return
    with np.load(FEDIC_RESULTS, allow_pickle=False) as stored:
        different = [key for key in stored if stored[key].tobytes() != found[key].tobytes()]
        lines = [f"{key}: differs by {np.nanmax(np.abs(stored[key] - found[key])):.2e}\n" for key in different]
    sys.stdout.write("".join(lines) + f"{len(found) - len(different)} of {len(found)} arrays have the same bits\n")


if __name__ == "__main__":
    main()
