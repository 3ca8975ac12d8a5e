"""``splatline bench engine``: cycles beside the fewest possible."""
