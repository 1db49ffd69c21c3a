"""Work that does not fit in memory is refused before it begins; an allocation that fails would end the process."""

import subprocess
import sys
import textwrap

import pytest

pytest.importorskip("resource")

_SCRIPT = """
    import resource
    import numpy as np, fedic
    image = np.random.default_rng(0).integers(0, 255, (1000, 1000)).astype(np.uint8)
    mesh = fedic.rectangle_mesh((10, 10, 990, 990), 4)
    correlator = fedic.Correlator(image, fedic.rectangle_mesh((10, 10, 990, 990), 5), num_threads=1, smoothing=0.0)
    pages = int(open("/proc/self/statm").read().split()[0])
    limit = pages * resource.getpagesize() + {megabytes} * 2**20
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    try:
        {work}
        print("done")
    except fedic.FedicError as error:
        print(type(error).__name__, error)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is limited on Linux only")
@pytest.mark.parametrize(
    ("work", "few", "enough", "message"),
    [
        ("fedic.rectangle_mesh((0, 0, 1000, 1000), 1)", 100, 1000, "OptionError a mesh of 1.000e6 cells is too large"),
        (
            "fedic.Correlator(image, mesh, num_threads=1, smoothing=0.0)",
            40,
            1000,
            "FedicError the preparation of the reference image needs 0.1 GB of memory",
        ),
        (
            "correlator.standard_deviations(1.0)",
            8,
            1000,
            "FedicError the covariance of the displacement needs 0.1 GB of memory",
        ),
    ],
    ids=["mesh", "correlator", "standard deviations"],
)
def test_work_beyond_the_memory_is_refused(work: str, few: int, enough: int, message: str) -> None:
    for megabytes, expected in ((few, message), (enough, "done")):
        script = textwrap.dedent(_SCRIPT).format(megabytes=megabytes, work=work)
        command = [sys.executable, "-W", "ignore", "-c", script]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
        assert ended.stdout.startswith(expected), (ended.returncode, ended.stdout, ended.stderr[-500:])
