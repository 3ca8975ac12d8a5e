"""Skips: the reasons to leave a point out, by name."""

from __future__ import annotations

from collections.abc import Iterable

from splatline.contract.errors import InputError

__all__ = ["DEFAULT_SKIPS", "REASONS", "SKIPS", "check_skips"]

SKIPS = {
    "outside": "points that cannot touch the image",
    "facing_away": "points whose surface shows its back",
    "no_pixel": "points whose disc covers no pixel's centre; without this skip each is drawn as the"
    " pixel that holds it",
    "overdrawn": "points of one pixel that a nearer point of one pixel covers",
    "hidden": "points wholly behind nearer ones",
}
"""Names and meanings, in the order in which they are tested."""

REASONS = {name: number for number, name in enumerate(SKIPS, start=1)}
"""Their numbers in compiled code; a point that is kept has 0."""

DEFAULT_SKIPS = frozenset({"outside", "facing_away", "no_pixel", "overdrawn"})
"""The default skips (decisions 0011 and 0065)."""


def check_skips(skips: Iterable[str]) -> frozenset[str]:
    """Return a set of skips, or raise ``InputError`` for an unknown name."""
    chosen = frozenset(skips)
    unknown = sorted(chosen - SKIPS.keys())
    if unknown:
        raise InputError(f"no skip named {unknown[0]!r}; there are: {', '.join(SKIPS)}")
    return chosen
