"""Exit statuses of the commands; 0 if everything is done and nothing is doubtful."""

__all__ = ["EXIT_DOUBTFUL", "EXIT_ERROR", "EXIT_EXCEEDED", "EXIT_INTERRUPTED"]

EXIT_ERROR = 2
EXIT_DOUBTFUL = 3
"""After a result that did not converge or is doubtful."""
EXIT_EXCEEDED = 4
"""After a value that exceeds a limit of the user."""
EXIT_INTERRUPTED = 130
