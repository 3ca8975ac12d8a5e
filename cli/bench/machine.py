"""The machine that a benchmark ran on."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from splatline.cli.report.statistics import tool_versions

__all__ = ["described", "machine"]


def machine() -> dict[str, Any]:
    """Return the platform, the processor and the cores that this process may use."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {"platform": platform.platform(), "processor": _processor(), "cores": cores or 1}


def described(*packages: str) -> str:
    """Return this machine and its tools' versions in words, with those of further packages."""
    from importlib import metadata

    here = machine()
    tools = tool_versions("golden") | {name: metadata.version(name) for name in packages}
    versions = ", ".join(f"{name} {version}" for name, version in tools.items())
    return f"{here['processor'] or here['platform']}, {here['cores']} cores; {versions}"


def _processor() -> str:
    """Return the processor's name if the system tells it, else its type."""
    try:
        lines: Sequence[str] = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = ()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()
