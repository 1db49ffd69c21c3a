"""Forked children, pickled objects and the number of threads."""

import os
import pickle
import subprocess
import sys
import textwrap

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import fedic

_WORK = """
    import os, sys
    import numpy as np, fedic
    image = np.random.default_rng(0).integers(0, 255, (120, 120)).astype(np.uint8)
    moved = np.roll(image, 1, axis=1).astype(np.float32)
    mesh = fedic.rectangle_mesh((10, 10, 110, 110), 20)
    own = fedic.Correlator(image, mesh, num_threads=2, initial="zero")
    shared = fedic.Correlator(image.astype(np.float32), mesh, initial="zero")
    def work():
        found = [each.correlate(moved).unchecked_displacement for each in (own, shared)]
        found.append(mesh.interpolate(np.ones((mesh.num_nodes, 2)), [[50.0, 50.0]]))
        found.append(shared.standard_deviations(1.0))
        found.append(fedic.synthetic.Speckle(3.0).values(mesh.points))
        found.append(fedic.correlate(image, image, mesh).displacement)
        return b"".join(each.tobytes() for each in found)
"""


def run(text: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-W", "ignore", "-c", textwrap.dedent(_WORK) + textwrap.dedent(text)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
@pytest.mark.parametrize("before", ["work()", "pass"])
def test_a_forked_child_measures_as_its_parent_does(before: str) -> None:
    script = f"""
        {before}
        reader, writer = os.pipe()
        if os.fork() == 0:
            os.write(writer, bytes([len(set(work() for _ in range(2)))]) + work()[:1000])
            os._exit(0)
        child = os.read(reader, 1001)
        assert os.wait()[1] == 0
        assert child == bytes([1]) + work()[:1000]
        print("same")
    """
    ended = run(script)
    assert ended.stdout == "same\n", ended.stderr


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
@pytest.mark.parametrize(("before", "expected"), [("render()", "refused"), ("work()", "rendered")])
def test_a_forked_child_renders_or_refuses_at_once(before: str, expected: str) -> None:
    script = f"""
        def render():
            return fedic.synthetic.render(fedic.synthetic.Speckle(3.0), fedic.ImageFrame(), (200, 200))
        {before}
        if os.fork() == 0:
            try:
                render()
                print("rendered", flush=True)
            except fedic.FedicError as error:
                print("refused" if "spawn" in str(error) else error, flush=True)
            os._exit(0)
        assert os.wait()[1] == 0
    """
    ended = run(script)
    assert ended.stdout == f"{expected}\n", ended.stderr


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
@pytest.mark.parametrize("start", ["fft", "features", "log-polar", "flow"])
def test_a_forked_child_uses_the_starts_of_opencv_after_its_parent(start: str) -> None:
    script = f"""
        import cv2
        cv2.setNumThreads(4)
        large = cv2.GaussianBlur(np.kron(image, np.ones((6, 6), np.uint8)), (0, 0), 3.0)
        def measured():
            shifted = np.roll(large, 5, axis=1)
            return fedic.correlate(large, shifted, fedic.rectangle_mesh((60, 60, 660, 660), 60), initial="{start}")
        expected = measured().displacement
        if os.fork() == 0:
            print(np.array_equal(measured().displacement, expected), flush=True)
            os._exit(0)
        assert os.wait()[1] == 0
    """
    ended = run(script)
    assert ended.stdout == "True\n", ended.stderr


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_pools_of_forked_processes_measure() -> None:
    script = """
        import multiprocessing
        expected = work()
        def in_child(_):
            return work() == expected
        with multiprocessing.get_context("fork").Pool(2) as pool:
            print(pool.map(in_child, range(4)))
    """
    ended = run(script)
    assert ended.stdout == "[True, True, True, True]\n", ended.stderr


@pytest.mark.skipif(not os.path.isdir("/proc/self/task"), reason="this system does not list threads")  # noqa: PTH112
def test_one_thread_means_one_thread() -> None:
    script = """
        count = lambda: len(os.listdir("/proc/self/task"))
        before = count()
        image = moved[:100, :100].copy()
        small = fedic.rectangle_mesh((10, 10, 90, 90), 20)
        correlator = fedic.Correlator(image, small, num_threads=1, initial="pyramid")
        result = correlator.correlate(image)
        correlator.standard_deviations(1.0)
        correlator.residual_map(image, result.displacement)
        import time
        for _ in range(100):  # threads that have ended stay listed for a moment
            if count() - before == 1:
                break
            time.sleep(0.05)
        print(count() - before)
    """
    ended = run(script)
    # The thread of the correlator itself, which lives as long as it.
    assert ended.stdout == "1\n", ended.stderr


def test_correlators_can_be_pickled(speckle_pair: tuple[np.ndarray, np.ndarray]) -> None:
    reference, deformed = speckle_pair
    mask = np.zeros(reference.shape, dtype=bool)
    mask[60:70, 60:70] = True
    mesh = fedic.rectangle_mesh((30, 30, 170, 130), 20)
    correlator = fedic.Correlator(
        reference, mesh, initial="pyramid", mask=mask, smoothing=0.5, quadrature=fedic.MeshQuadrature(density=2.0)
    )
    copy = pickle.loads(pickle.dumps(correlator))
    first, second = correlator.correlate(deformed), copy.correlate(deformed)
    assert copy.num_points == correlator.num_points
    assert_array_equal(first.displacement, second.displacement)
    assert second.start == "pyramid"


def test_speckles_can_be_pickled() -> None:
    speckle = fedic.synthetic.Speckle(4.0, coverage=0.4, seed=7)
    copy = pickle.loads(pickle.dumps(speckle))
    points = np.random.default_rng(0).uniform(0.0, 50.0, (100, 2))
    assert_array_equal(copy.values(points), speckle.values(points))
    assert (copy.size, copy.coverage, copy.seed) == (4.0, 0.4, 7)
