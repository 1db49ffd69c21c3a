"""Rules on the structure of the sources: imports between files, length of files, headers of folders."""
