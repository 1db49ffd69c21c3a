"""Campaigns: starts from earlier frames, frames that fail, updates of the reference image, and what is read back."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import fedic
from fedic.campaign import load_config
from fedic.campaign.tracking.prediction import KnownFrame, extrapolated, filled
from fedic.starts.motion import moved
from scenes.damaged_plate import damaged
from scenes.moved_plate import motion, pair
from scenes.series import MESH, STEP, frame, frames, write_frames


def run(*arguments: Any, **options: Any) -> fedic.Campaign:
    campaign = fedic.Campaign(*arguments, **options)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fedic.QualityWarning)
        return campaign.run(progress=False)


def error(result: fedic.Result, number: float) -> float:
    """Root mean square of the error of the measured nodes, in pixels."""
    difference = result.displacement - np.multiply(STEP, number)
    return float(np.sqrt(np.nanmean((difference**2).sum(axis=1))))


def starts(campaign: fedic.Campaign) -> list[str]:
    return [record.start for record in campaign.frames]


def test_each_frame_starts_from_the_extrapolated_displacement() -> None:
    campaign = run(frame(0), frames(5), MESH)
    assert len(campaign) == 5
    assert starts(campaign)[1:] == ["given"] * 4
    for index, record in enumerate(campaign.frames):
        assert record.index == index
        assert record.good
        assert error(campaign[index], index + 1) < 0.016
    # Motion of the same size in each frame is foreseen.
    assert campaign.frames[4].iterations <= campaign.frames[1].iterations


@pytest.mark.parametrize("mode", ["extrapolated", "previous", "independent"])
def test_the_result_does_not_depend_on_the_start(mode: Any) -> None:
    campaign = run(frame(0), frames(3), MESH, starts=mode)
    single = fedic.Correlator(frame(0), MESH)
    for index in range(3):
        alone = single.correlate(frame(index + 1))
        np.testing.assert_allclose(campaign[index].displacement, alone.displacement, atol=5e-5)
    if mode == "independent":
        assert "given" not in starts(campaign)
        np.testing.assert_array_equal(campaign[2].displacement, alone.displacement)


def test_a_jump_is_measured_from_another_start() -> None:
    """The motion foreseen is wrong by 12 pixels, three times the speckle."""
    images = [*frames(3), frame(18), frame(19)]
    campaign = run(frame(0), images, MESH)
    assert starts(campaign)[3] != "given"
    for index, number in enumerate((1, 2, 3, 18, 19)):
        assert error(campaign[index], number) < 0.016, index


def test_frames_that_fail_are_named_and_the_others_measured(tmp_path: Path) -> None:
    files = write_frames(tmp_path, 6)
    intact = run(files[0], files[1:], MESH)
    files[2].write_bytes(files[2].read_bytes()[:3000])
    files[4].unlink()
    black = np.zeros_like(frame(0))
    entries: list[Any] = [*files[1:], black, frame(0)[:-5]]
    campaign = fedic.Campaign(files[0], entries, MESH)
    with pytest.warns(fedic.QualityWarning, match="4 of 8 frames could not be measured, the first being frame_002"):
        campaign.run(progress=False)
    errors = [record.error for record in campaign.frames]
    assert [bool(each) for each in errors] == [False, True, False, True, False, False, True, True]
    assert "truncated or damaged" in errors[1]
    assert "there is no such image file" in errors[3]
    assert "nothing can be measured without a texture" in errors[6]
    assert "144 x 139 px" in errors[7]
    for index in (0, 2, 4, 5):
        np.testing.assert_allclose(campaign[index].displacement, intact[index].displacement, atol=1e-3)
    with pytest.raises(fedic.FedicError, match=r"frame 3 \(frame_004\) was not measured: .*no such image file"):
        campaign[3]
    assert len(list(campaign)) == 4


def test_a_frame_that_does_not_converge_starts_no_other_one() -> None:
    campaign = run(frame(0), [frame(1), frame(2), frame(3, seed=7), frame(4)], MESH)
    assert not campaign.frames[2].good
    assert campaign.frames[3].start == "given"
    assert error(campaign[3], 4) < 0.016


def test_the_extrapolation_counts_frames_and_is_limited() -> None:
    ones = np.ones((MESH.num_nodes, 2))
    known = [KnownFrame(1, ones, 1.0, 0.0), KnownFrame(3, 2 * ones, 1.0, 0.0)]
    np.testing.assert_allclose(extrapolated(known, 4), 2.5 * ones)
    np.testing.assert_allclose(extrapolated(known, 5), 3.0 * ones)
    np.testing.assert_allclose(extrapolated(known, 50), 4.0 * ones)
    np.testing.assert_allclose(extrapolated(known[1:], 5), 2.0 * ones)


def test_what_was_not_measured_is_filled_smoothly() -> None:
    x, y = MESH.points[:, 0], MESH.points[:, 1]
    affine = np.column_stack([0.3 + 0.01 * x - 0.02 * y, -1.0 + 0.03 * y])
    hidden = (x > 60) & (y > 50)
    np.testing.assert_allclose(filled(MESH, np.where(hidden[:, None], np.nan, affine)), affine, atol=1e-12)
    wave = affine + 0.2 * np.sin(0.05 * x)[:, None]
    patch = (abs(x - 72) < 20) & (abs(y - 72) < 20)
    found = filled(MESH, np.where(patch[:, None], np.nan, wave))
    np.testing.assert_array_equal(found[~patch], wave[~patch])
    assert abs(found - wave).max() < 0.1
    assert not filled(MESH, np.full_like(affine, np.nan)).any()


def test_displacements_through_later_reference_images_are_counted_from_the_first_mesh() -> None:
    first = run(frame(0), frames(6), MESH)
    chained = run(frame(0), frames(6), MESH, reference_update="previous")
    assert [record.reference for record in chained.frames] == [-1, 0, 1, 2, 3, 4]
    direct, last = error(first[5], 6), error(chained[5], 6)
    assert last < 1.05 * direct
    np.testing.assert_allclose(chained[5].pixel_displacement, chained[5].displacement, atol=1e-6)
    drift = chained.drift(5)
    assert drift is not None
    np.testing.assert_allclose(drift, chained[5].displacement - first[5].displacement, atol=5e-5)
    assert first.drift(5) is None
    first_drift = chained.drift(0)
    assert first_drift is not None
    assert np.isnan(first_drift).all()
    # The deviations are those of the noise of the first and the last image.
    deviations = [campaign[5].standard_deviations(1.0) for campaign in (first, chained)]
    np.testing.assert_allclose(deviations[1], deviations[0], rtol=0.03)


def ageing(number: int, last: int) -> NDArray[np.uint8]:
    """Return a frame whose speckle turns into another one."""
    share = number / last
    blend = (1.0 - share) * frame(number).astype(float) + share * frame(number, seed=9)
    return np.rint(blend).astype(np.uint8)


def test_the_reference_is_updated_where_the_direct_measurement_fails() -> None:
    images = [ageing(number, 10) for number in range(1, 11)]
    direct = run(frame(0), images, MESH)
    updated = run(frame(0), images, MESH, reference_update="auto")
    good = [record.converged and direct[record.index].quality.flagged_share < 0.05 for record in direct.frames]
    references = [record.reference for record in updated.frames]
    first_failure = good.index(False)
    assert references[:first_failure] == [-1] * first_failure
    assert references[first_failure] == first_failure - 1
    assert all(record.converged for record in updated.frames)
    assert all(updated[index].valid_nodes.all() for index in range(10))
    assert not direct[9].valid_nodes.any()
    # Where the direct measurement is possible the reference is never updated.
    assert {record.reference for record in run(frame(0), frames(4), MESH, reference_update="auto").frames} == {-1}


@pytest.fixture(scope="module")
def stretched() -> tuple[list[NDArray[np.uint8]], list[NDArray[np.float64]]]:
    """Images of a plate stretched by up to 70 % and turned by up to 40 degrees, and the matrices of the motion."""
    side, count = 260, 14
    matrices = [
        motion(40.0 * share, (1.0 - 0.21 * share, 1.0 + 0.7 * share), (10.0 * share, -6.0 * share), side=side)
        for share in np.arange(1, count + 1) / count
    ]
    pairs = [pair(matrix, side=side, noise=2.0) for matrix in matrices]
    return [pairs[0][0], *(deformed for _, deformed in pairs)], matrices


@pytest.mark.parametrize("mode", ["first", "previous", "auto"])
def test_a_long_series_of_large_strain_converges(stretched: Any, mode: Any) -> None:
    images, matrices = stretched
    mesh = fedic.rectangle_mesh((90.0, 90.0, 170.0, 170.0), 20.0)
    campaign = run(images[0], images[1:], mesh, reference_update=mode)
    assert all(record.converged for record in campaign.frames)
    references = [record.reference for record in campaign.frames]
    assert references == (list(range(-1, 13)) if mode == "previous" else [-1] * 14)
    points = mesh.points[:, :2]
    errors = [
        float(np.sqrt(((result.displacement - (moved(matrix, points) - points)) ** 2).sum(axis=1).mean()))
        for result, matrix in zip(campaign, matrices, strict=True)
    ]
    assert max(errors) < (0.037 if mode == "previous" else 0.035), errors


def test_updates_on_the_open_hole_agree_with_the_direct_measurement(
    repository: Path, shared_data: Callable[[str], Path]
) -> None:
    """Five frames to a strain of 19 % beside the hole."""
    shared_data("openhole")
    config = load_config(repository / "examples" / "openhole.toml")
    images = (config.images.reference, config.images.deformed)
    mesh, camera = config.mesh.build(), config.camera.build()
    direct, updated = (run(*images, mesh, camera, reference_update=mode) for mode in ("first", "previous"))
    assert [record.reference for record in updated.frames] == [-1, 0, 1, 2, 3]
    difference = np.linalg.norm(updated[4].pixel_displacement - direct[4].pixel_displacement, axis=1)
    assert np.nanmedian(difference) < 0.0012
    assert np.nanpercentile(difference, 95) < 0.007


@pytest.mark.parametrize("kind", ["chips", "crack", "shadow"])
def test_with_robust_weights_the_start_changes_little(kind: str) -> None:
    scene = damaged(kind)
    mesh = fedic.rectangle_mesh((48.0, 48.0, 272.0, 272.0), 16.0)
    correlator = fedic.Correlator(scene.reference, mesh, robust="tukey")
    points = mesh.points[:, :2]
    truth = scene.displacement(points)
    wobble = 0.3 * np.sin(0.05 * points)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fedic.QualityWarning)
        near, far = (correlator.correlate(scene.deformed, start) for start in (truth, truth + wobble))
    difference = np.linalg.norm(near.displacement - far.displacement, axis=1)
    assert np.sqrt(np.nanmean(difference**2)) < 0.001
    assert np.nanmax(difference) < 0.01


def test_a_mask_moves_with_the_specimen() -> None:
    """A dark patch hides the specimen at one place of it, in all frames."""

    def hidden(number: int) -> NDArray[np.uint8]:
        image = frame(number).copy()
        u, v = np.rint(np.array([60.0, 60.0]) + np.multiply(STEP, number)).astype(int)
        image[v : v + 20, u : u + 20] = 10
        return image

    images = [hidden(number) for number in range(1, 7)]
    mask = [[(58.0, 58.0), (82.0, 58.0), (82.0, 82.0), (58.0, 82.0)]]
    campaign = run(hidden(0), images, MESH, mask=mask, reference_update="previous")
    assert campaign.frames[5].reference == 4
    assert error(campaign[5], 6) < 0.05
    assert campaign[5].valid_nodes.all()


def test_the_mean_of_static_images_has_less_noise() -> None:
    def static(number: float, count: int) -> list[NDArray[np.uint8]]:
        rng = np.random.default_rng(int(10 * number) + 5)
        clean = frame(number, noise=0.0).astype(float)
        return [
            np.clip(np.rint(clean + rng.normal(0, 4.0, clean.shape)), 0, 255).astype(np.uint8) for _ in range(count)
        ]

    single = run(static(0, 1), [static(1, 1)], MESH, noise=4.0)
    mean = run(static(0, 16), [static(1, 16)], MESH, noise=4.0)
    assert error(mean[0], 1) < 0.4 * error(single[0], 1)
    assert mean[0].quality.noise == pytest.approx(1.0)
    assert single[0].quality.noise == pytest.approx(4.0)
    half = run(static(0, 16), [static(1, 1)], MESH, noise=4.0)
    assert half[0].quality.noise == pytest.approx(4.0 * np.sqrt((1 / 16 + 1) / 2))
    estimated = run(static(0, 16), [static(1, 16)], MESH)
    assert estimated[0].quality.noise == pytest.approx(1.0, rel=0.15)
    with pytest.raises(fedic.OptionError, match="means of different numbers of images"):
        fedic.Campaign(frame(0), [static(1, 2), frame(2)], MESH, noise=4.0)
    with pytest.raises(fedic.OptionError, match="a mean of another number of images than the frames"):
        fedic.Campaign(static(0, 2), [frame(1)], MESH, noise=4.0, reference_update="auto")


def test_progress_tells_frame_residual_and_doubtful_cells() -> None:
    images = [frame(1), frame(2).copy()]
    images[1].flags.writeable = True
    images[1][40:80, 40:80] = 128
    seen: list[fedic.Progress] = []
    campaign = fedic.Campaign(frame(0), images, MESH)
    with pytest.warns(fedic.QualityWarning, match="1 of 2 frames did not converge or are doubtful, the first being"):
        campaign.run(progress=seen.append)
    done = [progress for progress in seen if progress.frame]
    assert [progress.frame for progress in done] == [1, 2]
    assert [progress.frames for progress in done] == [2, 2]
    assert done[0].flagged_cells == 0
    assert done[1].flagged_cells == int((campaign[1].quality.cell_flags != 0).sum()) > 0
    assert done[1].residual_rms == campaign.frames[1].residual_rms


def test_the_progress_bar_names_the_frame(capsys: pytest.CaptureFixture[str]) -> None:
    fedic.Campaign(frame(0), frames(2), MESH).run(progress=True)
    assert "frame" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"starts": "random"}, "starts"),
        ({"reference_update": "always"}, "reference_update"),
        ({"strain_measure": "log"}, "strain_measure"),
        ({"times": "now"}, "times='now'"),
        ({"times": [0.0, 1.0]}, r"times has shape \(2,\)"),
        ({"times": [0.0, 2.0, 1.0]}, "increase from frame to frame"),
        ({"times": 0.0}, "greater than zero"),
        ({"regularisation": "smooth"}, "regularization"),
        ({"initial": "previous"}, "initial"),
    ],
)
def test_a_bad_argument_is_refused_before_anything_is_read(options: dict[str, Any], message: str) -> None:
    with pytest.raises(fedic.OptionError, match=message):
        fedic.Campaign("missing.tif", ["a.tif", "b.tif", "c.tif"], MESH, **options)


@pytest.mark.parametrize("images", [[], "nothing*.tif", 3, [3], [np.zeros((2, 3, 4))], "frame_%03d.tif"])
def test_what_is_no_series_of_frames_is_refused(images: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(fedic.OptionError, match="frame"):
        fedic.Campaign(frame(0), images, MESH)


def test_a_campaign_reads_tables_and_exports(tmp_path: Path) -> None:
    campaign = run(frame(0), frames(4), MESH, times=2.0)
    table = campaign.table(["x", "exx"], at=fedic.Gauge.rectangle(40.0, 40.0, 100.0, 100.0))
    np.testing.assert_allclose(table["x"], STEP[0] * np.arange(1, 5), atol=0.01)
    np.testing.assert_allclose(table["time"], np.arange(4) / 2.0)
    assert (table["exx_std"] > 0).all()
    assert campaign.frame_table()["rigid_y"].iloc[-1] == pytest.approx(4 * STEP[1], abs=0.01)
    machine = tmp_path / "machine.csv"
    rows = "".join(f"{0.1 * row:.1f},{row}\n" for row in range(40))
    machine.write_text(f"Time (s),Force (N)\n{rows}")
    joined = table.join(campaign.join(machine, time="Time"))
    np.testing.assert_allclose(joined["Force"], [0.0, 5.0, 10.0, 15.0])
    assert campaign.export(tmp_path / "nodes.csv").stat().st_size > 0


def test_several_campaigns_in_memory_exist_at_once() -> None:
    one, other = (run(frame(0), [frame(number)], MESH) for number in (1, 2))
    assert error(one[0], 1) < 0.016
    assert error(other[0], 2) < 0.016
