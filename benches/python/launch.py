"""Run a command as a fresh process and print its exit code, seconds and peak memory: python launch.py LOG COMMAND ...

A process starts with the peak memory of the one that starts it: a small process stands between the comparison, which
holds results, and each measurement, so that this floor is about 15 MB. What the command prints goes to LOG.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

from measure import megabytes


def main() -> None:
    """Print ``exit_code N seconds S cpu_seconds C peak_MB M``."""
    with Path(sys.argv[1]).open("w") as log:
        start = time.perf_counter()
        process = subprocess.Popen(sys.argv[2:], stdout=log, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    cpu, peak = usage.ru_utime + usage.ru_stime, megabytes(usage.ru_maxrss)
    sys.stdout.write(f"exit_code {process.returncode} seconds {seconds:.6g} cpu_seconds {cpu:.6g} peak_MB {peak:.6g}\n")


if __name__ == "__main__":
    main()
