"""``splatline bench surface``: pictures of sampled scenes against their true surfaces."""
