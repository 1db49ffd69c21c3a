"""Helpers without public interface."""
