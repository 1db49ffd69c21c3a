"""Calibration on the specimen: the scene of the paper, Monte Carlo, undetermined parameters, errors."""

import time
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import fedic
from fedic.demo.scene import HEIGHT, LEVELS, MILLIMETRES, PRINCIPAL_POINT, RADIAL, SPECKLE, WIDTH, Scene
from fedic.experiments import Request, run_experiment
from fedic.experiments.lens_errors import measure
from fedic.experiments.option_sets import DEFAULT
from fedic.starts.fft import rigid_translation
from interruption import interrupt, read_line, script

SHAPE = (180, 240)
FOCAL, K1, CENTRE = 600.0, -0.2, (125.0, 86.0)
MOTIONS = ((70.0, -20.0), (-45.0, 50.0), (10.0, -60.0))


def small_camera(k1: float | None = K1, centre: tuple[float, float] = CENTRE) -> fedic.Pinhole:
    """Return a camera in whose world frame one unit is one pixel."""
    lens = None if k1 is None else fedic.BrownDistortion((k1, 0.0, 0.0))
    return fedic.Pinhole((FOCAL, FOCAL), centre, np.diag([1.0, -1.0, -1.0]), (0.0, 0.0, FOCAL), distortion=lens)


START = small_camera(None, (119.5, 89.5))


def specimen(size: float = 24.0, shape: tuple[int, int] = SHAPE, camera: fedic.Pinhole = START) -> fedic.Mesh:
    """Return a mesh of the region the camera sees."""
    pixels = fedic.rectangle_mesh((1.0, 1.0, shape[1] - 2.0, shape[0] - 2.0), size)
    return fedic.Mesh(camera.unproject(pixels.points)[:, :2], pixels.cells)


@pytest.fixture(scope="module")
def frames() -> list[NDArray[np.float32]]:
    """Return float images without noise of the small specimen at rest and after its motions."""
    texture = fedic.synthetic.Speckle(5.0, seed=3)
    render = fedic.synthetic.render
    return [
        render(texture, small_camera(), SHAPE, displacement=motion, levels=LEVELS, bits=16).astype(np.float32) / 257.0
        for motion in (None, *MOTIONS)
    ]


@pytest.fixture(scope="module")
def scene_images() -> list[Any]:
    """Return 8-bit images of the paper's scene at rest and after three translations of up to 400 px."""
    texture = fedic.synthetic.Speckle(SPECKLE * MILLIMETRES, seed=0)
    motions = (None, (-400.0, -200.0), (300.0, -250.0), (50.0, 400.0))
    world = [None if m is None else (m[0] * MILLIMETRES, -m[1] * MILLIMETRES) for m in motions]
    return [
        fedic.synthetic.render(texture, Scene().camera, (HEIGHT, WIDTH), displacement=m, levels=LEVELS, supersampling=2)
        for m in world
    ]


