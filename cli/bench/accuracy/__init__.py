"""``splatline bench accuracy``: error against run time."""
