"""The ways to turn a splat into code words, and the sources of the symmetric shapes."""

from __future__ import annotations

from collections.abc import Set

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError

__all__ = [
    "AS_PAPER",
    "DEFAULT_QUALITY",
    "EXACT",
    "FAST",
    "QUALITIES",
    "SHAPE_SOURCES",
    "check_shapes",
]

QUALITIES = {
    "paper": "every splat is a symmetric shape at a whole-pixel position, of a whole diameter",
    "fast": "a splat of up to 8 x 8 pixels is one word: a fraction at the true position if it "
    "fits, else a symmetric shape of the true size at the nearest half pixel; a larger splat is "
    "drawn as in exact, but fractions stay whole",
    "exact": "a splat is fractions at the true position and of the true size; each has its own "
    "depth, and steep ones are halved",
}
"""Names and meanings."""

AS_PAPER, FAST, EXACT = (list(QUALITIES).index(name) for name in ("paper", "fast", "exact"))
"""Their numbers, for compiled code."""

DEFAULT_QUALITY = "exact"
"""``exact`` has the highest PSNR on every scene measured. It takes as many words as ``fast``
wherever splats are small (decision 0001)."""

SHAPE_SOURCES = {
    "table": "the host looks shapes up and sends each element's rows",
    "rom": "the host sends sizes and normals, and the engine looks shapes up",
}
"""Sources of the shapes of symmetric elements: names and meanings."""


def check_shapes(shapes: str, quality: str, skips: Set[str], config: EngineConfig) -> None:
    """Raise ``InputError`` unless a source can supply the shapes.

    A ROM holds shapes of whole sizes and quantised normals, which only the quality ``paper`` uses.
    The skip ``hidden`` needs the rows of the words, which compact words do not have.
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