def test_the_lens_found_on_the_specimen_improves_the_next_measurement(scene_images: list[Any]) -> None:
    """k1 within 1 %; displacement error at most 0.003 px, 0.017 px if the lens is ignored."""
    scene = Scene()
    true = scene.camera
    centre = ((WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    start = fedic.Pinhole(true.focal, centre, true.rotation, true.translation)
    mesh = specimen(40.0, (HEIGHT, WIDTH), start)
    found = fedic.calibrate_on_specimen(scene_images[0], scene_images[1:], mesh, start)
    assert found.converged
    assert found.advice == []
    assert found.camera.distortion is not None
    assert found.camera.distortion.radial[0] == pytest.approx(RADIAL[0], rel=1e-3)
    assert_allclose(found.camera.principal_point, PRINCIPAL_POINT, rtol=0, atol=0.2)
    assert found.noise == pytest.approx(1 / np.sqrt(12), rel=0.05)
    errors = np.array(
        [found.camera.distortion.radial[0] - RADIAL[0], *(found.camera.principal_point - np.array(PRINCIPAL_POINT))]
    )
    assert (np.abs(errors) < 3.0 * np.array(list(found.standard_deviations.values()))).all()
    alone = fedic.calibrate_on_specimen(scene_images[0], scene_images[1:], mesh, start, ("k1",))
    assert alone.camera.distortion is not None
    assert alone.camera.distortion.radial[0] == pytest.approx(RADIAL[0], rel=0.01)

    # Another specimen, moved by (400, 200) px: the measurement of Fig. 14 and 16.
    pair = scene.pair(seed=7).rounded()
    pixels = fedic.rectangle_mesh(scene.window, 20.0)
    ignored = measure(scene, pair, pixels, DEFAULT, DEFAULT.quadrature("pixel"), lens=False)
    assert ignored.bias[0] == pytest.approx(0.017, abs=0.001)
    for camera in (found.camera, alone.camera):
        plane = fedic.Mesh(camera.unproject(pixels.points)[:, :2], pixels.cells)
        result = fedic.correlate(pair.reference, pair.deformed, plane, camera, initial="fft")
        error = (result.displacement - scene.motion) / MILLIMETRES
        assert np.abs(error.mean(axis=0)).max() < 0.003
        assert error.std(axis=0).max() < 0.003


@pytest.mark.parametrize(
    ("options", "noise", "draws"),
    [
        ({}, 2.0, 40),
        ({"smoothing": 0.0}, 2.0, 25),
        ({"density": 0.3}, 4.0, 25),
        ({"motion": "spatial"}, 2.0, 25),
        ({"images": 1, "motion": "translation"}, 2.0, 25),
    ],
)
def test_standard_deviations_agree_with_repeated_calibrations(
    frames: list[NDArray[np.float32]], options: dict[str, Any], noise: float, draws: int
) -> None:
    options = dict(options)
    count = options.pop("images", len(MOTIONS))
    mesh, scores, deviations, noises = specimen(), [], [], []
    for draw in range(draws):
        noisy = [
            fedic.synthetic.add_noise(frame, noise=noise, seed=100 * draw + k)
            for k, frame in enumerate(frames[: count + 1])
        ]
        found = fedic.calibrate_on_specimen(noisy[0], noisy[1:], mesh, START, **options)
        assert found.converged
        assert found.camera.distortion is not None
        error = np.array([found.camera.distortion.radial[0], *found.camera.principal_point]) - (K1, *CENTRE)
        deviations.append([found.standard_deviations[name] for name in ("k1", "cx", "cy")])
        scores.append(error / deviations[-1])
        noises.append(found.noise)
    assert (np.abs(scores) < 3.0).mean(axis=0).min() >= 0.95
    # The sample standard deviation of 40 draws is accurate to 11 %, of 25 draws to 14 %.
    assert_allclose(np.std(scores, axis=0), 1.0, atol=0.3)
    assert np.mean(noises) == pytest.approx(noise, rel=0.05)


def test_motions_lie_within_their_standard_deviations(frames: list[NDArray[np.float32]]) -> None:
    noisy = [fedic.synthetic.add_noise(frame, noise=2.0, seed=k) for k, frame in enumerate(frames)]
    found = fedic.calibrate_on_specimen(noisy[0], noisy[1:], specimen(), START)
    assert found.motions.shape == found.motion_standard_deviations.shape == (3, 6)
    held = [2, 3, 4]
    assert (found.motions[:, held] == 0.0).all()
    assert (found.motion_standard_deviations[:, held] == 0.0).all()
    # Scale and rotation in the plane are known from the start, whose focal length and pose are true.
    errors = found.motions[:, [0, 1, 5]] - np.column_stack([MOTIONS, np.zeros(3)])
    assert (np.abs(errors) < 4.0 * found.motion_standard_deviations[:, [0, 1, 5]]).all()


def test_out_of_plane_motions_are_found() -> None:
    """A motion along Z by 1/300 of the distance, which magnifies the image by as much."""
    texture = fedic.synthetic.Speckle(5.0, seed=5)
    heights = (0.0, 2.0, -1.0)
    images = [
        fedic.synthetic.render(texture, small_camera(), SHAPE, displacement=motion, z=z, levels=LEVELS)
        for motion, z in zip((None, *MOTIONS[:2]), heights, strict=True)
    ]
    spatial = fedic.calibrate_on_specimen(images[0], images[1:], specimen(), START, motion="spatial")
    assert_allclose(spatial.motions[:, 2], heights[1:], rtol=0, atol=0.02)
    assert spatial.camera.distortion is not None
    assert spatial.camera.distortion.radial[0] == pytest.approx(K1, rel=0.01)
    flat = fedic.calibrate_on_specimen(images[0], images[1:], specimen(), START)
    assert flat.residual_rms > 2.0 * spatial.residual_rms


def test_the_tilt_of_the_camera_is_found() -> None:
    """A camera tilted by more than one degree with a known principal point."""
    turns = np.array([0.02, -0.03])
    start = small_camera(None, CENTRE)
    tilt = fedic.Pinhole((1.0, 1.0), (0.0, 0.0), rotation=[*turns, 0.0]).rotation
    lens = fedic.BrownDistortion((K1, 0.0, 0.0))
    camera = fedic.Pinhole(start.focal, CENTRE, tilt @ start.rotation, start.translation, distortion=lens)
    texture = fedic.synthetic.Speckle(5.0, seed=9)
    images = [
        fedic.synthetic.render(texture, camera, SHAPE, displacement=motion, levels=LEVELS)
        for motion in (None, *MOTIONS)
    ]
    found = fedic.calibrate_on_specimen(images[0], images[1:], specimen(), start, ("k1", "rx", "ry"))
    assert found.converged
    # The rotation is exp(d) times that of the start: d is read off the remaining rotation.
    left = tilt.T @ found.camera.rotation @ start.rotation.T
    deviations = [found.standard_deviations[name] for name in ("rx", "ry")]
    assert (np.abs([left[2, 1], left[0, 2]]) < 4.0 * np.array(deviations)).all()
    assert max(deviations) < 1e-4


def test_brightness_changes_are_corrected(frames: list[NDArray[np.float32]]) -> None:
    darker = [frames[0], 0.8 * frames[1] + 5.0, *frames[2:]]
    found = fedic.calibrate_on_specimen(darker[0], darker[1:], specimen(), START)
    same = fedic.calibrate_on_specimen(frames[0], frames[1:], specimen(), START, gain_and_offset=False)
    assert_allclose(found.camera.principal_point, same.camera.principal_point, rtol=0, atol=0.01)
    ignored = fedic.calibrate_on_specimen(darker[0], darker[1:], specimen(), START, gain_and_offset=False)
    assert ignored.residual_rms > 5.0 * found.residual_rms


def test_a_specimen_larger_than_the_image_improves_the_calibration(frames: list[NDArray[np.float32]]) -> None:
    wide = fedic.rectangle_mesh((-260.0, -220.0, 260.0, 220.0), 20.0)
    larger = fedic.calibrate_on_specimen(frames[0], frames[1:], wide, START, noise=2.0)
    inner = fedic.calibrate_on_specimen(frames[0], frames[1:], specimen(), START, noise=2.0)
    assert_allclose(larger.camera.principal_point, inner.camera.principal_point, rtol=0, atol=0.05)
    # Parts that only the moved images show add information.
    assert larger.standard_deviations["k1"] < 0.99 * inner.standard_deviations["k1"]


def test_results_do_not_depend_on_the_number_of_threads(frames: list[NDArray[np.float32]]) -> None:
    found = [fedic.calibrate_on_specimen(frames[0], frames[1:], specimen(), START, num_threads=n) for n in (1, 2, 4)]
    for other in found[1:]:
        assert other.camera == found[0].camera
        assert other.covariance.tobytes() == found[0].covariance.tobytes()
        assert other.motions.tobytes() == found[0].motions.tobytes()
        assert other.history == found[0].history


@pytest.mark.parametrize("motion", [(-400.0, -200.0), (500.0, 300.0), (0.0, -450.0)])
def test_motions_of_half_the_image_are_found(motion: tuple[float, float]) -> None:
    texture = fedic.synthetic.Speckle(6.0, seed=1)
    camera = fedic.FrontParallel(0.5, (300.0, 250.0))
    world = (2.0 * motion[0] * 0.7, -2.0 * motion[1] * 0.7)
    images = [fedic.synthetic.render(texture, camera, (700, 900), displacement=m) for m in (None, world)]
    mesh = fedic.rectangle_mesh((-600.0, -900.0, 1200.0, 500.0), 100.0)
    assert_allclose(rigid_translation(images[0], images[1], mesh, camera), world, rtol=0, atol=1.0)


def test_a_rotated_specimen_and_a_strong_lens_are_found_from_a_rough_start() -> None:
    camera = small_camera(-0.9)
    texture = fedic.synthetic.Speckle(5.0, seed=6)
    turn = np.deg2rad(1.5)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]) - np.eye(2)

    def turned(points: NDArray[np.float64]) -> NDArray[np.float64]:
        moved: NDArray[np.float64] = points @ matrix.T + (55.0, -35.0)
        return moved

    motions: tuple[Any, ...] = (None, turned, (-60.0, 40.0))
    images = [fedic.synthetic.render(texture, camera, SHAPE, displacement=m, levels=LEVELS) for m in motions]
    found = fedic.calibrate_on_specimen(images[0], images[1:], specimen(), START)
    assert found.converged
    assert found.camera.distortion is not None
    assert found.camera.distortion.radial[0] == pytest.approx(-0.9, rel=0.01)
    assert found.motions[0, 5] == pytest.approx(turn, abs=1e-4)


