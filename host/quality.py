"""The ways to turn a splat into code words."""

__all__ = ["DEFAULT_QUALITY", "QUALITIES"]

QUALITIES = {
    "paper": "the symmetric shape always, at whole places and whole diameters",
    "fast": "a fraction at the true place where that takes one word; else the symmetric shape",
    "exact": "fractions at the true place and size, each with its own depth",
}
"""Names, in the order in which the compiled code numbers them."""

DEFAULT_QUALITY = "exact"
"""Best on every scene, for as many words as ``fast`` wherever splats are small
(``docs/decisions.md``)."""
