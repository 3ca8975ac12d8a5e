"""``splatline bench configurations``: comparison of windows, widths and depths."""
