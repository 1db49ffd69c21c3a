"""The plate of 3 x 2 by 6 quads, or by 4 quads and 4 triangles."""

import numpy as np

__all__ = ["LEFT", "MIXED_QUADS", "POINTS", "QUADS", "TRIANGLES"]

POINTS = np.array([(x, y, 0.0) for y in range(3) for x in range(4)])
QUADS = np.array([(i, i + 1, i + 5, i + 4) for i in (0, 1, 2, 4, 5, 6)])
MIXED_QUADS = QUADS[:4]
TRIANGLES = np.array([t for a, b, c, d in QUADS[4:].tolist() for t in ((a, b, c), (a, c, d))])
LEFT = np.flatnonzero(POINTS[:, 0] == 0.0)
