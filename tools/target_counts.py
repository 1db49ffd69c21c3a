"""Count how often wrong numbers of corners and circles are accepted, and right ones refused; for docs/targets.md."""

import sys
from collections import Counter
from pathlib import Path

from fedic.calibration import NotFoundError, Target, find_target
from fedic.calibration.detection import WrongCountError

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))


def main(count: int = 51) -> None:
    """Print the outcomes for the views of `count` targets."""
    from scenes.printed import Grey, scene, wrong_counts

    def outcome(image: Grey, target: Target) -> str:
        try:
            find_target(image, target)
        except WrongCountError:
            return "wrong count"
        except NotFoundError:
            return "not found"
        return "accepted"

    right, wrong = Counter[str](), Counter[str]()
    for seed in range(count):
        drawn = scene(seed)
        other = wrong_counts(drawn.target, drawn.rng)
        right.update(outcome(image, drawn.target) for image in drawn.views)
        wrong.update(outcome(image, other) for image in drawn.views)
    sys.stdout.write(f"right counts: {dict(right)}; wrong counts: {dict(wrong)}\n")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
