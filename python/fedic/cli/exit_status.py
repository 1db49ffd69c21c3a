"""Exit statuses of the commands; 0 if everything is done and nothing is doubtful."""

__all__ = ["EXIT_DOUBTFUL", "EXIT_ERROR", "EXIT_INTERRUPTED"]

EXIT_ERROR = 2
EXIT_DOUBTFUL = 3
"""After a result that did not converge or is doubtful."""
EXIT_INTERRUPTED = 130
