"""The one kind of error that a user's input can cause."""

__all__ = ["InputError"]


class InputError(ValueError):
    """Bad input, with a one-line message that says what was wrong and what to do.

    The command line prints the message and exits with code 2.
    """
