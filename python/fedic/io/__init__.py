"""Reading images and meshes, and writing results.

``images/`` reads image files, a module for each format, recognised by the first bytes in ``images/_formats.py``.
``mesh_formats/`` reads and writes mesh files, a module or package for each format, listed in its ``_readers.py`` and
``_writers.py``. ``meshes.py`` makes a mesh of what they return; ``mesh_parts/`` chooses from it. ``files.py``,
``text.py``, ``toml.py`` and ``limits.py`` are what all readers share, also those of cameras.
"""
