"""The one kind of error that a user's input can cause."""

__all__ = ["InputError", "install_hint"]


class InputError(ValueError):
    """Bad input, with a one-line message that says what was wrong and what to do.

    The command line prints the message and exits with code 2.
    """


def install_hint(extra: str) -> str:
    """Return how the packages of an extra of ``pyproject.toml`` are installed."""
    return f"pip install '.[{extra}]' in Splatline's folder"
