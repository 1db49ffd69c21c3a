"""Camera files and poses."""
