"""The frames of a campaign: patterns, numbered files, videos, means and times."""

import os
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image

import fedic
from fedic.campaign.frames import FrameSeries, read_ahead
from fedic.campaign.frames.times import file_time
from scenes.series import MESH, frame, write_frames


def names(series: FrameSeries) -> list[str]:
    return [each.name for each in series]


def test_a_pattern_is_in_the_order_of_the_numbers(tmp_path: Path) -> None:
    for number in (10, 9, 1, 100):
        (tmp_path / f"f_{number}.tif").touch()
    assert names(FrameSeries(str(tmp_path / "f_*.tif"))) == ["f_1", "f_9", "f_10", "f_100"]


@pytest.mark.parametrize(("pattern", "form"), [("f_%03d.tif", "f_{:03d}.tif"), ("50%d[a].tif", "50{}[a].tif")])
def test_missing_files_of_a_numbered_pattern_are_frames(tmp_path: Path, pattern: str, form: str) -> None:
    for number in (7, 8, 11):
        (tmp_path / form.format(number)).touch()
    (tmp_path / "f_x.tif").touch()
    expected = [Path(form.format(number)).stem for number in range(7, 12)]
    series = FrameSeries(str(tmp_path / pattern))
    assert names(series) == expected
    loaded = list(read_ahead(series))
    assert ["there is no such image file" in each.error for each in loaded] == [False, False, True, True, False]


def test_a_video_gives_frames_and_times(tmp_path: Path) -> None:
    path = tmp_path / "test.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 5.0, (144, 144), isColor=False)
    assert writer.isOpened()
    for number in range(4):
        writer.write(np.array(frame(number)))
    writer.release()
    loaded = list(read_ahead(FrameSeries(path)))
    assert [each.frame.time for each in loaded] == pytest.approx([0.0, 0.2, 0.4, 0.6])
    for number, each in enumerate(loaded):
        assert each.image is not None
        assert np.abs(each.image.astype(float) - frame(number)).mean() < 5.0
    campaign = fedic.Campaign(frame(0), path, MESH).run(progress=False)
    assert len(campaign) == 4
    assert campaign.frames[3].time == pytest.approx(0.6)
    (tmp_path / "no.mp4").write_bytes(b"no video")
    with pytest.raises(fedic.ImageError, match="OpenCV cannot read this video"):
        list(FrameSeries(tmp_path / "no.mp4"))
    with pytest.raises(fedic.ImageError, match="there is no such video"):
        FrameSeries(tmp_path / "none.mp4")


def test_the_buffer_of_a_camera_may_be_filled_again() -> None:
    def camera() -> Any:
        buffer = np.zeros((4, 4), dtype=np.uint8)
        for number in range(10):
            buffer[:] = number
            yield 0.1 * number, buffer

    loaded = list(read_ahead(FrameSeries(camera())))
    assert [int(each.image[0, 0]) for each in loaded if each.image is not None] == list(range(10))
    assert loaded[3].frame.time == pytest.approx(0.3)


def test_a_fault_of_a_stream_is_raised_after_the_frames_before() -> None:
    def camera() -> Any:
        yield frame(1)
        raise RuntimeError("unplugged")

    seen = []
    with pytest.raises(RuntimeError, match="unplugged"):
        seen.extend(read_ahead(FrameSeries(camera())))
    campaign = fedic.Campaign(frame(0), camera(), MESH)
    with pytest.raises(RuntimeError, match="unplugged"):
        campaign.run(progress=False)
    assert len(campaign) == 1


def test_images_of_a_mean_have_one_size(tmp_path: Path) -> None:
    files = write_frames(tmp_path, 1)
    assert len(fedic.Campaign(files, [[files[1], frame(1)]], MESH)) == 0
    loaded = next(iter(read_ahead(FrameSeries([[files[1], frame(1)[:-1]]]))))
    assert "the images of a mean must have one size" in loaded.error


def test_times_come_from_where_they_are_asked_for(tmp_path: Path) -> None:
    files = write_frames(tmp_path, 2)[1:]
    for number, file in enumerate(files):
        os.utime(file, (1e9, 1.5e9 + 0.25 * number))
    entries: Any = files
    assert [each.time for each in FrameSeries(entries, "modified")] == [1.5e9, 1.5e9 + 0.25]
    assert [each.time for each in FrameSeries(entries, 4.0)] == [0.0, 0.25]
    assert [each.time for each in FrameSeries(entries, [3.0, 7.0])] == [3.0, 7.0]
    assert np.isnan([each.time for each in FrameSeries(entries)]).all()
    assert np.isnan(file_time([tmp_path / "none.tif"], "modified"))


@pytest.mark.parametrize("suffix", [".jpg", ".png"])
def test_the_camera_records_the_time_in_the_file(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"frame{suffix}"
    tags = Image.Exif()
    tags[0x0132] = "2026:03:04 05:06:07"
    details = tags.get_ifd(0x8769)
    details[0x9003], details[0x9291] = "2026:03:04 05:06:08", "25"
    Image.fromarray(frame(0)).save(path, exif=tags)
    expected = 1772600768.25
    assert file_time([path], "recorded") == pytest.approx(expected, abs=1e-3)
    assert file_time([path, path], "recorded") == pytest.approx(expected, abs=1e-3)


def test_a_file_without_a_time_has_none(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "a.tif", frame(0), datetime=None)
    tifffile.imwrite(tmp_path / "b.tif", frame(0), datetime="2026:03:04 05:06:07")
    (tmp_path / "c.tif").write_bytes(b"damaged")
    times = [file_time([tmp_path / name], "recorded") for name in ("a.tif", "b.tif", "c.tif")]
    np.testing.assert_array_equal(times, [np.nan, 1772600767.0, np.nan])
