"""Variants by name."""

from splatline.contract.variants import VARIANTS

__all__ = ["variant"]


def variant(name):
    """Return the variant of that name."""
    return next(config for config in VARIANTS if config.name == name)