def test_advice_names_undetermined_parameters(frames: list[NDArray[np.float32]]) -> None:
    mesh, noisy = specimen(), [fedic.synthetic.add_noise(frame, noise=2.0, seed=k) for k, frame in enumerate(frames)]
    many = fedic.calibrate_on_specimen(noisy[0], noisy[1:], mesh, START, ("k1", "k2", "k3"))
    assert any("k2 and k3 are correlated by -0.9" in sentence for sentence in many.advice)
    assert any("is zero within its standard deviation" in sentence for sentence in many.advice)
    line = fedic.calibrate_on_specimen(noisy[0], noisy[1:2], mesh, START, ("k1",))
    assert line.advice == ["All motions lie along one line: move the specimen in a second direction too."]
    hasty = fedic.calibrate_on_specimen(noisy[0], noisy[1:], mesh, START, max_iterations=1)
    assert not hasty.converged
    assert hasty.advice[0].startswith("The iterations did not converge")
    near = [
        fedic.synthetic.render(fedic.synthetic.Speckle(5.0, seed=3), small_camera(), SHAPE, displacement=m, noise=16.0)
        for m in (None, (4.0, 0.0), (0.0, 4.0))
    ]
    little = fedic.calibrate_on_specimen(near[0], near[1:], mesh, START)
    assert any(sentence.startswith("The specimen moves by 4 px at most, 2% of") for sentence in little.advice)
    assert any(sentence.startswith("cx is known to") for sentence in little.advice)


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"images": []}, fedic.OptionError, "images is empty; give at least one"),
        ({"images": np.zeros((180, 240), np.uint8)}, fedic.OptionError, "images is a single image; give a list"),
        ({"images": [np.zeros((90, 90), np.uint8)]}, fedic.ImageError, r"images\[0\] has shape \(90, 90\) and the ref"),
        ({"images": ["a.png"]}, fedic.ImageError, r"moved \(images\[0\]\) image is a str"),
        ({"camera": fedic.FrontParallel(1.0)}, fedic.OptionError, "FrontParallel has no parameters .* give a Pinhole"),
        ({"parameters": ("k1", "k9")}, fedic.OptionError, 'no camera has a parameter "k9": choose among fx'),
        ({"parameters": "k1"}, fedic.OptionError, "give a sequence"),
        ({"parameters": ()}, fedic.OptionError, "name each unknown camera parameter once: got none"),
        ({"parameters": ("k1", "k1")}, fedic.OptionError, "k1 is named twice"),
        ({"parameters": ("k1", "fx", "fy")}, fedic.SolveError, "fix fx, fy and tz, or give the true translations"),
        ({"parameters": ("k1", "cx", "d2")}, fedic.SolveError, "do not tell cx, d2 apart"),
        ({"parameters": ("tx",)}, fedic.SolveError, "no image shows where the specimen is in its plane"),
        ({"motion": "any"}, fedic.OptionError, """motion must be "translation", "in-plane" or "spatial", got 'any'"""),
        ({"translations": [(0, 0)]}, fedic.OptionError, r"each of the 3 images, shape \(3, 2\); got shape \(1, 2\)"),
        ({"known_translations": True}, fedic.OptionError, "known_translations needs the translations"),
        ({"noise": -1.0}, fedic.OptionError, "noise must be zero or a positive"),
        ({"mesh": "mesh"}, fedic.OptionError, "mesh must be a fedic.Mesh"),
    ],
)
def test_bad_input_is_refused(
    frames: list[NDArray[np.float32]], change: dict[str, Any], error: type[fedic.FedicError], message: str
) -> None:
    given: dict[str, Any] = {"images": frames[1:], "mesh": specimen(), "camera": START, **change}
    images, mesh, camera = given.pop("images"), given.pop("mesh"), given.pop("camera")
    with pytest.raises(error, match=message):
        fedic.calibrate_on_specimen(frames[0], images, mesh, camera, **given)


