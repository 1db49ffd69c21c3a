"""Command line of fedic."""

from fedic.cli._app import app

__all__ = ["app"]
