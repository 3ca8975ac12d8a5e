"""``splatline bench stability``: the stress suite."""
