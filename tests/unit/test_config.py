"""Configuration files: paths, options, and errors that name the key."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

import fedic
from fedic.campaign.config import Config, load_config

VALID = """\
[images]
reference = "frame-00.png"
deformed = "frame-0[12].png"

[mesh.rectangle]
bounds = [10, 10, 50.0, 40]
size = 10

[camera]
model = "pinhole"
focal = [100.0, 100.0]
principal_point = [32.0, 24.0]
rotation = [[1, 0, 0], [0, -1, 0], [0, 0, -1]]
translation = [0.0, 0.0, 100.0]

[camera.distortion]
radial = [-0.1, 0.0, 0.0]

[correlation]
quadrature = "diameter"
density = 0.5
brightness = "none"
initial = "pyramid"
tolerance = 1e-2

[output]
folder = "out"
pictures = false
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for number in range(3):
        assert cv2.imwrite(str(tmp_path / f"frame-0{number}.png"), np.zeros((48, 64), dtype=np.uint8))
    return tmp_path


def load(folder: Path, text: str) -> Config:
    path = folder / "test.toml"
    path.write_text(text)
    return load_config(path)


def test_paths_are_relative_to_the_configuration_file(folder: Path) -> None:
    config = load(folder, VALID)
    assert config.images.reference == folder / "frame-00.png"
    assert config.images.deformed == [folder / "frame-01.png", folder / "frame-02.png"]
    assert config.output.folder == folder / "out"
    assert config.mesh.build().num_cells == 12
    camera = config.camera.build()
    assert isinstance(camera, fedic.Pinhole)
    assert camera.distortion is not None
    assert tuple(camera.distortion.radial) == (-0.1, 0.0, 0.0)
    options = config.correlation.options()
    assert options["quadrature"] == fedic.MeshQuadrature(density=0.5, rule="diameter")
    assert (options["brightness"], options["initial"], options["tolerance"]) == (None, "pyramid", 1e-2)


def test_options_are_passed_to_the_correlator(folder: Path) -> None:
    image = fedic.synthetic.render(fedic.synthetic.Speckle(4.0), fedic.ImageFrame(), (48, 64))
    minimal = VALID[: VALID.index("[camera]")] + '[output]\nfolder = "out"\n'
    config = load(folder, minimal)
    assert isinstance(config.camera.build(), fedic.ImageFrame)
    fedic.Correlator(image, config.mesh.build(), config.camera.build(), **config.correlation.options())


@pytest.mark.parametrize(
    ("old", "new", "key", "message"),
    [
        ("tolerance", "tolerence", "correlation.tolerence", 'did you mean "tolerance"'),
        ("radial", "radail", "camera.distortion.radail", 'did you mean "radial"'),
        ("[output]", "[ouput]", "ouput", 'did you mean "output"'),
        ("focal", "zoom", "camera.zoom", "the keys here are model, focal"),
        ("size = 10", "size = -10", "mesh.rectangle.size", "= -10.* greater than 0"),
        ("1e-2", "nan", "correlation.tolerance", "= nan should be a finite number"),
        ("1e-2", '"small"', "correlation.tolerance", "= 'small' should be a valid number"),
        ("[100.0, 100.0]", "[100.0, 0.0]", "camera.focal[1]", "greater than 0"),
        ("[100.0, 100.0]", "[100.0]", "camera.focal[1]", "is missing"),
        ("focal = [100.0, 100.0]", "", "camera.focal", "is missing"),
        ('"pinhole"', '"pin-hole"', "camera.model", "choose one of image-frame, front-parallel, pinhole"),
        ('model = "pinhole"', "", "camera.model", "is missing; choose one of"),
        ("[[1, 0, 0], ", "[", "camera.rotation", "3 rows of 3 numbers"),
        (
            '"pyramid"',
            '"pyramids"',
            "correlation.initial",
            "'auto', 'zero', 'pyramid', 'fft', 'features', 'log-polar' or 'flow'",
        ),
        ("false", "0", "output.pictures", "should be a valid boolean"),
        (
            "pictures = false",
            'strain_measure = "log"',
            "output.strain_measure",
            "'green-lagrange', 'hencky' or 'small'",
        ),
        ('"frame-00.png"', "1", "images.reference", "should be the name of a file"),
        ('"frame-0[12].png"', "[]", "images.deformed", "at least 1 item"),
        ('"frame-0[12].png"', '"frame-9*.png"', "images.deformed", "matches none"),
        ('"frame-0[12].png"', '["frame-01.png", "frame-01.png"]', "images.deformed", "overwrite each other"),
        ("[mesh.rectangle]", '[mesh]\nfile = "m.msh"\n[mesh.rectangle]', "mesh", "exactly one of"),
    ],
)
def test_errors_name_the_key(folder: Path, old: str, new: str, key: str, message: str) -> None:
    assert old in VALID
    with pytest.raises(fedic.ConfigError, match=message) as caught:
        load(folder, VALID.replace(old, new))
    assert caught.value.key == key
    assert str(folder / "test.toml") in str(caught.value)
    assert key in str(caught.value)


