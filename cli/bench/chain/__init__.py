"""``splatline bench chain``: chains of engines."""
