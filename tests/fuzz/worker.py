"""A process that uses mutated files: numbers of inputs in, one line with the outcome of each out."""

import os
import random
import sys
import tempfile
import warnings
from pathlib import Path

import fedic
from fuzz.mutations import mutated
from fuzz.suites import SUITES

_MEMORY = 3 << 30


def _limit_memory() -> None:
    try:
        import resource
    except ImportError:  # Windows has no such limit.
        return
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))


def _outcome(use: object, path: Path) -> str:
    try:
        use(path)  # type: ignore[operator]
    except fedic.FedicError as error:
        return "refused" if str(error).strip() else "untyped FedicError without a message"
    except BaseException as error:  # every other exception is a fault
        return " ".join(f"untyped {type(error).__name__}: {error}".split())[:200]
    return "read"


def main() -> None:
    """Answer each line ``seed:number`` of the input with ``seed:number outcome``."""
    suite = SUITES[sys.argv[1]]
    # What libraries print must not mix with the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "seeds").mkdir()
        seeds = [(path, path.read_bytes()) for path in suite.seeds(folder / "seeds")]
        _limit_memory()
        print("ready", file=answers, flush=True)
        for line in sys.stdin:
            draw = random.Random(line.strip())
            original, data = draw.choice(seeds)
            path = original.with_name(f"{draw.randrange(1 << 60)}{''.join(original.suffixes)}")
            path.write_bytes(mutated(data, draw))
            outcome = _outcome(suite.use, path)
            path.unlink(missing_ok=True)
            print(line.strip(), original.name.replace(" ", "_"), outcome, file=answers, flush=True)


if __name__ == "__main__":
    main()
