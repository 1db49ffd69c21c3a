"""Threads, the interpreter lock, Ctrl-C and callbacks."""

import itertools
import threading
import time

import numpy as np
import pytest

import fedic
from interruption import interrupt, read_line, script


@pytest.fixture(scope="module")
def images() -> tuple[np.ndarray, np.ndarray]:
    texture = fedic.synthetic.Speckle(5.0, seed=4)
    render = fedic.synthetic.render
    return render(texture, fedic.ImageFrame(), (600, 700)), render(
        texture, fedic.ImageFrame(), (600, 700), displacement=(3.3, -2.4), noise=2.0
    )


@pytest.mark.parametrize("quadrature", [fedic.MeshQuadrature(), fedic.PixelQuadrature()])
def test_results_do_not_depend_on_the_number_of_threads(
    images: tuple[np.ndarray, np.ndarray], quadrature: object
) -> None:
    mesh = fedic.rectangle_mesh((20, 20, 680, 580), 14, "triangle6")
    results = [
        fedic.correlate(*images, mesh, quadrature=quadrature, initial="pyramid", num_threads=n)  # type: ignore[arg-type]
        for n in (1, 2, 4)
    ]
    for other in results[1:]:
        assert other.displacement.tobytes() == results[0].displacement.tobytes()
        assert other.cell_residuals.tobytes() == results[0].cell_residuals.tobytes()
        assert other.history == results[0].history


def test_other_python_threads_run_during_a_correlation(images: tuple[np.ndarray, np.ndarray]) -> None:
    mesh = fedic.rectangle_mesh((20, 20, 680, 580), 20)
    correlator = fedic.Correlator(images[0], mesh, quadrature=fedic.MeshQuadrature(density=16.0), num_threads=1)
    ticks, over = itertools.count(), threading.Event()

    def tick() -> None:
        while not over.wait(0.002):
            next(ticks)

    def ticks_during_a_correlation() -> int:
        before = next(ticks)
        correlator.correlate(images[1], initial="pyramid")
        return next(ticks) - before - 1

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        # With the interpreter lock held, at most two ticks would fall into a correlation. On a busy machine the thread
        # may not run during some of them.
        assert any(ticks_during_a_correlation() > 10 for _ in range(20))
    finally:
        over.set()
        thread.join()


@pytest.mark.parametrize(("density", "stage"), [(100.0, "preparing"), (1.0, "iterating")])
def test_ctrl_c_stops_a_correlation_within_two_processor_seconds(density: float, stage: str) -> None:
    """The preparation takes minutes with a density of 100; the iterations with a density of 1 are repeated for ever."""
    child = """
        import sys, numpy as np, fedic
        image = np.random.default_rng(0).integers(0, 255, (2000, 2000), dtype=np.uint8)
        mesh = fedic.rectangle_mesh((20, 20, 1980, 1980), 20)
        quadrature = fedic.MeshQuadrature(density=float(sys.argv[1]))
        print("preparing", flush=True)
        try:
            correlator = fedic.Correlator(image, mesh, quadrature=quadrature)
            print("iterating", flush=True)
            while True:
                correlator.correlate(image, initial=np.ones((mesh.num_nodes, 2)))
        except KeyboardInterrupt:
            print(seconds_since_signal(), flush=True)
    """
    with script(child, str(density)) as process:
        while (line := read_line(process)) != stage:
            assert line
        time.sleep(0.5)  # most likely in compiled code by now
        interrupt(process)
        assert float(read_line(process)) < 2.0
        assert process.wait() == 0


@pytest.mark.parametrize(
    "call",
    [
        "fedic.synthetic.render(fedic.synthetic.Speckle(3.0), fedic.ImageFrame(), (8000, 8000))",
        "camera.unproject(places)",
        "mesh.interpolate(np.ones((mesh.num_nodes, 2)), places)",
    ],
    ids=["render", "unproject", "interpolate"],
)
def test_ctrl_c_stops_other_loops_over_many_points(call: str) -> None:
    """Each call takes several seconds."""
    child = f"""
        import numpy as np, fedic
        places = np.random.default_rng(0).uniform(0.0, 800.0, (6_000_000, 2))
        mesh = fedic.rectangle_mesh((0, 0, 800, 800), 2)
        lens = fedic.BrownDistortion(radial=(-0.1, 0.01, 0.0))
        camera = fedic.Pinhole((1000.0, 1000.0), (400.0, 400.0), np.eye(3), (0.0, 0.0, 1000.0), distortion=lens)
        print("calling", flush=True)
        try:
            {call}
        except KeyboardInterrupt:
            print(seconds_since_signal(), flush=True)
    """
    with script(child) as process:
        assert read_line(process) == "calling"
        time.sleep(0.5)
        interrupt(process)
        assert float(read_line(process)) < 2.0
        assert process.wait() == 0


def test_an_exception_in_the_progress_callback_propagates(images: tuple[np.ndarray, np.ndarray]) -> None:
    def refuse(*_: object) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        fedic.correlate(*images, fedic.rectangle_mesh((20, 20, 680, 580), 20), progress=refuse)
