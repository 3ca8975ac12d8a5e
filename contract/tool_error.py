"""Failures of external tools."""

import click

__all__ = ["ToolFailure"]


class ToolFailure(click.ClickException):
    """A simulator or Yosys failed; the message may end with its log. Exit code 1."""

    exit_code = 1
