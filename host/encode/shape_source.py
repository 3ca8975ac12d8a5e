"""Where the shapes of symmetric elements come from: the host's table, or the engine's ROM."""

from __future__ import annotations

from collections.abc import Set

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError

__all__ = ["SHAPE_SOURCES", "check_shapes"]

SHAPE_SOURCES = {
    "table": "the host looks them up, and sends each element's rows",
    "rom": "the host sends sizes and normals, and the engine looks them up",
}
"""Names of the sources."""


def check_shapes(shapes: str, quality: str, skips: Set[str], config: EngineConfig) -> None:
    """Raise ``InputError`` unless the shapes can come from a source.

    Only the quality ``paper`` has shapes of whole sizes and levels, which a ROM can hold; and what
    is hidden is found by what the words before it cover, which compact ones do not say.
    """
    if shapes not in SHAPE_SOURCES:
        names = ", ".join(SHAPE_SOURCES)
        raise InputError(f"no source of shapes named {shapes!r}; there are: {names}")
    if shapes == "table":
        return
    if quality != "paper":
        raise InputError(f"shapes from the ROM need the quality paper, not {quality}")
    if "hidden" in skips:
        raise InputError(
            "shapes from the ROM do not go with the skip hidden: leave one of them out"
        )
    if config.shapes == "none":
        raise InputError(f"an engine of preset {config.name} has no shape ROM; take paper-rom")
