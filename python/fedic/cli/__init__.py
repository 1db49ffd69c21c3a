"""Command line of fedic.

The application is imported when it is asked for, so that Ctrl-C meanwhile ends the command as it does later.
"""

import sys
from typing import TYPE_CHECKING

from fedic.cli.exit_status import EXIT_INTERRUPTED

if TYPE_CHECKING:
    from fedic.cli._app import app

__all__ = ["app"]


def __getattr__(name: str) -> object:
    if name != "app":
        raise AttributeError(f"module 'fedic.cli' has no attribute {name!r}")
    try:
        from fedic.cli._app import app
    except KeyboardInterrupt:
        sys.stderr.write("fedic: interrupted\n")
        raise SystemExit(EXIT_INTERRUPTED) from None
    return app
