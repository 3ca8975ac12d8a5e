"""What a scene does not need: the reasons to leave a point out, by name."""

from __future__ import annotations

from collections.abc import Iterable

from splatline.contract.errors import InputError

__all__ = ["DEFAULT_SKIPS", "REASONS", "SKIPS", "check_skips"]

SKIPS = {
    "outside": "points that cannot touch the image",
    "facing_away": "points whose surface shows its back",
    "no_pixel": "points whose disc covers no pixel's centre; kept, each is drawn as the pixel that"
    " holds it",
    "hidden": "points wholly behind what is nearer",
    "crowded": "points beyond a few a pixel, the others growing to fill their place (lossy)",
}
"""Every skip, in the order in which they are tried."""

REASONS = {name: number for number, name in enumerate(SKIPS, start=1)}
"""Their numbers in compiled code; 0 is a point that is kept."""

DEFAULT_SKIPS = frozenset({"outside", "facing_away", "no_pixel"})
"""What is left out unless asked otherwise (decision 0011)."""


def check_skips(skips: Iterable[str]) -> frozenset[str]:
    """Return a set of skips, or raise ``InputError`` for a name that is none."""
    chosen = frozenset(skips)
    unknown = sorted(chosen - SKIPS.keys())
    if unknown:
        raise InputError(f"no skip named {unknown[0]!r}; there are: {', '.join(SKIPS)}")
    return chosen
