"""The ways to turn a splat into code words."""

__all__ = ["AS_PAPER", "DEFAULT_QUALITY", "EXACT", "FAST", "QUALITIES"]

QUALITIES = {
    "paper": "the symmetric shape always, at whole places and whole diameters",
    "fast": "one word a splat up to 8 pixels, a fraction at the true place where it fits one, "
    "else a symmetric shape of the true size at the nearest half pixel; larger ones as exact, in "
    "whole fractions",
    "exact": "fractions at the true place and size, each with its own depth, halved where steep",
}
"""Names and meanings."""

AS_PAPER, FAST, EXACT = (list(QUALITIES).index(name) for name in ("paper", "fast", "exact"))
"""Their numbers, for compiled code."""

DEFAULT_QUALITY = "exact"
"""Highest PSNR on every scene measured, for as many words as ``fast`` wherever splats are small
(decision 0001)."""
