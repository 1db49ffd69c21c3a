#!/usr/bin/env bash
# OpenCV 5.0.0: the positions of a video in frames and in milliseconds are those of different frames
#
# Behaviour: after k frames are read, CAP_PROP_POS_FRAMES is k, the number of the frame that comes next, and CAP_PROP_POS_MSEC is the time
#   of the frame read last, k - 1 frames from the start. Before the first and before the second frame it is zero both times. Whoever
#   asks for the time before reading, as the description "current position of the video file in milliseconds" beside "0-based index of
#   the frame to be decoded/captured next" suggests, gives every frame but the first the time of the one before.
# Expected: both positions of the same frame.
# Output seen (opencv-python-headless 5.0.0.93, FFMPEG, 5 frames a second): frames 0 1 2 3, milliseconds before reading 0 0 200 400
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check opencv-python-headless==5.0.0.93 numpy==2.4.6
cd "$folder"
venv/bin/python - <<'PYTHON'
import cv2
import numpy as np

writer = cv2.VideoWriter("test.avi", cv2.VideoWriter.fourcc(*"MJPG"), 5.0, (64, 64))
for level in (0, 60, 120, 180):
    writer.write(np.full((64, 64, 3), level, np.uint8))
writer.release()
capture = cv2.VideoCapture("test.avi", cv2.CAP_FFMPEG)
assert capture.isOpened()
before, after, frames = [], [], []
for _ in range(4):
    frames.append(round(capture.get(cv2.CAP_PROP_POS_FRAMES)))
    before.append(round(capture.get(cv2.CAP_PROP_POS_MSEC)))
    assert capture.read()[0]
    after.append(round(capture.get(cv2.CAP_PROP_POS_MSEC)))
print("frames", *frames, "| milliseconds before reading", *before, "| after reading", *after)
assert frames == [0, 1, 2, 3], "the behaviour has changed"
assert before == [0, 0, 200, 400], "the behaviour has changed"
assert after == [0, 200, 400, 600], "the behaviour has changed"
PYTHON
