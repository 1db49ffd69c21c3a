"""Initial displacement of large motions: one estimator a file, joined in `fedic.starts.estimators`."""
