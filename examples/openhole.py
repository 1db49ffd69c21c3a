"""The measurement of openhole.toml in Python, one frame."""

from pathlib import Path

import numpy as np

import fedic

data = Path(__file__).parents[2] / "shared" / "data" / "openhole"
cosine, sine = np.cos(-1.573863), np.sin(-1.573863)
rotation = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]]) @ np.diag([1.0, -1.0, -1.0])
camera = fedic.Pinhole((1.0, 1.0), (0.0, 0.0), rotation=rotation, translation=(0.081188, 0.096383, 0.000095))

mesh = fedic.read_mesh(data / "abaqus_q4_m.inp")
reference, deformed = (fedic.read_image(data / f"zoom-{frame}_1.tif") for frame in ("0053", "0070"))
result = fedic.correlate(reference, deformed, mesh, camera, initial="pyramid")
result.write("openhole-0070.vtu")
print(result)
