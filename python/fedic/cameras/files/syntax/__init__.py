"""Syntax of files that hold cameras: YAML, XML, arrays, as trees of texts and numbers."""