def test_toml_syntax_errors_give_the_line(folder: Path) -> None:
    with pytest.raises(fedic.ConfigError, match="line 2"):
        load(folder, "[images]\nreference = = 3\n")


def test_missing_files_are_reported_on_loading(folder: Path) -> None:
    with pytest.raises(fedic.ConfigError, match="there is no such configuration file"):
        load_config(folder / "nothing.toml")
    with pytest.raises(fedic.ImageError, match=r"images\.reference names .*frame-07\.png"):
        load(folder, VALID.replace("frame-00", "frame-07"))
    rectangle = VALID[VALID.index("[mesh.rectangle]") : VALID.index("[camera]")]
    with pytest.raises(fedic.MeshError, match=r"mesh\.file names .*plate\.msh"):
        load(folder, VALID.replace(rectangle, '[mesh]\nfile = "plate.msh"\n'))


def test_a_part_of_a_mesh_file_is_chosen(folder: Path) -> None:
    rectangle = VALID[VALID.index("[mesh.rectangle]") : VALID.index("[camera]")]
    plate = fedic.rectangle_mesh((0, 0, 2, 1), 1.0).with_sets({"SKIN": fedic.MeshSet(cells=[1])})
    plate.write(folder / "plate.vtu")
    config = load(folder, VALID.replace(rectangle, '[mesh]\nfile = "plate.vtu#skin"\n'))
    assert config.mesh.build().num_cells == 1
    with pytest.raises(fedic.MeshError, match=r"mesh\.file names .*none\.vtu, which does not exist"):
        load(folder, VALID.replace(rectangle, '[mesh]\nfile = "none.vtu#skin"\n'))


def test_the_example_lists_every_key(repository: Path) -> None:
    text = (repository / "examples" / "openhole.toml").read_text()
    lines = {line.lstrip("# ").split(" = ")[0] for line in text.splitlines()}
    sections = {line.lstrip("# ") for line in text.splitlines()}

    def check(schema: dict, definitions: dict) -> None:
        for name, value in schema["properties"].items():
            options = [value, *value.get("anyOf", [])]
            options += [each for option in options for each in option.get("oneOf", [])]
            nested = [option["$ref"] for option in options if "$ref" in option]
            for reference in nested:
                check(definitions[reference.rsplit("/", 1)[1]], definitions)
            assert nested or name in lines, name

    schema = Config.model_json_schema()
    check(schema, schema["$defs"])
    assert {
        "[images]",
        "[mesh]",
        "[camera]",
        "[camera.distortion]",
        "[correlation]",
        "[series]",
        "[output]",
    } <= sections


def test_the_open_hole_camera_projects_to_the_reference_pixels(
    repository: Path, shared_data: Callable[[str], Path], shared_reference: Callable[[str], Path]
) -> None:
    shared_data("openhole")
    known = np.load(shared_reference("openhole_pyxel.npz"))
    config = load_config(repository / "examples" / "openhole.toml")
    pixels = config.camera.build().project(config.mesh.build().points)
    np.testing.assert_allclose(pixels, np.column_stack([known["u_px"], known["v_px"]]), rtol=0, atol=1e-6)
