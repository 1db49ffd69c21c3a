"""Threads, the interpreter lock and Ctrl-C."""

import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import fedic


@pytest.fixture(scope="module")
def images() -> tuple[np.ndarray, np.ndarray]:
    texture = fedic.synthetic.Speckle(5.0, seed=4)
    render = fedic.synthetic.render
    return render(texture, fedic.ImageFrame(), (600, 700)), render(
        texture, fedic.ImageFrame(), (600, 700), displacement=(3.3, -2.4), noise=2.0
    )


@pytest.mark.parametrize("quadrature", [fedic.MeshQuadrature(), fedic.PixelQuadrature()])
def test_the_bits_do_not_depend_on_the_threads(images: tuple[np.ndarray, np.ndarray], quadrature: object) -> None:
    mesh = fedic.rectangle_mesh((20, 20, 680, 580), 14, "triangle6")
    results = [
        fedic.correlate(*images, mesh, quadrature=quadrature, initial="pyramid", num_threads=n)  # type: ignore[arg-type]
        for n in (1, 2, 4)
    ]
    for other in results[1:]:
        assert other.displacement.tobytes() == results[0].displacement.tobytes()
        assert other.cell_residuals.tobytes() == results[0].cell_residuals.tobytes()
        assert other.history == results[0].history


def test_other_python_threads_run_meanwhile(images: tuple[np.ndarray, np.ndarray]) -> None:
    mesh = fedic.rectangle_mesh((20, 20, 680, 580), 20)
    ticks: list[float] = []
    over = threading.Event()

    def tick() -> None:
        while not over.wait(0.002):
            ticks.append(time.perf_counter())

    thread = threading.Thread(target=tick)
    thread.start()
    correlator = fedic.Correlator(images[0], mesh, quadrature=fedic.MeshQuadrature(density=16.0), num_threads=1)
    start = time.perf_counter()
    correlator.correlate(images[1], initial="pyramid")
    end = time.perf_counter()
    over.set()
    thread.join()
    # Were the interpreter lock held, at most one tick would fall between the two.
    assert sum(start < t < end for t in ticks) > 10


def test_ctrl_c_stops_a_correlation_within_a_second() -> None:
    """A problem of minutes is interrupted: an iteration takes seconds, the preparation too."""
    script = """
        import sys, time, numpy as np, fedic
        image = np.random.default_rng(0).integers(0, 255, (2000, 2000), dtype=np.uint8)
        mesh = fedic.rectangle_mesh((20, 20, 1980, 1980), 20)
        quadrature = fedic.MeshQuadrature(density=float(sys.argv[1]))
        print("ready", flush=True)
        try:
            correlator = fedic.Correlator(image, mesh, quadrature=quadrature)
            print("prepared", flush=True)
            while True:
                correlator.correlate(image, initial=np.ones((mesh.num_nodes, 2)))
        except KeyboardInterrupt:
            print("interrupted", flush=True)
    """
    for density, stage in ((100.0, "ready"), (1.0, "prepared")):
        process = subprocess.Popen(
            [sys.executable, "-c", textwrap.dedent(script), str(density)], stdout=subprocess.PIPE, text=True
        )
        assert process.stdout is not None
        while process.stdout.readline().strip() != stage:
            assert process.poll() is None
        time.sleep(0.5)
        start = time.perf_counter()
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline().strip() == "interrupted"
        elapsed = time.perf_counter() - start
        assert process.wait(timeout=30) == 0
        process.stdout.close()
        assert elapsed < 1.0


def test_an_exception_in_the_progress_callback_stops_the_work(images: tuple[np.ndarray, np.ndarray]) -> None:
    def refuse(*_: object) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        fedic.correlate(*images, fedic.rectangle_mesh((20, 20, 680, 580), 20), progress=refuse)
