"""Measurement of a series of images described by a configuration file."""
