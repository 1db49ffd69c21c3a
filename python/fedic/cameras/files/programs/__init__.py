"""Camera files of each program."""
