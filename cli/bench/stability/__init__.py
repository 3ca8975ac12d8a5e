"""``splatline bench stability``: inputs that are meant to break it."""
