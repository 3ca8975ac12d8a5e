"""Mutants that survive since they change no result, and why."""

__all__ = ["EQUAL"]

EQUAL: dict[tuple[str, str], str] = {}
"""Reasons by file and changed line, without spaces about it."""
