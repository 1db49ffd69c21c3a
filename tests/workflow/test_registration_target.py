"""Registration from a calibration target that lies on the specimen."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.calibration import parse_target
from scenes.placed_plate import BARE, BLANK, BOARD, FRONT, MESH, PINHOLE, POINTS, SHAPE, errors, off
from scenes.plate import Plate, WithTarget, signs, wrong

PLACE = ((8.0, 8.0), 0.2)


@pytest.fixture(scope="module")
def image() -> NDArray[np.uint8]:
    scene: Any = WithTarget(Plate(0.02), parse_target(BOARD), *PLACE)
    return fedic.synthetic.render(scene, PINHOLE, SHAPE, noise=2.0)  # type: ignore[return-value]


class TestTarget:
    @pytest.mark.parametrize("sign", signs()[::5])
    def test_the_pose_is_recovered_from_a_target_at_a_known_place(
        self, image: NDArray[np.uint8], sign: tuple[int, ...]
    ) -> None:
        origin, angle = PLACE
        start = wrong(PINHOLE, sign)
        found = fedic.register(MESH, image, start, target=BOARD, target_origin=origin, target_angle=angle)
        assert off(found.camera, PINHOLE).max() < 0.15
        assert len(found.residuals) == 28
        assert np.all(np.abs(errors(found.camera, PINHOLE)) < 5.0 * np.array([*found.standard_deviations.values()]))

    def test_the_thickness_of_the_target_is_taken_into_account(self, image: NDArray[np.uint8]) -> None:
        origin, angle = PLACE
        kept: Any = {"target": BOARD, "target_origin": origin, "target_angle": angle}
        thin = fedic.register(MESH, image, PINHOLE, **kept).camera
        thick = fedic.register(MESH, image, PINHOLE, **kept, target_thickness=0.5).camera
        raised = np.column_stack([POINTS, np.full(len(POINTS), 0.5)])
        np.testing.assert_allclose(thick.project(raised), thin.project(POINTS), atol=1e-6)

    @pytest.mark.parametrize("sign", signs()[::5])
    def test_features_in_the_plane_of_the_target_fix_the_position(
        self, image: NDArray[np.uint8], sign: tuple[int, ...]
    ) -> None:
        found = fedic.register(MESH, image, wrong(PINHOLE, sign), target=BOARD, features=["hole 0", "right"])
        assert off(found.camera, PINHOLE).max() < 0.8
        # The target determines the plane: the tilt is as accurate as with the target alone.
        assert max(found.standard_deviations[name] for name in ("rx", "ry")) < 1e-3
        assert np.abs(errors(found.camera, PINHOLE)[:2]).max() < 2e-3
        away = np.linalg.norm(found.points[-7:, :2].mean(axis=0) - found.points[:7, :2].mean(axis=0))
        assert away == pytest.approx(6.0, rel=1e-9)

    def test_points_in_the_plane_of_the_target_fix_the_position(self, image: NDArray[np.uint8]) -> None:
        pair = POINTS[[0, 11]], PINHOLE.project(POINTS[[0, 11]])
        found = fedic.register(MESH, image, wrong(PINHOLE, (1, -1, -1, 1)), target=BOARD, points=pair)
        assert off(found.camera, PINHOLE).max() < 0.15

    @pytest.mark.parametrize(
        ("options", "error", "message"),
        [
            ({"target": "chessboard:9x6:2"}, fedic.ImageError, r"target chessboard:9x6:2 is not found in the image: "),
            ({"target": "chess:9x6:2"}, fedic.OptionError, "'chess' is unknown"),
            (
                {"target_origin": None},
                fedic.OptionError,
                r"the plane of the specimen only; give target_origin=\(x, y\)",
            ),
            ({"target_origin": (np.nan, 0)}, fedic.OptionError, "target_origin=nan: give .* both finite"),
            ({"target_origin": 3.0}, fedic.OptionError, r"target_origin=3.0: give \(x, y\)"),
            ({"target_origin": (1.0, 2.0, 3.0)}, fedic.OptionError, "target_origin=.* in the frame of the mesh"),
            ({"target_origin": ("1", 2.0)}, fedic.OptionError, "target_origin='1': give .* both finite"),
            ({"target_angle": "a"}, fedic.OptionError, "target_angle='a': give a finite angle in radians"),
            ({"target_thickness": None}, fedic.OptionError, "target_thickness=None: give a finite height"),
            ({"target": 7}, fedic.OptionError, "target is a int"),
            (
                {"target_origin": None, "target_angle": 0.1, "features": ["hole 0"]},
                fedic.OptionError,
                "target_angle is given without target_origin.* add target_origin",
            ),
            ({"target_thickness": np.inf}, fedic.OptionError, "target_thickness=inf: give a finite height"),
            ({"camera": FRONT}, fedic.OptionError, "needs a calibrated Pinhole, not a FrontParallel"),
            ({"camera": BARE}, fedic.CameraError, "read in two directions, and the given pose.* give a rough pose"),
            (
                {"target_origin": None, "features": ["hole 0", "right"], "free": ["tx", "ty"]},
                fedic.OptionError,
                "needs all of rx ry rz tx ty tz to be free",
            ),
        ],
    )
    def test_bad_target_options_are_refused(
        self, image: NDArray[np.uint8], options: dict[str, Any], error: type[Exception], message: str
    ) -> None:
        given: dict[str, Any] = {"camera": PINHOLE, "target": BOARD, "target_origin": (8.0, 8.0), **options}
        with pytest.raises(error, match=message):
            fedic.register(MESH, image, **given)

    @pytest.mark.parametrize(
        "options",
        [
            {"target_origin": 3.0},
            {"target_origin": None},
            {"target_angle": np.nan},
            {"target_thickness": "thick"},
            {"search": "far"},
        ],
        ids=repr,
    )
    def test_bad_options_are_refused_before_the_search(
        self, options: dict[str, Any], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr("fedic.registration._target.find_target", lambda *_: pytest.fail("the search was begun"))
        given: dict[str, Any] = {"target": BOARD, "target_origin": (8.0, 8.0), **options}
        with pytest.raises(fedic.OptionError):
            fedic.register(MESH, BLANK, PINHOLE, **given)

    def test_a_wrong_focal_length_is_refused(self, image: NDArray[np.uint8]) -> None:
        other = fedic.Pinhole((900, 500), (300, 200), PINHOLE.rotation, PINHOLE.translation)
        with pytest.raises(fedic.ImageError, match=r"fits its points to less than .* px: .* another calibration"):
            fedic.register(MESH, image, other, target=BOARD, target_origin=(8.0, 8.0))
