"""Options reach the signature, the documentation, the types and the configuration from one declaration."""

import inspect
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

import fedic
from fedic._core import CORRELATION_OPTIONS, SPECIMEN_OPTIONS, OptionInfo
from fedic._internal import option_types
from fedic.campaign.config.correlation_section import CorrelationSection
from fedic.plotting import plot_displacement
from fedic.starts.initial import Start

ROOT = Path(__file__).resolve().parents[2]
MESH = fedic.rectangle_mesh((8, 8, 40, 40), size=16)


def image() -> np.ndarray:
    return fedic.synthetic.render(fedic.synthetic.Speckle(4.0, seed=1), fedic.ImageFrame(), (48, 48))


@pytest.mark.parametrize(
    ("function", "table"),
    [
        (fedic.correlate, CORRELATION_OPTIONS),
        (fedic.Correlator, CORRELATION_OPTIONS),
        (fedic.calibrate_on_specimen, SPECIMEN_OPTIONS),
    ],
)
def test_signature_and_docstring_show_every_option(function: object, table: list[OptionInfo]) -> None:
    signature, doc = inspect.signature(function), inspect.getdoc(function)  # type: ignore[arg-type]
    assert doc is not None
    assert "{options}" not in doc
    for info in table:
        parameter = signature.parameters[info.name]
        assert parameter.kind is inspect.Parameter.KEYWORD_ONLY
        assert f"\n{info.name} : " in doc
        shown = f'"{parameter.default}"' if isinstance(parameter.default, str) else repr(parameter.default)
        assert f", default {shown}\n" in doc
    assert not any(p.kind is inspect.Parameter.VAR_KEYWORD for p in signature.parameters.values())


def test_defaults_are_those_of_the_core() -> None:
    defaults = {name: p.default for name, p in inspect.signature(fedic.correlate).parameters.items()}
    assert defaults["smoothing"] == 0.8
    assert defaults["brightness"] == "auto"
    assert defaults["robust"] is None
    assert defaults["regularization_length"] is None
    assert defaults["quadrature"] == fedic.MeshQuadrature(density=1.0, rule="rotated")
    assert defaults["initial"] == "auto"


def test_correlate_and_correlator_take_the_same_options() -> None:
    of_correlate = dict(inspect.signature(fedic.correlate).parameters)
    del of_correlate["deformed"]
    assert list(of_correlate) == list(inspect.signature(fedic.Correlator).parameters)


def test_types_and_configuration_have_every_option() -> None:
    names = [info.name for info in CORRELATION_OPTIONS]
    assert list(option_types.CorrelationOptions.__annotations__) == names
    assert list(option_types.SpecimenOptions.__annotations__) == [info.name for info in SPECIMEN_OPTIONS]
    assert set(CorrelationSection.model_fields) == {*names, "density", "initial", "equilibrium_gap"}
    defaults = {name: p.default for name, p in inspect.signature(fedic.correlate).parameters.items()}
    assert CorrelationSection().options() == {name: defaults[name] for name in [*names, "initial"]}


@pytest.mark.parametrize("initial", get_args(Start))
def test_every_start_can_be_configured(initial: str) -> None:
    assert CorrelationSection.model_validate({"initial": initial}).options()["initial"] == initial


def test_a_density_without_a_mesh_quadrature_is_refused() -> None:
    with pytest.raises(ValueError, match='density should be left out with quadrature = "pixel"'):
        CorrelationSection.model_validate({"quadrature": "pixel", "density": 1.0})
    assert CorrelationSection.model_validate({"quadrature": "pixel"}).options()["quadrature"] == fedic.PixelQuadrature()


