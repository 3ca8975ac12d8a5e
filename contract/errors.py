"""The error that bad input raises."""

__all__ = ["InputError", "install_hint"]


class InputError(ValueError):
    """Bad input; the message is one line with the cause and a remedy.

    The command line prints the message and exits with code 2.
    """


def install_hint(extra: str) -> str:
    """Return the command that installs an extra of ``pyproject.toml``."""
    return f"pip install '.[{extra}]' in Splatline's folder"