def test_a_specimen_at_rest_and_another_specimen_are_refused(frames: list[NDArray[np.float32]]) -> None:
    still = [fedic.synthetic.add_noise(frames[0], noise=2.0, seed=k) for k in range(3)]
    with pytest.raises(fedic.SolveError, match=r"moves by no more than 0\.\d+ pixels .* at least two directions"):
        fedic.calibrate_on_specimen(still[0], still[1:], specimen(), START)
    other = fedic.synthetic.render(fedic.synthetic.Speckle(5.0, seed=77), small_camera(), SHAPE, levels=LEVELS)
    with pytest.raises(fedic.SolveError, match=r"moved image number 2 .* does not match the others"):
        fedic.calibrate_on_specimen(frames[0], [frames[1], other], specimen(), START, ("k1",))


def test_the_quick_experiment_holds_its_claims() -> None:
    outcome = run_experiment("specimen", Request(quick=True))
    assert {claim.text: claim.measured for claim in outcome.claims if not claim.holds} == {}
    assert outcome.figures[""].axes
    assert [row["noise_found"] for row in outcome.rows] == pytest.approx([1 / np.sqrt(12), 2.02], rel=0.02)
    assert all(row["converged"] for row in outcome.rows)


def test_ctrl_c_stops_a_calibration_within_two_processor_seconds() -> None:
    child = """
        import numpy as np, fedic
        spots = np.random.default_rng(0).integers(0, 255, (400, 400), dtype=np.uint8)
        image = np.kron(spots, np.ones((5, 5), np.uint8))
        moved = np.roll(image, 30, axis=(0, 1))
        camera = fedic.Pinhole((2000, 2000), (1000, 1000), translation=(0, 0, 2000))
        mesh = fedic.rectangle_mesh((-900, -900, 900, 900), 1800)
        print("ready", flush=True)
        try:
            fedic.calibrate_on_specimen(image, [moved], mesh, camera, ('k1',), translations=[(30, 30)], density=100.0)
            print("finished", flush=True)
        except KeyboardInterrupt:
            print(seconds_since_signal(), flush=True)
    """
    with script(child) as process:
        assert read_line(process) == "ready"
        time.sleep(1.0)  # most likely in compiled code by now
        interrupt(process)
        assert float(read_line(process)) < 2.0
        assert process.wait() == 0