@pytest.mark.parametrize(
    ("options", "option", "message"),
    [
        ({"smoothin": 0.8}, "smoothin", "there is no option 'smoothin'; did you mean smoothing?"),
        ({"initiall": "fft"}, "initiall", "there is no option 'initiall'; did you mean initial?"),
        (
            {"xyz": 1},
            "xyz",
            "there is no option 'xyz'; the options are quadrature, interpolation, gradient, smoothing, brightness, "
            "robust, hessian, regularization_length, tolerance, noise, max_iterations, num_threads, initial, mask, "
            "regularization, unit, progress.",
        ),
        (
            {"smoothing": -1.0},
            "smoothing",
            "smoothing must be zero or a positive standard deviation in pixels, got -1.0",
        ),
        (
            {"smoothing": "0.8"},
            "smoothing",
            "smoothing must be zero or a positive standard deviation in pixels, got '0.8'",
        ),
        (
            {"smoothing": None},
            "smoothing",
            "smoothing must be zero or a positive standard deviation in pixels, got None",
        ),
        ({"tolerance": 0}, "tolerance", "tolerance must be a positive number of pixels of at most 1, got 0"),
        ({"tolerance": 2.0}, "tolerance", "tolerance must be a positive number of pixels of at most 1, got 2.0"),
        ({"tolerance": True}, "tolerance", "tolerance must be a positive number of pixels of at most 1, got True"),
        ({"max_iterations": 2.0}, "max_iterations", "max_iterations must be an integer of at least 1, got 2.0"),
        (
            {"num_threads": 0},
            "num_threads",
            "num_threads must be an integer between 1 and 1024 or None, got 0",
        ),
        (
            {"regularization_length": [10.0]},
            "regularization_length",
            "regularization_length must be a positive wavelength in pixels or None, got [10.0]",
        ),
        (
            {"brightness": "all"},
            "brightness",
            'brightness must be "auto", "global", "element", "field" or None, got \'all\'',
        ),
        ({"hessian": None}, "hessian", 'hessian must be "initial" or "updated", got None'),
        (
            {"interpolation": "cubic"},
            "interpolation",
            'interpolation must be "bilinear", "bicubic", "bspline3" or "bspline5", got \'cubic\'',
        ),
        (
            {"quadrature": "edges"},
            "quadrature",
            "quadrature must be a fedic.MeshQuadrature or a fedic.PixelQuadrature, got 'edges'",
        ),
        (
            {"initial": "previous"},
            "initial",
            "a correlator remembers no earlier frame: give its result as initial, or measure with fedic.Campaign",
        ),
    ],
)
def test_a_bad_option_is_refused_verbatim(options: dict[str, object], option: str, message: str) -> None:
    for measure in (
        lambda: fedic.correlate(image(), image(), MESH, **options),  # type: ignore[arg-type]
        lambda: fedic.Correlator(image(), MESH, **options),  # type: ignore[arg-type]
    ):
        with pytest.raises(fedic.OptionError) as caught:
            measure()
        assert str(caught.value) == message
        assert caught.value.option == option
        assert isinstance(caught.value, ValueError)
        assert isinstance(caught.value, fedic.FedicError)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"density": 0}, "density must be a positive number of at most 10000, got 0"),
        ({"density": "1"}, "density must be a positive number, got '1'"),
        ({"rule": "gauss"}, 'rule must be one of "rotated", "edges", "diameter", got \'gauss\''),
        ({"rule": "pixel"}, 'rule must be one of "rotated", "edges", "diameter", got \'pixel\''),
    ],
)
def test_a_bad_quadrature_is_refused_verbatim(options: dict[str, object], message: str) -> None:
    with pytest.raises(fedic.OptionError) as caught:
        fedic.MeshQuadrature(**options)  # type: ignore[arg-type]
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fedic.rectangle_mesh((0, 0, 1, 1), 1.0, "hexagon"), 'unknown cell type "hexagon"'),  # type: ignore[arg-type]
        (lambda: fedic.rectangle_mesh((0, 0, 1, 1), -1.0), "size"),
        (lambda: MESH.strains(np.zeros((3, 2))), "displacement must have one row per node of the mesh: 9, got 3"),
        (lambda: MESH.interpolate(np.zeros((9, 2)), "here"), "points must be a 2-dimensional array"),
        (lambda: fedic.ImageFrame().project([[1.0]]), r"points must have shape \(n, 2\) or \(n, 3\)"),
        (lambda: fedic.Correlator(image(), "mesh"), "mesh must be a fedic.Mesh, got str"),  # type: ignore[arg-type]
        (lambda: fedic.Correlator(image(), MESH, "camera"), "camera must be an ImageFrame"),  # type: ignore[arg-type]
        (lambda: fedic.synthetic.Speckle(-1.0), "size must be a positive length, got -1"),
        (lambda: fedic.Correlator(image(), MESH).residual_map(image(), np.zeros((3, 2))), "displacement|9 nodes"),
        (
            lambda: plot_displacement(fedic.correlate(image(), image(), MESH), image(), "z"),  # type: ignore[arg-type]
            'component must be one of "x", "y", "u", "v", got \'z\'',
        ),
    ],
)
def test_a_bad_argument_is_an_option_error(call: Callable[[], object], message: str) -> None:
    with pytest.raises(fedic.OptionError, match=message):
        call()


def test_numpy_scalars_are_accepted() -> None:
    fedic.Correlator(image(), MESH, smoothing=np.float32(0.5), max_iterations=np.int64(3), tolerance=np.float64(1e-2))  # type: ignore[arg-type]


def test_option_errors_can_be_pickled() -> None:
    error = pickle.loads(pickle.dumps(fedic.OptionError("a message", "smoothing")))
    assert (str(error), error.option) == ("a message", "smoothing")


def test_a_correlator_started_from_elsewhere_can_start_from_zero() -> None:
    correlator = fedic.Correlator(image(), MESH, initial=np.full((MESH.num_nodes, 2), 0.5), max_iterations=1)
    far, near = correlator.correlate(image()), correlator.correlate(image(), initial="zero")
    assert far.history[0].correction > 0.4
    assert near.history[0].correction < 1e-6


def test_generated_files_are_up_to_date() -> None:
    found = subprocess.run([sys.executable, ROOT / "tools/generate.py", "--check"], capture_output=True, text=True)
    assert found.stderr == ""
    assert found.returncode == 0


PROGRAM = """\
import numpy as np
import fedic

image = np.zeros((10, 10), np.uint8)
mesh = fedic.rectangle_mesh((0, 0, 9, 9), 3.0)
fedic.correlate(image, image, mesh, smoothing=0.5, brightness=None, quadrature=fedic.PixelQuadrature(), initial="fft")
fedic.Correlator(image, mesh, regularization_length=None, interpolation="bicubic").correlate(image, initial="zero")
fedic.correlate(image, image, mesh, smoothin=0.5)
fedic.correlate(image, image, mesh, interpolation="cubic")
fedic.Correlator(image, mesh, max_iterations="many")
"""


def test_a_type_checker_sees_the_options(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    (tmp_path / "program.py").write_text(PROGRAM)
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "--cache-dir", str(tmp_path / "cache")]
    found = subprocess.run([*command, "program.py"], cwd=tmp_path, capture_output=True, text=True)
    lines = [line.split(":", 2)[1] for line in found.stdout.splitlines() if ": error:" in line]
    assert lines == ["8", "9", "10"], found.stdout + found.stderr
    assert 'Unexpected keyword argument "smoothin"' in found.stdout
