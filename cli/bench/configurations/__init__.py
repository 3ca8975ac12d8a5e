"""``splatline bench configurations``: windows, sizes and depths compared."""
