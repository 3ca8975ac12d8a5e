"""``splatline bench host``: run time of host and golden."""
