"""Registration from point pairs: exact points, free parameters, standard deviations by Monte Carlo."""

from typing import Any

import numpy as np
import pytest

import fedic
from fedic.registration import _steps as steps
from fedic.registration._pose import move, pose_jacobian
from scenes.placed_plate import BARE, BLANK, CAMERAS, FRONT, LENS, MESH, PINHOLE, POINTS, SHAPE, errors, off
from scenes.plate import signs, wrong


@pytest.mark.parametrize("name", CAMERAS)
def test_the_pose_jacobian_agrees_with_finite_differences(name: str) -> None:
    camera = CAMERAS[name]
    names = ("u0", "v0", "angle", "scale") if name == "front" else ("rx", "ry", "rz", "tx", "ty", "tz")
    points = np.column_stack([POINTS, 0.1 * POINTS[:, 0]])
    exact = pose_jacobian(camera, points, names)
    for index in range(len(names)):
        step = np.zeros(len(names))
        step[index] = 1e-5
        ahead, behind = (move(camera, names, sign * step).project(points) for sign in (1.0, -1.0))
        np.testing.assert_allclose((ahead - behind) / 2e-5, exact[:, :, index], rtol=0, atol=1e-5)


@pytest.mark.parametrize("sign", signs()[::5])
def test_exact_points_recover_the_pose(sign: tuple[int, ...]) -> None:
    for camera in CAMERAS.values():
        found = fedic.register(MESH, BLANK, wrong(camera, sign), points=(POINTS, camera.project(POINTS)))
        np.testing.assert_allclose(off(found.camera, camera), 0.0, atol=1e-8)
        assert np.abs(found.residuals).max() < 1e-8
        np.testing.assert_array_equal(found.points[:, :2], POINTS)


def test_four_coplanar_points_need_no_start_and_three_need_one() -> None:
    pixels = PINHOLE.project(POINTS)
    some = [0, 2, 9, 11]
    found = fedic.register(MESH, BLANK, BARE, points=(POINTS[some], pixels[some]))
    np.testing.assert_allclose(off(found.camera, PINHOLE), 0.0, atol=1e-7)
    start = wrong(PINHOLE, (1, 1, 1, 1))
    exact = fedic.register(MESH, BLANK, start, points=(POINTS[some[:3]], pixels[some[:3]]))
    np.testing.assert_allclose(off(exact.camera, PINHOLE), 0.0, atol=1e-6)
    assert np.isnan(exact.covariance).all()  # no residual is left to estimate the noise
    known = fedic.register(MESH, BLANK, start, points=(POINTS[some[:3]], pixels[some[:3]]), pixel_noise=0.05)
    assert np.isfinite(known.covariance).all()


def behind(camera: fedic.Pinhole) -> fedic.Pinhole:
    tx, ty, tz = camera.translation
    return fedic.Pinhole(camera.focal, camera.principal_point, camera.rotation, (tx, ty, -tz), distortion=LENS)


@pytest.mark.parametrize("place", [0, 1])
def test_a_failed_candidate_pose_does_not_discard_the_other(place: int, monkeypatch: pytest.MonkeyPatch) -> None:
    pairs = POINTS, PINHOLE.project(POINTS)
    poses = [wrong(PINHOLE, (1, 1, 1, 1))]
    poses.insert(place, behind(PINHOLE))
    monkeypatch.setattr(steps, "pinhole_from_pairs", lambda *_: poses)
    found = fedic.register(MESH, BLANK, BARE, points=pairs)
    np.testing.assert_allclose(off(found.camera, PINHOLE), 0.0, atol=1e-7)

    def failing(start: Any, problem: Any) -> Any:
        if start.camera is poses[0]:
            raise fedic.SolveError("no pose from this start")
        return fit_pairs(start, problem)

    fit_pairs = steps.fit_pairs
    poses[:] = [PINHOLE, wrong(PINHOLE, (1, -1, 1, 1))]
    poses[:] = poses[:: -1 if place else 1]
    monkeypatch.setattr(steps, "fit_pairs", failing)
    found = fedic.register(MESH, BLANK, BARE, points=pairs)
    np.testing.assert_allclose(off(found.camera, PINHOLE), 0.0, atol=1e-7)

    poses[:] = [behind(PINHOLE)] * 2
    with pytest.raises(fedic.CameraError, match="does not see all points"):
        fedic.register(MESH, BLANK, BARE, points=pairs)


def test_parameters_not_free_keep_their_values() -> None:
    pixels = FRONT.project(POINTS)
    start = fedic.FrontParallel(8.0, (50.0, 280.0), 0.0)
    found = fedic.register(MESH, BLANK, start, points=(POINTS, pixels), free=["angle", "u0", "v0"])
    assert found.free == ("u0", "v0", "angle")
    assert found.camera.scale == 8.0  # type: ignore[union-attr]
    np.testing.assert_allclose(off(found.camera, FRONT), 0.0, atol=1e-8)
    start = wrong(PINHOLE, (1, -1, 1, -1))  # type: ignore[assignment]
    found = fedic.register(MESH, BLANK, start, points=(POINTS, PINHOLE.project(POINTS)), free=["rz", "tx", "ty", "tz"])
    np.testing.assert_allclose(off(found.camera, PINHOLE), 0.0, atol=1e-7)


@pytest.mark.parametrize("known", [None, 0.3])
@pytest.mark.parametrize("name", CAMERAS)
def test_standard_deviations_from_points_agree_with_monte_carlo(name: str, known: float | None) -> None:
    camera, rng = CAMERAS[name], np.random.default_rng(5)
    ratios = []
    for _ in range(100):
        seen = camera.project(POINTS) + rng.normal(0.0, 0.3, (len(POINTS), 2))
        seen = np.clip(seen, 0.0, np.array(SHAPE[::-1]) - 1.0)
        found = fedic.register(MESH, BLANK, camera, points=(POINTS, seen), pixel_noise=known)
        ratios.append(errors(found.camera, camera) / list(found.standard_deviations.values()))
    scores = np.array(ratios)
    assert (np.abs(scores) < 3.0).sum(axis=0).min() >= 95
    assert np.all(np.abs(scores.std(axis=0) - 1.0) < 0.25)
