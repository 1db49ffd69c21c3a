"""Measure a pair with pyvale, 21 px subsets every SIZE: python pair_pyvale.py REF DEF X0 Y0 X1 Y1 SIZE THREADS OUT."""

import time

from measure import arguments, report, save_field

_SUBSET = 21
_PREFIX = "pyvale_"


def main() -> None:
    """Measure with the default method (affine subsets) and leave the displacement at their centres.

    Subsets iterate apart: the time of an iteration is that of the whole calculation over the mean number of them.
    """
    given = arguments()
    start = time.perf_counter()
    import cv2
    import numpy as np
    import pyvale.dic as dic  # type: ignore[import-not-found]

    imported = time.perf_counter()
    image = cv2.imread(str(given.reference), cv2.IMREAD_GRAYSCALE)
    assert image is not None, f"{given.reference} is no image"
    x0, y0, x1, y1 = map(int, given.bounds)
    region = np.zeros(image.shape, dtype=bool)
    region[y0:y1, x0:x1] = True
    begin = time.perf_counter()
    dic.calculate_2d(
        reference=given.reference,
        deformed=[given.deformed],
        roi_mask=region,
        seed=[(x0 + x1) // 2, (y0 + y1) // 2],
        subset_size=_SUBSET,
        subset_step=int(given.size),
        num_threads=given.threads,
        output_basepath=given.out.parent,
        output_prefix=_PREFIX,
        print_level=0,
    )
    calculated = time.perf_counter() - begin
    (table,) = given.out.parent.glob(f"{_PREFIX}{given.deformed.stem}*.csv")
    found = dic.import_2d(table, delimiter=",", layout="column", print_level=0)
    columns = (found.ss_x, found.ss_y, found.u_px, found.v_px, found.niter)
    x, y, u, v, iterations = (np.ravel(np.asarray(column, dtype=np.float64)) for column in columns)
    save_field(given.out, np.column_stack([x, y]), np.column_stack([u, v]))
    times = {"seconds": time.perf_counter() - start, "import": imported - start}
    mean = float(iterations.mean())
    report(points=x.size * _SUBSET**2, unknowns=2 * x.size, iterations=mean, iteration=calculated / mean, **times)


if __name__ == "__main__":
    main()
