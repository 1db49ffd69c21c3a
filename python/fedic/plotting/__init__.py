"""Figures of fields, calibrations and registrations."""
