"""Initial displacement fields for large motions."""
